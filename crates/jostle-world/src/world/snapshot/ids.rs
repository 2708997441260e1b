//! Serialization of ids.

use super::super::ids::Ids;
use jostle_base::bytes::{Reader, Writer, damaged};
use jostle_base::error::Result;
use jostle_base::ids::Id;

pub(super) fn put_ids(to: &mut Writer, ids: &Ids) {
    let (listed, next) = ids.parts();
    to.put(next as u64);
    to.put(u8::from(listed.is_some()));
    // None is below 0.
    to.put_all(&listed.unwrap_or_default().iter().map(|&id| id as u64).collect::<Vec<u64>>());
}

/// The ids of `len` rows.
pub(super) fn get_ids(from: &mut Reader<'_>, len: usize) -> Result<Ids> {
    let next = from.get::<u64>()? as Id;
    let listed = if from.get::<u8>()? > 0 {
        let all: Vec<u64> = from.get_all(len)?;
        Some(all.into_iter().map(|id| id as Id).collect())
    } else {
        None
    };
    Ids::read(listed, len, next).map_err(|error| damaged(&error.to_string()))
}
