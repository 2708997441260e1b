//! Columns of particles on their way into a world.

use jostle::particles::{
    MASS_RANGE, check_angles, check_angular_velocities, check_friction, check_masses, check_radii,
    check_restitutions, check_vectors,
};
use jostle::{Each, Error, Filter, Particles, Spin};
use pyo3::prelude::*;

use crate::arrays::Argument;

/// An argument that may be left out or None.
type Maybe<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// Copied columns, of the right shapes; the values are not yet checked.
#[derive(Default)]
pub struct Draft {
    pub positions: Option<Vec<[f32; 2]>>,
    pub velocities: Option<Vec<[f32; 2]>>,
    pub radii: Option<Each<f32>>,
    pub masses: Option<Each<f32>>,
    pub densities: Option<Each<f32>>,
    pub restitutions: Option<Each<f32>>,
    pub movable: Option<Each<bool>>,
    pub friction: Option<Each<f32>>,
    pub angles: Option<Each<f32>>,
    pub angular_velocities: Option<Each<f32>>,
    pub categories: Option<Each<u32>>,
    pub masks: Option<Each<u32>>,
}

impl Draft {
    /// The columns that every new particle needs.
    pub fn of_new<'py>(
        positions: &Bound<'py, PyAny>,
        velocities: &Bound<'py, PyAny>,
        radii: &Bound<'py, PyAny>,
    ) -> PyResult<(Self, usize)> {
        let len = Argument::reals("positions", positions)?.pairs_len()?;
        let draft = Self {
            positions: vectors("positions", Some(positions), len)?,
            velocities: vectors("velocities", Some(velocities), len)?,
            radii: reals("radii", Some(radii), len)?,
            ..Self::default()
        };
        Ok((draft, len))
    }

    /// New particles of these columns; what was left out takes its default. Needs no Python.
    pub fn particles(mut self, len: usize) -> jostle::Result<Particles> {
        self.check()?;
        let blank = vec![[0.0; 2]; len];
        let mut particles = Particles::new(blank.clone(), blank, vec![0.0; len], 1.0);
        let densities = self.densities.take().unwrap_or(Each::One(1.0)).rows(len);
        let has_masses = self.masses.is_some();
        self.write(&mut particles, None);
        if !has_masses {
            let pairs = particles.radii.iter().zip(densities);
            particles.masses = pairs.map(|(r, density)| density * r * r).collect();
            check_own_masses(&particles)?;
        }
        Ok(particles)
    }

    /// Refuses values that no world can hold, by the index that the caller gave them.
    pub fn check(&self) -> jostle::Result<()> {
        check_vectors("positions", self.positions.as_deref().unwrap_or_default())?;
        check_vectors("velocities", self.velocities.as_deref().unwrap_or_default())?;
        check_column(self.radii.as_ref(), check_radii)?;
        check_column(self.densities.as_ref(), check_densities)?;
        check_column(self.masses.as_ref(), check_masses)?;
        check_column(self.restitutions.as_ref(), check_restitutions)?;
        check_column(self.friction.as_ref(), check_friction)?;
        check_column(self.angles.as_ref(), check_angles)?;
        check_column(self.angular_velocities.as_ref(), check_angular_velocities)
    }

    /// Writes the columns over those of the particles `ids`, or of all.
    pub fn write(self, particles: &mut Particles, ids: Option<&[u32]>) {
        // Given positions are exact.
        let residuals = self.positions.is_some().then_some(Each::One([0.0; 2]));
        put(residuals, &mut particles.residuals, ids);
        put(self.positions.map(Each::Rows), &mut particles.positions, ids);
        put(self.velocities.map(Each::Rows), &mut particles.velocities, ids);
        put(self.radii, &mut particles.radii, ids);
        put(self.masses, &mut particles.masses, ids);
        put(self.restitutions, &mut particles.restitutions, ids);
        put(self.movable, &mut particles.movable, ids);
        put_spins(self.friction, particles, ids, |spin, friction| spin.friction = friction);
        put_spins(self.angles, particles, ids, |spin, angle| spin.angle = f64::from(angle));
        put_spins(self.angular_velocities, particles, ids, |spin, speed| spin.velocity = speed);
        put_filters(self.categories, particles, ids, |filter, bits| filter.category = bits);
        put_filters(self.masks, particles, ids, |filter, bits| filter.mask = bits);
    }
}

/// `len` pairs of float32.
pub fn vectors(
    name: &'static str,
    value: Maybe<'_, '_>,
    len: usize,
) -> PyResult<Option<Vec<[f32; 2]>>> {
    value.map(|value| Argument::reals(name, value)?.pairs(len)).transpose()
}

/// A float32 for all or one for each of `len` particles.
pub fn reals(name: &'static str, value: Maybe<'_, '_>, len: usize) -> PyResult<Option<Each<f32>>> {
    value.map(|value| Argument::reals(name, value)?.real_each(len)).transpose()
}

/// A truth for all or one for each of `len` particles.
pub fn truths(
    name: &'static str,
    value: Maybe<'_, '_>,
    len: usize,
) -> PyResult<Option<Each<bool>>> {
    value.map(|value| Argument::booleans(name, value)?.truth_each(len)).transpose()
}

/// Bits for all or for each of `len` particles.
pub fn bit_sets(
    name: &'static str,
    value: Maybe<'_, '_>,
    len: usize,
) -> PyResult<Option<Each<u32>>> {
    value.map(|value| Argument::integers(name, value)?.bits_each(len)).transpose()
}

fn check_column(
    column: Option<&Each<f32>>,
    check: impl Fn(&[f32]) -> jostle::Result<()>,
) -> jostle::Result<()> {
    column.map_or(Ok(()), |column| column.check(check))
}

/// As [`check_masses`], where the caller has given none.
fn check_own_masses(particles: &Particles) -> jostle::Result<()> {
    let Particles { masses, radii, .. } = particles;
    let [least, most] = MASS_RANGE;
    match masses.iter().position(|mass| !(least..=most).contains(mass)) {
        Some(index) => {
            let rule = format!(
                "its mass, density times radius squared, would be {:e}, but must lie between \
                 {least:e} and {most:e}; give masses",
                masses[index]
            );
            Err(Error::at("radii", index, radii[index], &rule))
        }
        None => Ok(()),
    }
}

/// The core knows masses only.
fn check_densities(densities: &[f32]) -> jostle::Result<()> {
    match densities.iter().position(|d| !(*d > 0.0 && d.is_finite())) {
        Some(index) => {
            let rule = "a density must be finite and above 0";
            Err(Error::at("densities", index, densities[index], rule))
        }
        None => Ok(()),
    }
}

fn put<V: Copy>(values: Option<Each<V>>, column: &mut [V], ids: Option<&[u32]>) {
    if let Some(values) = values {
        put_each(values, column, ids, |to, value| *to = value);
    }
}

/// As [`put`] for friction and rotation, of which there is no column while all of it is 0.
fn put_spins(
    values: Option<Each<f32>>,
    particles: &mut Particles,
    ids: Option<&[u32]>,
    set: impl Fn(&mut Spin, f32),
) {
    if let Some(values) = values {
        put_each(values, particles.spins_mut(), ids, set);
    }
}

/// As [`put`] for categories and masks, of which there is no column while all have the default.
fn put_filters(
    values: Option<Each<u32>>,
    particles: &mut Particles,
    ids: Option<&[u32]>,
    set: impl Fn(&mut Filter, u32),
) {
    if let Some(values) = values {
        put_each(values, particles.filters_mut(), ids, set);
    }
}

fn put_each<V: Copy, C>(
    values: Each<V>,
    column: &mut [C],
    ids: Option<&[u32]>,
    set: impl Fn(&mut C, V),
) {
    match (values, ids) {
        (Each::One(value), None) => column.iter_mut().for_each(|to| set(to, value)),
        (Each::Rows(values), None) => {
            column.iter_mut().zip(values).for_each(|(to, value)| set(to, value));
        }
        (Each::One(value), Some(ids)) => {
            ids.iter().for_each(|&id| set(&mut column[id as usize], value));
        }
        (Each::Rows(values), Some(ids)) => {
            ids.iter().zip(values).for_each(|(&id, value)| set(&mut column[id as usize], value));
        }
    }
}
