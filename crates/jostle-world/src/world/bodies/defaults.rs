//! Values of new particles for which the caller gives none.

use crate::particles::{check_friction, check_masses, check_radii, check_restitutions};
use jostle_base::error::{Error, Result};
use jostle_base::saved;
use jostle_index::shapes::Filter;

/// What callers of [`World::add`](crate::World::add) take for columns that they leave out: the last number that was
/// given for all particles. The world only keeps it, in snapshots too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Defaults {
    /// Radius, if there is one.
    pub radius: Option<f32>,
    /// Mass; None if it follows from the density.
    pub mass: Option<f32>,
    /// Mass over radius squared.
    pub density: f32,
    /// Coefficient of restitution.
    pub restitution: f32,
    /// Coefficient of friction.
    pub friction: f32,
    /// Category and mask.
    pub filter: Filter,
}

saved! { struct Defaults { radius, mass, density, restitution, friction, filter } }

impl Default for Defaults {
    fn default() -> Self {
        Self {
            radius: None,
            mass: None,
            density: 1.0,
            restitution: 1.0,
            friction: 0.0,
            filter: Filter::default(),
        }
    }
}

impl Defaults {
    /// Refuses values that no particle can have.
    pub(crate) fn validate(&self) -> Result<()> {
        check_radii(self.radius.as_slice())?;
        check_masses(self.mass.as_slice())?;
        if !(self.density > 0.0 && self.density.is_finite()) {
            let rule = "a density must be finite and above 0";
            return Err(Error::of("densities", self.density, rule));
        }
        check_restitutions(&[self.restitution])?;
        check_friction(&[self.friction])
    }
}
