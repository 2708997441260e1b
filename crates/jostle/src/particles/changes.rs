//! New values of some columns of particles.

use super::{
    Particles, Spin, check_angles, check_angular_velocities, check_friction, check_masses,
    check_radii, check_restitutions, check_vectors, wrap_angle,
};
use crate::error::Result;
use crate::shapes::{Each, Filter};
use crate::table::sparse;

/// New values of some columns, as callers see them, with a value for each of some particles or one for
/// all of them. None leaves a column as it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Changes {
    /// Centres.
    pub positions: Option<Each<[f32; 2]>>,
    /// Residuals of the centres; 0 if there are new centres without residuals.
    pub residuals: Option<Each<[f32; 2]>>,
    /// Velocities.
    pub velocities: Option<Each<[f32; 2]>>,
    /// Radii.
    pub radii: Option<Each<f32>>,
    /// Masses.
    pub masses: Option<Each<f32>>,
    /// Coefficients of restitution.
    pub restitutions: Option<Each<f32>>,
    /// Whether the particles are movable.
    pub movable: Option<Each<bool>>,
    /// Coefficients of friction.
    pub friction: Option<Each<f32>>,
    /// Angles in radians.
    pub angles: Option<Each<f64>>,
    /// Angular velocities.
    pub angular_velocities: Option<Each<f32>>,
    /// Categories.
    pub categories: Option<Each<u32>>,
    /// Masks.
    pub masks: Option<Each<u32>>,
    /// Whether the particles are sensors.
    pub sensors: Option<Each<bool>>,
}

/// What changes change of one particle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Nothing.
    None,
    /// The velocity or the angular velocity alone.
    Velocity,
    /// Anything else.
    Other,
}

impl Changes {
    /// Refuses columns that do not have `len` values, and values out of range.
    pub fn validate(&self, len: usize) -> Result<()> {
        // All columns are named, so that none is forgotten.
        #[rustfmt::skip]
        let Self {
            positions, residuals, velocities, radii, masses, restitutions, movable, friction, angles,
            angular_velocities, categories, masks, sensors,
        } = self;
        check("positions", positions, len, |all| check_vectors("positions", all))?;
        check("residuals", residuals, len, |all| check_vectors("residuals", all))?;
        check("velocities", velocities, len, |all| check_vectors("velocities", all))?;
        check("radii", radii, len, check_radii)?;
        check("masses", masses, len, check_masses)?;
        check("restitutions", restitutions, len, check_restitutions)?;
        check("movable", movable, len, |_| Ok(()))?;
        check("friction", friction, len, check_friction)?;
        check("angles", angles, len, check_angles)?;
        check("angular_velocities", angular_velocities, len, check_angular_velocities)?;
        check("categories", categories, len, |_| Ok(()))?;
        check("masks", masks, len, |_| Ok(()))?;
        check("sensors", sensors, len, |_| Ok(()))
    }

    /// What the values of `index` change of the particle in a row.
    pub fn effect(&self, index: usize, particles: &Particles, row: usize) -> Effect {
        let (position, residual) = (particles.positions[row], particles.residuals[row]);
        let (spin, filter) = (particles.spin(row), particles.filter(row));
        let turned = self.spin(index, spin, value(&self.radii, index, particles.radii[row]));
        let is_same_at_rest = value(&self.positions, index, position) == position
            && self.residual(index).unwrap_or(residual) == residual
            && is_same(&self.radii, index, particles.radii[row])
            && is_same(&self.masses, index, particles.masses[row])
            && is_same(&self.restitutions, index, particles.restitutions[row])
            && is_same(&self.movable, index, particles.movable[row])
            && Spin { velocity: spin.velocity, ..turned } == spin
            && self.filter(index, filter) == filter
            && is_same(&self.sensors, index, particles.is_sensor(row));
        if !is_same_at_rest {
            Effect::Other
        } else if !is_same(&self.velocities, index, particles.velocities[row]) || turned != spin {
            Effect::Velocity
        } else {
            Effect::None
        }
    }

    /// Writes the values over those of the particles in some rows. Rows that `particles` does not have are
    /// left out.
    pub fn write(&self, particles: &mut Particles, rows: &[u32]) {
        let len = particles.len();
        // All columns are named, so that none is forgotten.
        #[rustfmt::skip]
        let Particles {
            positions, residuals, velocities, radii, masses, restitutions, movable, spins, filters, sensors,
        } = particles;
        if self.positions.is_some() && self.residuals.is_none() {
            put(&Some(Each::One([0.0; 2])), residuals, rows);
        }
        put(&self.residuals, residuals, rows);
        put(&self.positions, positions, rows);
        put(&self.velocities, velocities, rows);
        put(&self.radii, radii, rows);
        put(&self.masses, masses, rows);
        put(&self.restitutions, restitutions, rows);
        put(&self.movable, movable, rows);
        if self.turns() || self.radii.is_some() && !spins.is_empty() {
            put_sparse(spins, len, rows, |index, row, spin| self.spin(index, spin, radii[row]));
        }
        if self.categories.is_some() || self.masks.is_some() {
            put_sparse(filters, len, rows, |index, _, filter| self.filter(index, filter));
        }
        if self.sensors.is_some() {
            put_sparse(sensors, len, rows, |index, _, own| value(&self.sensors, index, own));
        }
    }

    /// Whether friction or rotation changes.
    fn turns(&self) -> bool {
        self.friction.is_some() || self.angles.is_some() || self.angular_velocities.is_some()
    }

    /// The new residual, if there is one.
    fn residual(&self, index: usize) -> Option<[f32; 2]> {
        let given = self.residuals.as_ref().map(|residuals| residuals.at(index));
        given.or(self.positions.as_ref().map(|_| [0.0; 2]))
    }

    /// Friction and rotation instead of `old` ones, of a disc with its new radius; points do not turn.
    fn spin(&self, index: usize, old: Spin, radius: f32) -> Spin {
        let velocity = value(&self.angular_velocities, index, old.velocity);
        Spin {
            friction: value(&self.friction, index, old.friction),
            velocity: if radius == 0.0 { 0.0 } else { velocity },
            angle: wrap_angle(value(&self.angles, index, old.angle)),
        }
    }

    fn filter(&self, index: usize, old: Filter) -> Filter {
        Filter {
            category: value(&self.categories, index, old.category),
            mask: value(&self.masks, index, old.mask),
        }
    }
}

/// All columns of particles.
impl From<Particles> for Changes {
    fn from(all: Particles) -> Self {
        let len = all.len();
        // All columns are named, so that none is forgotten.
        #[rustfmt::skip]
        let Particles {
            positions, residuals, velocities, radii, masses, restitutions, movable,
            mut spins, mut filters, mut sensors,
        } = all;
        spins.resize(len, Spin::default());
        filters.resize(len, Filter::default());
        sensors.resize(len, false);
        Self {
            positions: Some(Each::Rows(positions)),
            residuals: Some(Each::Rows(residuals)),
            velocities: Some(Each::Rows(velocities)),
            radii: Some(Each::Rows(radii)),
            masses: Some(Each::Rows(masses)),
            restitutions: Some(Each::Rows(restitutions)),
            movable: Some(Each::Rows(movable)),
            friction: Some(Each::Rows(spins.iter().map(|spin| spin.friction).collect())),
            angles: Some(Each::Rows(spins.iter().map(|spin| spin.angle).collect())),
            angular_velocities: Some(Each::Rows(spins.iter().map(|spin| spin.velocity).collect())),
            categories: Some(Each::Rows(filters.iter().map(|filter| filter.category).collect())),
            masks: Some(Each::Rows(filters.iter().map(|filter| filter.mask).collect())),
            sensors: Some(Each::Rows(sensors)),
        }
    }
}

fn check<V: Copy>(
    argument: &'static str,
    column: &Option<Each<V>>,
    len: usize,
    check: impl Fn(&[V]) -> Result<()>,
) -> Result<()> {
    let Some(values) = column else { return Ok(()) };
    values.check_len(argument, len)?;
    values.check(check)
}

/// The new value, or the old one if there is none.
#[inline(always)]
fn value<V: Copy>(column: &Option<Each<V>>, index: usize, old: V) -> V {
    column.as_ref().map_or(old, |values| values.at(index))
}

fn is_same<V: Copy + PartialEq>(column: &Option<Each<V>>, index: usize, old: V) -> bool {
    value(column, index, old) == old
}

/// Writes new values into some rows of a column.
fn put<V: Copy>(new: &Option<Each<V>>, column: &mut [V], rows: &[u32]) {
    let Some(values) = new else { return };
    for (index, &row) in rows.iter().enumerate() {
        if let Some(to) = column.get_mut(row as usize) {
            *to = values.at(index);
        }
    }
}

/// The same for a sparse column of `len` rows; `new` gets the index, the row and the old value.
fn put_sparse<V: Copy + Default + PartialEq>(
    column: &mut Vec<V>,
    len: usize,
    rows: &[u32],
    new: impl Fn(usize, usize, V) -> V,
) {
    let rows = || rows.iter().map(|&row| row as usize).enumerate().filter(|&(_, row)| row < len);
    let default = V::default();
    if column.is_empty() {
        if rows().all(|(index, row)| new(index, row, default) == default) {
            return;
        }
        column.resize(len, default);
    }
    let mut has_default = false;
    for (index, row) in rows() {
        column[row] = new(index, row, column[row]);
        has_default |= column[row] == default;
    }
    if has_default {
        sparse::drop_defaults(column);
    }
}
