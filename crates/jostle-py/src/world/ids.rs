//! Ids of particles, and the rows of these.

use jostle_base::{Id, memory};
use numpy::PyArray1;
use pyo3::prelude::*;

use super::PyWorld;
use crate::arrays::{column, read_only};
use crate::error::refused;
use crate::ids::rows_of_any_shape;

#[pymethods]
impl PyWorld {
    /// The ids of all particles, ascending: ndarray of int64, shape (n,), a read-only copy.
    ///
    /// The particle in row i of every column has the id ``ids[i]``. Ids never change and are never
    /// used again. ``id in world`` is True if a particle has the id.
    ///
    /// See Also
    /// --------
    /// rows : The rows of ids.
    /// renumbered : The new ids after particles merged.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (5, 0), (9, 0)], 1.0)
    /// >>> world.remove(0)
    /// >>> world.add([(2, 2)], 1.0)
    /// array([3])
    /// >>> world.ids
    /// array([1, 2, 3])
    #[getter]
    fn ids<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<Id>>> {
        let ids = self.long(py, |state| state.world.bodies().ids())?.map_err(refused)?;
        Ok(read_only(column(py, ids)))
    }

    /// Return the rows that particles have in the columns.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, of any shape
    ///     The particles.
    ///
    /// Returns
    /// -------
    /// ndarray of int64 of the same shape, or int
    ///     Their rows, until a particle before them is removed or merges; one row for one id.
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
    /// ids : The ids of all rows.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (5, 0), (9, 0)], 1.0)
    /// >>> world.remove(0)
    /// >>> world.positions[world.rows(2)]
    /// array([9., 0.], dtype=float32)
    fn rows<'py>(&self, py: Python<'py>, ids: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        rows_of_any_shape(ids, "particle", |ids| {
            self.long(py, |state| {
                let rows = state.world.bodies().rows_of(ids);
                rows.and_then(|rows| memory::collect(rows.into_iter().map(i64::from)))
            })
        })
    }

    /// The new id of each id after the last call of `step`: a read-only ndarray of int64, or None
    /// if no particles merged.
    ///
    /// It has one number for each id that was ever given: ``ids = world.renumbered[ids]`` updates
    /// ids. Particles that merged share the smallest of their ids; all other ids stay the same. -1
    /// stands for an id that no particle has, also if it was removed since. Each call of `step`
    /// replaces the array: read it after every call that may merge particles. If its first step is
    /// refused, the array stays. Snapshots, files and copies do not contain it.
    ///
    /// Raises
    /// ------
    /// MemoryError
    ///     If more than 134217728 ids were given, or there is not enough memory.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (5, 0), (1, 0), (9, 0)], 1.0, on_touch="merge")
    /// >>> world.step(0.1)
    /// >>> world.ids
    /// array([0, 1, 3])
    /// >>> mine = np.array([2, 3])
    /// >>> world.renumbered[mine]  # 2 is part of 0 now
    /// array([0, 3])
    #[getter]
    fn renumbered<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray1<i64>>>> {
        let ids = self.long(py, |state| state.world.renumbered())?.map_err(refused)?;
        let ids = ids.map(|ids| memory::collect(ids.into_iter().map(|id| id.unwrap_or(-1))));
        let ids = ids.transpose().map_err(refused)?;
        Ok(ids.map(|ids| read_only(column(py, ids))))
    }
}
