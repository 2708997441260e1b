//! Columns of particles as arguments of a world.

use jostle_base::{Error, memory};
use jostle_index::Each;
use jostle_world::particles::MASS_RANGE;
use jostle_world::{Changes, Particles};
use pyo3::prelude::*;

use crate::arrays::{Argument, Maybe};
use crate::error::refused;
use crate::keywords::Keywords;

/// Declares the arguments by their Python names, which are those of [`Changes`].
macro_rules! arguments {
    ($($name:ident,)*) => {
        /// Columns that `World`, `World.add`, `World.set` and the properties of `World` read alike. None is as
        /// if omitted.
        #[derive(Default)]
        pub struct Arguments<'py> {
            pub positions: Option<Bound<'py, PyAny>>,
            $(pub $name: Option<Bound<'py, PyAny>>,)*
        }

        impl<'py> Arguments<'py> {
            /// The keywords of a call that are columns.
            pub fn of(keywords: &mut Keywords<'py>) -> PyResult<Self> {
                Ok(Self {
                    positions: keywords.take_some("positions"),
                    $($name: keywords.take_some(stringify!($name)),)*
                })
            }

            /// The name of the first column that is given.
            pub fn first(&self) -> Option<&'static str> {
                let all = [
                    ("positions", self.positions.is_some()),
                    $((stringify!($name), self.$name.is_some()),)*
                ];
                all.into_iter().find(|(_, is_given)| *is_given).map(|(name, _)| name)
            }

            /// The columns of `len` particles.
            pub fn read(self, len: usize) -> PyResult<Changes> {
                let positions = vectors("positions", self.positions.as_ref(), len)?;
                $(let $name = read(stringify!($name), self.$name.as_ref(), len)?;)*
                Ok(Changes { positions: positions.map(Each::Rows), $($name,)* residuals: None })
            }

            /// The columns of new particles at `positions`, and how many these are; None for one particle.
            pub fn read_new(self, positions: &Bound<'py, PyAny>) -> PyResult<(Changes, Option<usize>)> {
                let positions: Each<[f32; 2]> =
                    Argument::reals("positions", positions)?.one_or_rows()?;
                let many = positions.len();
                let others = match many {
                    Some(len) => self.read(len)?,
                    None => self.read_one("particle")?,
                };
                let positions = Some(Each::Rows(positions.rows(1)));
                Ok((Changes { positions, ..others }, many))
            }

            /// The columns of a single particle, whose vectors have no axis for particles; `of` names what has
            /// them, for error messages.
            pub fn read_one(mut self, of: &str) -> PyResult<Changes> {
                let [positions, velocities] = [self.positions.take(), self.velocities.take()];
                let only = |name, value: Option<Bound<'py, PyAny>>| {
                    value.map(|value| only_vector(name, &value, of)).transpose()
                };
                let positions = only("positions", positions)?.map(Each::Rows);
                let velocities = only("velocities", velocities)?.map(Each::Rows);
                Ok(Changes { positions, velocities, ..self.read(1)? })
            }
        }
    };
}
arguments! {
    velocities, radii, masses, restitution, movable, friction, angles, angular_velocities, categories,
    masks, sensors, kinds,
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
    [f32; 2]: |name, value, len| Argument::reals(name, value)?.one_or_pairs(len),
    f64: |name, value, len| Ok(match f32::read_each(name, value, len)? {
        Each::One(one) => Each::One(one.into()),
        Each::Rows(all) => {
            Each::Rows(memory::collect(all.into_iter().map(f64::from)).map_err(refused)?)
        }
    }),
}

/// New particles with these columns; omitted ones have their defaults, and masses that are omitted are the squares of
/// the radii. Without the GIL.
pub fn particles(columns: &Changes, len: usize) -> jostle_base::Result<Particles> {
    // Checked before the masses that follow from them.
    columns.validate(len)?;
    let blank = || memory::filled(len, [0.0; 2]);
    let radii = memory::filled(len, 0.0)?;
    let mut particles = Particles::try_new(blank()?, blank()?, radii, 1.0)?;
    columns.reserve(&mut particles, len)?;
    columns.write(&mut particles, &memory::collect(0..len as u32)?);
    if columns.masses.is_none() {
        let pairs = particles.masses.iter_mut().zip(&particles.radii);
        pairs.for_each(|(mass, r)| *mass = r * r);
        check_own_masses(&particles)?;
    }
    Ok(particles)
}

/// `len` pairs of float32.
pub fn vectors(
    name: &'static str,
    value: Maybe<'_, '_>,
    len: usize,
) -> PyResult<Option<Vec<[f32; 2]>>> {
    value.map(|value| Argument::reals(name, value)?.pairs(len)).transpose()
}

/// As [`vectors`], also from one pair for all.
pub fn one_or_vectors(
    name: &'static str,
    value: Maybe<'_, '_>,
    len: usize,
) -> PyResult<Option<Vec<[f32; 2]>>> {
    value.map(|value| Ok(Argument::reals(name, value)?.one_or_pairs(len)?.rows(len))).transpose()
}

/// A single pair of float32; `of` names the object that it belongs to, for error messages.
pub fn only_vector(
    name: &'static str,
    value: &Bound<'_, PyAny>,
    of: &str,
) -> PyResult<Vec<[f32; 2]>> {
    Ok(vec![Argument::reals(name, value)?.only_pair(of)?])
}

/// As [`check_masses`](jostle_world::particles::check_masses), for masses that follow from radii.
fn check_own_masses(particles: &Particles) -> jostle_base::Result<()> {
    let Particles { masses, radii, .. } = particles;
    let [min, max] = MASS_RANGE;
    match masses.iter().position(|mass| !(min..=max).contains(mass)) {
        Some(index) => {
            let rule = format!(
                "its mass, the square of the radius, would be {:e}, but must lie between \
                 {min:e} and {max:e}; give masses",
                masses[index]
            );
            Err(Error::at("radii", index, radii[index], &rule))
        }
        None => Ok(()),
    }
}
