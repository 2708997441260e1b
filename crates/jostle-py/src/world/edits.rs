//! Adding, removing, reading and changing particles.

use jostle_base::{Id, memory};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::PyWorld;
use crate::arrays::{Given, column};
use crate::ids::Ids;
use crate::keywords::Keywords;
use crate::particles::{self, Arguments, one_or_vectors, only_vector};
use crate::queries::result_of;
use crate::results;

#[pymethods]
impl PyWorld {
    /// Add one particle or many, after the others.
    ///
    /// Parameters
    /// ----------
    /// positions : array_like, shape (k, 2), or (2,) for one particle
    ///     Centres, in units of length.
    /// radii : array_like, a number or shape (k,)
    ///     In units of length.
    /// velocities : array_like, shape (2,) or (k, 2), default (0.0, 0.0)
    ///     In units of length per second.
    /// masses : array_like, a number or shape (k,), optional
    ///     In units of mass; the squares of the radii if omitted.
    /// angles, angular_velocities : array_like, a number or shape (k,), default 0.0
    ///     In radians and in radians per second, positive from +x to +y.
    /// friction : array_like, a number or shape (k,), default 0.0
    ///     Coefficients of friction.
    /// restitution : array_like, a number or shape (k,), default 1.0
    ///     Coefficients of restitution.
    /// movable : array_like of bool, one or shape (k,), default True
    ///     Whether contacts and forces can change the velocity.
    /// sensors : array_like of bool, one or shape (k,), default False
    ///     Whether the particle is a sensor.
    /// kinds : array_like of int, a number or shape (k,), default 0
    ///     Their kinds in each `PairForce`, from 0 to 63.
    /// categories, masks : array_like of int, a number or shape (k,), default 1 and all bits
    ///     Bit sets of 32 bits. Omitted columns have these defaults, whatever the other particles have.
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
    /// >>> world = jostle.World([(0, 0)], 1.0)
    /// >>> world.add([(5, 0), (9, 0)], 0.5)
    /// array([1, 2])
    /// >>> world.add((0, 5), 2.0, velocities=(1, 0))
    /// 3
    /// >>> world.radii
    /// array([1. , 0.5, 0.5, 2. ], dtype=float32)
    #[pyo3(
        signature = (positions=Given::NOTHING, radii=Given::NOTHING, **columns),
        text_signature = "($self, positions, radii, *, velocities=(0.0, 0.0), masses=None, \
                          angles=0.0, angular_velocities=0.0, friction=0.0, restitution=1.0, \
                          movable=True, sensors=False, kinds=0, categories=1, \
                          masks=4294967295)"
    )]
    fn add<'py>(
        &self,
        py: Python<'py>,
        positions: Given<'py>,
        radii: Given<'py>,
        columns: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut keywords = Keywords::of("World.add()", columns)?;
        let [positions, radii] =
            keywords.require_given([("positions", positions), ("radii", radii)])?;
        let arguments = Arguments { radii: Some(radii), ..Arguments::of(&mut keywords)? };
        keywords.end()?;
        let (columns, many) = arguments.read_new(&positions)?;
        let len = many.unwrap_or(1);
        let added = self.long(py, |state| {
            // The result before the change, which could not be returned otherwise.
            let mut ids = memory::with_capacity(len)?;
            let particles = particles::particles(&columns, len)?;
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
    /// IdError
    ///     If an id does not exist; then none is removed.
    /// ValueError
    ///     If an id is given twice; then none is removed.
    ///
    /// See Also
    /// --------
    /// add : Add particles.
    /// rows : The rows that the others have then.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (5, 0), (9, 0)], 1.0)
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
    /// IdError
    ///     If an id does not exist; then nothing is changed.
    /// TypeError, ValueError
    ///     As for a new world, or if an id is given twice; then nothing is changed.
    ///
    /// See Also
    /// --------
    /// add : Add particles.
    /// rows : The rows of ids in the columns.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (5, 0)], 1.0)
    /// >>> world.set([1], velocities=[(2, 0)], masses=3.0)
    /// >>> world.momentum()
    /// array([6., 0.])
    /// >>> world.set(0, positions=(2, 1))
    #[pyo3(
        signature = (ids=Given::NOTHING, **columns),
        text_signature = "($self, ids, *, positions=None, velocities=None, radii=None, \
                          masses=None, restitution=None, movable=None, friction=None, \
                          angles=None, angular_velocities=None, categories=None, masks=None, \
                          sensors=None, kinds=None)"
    )]
    fn set(
        &self,
        py: Python<'_>,
        ids: Given<'_>,
        columns: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        let mut keywords = Keywords::of("World.set()", columns)?;
        let [ids] = keywords.require_given([("ids", ids)])?;
        let arguments = Arguments::of(&mut keywords)?;
        keywords.end()?;
        let ids = Ids::read(&ids, "particle")?;
        let changes =
            if ids.single { arguments.read_one("id")? } else { arguments.read(ids.all.len())? };
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
    /// IdError
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
    /// >>> world = jostle.World([(0, 0), (5, 0)], [1.0, 0.5], velocities=[(0, 0), (2, 1)])
    /// >>> world.get(1).velocities, world.get(1).masses
    /// (array([2., 1.], dtype=float32), 0.25)
    /// >>> world.get([1, 0]).radii
    /// array([0.5, 1. ], dtype=float32)
    ///
    /// A copy of particle 1, in another place:
    ///
    /// >>> copy = world.get(1).to_dict() | {"positions": (9, 0)}
    /// >>> world.add(**copy)
    /// 2
    fn get<'py>(&self, py: Python<'py>, ids: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let ids = Ids::read(ids, "particle")?;
        let copy = ids.result_of(self.long(py, |state| state.world.read(&ids.all))?)?;
        results::world_particles(py, copy, ids.single)
    }
}

/// One pair for each id, or one for all.
pub(super) fn vectors_of(
    ids: &Ids,
    name: &'static str,
    value: Option<&Bound<'_, PyAny>>,
) -> PyResult<Option<Vec<[f32; 2]>>> {
    if !ids.single {
        return one_or_vectors(name, value, ids.all.len());
    }
    value.map(|value| only_vector(name, value, "id")).transpose()
}
