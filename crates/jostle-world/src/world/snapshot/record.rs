//! Serialization of the record of collisions and touching pairs.

use super::super::World;
use super::super::record::{Collisions, Record};
use jostle_base::bytes::{Reader, Writer, damaged};
use jostle_base::error::Result;
use jostle_base::ids::Id;

pub(super) fn put_record(to: &mut Writer, world: &World) {
    let record = &world.record;
    let collisions = record.collisions();
    to.put([collisions.pairs, collisions.walls]);
    to.put(u8::from(world.settings.track_events));
    for pairs in [&record.before, &record.sorted(), &record.at_end] {
        to.put_count(pairs.len());
        // No id is below 0.
        to.put_all(&pairs.iter().map(|pair| pair.map(|id| id as u64)).collect::<Vec<[u64; 2]>>());
    }
}

/// Reads it into a world whose ids are known.
pub(super) fn get_record(from: &mut Reader<'_>, world: &mut World) -> Result<()> {
    let [of_pairs, walls] = from.get()?;
    world.settings.track_events = from.get::<u8>()? > 0;
    let (_, next) = world.ids.parts();
    let mut list = || -> Result<Vec<[Id; 2]>> {
        let count = from.get_count()?;
        let all: Vec<[u64; 2]> = from.get_all(count)?;
        let is_pair = |&[a, b]: &[u64; 2]| a < b && b < next as u64;
        if !all.iter().all(is_pair) || !all.is_sorted_by(|a, b| a < b) {
            return Err(damaged("two particles that touched have no ids"));
        }
        Ok(all.into_iter().map(|pair| pair.map(|id| id as Id)).collect())
    };
    let pairs = [list()?, list()?, list()?];
    let has_pairs = pairs.iter().any(|pairs| !pairs.is_empty());
    if has_pairs && !world.settings.track_events {
        return Err(damaged("it has events, but tracks none"));
    }
    world.record = Record::restored(Collisions { pairs: of_pairs, walls }, pairs);
    Ok(())
}
