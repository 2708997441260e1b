//! Adding, removing, reading and changing particles.

use jostle_base::{Id, memory};
use jostle_index::Each;
use jostle_world::Changes;
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::PyWorld;
use crate::arrays::{column, reals};
use crate::ids::Ids;
use crate::particles::{Arguments, Draft, only_vector, vectors};
use crate::queries::result_of;
use crate::results;

#[pymethods]
impl PyWorld {
    /// Add one particle or many, after the others.
    ///
    /// The default of an omitted argument is the number that was last given for all particles: to
    /// `World`, as in ``World(..., friction=0.5)``, or by assignment, as in ``world.friction =
    /// 0.5``. An array with a number for each particle does not change the default.
    ///
    /// Parameters
    /// ----------
    /// positions, velocities : array_like, shape (k, 2), or (2,) for one particle
    ///     Centres in units of length, and velocities in units of length per second.
    /// radii : array_like, a number or shape (k,), optional
    ///     Required if no number was given for all particles.
    /// masses : array_like, a number or shape (k,), optional
    ///     If omitted and no number was given for all particles, or if `densities` are given,
    ///     density times radius squared, without π.
    /// densities : array_like, a number or shape (k,), optional
    ///     1.0 if no number was given to `World`.
    /// restitution : array_like, a number or shape (k,), optional
    ///     1.0 if no number was assigned to `world.restitution`; `world.restitution` is a factor
    ///     of all contacts anyway.
    /// movable : array_like of bool, one or shape (k,), default True
    ///     Whether contacts and forces can change the velocity.
    /// friction : array_like, a number or shape (k,), optional
    ///     0.0 if no number was given for all particles.
    /// angles, angular_velocities : array_like, a number or shape (k,), default 0.0
    ///     In radians and in radians per second, positive from +x to +y.
    /// categories, masks : array_like of int, a number or shape (k,), optional
    ///     1 and all bits if no number was given for all particles.
    /// sensors : array_like of bool, one or shape (k,), default False
    ///     Whether the particle is a sensor.
    /// kinds : array_like of int, a number or shape (k,), default 0
    ///     Their kinds in each `PairForce`, from 0 to 63.
    ///
    /// Returns
    /// -------
    /// ndarray of int64, shape (k,), or int
    ///     Their ids, above all ids before; one id for one position. Their rows are the last ones
    ///     of every column.
    ///
    /// Raises
    /// ------
    /// TypeError, ValueError
    ///     As for a new world; then nothing is added.
    ///
    /// See Also
    /// --------
    /// set : Change particles.
    /// remove : Remove particles.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0)], [(0, 0)], radii=1.0)
    /// >>> world.add([(5, 0), (9, 0)], [(0, 0), (0, 0)], radii=0.5)
    /// array([1, 2])
    /// >>> world.add((0, 5), velocities=(1, 0))
    /// 3
    /// >>> world.radii
    /// array([1. , 0.5, 0.5, 1. ], dtype=float32)
    #[pyo3(
        signature = (positions, velocities, radii=None, *, densities=None, **columns),
        text_signature = "($self, positions, velocities, radii=None, *, masses=None, \
                          densities=None, restitution=None, movable=None, friction=None, \
                          angles=None, angular_velocities=None, categories=None, masks=None, \
                          sensors=None, kinds=None)"
    )]
    fn add<'py>(
        &self,
        py: Python<'py>,
        positions: &Bound<'py, PyAny>,
        velocities: &Bound<'py, PyAny>,
        radii: Option<&Bound<'py, PyAny>>,
        densities: Option<&Bound<'py, PyAny>>,
        columns: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let arguments = Arguments::of("World.add()", columns)?;
        let (columns, many) = Draft::of_one_or_many(positions, velocities, radii)?;
        let len = many.unwrap_or(1);
        let densities = reals("densities", densities, len)?;
        let draft = Draft { columns: arguments.read(len, columns)?, densities };
        if radii.is_none() && self.state(py)?.world.defaults().radius.is_none() {
            let rule = "add needs radii: no number was given for all particles of this world";
            return Err(PyTypeError::new_err(rule));
        }
        let added = self.long(py, |state| {
            // The result before the change, which could not be returned otherwise.
            let mut ids = memory::with_capacity(len)?;
            let particles = draft.particles(len, &state.world.defaults())?;
            ids.extend(state.world.add(particles)?);
            Ok(ids)
        })?;
        let ids: Vec<Id> = result_of(added, many.is_none())?;
        if many.is_none() { ids[0].into_bound_py_any(py) } else { Ok(column(py, ids).into_any()) }
    }

    /// Remove particles. Their ids are never used again.
    ///
    /// The ids of other particles stay the same; in the columns, the rows after a removed one move
    /// up. Springs and attractors of a removed particle are removed too.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,)
    ///     The particles, each at most once.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an id does not exist or is given twice; then none is removed.
    ///
    /// See Also
    /// --------
    /// add : Add particles.
    /// rows : The rows that the others have then.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (5, 0), (9, 0)], [(0, 0)] * 3, radii=1.0)
    /// >>> world.remove(1)
    /// >>> world.positions
    /// array([[0., 0.],
    ///        [9., 0.]], dtype=float32)
    /// >>> world.ids
    /// array([0, 2])
    fn remove(&self, py: Python<'_>, ids: &Bound<'_, PyAny>) -> PyResult<()> {
        let ids = Ids::read(ids, "particle")?;
        ids.result_of(self.long(py, |state| state.world.remove(&ids.all))?)
    }

    /// Change some columns of some particles.
    ///
    /// Columns that are omitted stay the same. The arguments are those of :meth:`add`.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,)
    ///     The particles, each at most once.
    /// positions, velocities : array_like, shape (k, 2), or (2,) for one id, optional
    ///     Centres in units of length, and velocities in units of length per second.
    /// radii, masses, restitution : array_like, a number or shape (k,), optional
    ///     A new radius does not change the mass.
    /// movable : array_like of bool, one or shape (k,), optional
    ///     Whether contacts and forces can change the velocity.
    /// friction, angles, angular_velocities : array_like, a number or shape (k,), optional
    ///     Coefficients of friction; radians, and radians per second.
    /// categories, masks : array_like of int, a number or shape (k,), optional
    ///     Bit sets of 32 bits.
    /// sensors : array_like of bool, one or shape (k,), optional
    ///     Whether the particle is a sensor.
    /// kinds : array_like of int, a number or shape (k,), optional
    ///     Their kinds in each `PairForce`, from 0 to 63.
    ///
    /// Raises
    /// ------
    /// TypeError, ValueError
    ///     As for a new world, or if an id does not exist or is given twice; then nothing
    ///     is changed.
    ///
    /// See Also
    /// --------
    /// add : Add particles.
    /// rows : The rows of ids in the columns.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (5, 0)], [(0, 0), (0, 0)], radii=1.0)
    /// >>> world.set([1], velocities=[(2, 0)], masses=3.0)
    /// >>> world.momentum
    /// (6.0, 0.0)
    /// >>> world.set(0, positions=(2, 1))
    #[pyo3(
        signature = (ids, **columns),
        text_signature = "($self, ids, *, positions=None, velocities=None, radii=None, \
                          masses=None, restitution=None, movable=None, friction=None, \
                          angles=None, angular_velocities=None, categories=None, masks=None, \
                          sensors=None, kinds=None)"
    )]
    fn set(
        &self,
        py: Python<'_>,
        ids: &Bound<'_, PyAny>,
        columns: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        let mut arguments = Arguments::of("World.set()", columns)?;
        let ids = Ids::read(ids, "particle")?;
        let len = ids.all.len();
        let [positions, velocities] = [arguments.positions.take(), arguments.velocities.take()];
        let vectors = Changes {
            positions: vectors_of(&ids, "positions", positions.as_ref())?.map(Each::Rows),
            velocities: vectors_of(&ids, "velocities", velocities.as_ref())?.map(Each::Rows),
            ..Changes::default()
        };
        let changes = arguments.read(len, vectors)?;
        ids.result_of(self.long(py, |state| state.world.set(&ids.all, &changes))?)
    }

    /// Read all columns of one particle or some, without those of the others.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,)
    ///     The particles; one may be given more than once.
    ///
    /// Returns
    /// -------
    /// Particles or Particle
    ///     Copies of `positions`, `velocities`, `radii` and so on, by the names of the arguments of
    ///     `add` and `set`, with a row for each id; single values for one id, those of float32 as the
    ///     float with their shortest decimal: 0.1, where ``float(world.radii[0])`` is
    ///     0.10000000149011612. The cost depends on the
    ///     number of ids alone, except that the first call after a step reads all row numbers.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If `ids` does not hold integers.
    /// ValueError
    ///     If no particle has an id.
    ///
    /// See Also
    /// --------
    /// set : Writes columns of some particles.
    /// positions : The positions of all particles.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (5, 0)], [(0, 0), (2, 1)], radii=[1.0, 0.5])
    /// >>> world.read(1).velocities, world.read(1).masses
    /// (array([2., 1.], dtype=float32), 0.25)
    /// >>> world.read([1, 0]).radii
    /// array([0.5, 1. ], dtype=float32)
    ///
    /// A copy of particle 1, in another place:
    ///
    /// >>> copy = world.read(1).to_dict() | {"positions": (9, 0)}
    /// >>> world.add(**copy)
    /// 2
    fn read<'py>(&self, py: Python<'py>, ids: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let ids = Ids::read(ids, "particle")?;
        let copy = ids.result_of(self.long(py, |state| state.world.read(&ids.all))?)?;
        results::world_particles(py, copy, ids.single)
    }
}

/// One pair for each id, or a single pair for one id.
pub(super) fn vectors_of(
    ids: &Ids,
    name: &'static str,
    value: Option<&Bound<'_, PyAny>>,
) -> PyResult<Option<Vec<[f32; 2]>>> {
    if !ids.single {
        return vectors(name, value, ids.all.len());
    }
    value.map(|value| only_vector(name, value, "id")).transpose()
}
