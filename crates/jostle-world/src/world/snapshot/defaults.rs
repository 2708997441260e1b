//! Serialization of the values of new particles.

use super::super::Defaults;
use jostle_base::bytes::{Reader, Writer};
use jostle_base::error::Result;
use jostle_index::shapes::Filter;

/// Stands for no value: no radius and no mass is below 0.
const NONE: f32 = -1.0;

pub(super) fn put_defaults(to: &mut Writer, defaults: &Defaults) {
    let Defaults { radius, mass, density, restitution, friction, filter } = *defaults;
    to.put([radius.unwrap_or(NONE), mass.unwrap_or(NONE), density, restitution, friction]);
    to.put([filter.category, filter.mask]);
}

pub(super) fn get_defaults(from: &mut Reader<'_>) -> Result<Defaults> {
    let [radius, mass, density, restitution, friction] = from.get()?;
    let [radius, mass] = [radius, mass].map(|value| Some(value).filter(|&value| value != NONE));
    let [category, mask] = from.get()?;
    let filter = Filter { category, mask };
    Ok(Defaults { radius, mass, density, restitution, friction, filter })
}
