//! The columns of the particles as properties.

use jostle_base::{Error, memory};
use jostle_world::{Bodies, Changes};
use numpy::{Element, PyArray1, PyArray2};
use pyo3::prelude::*;

use super::{PyWorld, State};
use crate::arrays::{column, read_only, table};
use crate::error::refused;
use crate::particles::Arguments;

/// Declares properties that are columns, by the names of their arguments.
macro_rules! columns {
    ($($(#[$doc:meta])* $name:ident, $set:ident: $array:ty = $read:ident($values:expr);)*) => {
        #[pymethods]
        impl PyWorld {
            $(
                $(#[$doc])*
                #[getter]
                fn $name<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, $array>> {
                    self.$read(py, $values)
                }

                #[setter]
                fn $set(&self, py: Python<'_>, value: Bound<'_, PyAny>) -> PyResult<()> {
                    self.assign(py, Arguments { $name: Some(value), ..Arguments::default() })
                }
            )*
        }
    };
}

columns! {
    /// Centres: ndarray of float32, shape (n, 2), a read-only copy in units of length.
    ///
    /// Writing into the copy, as in ``world.positions[0] = (1, 2)`` or
    /// ``world.positions += 1``, raises ValueError. Assign a whole column instead,
    /// ``world.positions = world.positions + 1``, or change some particles with
    /// ``world.set([0], positions=[(1, 2)])``. The same holds for every column. Assigning what was
    /// read changes nothing and wakes nothing: a position that is the present one in float32 keeps
    /// what rounding removed.
    positions, set_positions: PyArray2<f32> = vectors(Bodies::positions);

    /// Velocities: ndarray of float32, shape (n, 2), a read-only copy in units of length per
    /// second.
    ///
    /// To change them, assign a whole column, ``world.velocities = world.velocities * 2``,
    /// or change some particles with ``world.set([0], velocities=[(7, 7)])``.
    velocities, set_velocities: PyArray2<f32> = vectors(Bodies::velocities);

    /// Radii: ndarray of float32, shape (n,), a read-only copy in units of length.
    ///
    /// To change all, assign an array or one number; to change some, use `set`. Masses stay
    /// the same.
    radii, set_radii: PyArray1<f32> = column(Bodies::radii);

    /// Masses: ndarray of float32, shape (n,), a read-only copy in units of mass.
    ///
    /// To change all, assign an array or one number; to change some, use `set`.
    masses, set_masses: PyArray1<f32> = column(Bodies::masses);

    /// Coefficients of restitution, 0 to 1: ndarray of float32, shape (n,), a read-only copy.
    ///
    /// A contact has the square root of the product of both. To change all, assign an array or one number; to change some, use `set`.
    restitution, set_restitution: PyArray1<f32> = column(Bodies::restitution);

    /// Which particles are movable: ndarray of bool, shape (n,), a read-only copy.
    ///
    /// The others keep their velocities: a disc that is made immovable while it moves becomes
    /// kinematic.
    ///
    /// To change all, assign an array or one bool; to change some, use `set`.
    movable, set_movable: PyArray1<bool> = column(Bodies::movable);

    /// Coefficients of friction: ndarray of float32, shape (n,), a read-only copy.
    ///
    /// To change all, assign an array or one number; to change some, use `set`.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an assigned coefficient is not finite or below 0, or the shape is wrong.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (3, 0)], 1.0)
    /// >>> world.friction = 0.5
    /// >>> world.set(1, friction=0.8)
    /// >>> world.friction
    /// array([0.5, 0.8], dtype=float32)
    friction, set_friction: PyArray1<f32> = column(Bodies::friction);

    /// Angles: ndarray of float32, shape (n,), a read-only copy in radians, -π to π without π.
    ///
    /// Positive angles are from +x to +y. To change all, assign an array or one number; to
    /// change some, use `set`. Numbers outside the range are wrapped into it.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an assigned angle is not finite, or the shape is wrong.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0)], 1.0, angular_velocities=0.5)
    /// >>> world.step(0.25, steps=8)
    /// >>> world.angles
    /// array([1.], dtype=float32)
    angles, set_angles: PyArray1<f32> = column(Bodies::angles);

    /// Angular velocities: ndarray of float32, shape (n,), a read-only copy in radians per second.
    ///
    /// Those of particles of radius 0 are 0. To change all, assign an
    /// array or one number; to change some, use `set`.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an assigned angular velocity is not finite or above 1e18, or the shape is wrong.
    ///
    /// See Also
    /// --------
    /// angles : The angles that follow from them.
    angular_velocities, set_angular_velocities: PyArray1<f32> = column(Bodies::angular_velocities);

    /// Categories: ndarray of uint32, shape (n,), a read-only copy of bit sets.
    ///
    /// Particles i and j may touch only if ``categories[i] & masks[j]`` and
    /// ``categories[j] & masks[i]``. To change all, assign an array or one number; to change some,
    /// use `set`. The islands of changed particles wake.
    ///
    /// See Also
    /// --------
    /// masks : The categories that each particle may touch.
    ///
    /// Examples
    /// --------
    /// Ghosts pass through each other, and bounce off everything else:
    ///
    /// >>> import jostle
    /// >>> GHOST = 2
    /// >>> world = jostle.World([(0, 0), (3, 0), (9, 0)], 1.0, velocities=[(1, 0), (0, 0), (0, 0)])
    /// >>> world.set([0, 1], categories=GHOST, masks=~GHOST)
    /// >>> world.step(0.1, steps=90)
    /// >>> world.velocities[:, 0]
    /// array([0., 0., 1.], dtype=float32)
    /// >>> world.categories
    /// array([2, 2, 1], dtype=uint32)
    categories, set_categories: PyArray1<u32>
        = column(|bodies| memory::collect(bodies.filters()?.iter().map(|filter| filter.category)));

    /// Masks: ndarray of uint32, shape (n,), a read-only copy of bit sets of the categories that
    /// each particle may touch, see `categories`.
    ///
    /// To change all, assign an array or one number; to change some, use `set`.
    masks, set_masks: PyArray1<u32>
        = column(|bodies| memory::collect(bodies.filters()?.iter().map(|filter| filter.mask)));

    /// Which particles are sensors: ndarray of bool, shape (n,), a read-only copy.
    ///
    /// A sensor and another particle pass through each other; `contacts` and `events` report that
    /// they touch, without impulses. A disc that passes through a sensor within a step, at any
    /// speed, is found too: it has entered and left. Walls, the container and forces act on sensors
    /// that are movable, as on other particles. One with ``movable=False`` stands still or moves with
    /// its velocity, and also reports other immovable particles. Two sensors report each other if
    /// one is movable. Categories and masks determine what they report. They
    /// never merge.
    ///
    /// To change all, assign an array or one bool; to change some, use `set`.
    ///
    /// See Also
    /// --------
    /// events : The pairs that began and ceased to touch.
    ///
    /// Examples
    /// --------
    /// A fast disc passes through a sensor within one step:
    ///
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0)], 1.0, velocities=[(900, 0)], track_events=True)
    /// >>> goal = world.add((5, 0), 2.0, movable=False, sensors=True)
    /// >>> world.step(1 / 60)
    /// >>> world.events.entered, world.events.exited
    /// (array([[0, 1]]), array([[0, 1]]))
    /// >>> world.velocities[0]
    /// array([900.,   0.], dtype=float32)
    sensors, set_sensors: PyArray1<bool> = column(Bodies::sensors);

    /// Kinds: ndarray of uint8, shape (n,), a read-only copy of the rows of the particles in the
    /// tables of each `PairForce`.
    ///
    /// To change all, assign an array or one number; to change some, use `set`.
    kinds, set_kinds: PyArray1<u8> = column(Bodies::kinds);
}

#[pymethods]
impl PyWorld {
    /// Where the particles would be without a period: ndarray of float64, shape (n, 2), a read-only
    /// copy in units of length.
    ///
    /// A particle that leaves a periodic plane on one side enters on the other, and `positions` are
    /// from 0 to the period. Here the periods that it has travelled are added, so differences from
    /// step to step are displacements. All digits of the state are included, also those that
    /// float32 removes from `positions`. A particle that is added, or is given another position by
    /// `set` or by assigning `positions`, begins at that position. If the period changes, all begin
    /// at their `positions`. A merged particle continues the path of that whose id it has.
    ///
    /// Without a period they are the positions. They are kept by snapshots and files.
    ///
    /// See Also
    /// --------
    /// positions : Within the period.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(9, 5)], 1.0, velocities=[(2, 0)], period=10)
    /// >>> world.step(0.5, steps=26)
    /// >>> world.positions, world.unwrapped_positions
    /// (array([[5., 5.]], dtype=float32), array([[35.,  5.]]))
    #[getter]
    fn unwrapped_positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let column = self.long(py, |state| state.world.unwrapped_positions())?.map_err(refused)?;
        Ok(read_only(table(py, column)?))
    }

    /// Which particles are asleep: ndarray of bool, shape (n,), a read-only copy.
    ///
    /// An island of particles that touch or nearly touch falls asleep under gravity if each of them
    /// rests on something and has been slow for half a second, and if their motion is steady and
    /// does not grow. Sleeping particles do not move, and cost almost nothing. Their
    /// contacts in `last_step` are those of the last step in which they were awake.
    ///
    /// An island wakes if a moving particle could touch it in the step, or if one of its particles
    /// is changed or removed (also if `world.positions` is assigned: to move a few, use
    /// `world.set`). All islands wake if the forces, an immovable particle or a setting other than
    /// `method`, `threads`, `leaf_capacity` and `max_depth` changes, or if an immovable particle is
    /// added. If only the velocities of an immovable particle change, the islands that touch it
    /// wake.
    ///
    /// Nothing falls asleep if there is a force other than a `Thermostat` or a `Motor`, while a wall
    /// moves, or with an `on_touch` other than "bounce". Immovable particles are never asleep, and
    /// nothing sleeps on a kinematic one.
    ///
    /// See Also
    /// --------
    /// sleeping : Turns it off.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World(
    /// ...     [(0, 1), (5, 1)], 1.0, velocities=[(0, 0), (2, 0)], gravity=(0, -9.8),
    /// ...     restitution=0.5, container=jostle.Box(-9, 0, 99, 9),
    /// ... )
    /// >>> world.step(1 / 60, steps=60)
    /// >>> world.asleep
    /// array([ True, False])
    #[getter]
    fn asleep<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        self.column(py, Bodies::asleep)
    }
}

impl PyWorld {
    /// A read-only copy of a column of pairs.
    fn vectors<'py>(
        &self,
        py: Python<'py>,
        of: fn(&Bodies) -> jostle_base::Result<Vec<[f32; 2]>>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let column = self.long(py, |state| of(state.world.bodies()))?.map_err(refused)?;
        Ok(read_only(table(py, column)?))
    }

    /// A read-only copy of a column.
    fn column<'py, V: Element>(
        &self,
        py: Python<'py>,
        of: fn(&Bodies) -> jostle_base::Result<Vec<V>>,
    ) -> PyResult<Bound<'py, PyArray1<V>>> {
        let values = self.long(py, |state| of(state.world.bodies()))?.map_err(refused)?;
        Ok(read_only(column(py, values)))
    }

    /// Replaces whole columns.
    fn assign(&self, py: Python<'_>, columns: Arguments<'_>) -> PyResult<()> {
        let len = self.len(py)?;
        let changes = columns.read(len)?;
        self.long(py, |state| state.write_all(changes, len))?.map_err(refused)
    }
}

impl State {
    fn write_all(&mut self, changes: Changes, found: usize) -> jostle_base::Result<()> {
        let expected = self.world.len();
        if found != expected {
            // Another thread has added or removed particles in the meantime.
            return Err(Error::Length { argument: "the new column", found, expected });
        }
        self.world.set_all(&changes)
    }
}
