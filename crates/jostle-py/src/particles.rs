//! Columns of particles as arguments of a world.

use jostle::particles::{
    MASS_RANGE, check_angles, check_angular_velocities, check_friction, check_masses, check_radii,
    check_restitutions, check_vectors,
};
use jostle::{Defaults, Each, Error, Filter, Particles};
use pyo3::prelude::*;

use crate::arrays::{Argument, Maybe, reals};

/// Copied columns with checked shapes; the values are not checked yet.
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
    pub sensors: Option<Each<bool>>,
}

impl Draft {
    /// The columns that are required for new particles.
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

    /// The same for one particle, without a number, or for many.
    pub fn of_one_or_many<'py>(
        positions: &Bound<'py, PyAny>,
        velocities: &Bound<'py, PyAny>,
        radii: Maybe<'_, 'py>,
    ) -> PyResult<(Self, Option<usize>)> {
        let positions: Each<[f32; 2]> = Argument::reals("positions", positions)?.one_or_rows()?;
        let len = positions.len();
        let draft = Self {
            positions: Some(positions.rows(1)),
            velocities: match len {
                Some(len) => vectors("velocities", Some(velocities), len)?,
                None => Some(only_vector("velocities", velocities, "particle")?),
            },
            radii: reals("radii", radii, len.unwrap_or(1))?,
            ..Self::default()
        };
        Ok((draft, len))
    }

    /// Columns given as one number become the defaults of particles that are added later.
    pub fn defaults(&self, before: Defaults) -> Defaults {
        fn one<V: Copy>(column: Option<&Each<V>>) -> Option<V> {
            column.and_then(|column| if let Each::One(one) = column { Some(*one) } else { None })
        }
        Defaults {
            radius: one(self.radii.as_ref()).or(before.radius),
            mass: one(self.masses.as_ref()).or(before.mass),
            density: one(self.densities.as_ref()).unwrap_or(before.density),
            restitution: one(self.restitutions.as_ref()).unwrap_or(before.restitution),
            friction: one(self.friction.as_ref()).unwrap_or(before.friction),
            filter: Filter {
                category: one(self.categories.as_ref()).unwrap_or(before.filter.category),
                mask: one(self.masks.as_ref()).unwrap_or(before.filter.mask),
            },
        }
    }

    /// New particles with these columns; omitted ones get their defaults. Without the GIL.
    pub fn particles(mut self, len: usize, defaults: &Defaults) -> jostle::Result<Particles> {
        self.check()?;
        self.radii = self.radii.or(defaults.radius.map(Each::One));
        self.restitutions.get_or_insert(Each::One(defaults.restitution));
        self.friction.get_or_insert(Each::One(defaults.friction));
        self.categories.get_or_insert(Each::One(defaults.filter.category));
        self.masks.get_or_insert(Each::One(defaults.filter.mask));
        if self.densities.is_none() {
            self.masses = self.masses.or(defaults.mass.map(Each::One));
        }
        let blank = vec![[0.0; 2]; len];
        let mut particles = Particles::new(blank.clone(), blank, vec![0.0; len], 1.0);
        let densities = self.densities.take().unwrap_or(Each::One(defaults.density)).rows(len);
        let has_masses = self.masses.is_some();
        self.write(&mut particles);
        if !has_masses {
            let pairs = particles.radii.iter().zip(densities);
            particles.masses = pairs.map(|(r, density)| density * r * r).collect();
            check_own_masses(&particles)?;
        }
        Ok(particles)
    }

    /// Refuses invalid values; errors have the index in the argument.
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

    /// Writes the columns over those of the particles.
    pub fn write(self, particles: &mut Particles) {
        // The positions of the caller are exact.
        let residuals = self.positions.is_some().then_some(Each::One([0.0; 2]));
        put(residuals, &mut particles.residuals, |to, value| *to = value);
        put(self.positions.map(Each::Rows), &mut particles.positions, |to, value| *to = value);
        put(self.velocities.map(Each::Rows), &mut particles.velocities, |to, value| *to = value);
        put(self.radii, &mut particles.radii, |to, value| *to = value);
        put(self.masses, &mut particles.masses, |to, value| *to = value);
        put(self.restitutions, &mut particles.restitutions, |to, value| *to = value);
        put(self.movable, &mut particles.movable, |to, value| *to = value);
        // The column of friction and rotation is omitted if all of it is 0.
        if self.friction.is_some() || self.angles.is_some() || self.angular_velocities.is_some() {
            let spins = particles.spins_mut();
            put(self.friction, spins, |spin, friction| spin.friction = friction);
            put(self.angles, spins, |spin, angle| spin.angle = f64::from(angle));
            put(self.angular_velocities, spins, |spin, speed| spin.velocity = speed);
        }
        // The column of categories and masks is omitted if all have the default.
        if self.categories.is_some() || self.masks.is_some() {
            let filters = particles.filters_mut();
            put(self.categories, filters, |filter, bits| filter.category = bits);
            put(self.masks, filters, |filter, bits| filter.mask = bits);
        }
        if self.sensors.is_some() {
            put(self.sensors, particles.sensors_mut(), |to, value| *to = value);
        }
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

/// A single pair of float32; `of` names the object that it belongs to, for error messages.
pub fn only_vector(
    name: &'static str,
    value: &Bound<'_, PyAny>,
    of: &str,
) -> PyResult<Vec<[f32; 2]>> {
    Ok(vec![Argument::reals(name, value)?.only_pair(of)?])
}

/// A bool for all or one for each of `len` particles.
pub fn truths(
    name: &'static str,
    value: Maybe<'_, '_>,
    len: usize,
) -> PyResult<Option<Each<bool>>> {
    value.map(|value| Argument::booleans(name, value)?.truth_each(len)).transpose()
}

fn check_column(
    column: Option<&Each<f32>>,
    check: impl Fn(&[f32]) -> jostle::Result<()>,
) -> jostle::Result<()> {
    column.map_or(Ok(()), |column| column.check(check))
}

/// As [`check_masses`], for masses that follow from densities and radii.
fn check_own_masses(particles: &Particles) -> jostle::Result<()> {
    let Particles { masses, radii, .. } = particles;
    let [min, max] = MASS_RANGE;
    match masses.iter().position(|mass| !(min..=max).contains(mass)) {
        Some(index) => {
            let rule = format!(
                "its mass, density times radius squared, would be {:e}, but must lie between \
                 {min:e} and {max:e}; give masses",
                masses[index]
            );
            Err(Error::at("radii", index, radii[index], &rule))
        }
        None => Ok(()),
    }
}

/// Refuses invalid densities. The core has masses only.
fn check_densities(densities: &[f32]) -> jostle::Result<()> {
    match densities.iter().position(|d| !(*d > 0.0 && d.is_finite())) {
        Some(index) => {
            let rule = "a density must be finite and above 0";
            Err(Error::at("densities", index, densities[index], rule))
        }
        None => Ok(()),
    }
}

/// Sets a value in each row.
fn put<V: Copy, C>(values: Option<Each<V>>, column: &mut [C], set: impl Fn(&mut C, V)) {
    match values {
        None => (),
        Some(Each::One(value)) => column.iter_mut().for_each(|to| set(to, value)),
        Some(Each::Rows(values)) => {
            column.iter_mut().zip(values).for_each(|(to, value)| set(to, value));
        }
    }
}
