//! Columns of particles as arguments of a world.

use jostle_base::{Error, memory};
use jostle_index::{Each, Filter};
use jostle_world::particles::MASS_RANGE;
use jostle_world::{Changes, Defaults, Particles};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::arrays::{Argument, Maybe, reals};
use crate::error::refused;

/// Copied columns of new particles with checked shapes; the values are not checked yet.
#[derive(Default)]
pub struct Draft {
    pub columns: Changes,
    pub densities: Option<Each<f32>>,
}

/// Declares the arguments by their Python names, which are those of [`Changes`].
macro_rules! arguments {
    ($($name:ident,)*) => {
        /// Columns that `World`, `World.add`, `World.set` and the properties of `World` read alike.
        #[derive(Default)]
        pub struct Arguments<'py> {
            $(pub $name: Option<Bound<'py, PyAny>>,)*
        }

        impl<'py> Arguments<'py> {
            /// The keywords of a call of `function` that are columns. Refuses others.
            pub fn of(function: &str, keywords: Option<&Bound<'py, PyDict>>) -> PyResult<Self> {
                let mut all = Self::default();
                for (name, value) in keywords.into_iter().flatten() {
                    let value = Some(value).filter(|value| !value.is_none());
                    match &*name.cast::<PyString>()?.to_cow()? {
                        $(stringify!($name) => all.$name = value,)*
                        name => {
                            let rule = "got an unexpected keyword argument";
                            let message = format!("{function} {rule} '{name}'");
                            return Err(PyTypeError::new_err(message));
                        }
                    }
                }
                Ok(all)
            }

            /// Adds the columns of `len` particles to others.
            pub fn read(self, len: usize, others: Changes) -> PyResult<Changes> {
                $(
                    let own = read(stringify!($name), self.$name.as_ref(), len)?;
                    let $name = own.or(others.$name);
                )*
                Ok(Changes { $($name,)* residuals: None })
            }
        }
    };
}
arguments! {
    positions, velocities, radii, masses, restitution, movable, friction, angles, angular_velocities,
    categories, masks, sensors, kinds,
}

/// The values of an argument, one for all or one for each of `len` particles.
fn read<V: Value>(
    name: &'static str,
    value: Maybe<'_, '_>,
    len: usize,
) -> PyResult<Option<Each<V>>> {
    value.map(|value| V::read_each(name, value, len)).transpose()
}

/// A type of values of columns.
trait Value: Sized {
    fn read_each(name: &'static str, value: &Bound<'_, PyAny>, len: usize) -> PyResult<Each<Self>>;
}

macro_rules! values {
    ($($type:ty: $read:expr,)*) => {$(
        impl Value for $type {
            fn read_each(
                name: &'static str,
                value: &Bound<'_, PyAny>,
                len: usize,
            ) -> PyResult<Each<Self>> {
                $read(name, value, len)
            }
        }
    )*};
}
values! {
    f32: |name, value, len| Argument::reals(name, value)?.real_each(len),
    u32: |name, value, len| Argument::integers(name, value)?.bits_each(len),
    u8: |name, value, len| Argument::integers(name, value)?.kind_each(len),
    bool: |name, value, len| Argument::booleans(name, value)?.truth_each(len),
    [f32; 2]: |name, value, len| Ok(Each::Rows(Argument::reals(name, value)?.pairs(len)?)),
    f64: |name, value, len| Ok(match f32::read_each(name, value, len)? {
        Each::One(one) => Each::One(one.into()),
        Each::Rows(all) => {
            Each::Rows(memory::collect(all.into_iter().map(f64::from)).map_err(refused)?)
        }
    }),
}

impl Draft {
    /// The columns that are required for new particles.
    pub fn of_new<'py>(
        positions: &Bound<'py, PyAny>,
        velocities: &Bound<'py, PyAny>,
        radii: &Bound<'py, PyAny>,
    ) -> PyResult<(Changes, usize)> {
        let len = Argument::reals("positions", positions)?.pairs_len()?;
        let columns = Changes {
            positions: vectors("positions", Some(positions), len)?.map(Each::Rows),
            velocities: vectors("velocities", Some(velocities), len)?.map(Each::Rows),
            radii: reals("radii", Some(radii), len)?,
            ..Changes::default()
        };
        Ok((columns, len))
    }

    /// The columns of one particle, for which the number is None, or of many, with their number.
    pub fn of_one_or_many<'py>(
        positions: &Bound<'py, PyAny>,
        velocities: &Bound<'py, PyAny>,
        radii: Maybe<'_, 'py>,
    ) -> PyResult<(Changes, Option<usize>)> {
        let positions: Each<[f32; 2]> = Argument::reals("positions", positions)?.one_or_rows()?;
        let len = positions.len();
        let velocities = match len {
            Some(len) => vectors("velocities", Some(velocities), len)?,
            None => Some(only_vector("velocities", velocities, "particle")?),
        };
        let columns = Changes {
            positions: Some(Each::Rows(positions.rows(1))),
            velocities: velocities.map(Each::Rows),
            radii: reals("radii", radii, len.unwrap_or(1))?,
            ..Changes::default()
        };
        Ok((columns, len))
    }

    /// Columns given as one number become the defaults of particles that are added later.
    pub fn defaults(&self, before: Defaults) -> Defaults {
        fn one<V: Copy>(column: Option<&Each<V>>) -> Option<V> {
            column.and_then(|column| if let Each::One(one) = column { Some(*one) } else { None })
        }
        let Changes { radii, masses, restitution, friction, categories, masks, .. } = &self.columns;
        Defaults {
            radius: one(radii.as_ref()).or(before.radius),
            mass: one(masses.as_ref()).or(before.mass),
            density: one(self.densities.as_ref()).unwrap_or(before.density),
            restitution: one(restitution.as_ref()).unwrap_or(before.restitution),
            friction: one(friction.as_ref()).unwrap_or(before.friction),
            filter: Filter {
                category: one(categories.as_ref()).unwrap_or(before.filter.category),
                mask: one(masks.as_ref()).unwrap_or(before.filter.mask),
            },
        }
    }

    /// New particles with these columns; omitted ones get their defaults. Without the GIL.
    pub fn particles(self, len: usize, defaults: &Defaults) -> jostle_base::Result<Particles> {
        let Self { mut columns, densities } = self;
        // Checked before the masses that follow from them.
        columns.validate(len)?;
        check_column(densities.as_ref(), check_densities)?;
        columns.radii = columns.radii.or(defaults.radius.map(Each::One));
        columns.restitution.get_or_insert(Each::One(defaults.restitution));
        columns.friction.get_or_insert(Each::One(defaults.friction));
        columns.categories.get_or_insert(Each::One(defaults.filter.category));
        columns.masks.get_or_insert(Each::One(defaults.filter.mask));
        if densities.is_none() {
            columns.masses = columns.masses.or(defaults.mass.map(Each::One));
        }
        let blank = || memory::filled(len, [0.0; 2]);
        let radii = memory::filled(len, 0.0)?;
        let mut particles = Particles::try_new(blank()?, blank()?, radii, 1.0)?;
        columns.reserve(&mut particles, len)?;
        columns.write(&mut particles, &memory::collect(0..len as u32)?);
        if columns.masses.is_none() {
            let densities = densities.unwrap_or(Each::One(defaults.density));
            let pairs = particles.masses.iter_mut().zip(&particles.radii).enumerate();
            pairs.for_each(|(row, (mass, r))| *mass = densities.at(row) * r * r);
            check_own_masses(&particles)?;
        }
        Ok(particles)
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

fn check_column(
    column: Option<&Each<f32>>,
    check: impl Fn(&[f32]) -> jostle_base::Result<()>,
) -> jostle_base::Result<()> {
    column.map_or(Ok(()), |column| column.check(check))
}

/// As [`check_masses`], for masses that follow from densities and radii.
fn check_own_masses(particles: &Particles) -> jostle_base::Result<()> {
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
fn check_densities(densities: &[f32]) -> jostle_base::Result<()> {
    match densities.iter().position(|d| !(*d > 0.0 && d.is_finite())) {
        Some(index) => {
            let rule = "a density must be finite and above 0";
            Err(Error::at("densities", index, densities[index], rule))
        }
        None => Ok(()),
    }
}
