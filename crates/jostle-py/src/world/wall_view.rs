//! `World.walls`: the walls of a world with their ids and columns.

use jostle_base::{Error, Id, memory};
use jostle_world::Wall;
use numpy::{Element, PyArray1, PyArray2, PyArray3};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::{PyWorld, State};
use crate::arrays::{Given, column, read_only, segments, table};
use crate::error::refused;
use crate::ids::{Ids, left_operand, rows_of_any_shape};
use crate::keywords::Keywords;
use crate::queries::result_of;
use crate::results;
use crate::walls::{self, Columns, as_it_is};

/// The walls of a world: line segments with ids, which discs do not cross.
///
/// It is made by `World.walls` and shows the walls that the world has at any time. Each wall has an
/// id, which never changes and is never used again: 0, 1, 2, ... in the order of adding. The columns
/// are in the order of `ids`, and `rows` gives the rows of ids. Columns are read-only copies: assign
/// them as a whole, or change some walls with `set`. A change wakes all particles. It costs as much
/// as all walls, so change many at once.
///
/// A wall stops particles from both sides and at its ends. A wall that is `one_way` stops them only
/// from its left, and a sensor stops none. A wall moves with its velocity in each step, and pushes
/// particles as a kinematic particle does. Walls that are moved by a change transfer no momentum:
/// particles that overlap a wall are pushed out in several steps, to the side on which their centre is.
///
/// Queries find walls by id, where they are now in float32, in a periodic world across its sides. Rays and
/// moving shapes hit the same walls as casts of the `World`: no sensors, and one-way walls only from their left.
/// The first query after walls have moved or changed builds a tree of all walls; later ones use it.
///
/// See Also
/// --------
/// World.walls : Returns it.
/// World.raycast : Rays that hit particles, walls and the container.
/// polyline : Walls between consecutive points.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> world = jostle.World([(0, 2)], 1.0, velocities=[(0, -4)])
/// >>> floor, piston = world.walls.add([((-3, 0), (3, 0)), ((9, 0), (9, 5))], restitution=[0.25, None])
/// >>> world.walls.set(piston, velocities=(-1, 0))
/// >>> world.step(0.5)
/// >>> world.positions, world.walls.get(piston).segments
/// (array([[0. , 1.5]], dtype=float32), array([[8.5, 0. ],
///        [8.5, 5. ]], dtype=float32))
/// >>> world.walls.query_circle((0, 0), 1), world.walls.nearest((8, 9)).ids
/// (array([0]), array([1]))
#[pyclass(module = "jostle", name = "Walls", frozen)]
pub struct PyWalls(Py<PyWorld>);

#[pymethods]
impl PyWorld {
    /// The walls of the world: a `Walls`, which shows and changes them.
    ///
    /// It cannot be assigned; ``world.walls.segments = ...`` moves all walls.
    ///
    /// See Also
    /// --------
    /// jostle.polyline : Walls between consecutive points.
    /// last_step : The walls that particles touched, and more.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World(walls=jostle.polyline([(-3, 0), (0, 0), (3, 0)]))
    /// >>> world.walls.remove(0)
    /// >>> world.walls.ids, world.walls.segments.tolist()
    /// (array([1]), [[[0.0, 0.0], [3.0, 0.0]]])
    #[getter]
    fn walls(slf: Bound<'_, Self>) -> PyWalls {
        PyWalls(slf.unbind())
    }
}

#[pymethods]
impl PyWalls {
    /// Add one wall or many, after the others.
    ///
    /// Parameters
    /// ----------
    /// segments : array_like, shape (k, 2, 2), or (2, 2) for one wall
    ///     From one end to the other, in units of length.
    /// velocities : array_like, shape (2,) or (k, 2), default (0.0, 0.0)
    ///     In units of length per second. Walls that share an end should have the same velocity.
    ///     Nothing falls asleep while a wall moves.
    /// friction, restitution : array_like, a number or shape (k,), optional
    ///     Coefficients. A contact has the square root of the product with that of the particle. None,
    ///     and NaN for one wall, is the coefficient of the particle.
    /// sensors : array_like of bool, one or shape (k,), default False
    ///     Whether the wall is a sensor: it stops no particle. `World.wall_events` has the particles that
    ///     touch it, also those that cross it within one step.
    /// one_way : array_like of bool, one or shape (k,), default False
    ///     Whether the wall stops only what comes from the left of start → end: from the side of (-dy, dx),
    ///     where (dx, dy) is ``end - start``. A particle comes from there if all of it is there, up to an
    ///     overlap of 1/64 of its radius. Anything else passes.
    /// categories, masks : array_like of int, a number or shape (k,), default 1 and all bits
    ///     Bit sets of 32 bits: a particle i and a wall w touch only if ``categories[i] & masks[w]`` and
    ///     ``categories[w] & masks[i]``.
    ///
    /// Returns
    /// -------
    /// ndarray of int64, shape (k,), or int
    ///     Their ids, above all ids before; one id for one segment.
    ///
    /// Raises
    /// ------
    /// TypeError, ValueError
    ///     If a shape is wrong, a coordinate is not finite or above 1e18, the ends of a wall are equal,
    ///     or a wall is longer than a side of the period; then nothing is added.
    ///
    /// See Also
    /// --------
    /// set : Change walls.
    /// remove : Remove walls.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World()
    /// >>> world.walls.add(jostle.polyline([(0, 0), (5, 0), (5, 5)]), friction=0.5)
    /// array([0, 1])
    /// >>> world.walls.add(((0, 9), (5, 9)))
    /// 2
    #[pyo3(
        signature = (segments=Given::NOTHING, **columns),
        text_signature = "($self, segments, *, velocities=(0.0, 0.0), friction=None, \
                          restitution=None, sensors=False, one_way=False, categories=1, \
                          masks=4294967295)"
    )]
    fn add<'py>(
        &self,
        py: Python<'py>,
        segments: Given<'py>,
        columns: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut keywords = Keywords::of("Walls.add()", columns)?;
        let [segments] = keywords.require_given([("segments", segments)])?;
        let (ends, single) = walls::one_or_many("segments", &segments)?;
        let columns = Columns::read(&mut keywords, (ends.len(), single), as_it_is)?;
        keywords.end()?;
        let mut new = walls::new(ends)?;
        columns.write(&mut new);
        let added = self.world().long(py, |state| {
            // The result before the change, which could not be returned otherwise.
            let mut ids = memory::with_capacity(new.len())?;
            ids.extend(state.world.add_walls(&new)?);
            Ok(ids)
        })?;
        let ids: Vec<Id> = result_of(added, single)?;
        if single { ids[0].into_bound_py_any(py) } else { Ok(column(py, ids).into_any()) }
    }

    /// Remove walls. Their ids are never used again.
    ///
    /// In the columns, the rows after a removed one move up. A `Motor` no longer drives them, and
    /// `ThermalWalls` leave them out.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,)
    ///     The walls, each at most once.
    ///
    /// Raises
    /// ------
    /// IdError
    ///     If an id does not exist; then none is removed.
    /// ValueError
    ///     If an id is given twice; then none is removed.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World(walls=[((0, 0), (5, 0)), ((5, 0), (5, 5))])
    /// >>> world.walls.remove(world.walls.ids)
    /// >>> len(world.walls)
    /// 0
    fn remove(&self, py: Python<'_>, ids: &Bound<'_, PyAny>) -> PyResult<()> {
        let ids = Ids::read(ids, "wall")?;
        ids.result_of(self.world().long(py, |state| state.world.remove_walls(&ids.all))?)
    }

    /// Change some columns of some walls.
    ///
    /// Columns that are omitted stay the same.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,)
    ///     The walls, each at most once.
    /// segments : array_like, shape (k, 2, 2), or (2, 2) for one id, optional
    ///     In units of length.
    /// velocities : array_like, shape (2,) or (k, 2), optional
    ///     In units of length per second.
    /// friction, restitution : array_like, a number or shape (k,), or None, optional
    ///     Coefficients. None, and NaN for one wall, is the coefficient of the particle.
    /// sensors : array_like of bool, one or shape (k,), optional
    ///     Whether the wall is a sensor.
    /// one_way : array_like of bool, one or shape (k,), optional
    ///     Whether the wall stops only what comes from its left.
    /// categories, masks : array_like of int, a number or shape (k,), optional
    ///     Bit sets of 32 bits.
    ///
    /// Raises
    /// ------
    /// IdError
    ///     If an id does not exist; then nothing is changed.
    /// TypeError, ValueError
    ///     As by `add`, or if an id is given twice; then nothing is changed.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World(walls=[((0, 0), (5, 0)), ((5, 0), (5, 5))])
    /// >>> world.walls.set([0, 1], friction=[0.5, None], velocities=(0, 1))
    /// >>> world.walls.friction
    /// array([0.5, nan], dtype=float32)
    #[pyo3(
        signature = (ids=Given::NOTHING, **columns),
        text_signature = "($self, ids, *, segments=None, velocities=None, friction=None, \
                          restitution=None, sensors=None, one_way=None, categories=None, \
                          masks=None)"
    )]
    fn set(
        &self,
        py: Python<'_>,
        ids: Given<'_>,
        columns: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        let mut keywords = Keywords::of("Walls.set()", columns)?;
        let [ids] = keywords.require_given([("ids", ids)])?;
        let ids = Ids::read(&ids, "wall")?;
        let columns = Columns::read(&mut keywords, (ids.all.len(), ids.single), as_it_is)?;
        keywords.end()?;
        ids.result_of(
            self.world().long(py, |state| {
                state.world.set_walls_of(&ids.all, |walls| columns.write(walls))
            })?,
        )
    }

    /// Read all columns of one wall or some.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,)
    ///     The walls; one may be given more than once.
    ///
    /// Returns
    /// -------
    /// WallColumns or Wall
    ///     Copies of the columns by the names of the arguments of `add`, with a row for each id; single
    ///     values for one id. NaN in `friction` and `restitution` stands for that of the particle.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If `ids` does not hold integers.
    /// IdError
    ///     If no wall has an id.
    ///
    /// Examples
    /// --------
    /// A copy of wall 0, in another place:
    ///
    /// >>> import jostle
    /// >>> world = jostle.World(walls=[((0, 0), (5, 0))])
    /// >>> copy = world.walls.get(0).to_dict() | {"segments": ((0, 9), (5, 9))}
    /// >>> world.walls.add(**copy)
    /// 1
    fn get<'py>(&self, py: Python<'py>, ids: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let ids = Ids::read(ids, "wall")?;
        let copies = ids.result_of(self.world().long(py, |state| {
            let rows = state.world.wall_rows_of(&ids.all)?;
            memory::collect(rows.into_iter().map(|row| state.world.walls()[row as usize]))
        })?)?;
        results::walls(py, &copies, ids.single)
    }

    /// Return the rows that walls have in the columns.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, of any shape
    ///     The walls.
    ///
    /// Returns
    /// -------
    /// ndarray of int64 of the same shape, or int
    ///     Their rows, until a wall before them is removed; one row for one id.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If `ids` does not hold integers.
    /// IdError
    ///     If no wall has an id.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World(walls=[((0, 0), (5, 0)), ((5, 0), (5, 5))])
    /// >>> world.walls.remove(0)
    /// >>> world.walls.rows(1)
    /// 0
    fn rows<'py>(&self, py: Python<'py>, ids: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        rows_of_any_shape(ids, "wall", |ids| {
            self.world().long(py, |state| {
                let rows = state.world.wall_rows_of(ids);
                rows.and_then(|rows| memory::collect(rows.into_iter().map(i64::from)))
            })
        })
    }

    /// The ids of all walls, ascending: ndarray of int64, shape (m,), a read-only copy.
    ///
    /// The wall in row k of every column has the id ``ids[k]``. ``id in world.walls`` is True if a wall
    /// has the id.
    #[getter]
    fn ids<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<Id>>> {
        let ids = self.world().long(py, |state| state.world.wall_ids())?.map_err(refused)?;
        Ok(read_only(column(py, ids)))
    }

    /// The ends of the walls: ndarray of float32, shape (m, 2, 2), a read-only copy in units of length.
    ///
    /// To move all walls, assign an array of this shape. A segment that is the present one in float32
    /// keeps what rounding removed while the wall moved.
    #[getter]
    fn segments<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let ends = self.column_of(py, |wall| wall.ends)?;
        Ok(read_only(segments(py, &ends)?))
    }

    #[setter]
    fn set_segments(&self, py: Python<'_>, value: Bound<'_, PyAny>) -> PyResult<()> {
        self.assign(py, "segments", value)
    }

    /// Velocities: ndarray of float32, shape (m, 2), a read-only copy in units of length per second.
    ///
    /// A wall moves with its velocity in each step, so that `segments` has its new ends: pistons, paddles,
    /// lifts. To change all, assign an array or one vector; to change some, use `set`.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(4, 0)], 1.0)
    /// >>> piston = world.walls.add(((0, -2), (0, 2)), velocities=(2, 0))
    /// >>> world.step(0.5, steps=4)  # they touch after 1.5 seconds
    /// >>> world.velocities, world.walls.segments[:, 0]
    /// (array([[4., 0.]], dtype=float32), array([[ 4., -2.]], dtype=float32))
    #[getter]
    fn velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        Ok(read_only(table(py, self.column_of(py, |wall| wall.velocity)?)?))
    }

    #[setter]
    fn set_velocities(&self, py: Python<'_>, value: Bound<'_, PyAny>) -> PyResult<()> {
        self.assign(py, "velocities", value)
    }

    /// Coefficients of friction: ndarray of float32, shape (m,), a read-only copy.
    ///
    /// NaN stands for the coefficient of the particle. To change all, assign an array, one number, or None
    /// for NaN.
    #[getter]
    fn friction<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        self.array_of(py, |wall| wall.surface.friction.unwrap_or(f32::NAN))
    }

    #[setter]
    fn set_friction(&self, py: Python<'_>, value: Bound<'_, PyAny>) -> PyResult<()> {
        self.assign(py, "friction", value)
    }

    /// Coefficients of restitution, 0 to 1: ndarray of float32, shape (m,), a read-only copy.
    ///
    /// NaN stands for the coefficient of the particle. To change all, assign an array, one number, or None
    /// for NaN.
    #[getter]
    fn restitution<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        self.array_of(py, |wall| wall.surface.restitution.unwrap_or(f32::NAN))
    }

    #[setter]
    fn set_restitution(&self, py: Python<'_>, value: Bound<'_, PyAny>) -> PyResult<()> {
        self.assign(py, "restitution", value)
    }

    /// Which walls are sensors, which stop no particle: ndarray of bool, shape (m,), a read-only copy.
    ///
    /// `World.wall_events` has the particles that touch them. To change all, assign an array or one bool.
    #[getter]
    fn sensors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        self.array_of(py, |wall| wall.is_sensor)
    }

    #[setter]
    fn set_sensors(&self, py: Python<'_>, value: Bound<'_, PyAny>) -> PyResult<()> {
        self.assign(py, "sensors", value)
    }

    /// Which walls stop only what comes from the left of start → end: ndarray of bool, shape (m,), a read-only
    /// copy.
    ///
    /// To change all, assign an array or one bool.
    ///
    /// Examples
    /// --------
    /// A platform that a particle flies through on its way up, and lands on:
    ///
    /// >>> import jostle
    /// >>> world = jostle.World([(0, -2)], 1.0, velocities=(0, 9), gravity=(0, -10), restitution=0.25)
    /// >>> platform = world.walls.add(((-3, 0), (3, 0)), one_way=True)
    /// >>> world.step(1 / 60, steps=240)
    /// >>> world.positions.round(3)
    /// array([[0., 1.]], dtype=float32)
    #[getter]
    fn one_way<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        self.array_of(py, |wall| wall.is_one_way)
    }

    #[setter]
    fn set_one_way(&self, py: Python<'_>, value: Bound<'_, PyAny>) -> PyResult<()> {
        self.assign(py, "one_way", value)
    }

    /// Categories: ndarray of uint32, shape (m,), a read-only copy of bit sets.
    ///
    /// To change all, assign an array or one number.
    #[getter]
    fn categories<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<u32>>> {
        self.array_of(py, |wall| wall.filter.category)
    }

    #[setter]
    fn set_categories(&self, py: Python<'_>, value: Bound<'_, PyAny>) -> PyResult<()> {
        self.assign(py, "categories", value)
    }

    /// Masks: ndarray of uint32, shape (m,), a read-only copy of bit sets of the categories that each wall
    /// may touch.
    ///
    /// To change all, assign an array or one number.
    #[getter]
    fn masks<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<u32>>> {
        self.array_of(py, |wall| wall.filter.mask)
    }

    #[setter]
    fn set_masks(&self, py: Python<'_>, value: Bound<'_, PyAny>) -> PyResult<()> {
        self.assign(py, "masks", value)
    }

    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        Ok(self.world().state(py)?.world.walls().len())
    }

    fn __contains__(&self, py: Python<'_>, id: &Bound<'_, PyAny>) -> PyResult<bool> {
        let id = left_operand(id, "np.isin(ids, world.walls.ids) tests many")?;
        id.map_or(Ok(false), |id| Ok(self.world().state(py)?.world.has_wall(id)))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("<jostle.Walls with {} walls>", self.__len__(py)?))
    }
}

impl PyWalls {
    /// The world that has the walls.
    pub(super) fn world(&self) -> &PyWorld {
        self.0.get()
    }

    /// One value of each wall.
    fn column_of<V: Send>(&self, py: Python<'_>, of: fn(&Wall) -> V) -> PyResult<Vec<V>> {
        let column = |state: &mut State| memory::collect(state.world.walls().iter().map(of));
        self.world().long(py, column)?.map_err(refused)
    }

    /// A read-only array with one value of each wall.
    fn array_of<'py, V: Element>(
        &self,
        py: Python<'py>,
        of: fn(&Wall) -> V,
    ) -> PyResult<Bound<'py, PyArray1<V>>> {
        Ok(read_only(column(py, self.column_of(py, of)?)))
    }

    /// Replaces a whole column.
    fn assign(&self, py: Python<'_>, name: &'static str, value: Bound<'_, PyAny>) -> PyResult<()> {
        let world = self.world();
        let found = self.__len__(py)?;
        let columns = Columns::read_one(name, value, found)?;
        let done = world.long(py, |state| {
            let expected = state.world.walls().len();
            if found != expected {
                // Another thread has added or removed walls in the meantime.
                return Err(Error::Length { argument: "the new column", found, expected });
            }
            let ids = state.world.wall_ids()?;
            state.world.set_walls_of(&ids, |walls| columns.write(walls))
        });
        done?.map_err(refused)
    }
}
