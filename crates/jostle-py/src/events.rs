//! `jostle.Events`.

use jostle_base::ids::Id;
use jostle_space::Events;
use numpy::PyArray2;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyTuple;

use crate::arrays::{Argument, long, table};
use crate::error::refused;
use crate::interrupt::detached;
use crate::space::PySpace;

/// Changes of the overlapping pairs of a space between two updates.
///
/// Each array contains pairs of ids, the smaller first, sorted by the first, then by the second.
/// Pairs that only met on the way, in an update with ``swept=True``, are in `entered` and in `exited`.
/// `stayed` takes time for every pair in the space, when it is first read. Copying and pickling read it
/// too, so after the next update they are errors unless it was read before.
///
/// See Also
/// --------
/// Space.update : Returns it.
/// WorldEvents : The same for particles.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> space = jostle.Space()
/// >>> ids = space.add([(0, 0), (1, 0), (9, 0)], radii=1.0)
/// >>> events = space.update()
/// >>> events
/// <jostle.Events: 1 entered, 0 exited>
/// >>> events.entered
/// array([[0, 1]])
#[pyclass(module = "jostle", name = "Events", frozen)]
pub struct PyEvents {
    events: Events,
    /// None after pickling, when all pairs are known.
    space: Option<Py<PySpace>>,
    entered: PyOnceLock<Pairs>,
    stayed: PyOnceLock<Pairs>,
    exited: PyOnceLock<Pairs>,
}

type Pairs = Py<PyArray2<Id>>;

/// A function and the arguments with which it makes an object again.
pub type Reduced<'py> = (Bound<'py, PyAny>, Bound<'py, PyTuple>);

/// Events with these pairs. For pickle.
#[pyfunction]
pub fn restore_events(
    py: Python<'_>,
    entered: &Bound<'_, PyAny>,
    stayed: &Bound<'_, PyAny>,
    exited: &Bound<'_, PyAny>,
) -> PyResult<PyEvents> {
    let read = |name, value| Argument::integers(name, value)?.id_pairs();
    let mut events = Events::default();
    events.entered = read("entered", entered)?;
    events.left = read("exited", exited)?;
    let pairs = table(py, read("stayed", stayed)?)?.unbind();
    let [entered, known, exited] = [const { PyOnceLock::new() }; 3];
    known.get_or_init(py, || pairs);
    Ok(PyEvents { events, space: None, entered, stayed: known, exited })
}

#[pymethods]
impl PyEvents {
    /// Pairs that overlap now and did not at the previous update, of a swept update also those that
    /// met on the way: ndarray of int64, shape (m, 2).
    #[getter]
    fn entered<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<Id>>> {
        kept(py, &self.entered, || copied(py, &self.events.entered))
    }

    /// Pairs that overlapped at both updates: ndarray of int64, shape (m, 2).
    ///
    /// They are computed when they are first read, which must be before the next update of the
    /// space; afterwards there is a RuntimeError.
    #[getter]
    fn stayed<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<Id>>> {
        kept(py, &self.stayed, || {
            let space = self.space.as_ref().map(|space| space.get());
            let stayed = space.map_or(Ok(None), |space| space.stayed(py, &self.events))?;
            stayed.ok_or_else(|| {
                PyRuntimeError::new_err(
                    "stayed is computed when it is first read, and the space has been updated \
                     since; read it before the next update",
                )
            })
        })
    }

    /// Pairs that overlapped at the previous update and do not now, also because a shape was
    /// removed, of a swept update also those that met on the way: ndarray of int64, shape (m, 2).
    #[getter]
    fn exited<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<Id>>> {
        kept(py, &self.exited, || copied(py, &self.events.left))
    }

    /// What pickle and copy store: all three arrays.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let restore = py.import("jostle._core")?.getattr("restore_events")?;
        let parts = [self.entered(py)?, self.stayed(py)?, self.exited(py)?];
        Ok((restore, PyTuple::new(py, parts)?))
    }

    fn __repr__(&self) -> String {
        let Events { entered, left: exited, .. } = &self.events;
        format!("<jostle.Events: {} entered, {} exited>", entered.len(), exited.len())
    }
}

impl PyEvents {
    /// The events of an update of `space`.
    pub fn of(events: Events, space: Py<PySpace>) -> Self {
        let [entered, stayed, exited] = [const { PyOnceLock::new() }; 3];
        Self { events, space: Some(space), entered, stayed, exited }
    }
}

fn copied(py: Python<'_>, pairs: &[[Id; 2]]) -> PyResult<Vec<[Id; 2]>> {
    detached(py, || long(pairs))?.map_err(refused)
}

/// The array of some pairs, which is made at the first call and kept.
fn kept<'py>(
    py: Python<'py>,
    array: &PyOnceLock<Pairs>,
    pairs: impl FnOnce() -> PyResult<Vec<[Id; 2]>>,
) -> PyResult<Bound<'py, PyArray2<Id>>> {
    if let Some(array) = array.get(py) {
        return Ok(array.bind(py).clone());
    }
    let pairs = pairs()?;
    Ok(array.get_or_try_init(py, || PyResult::Ok(table(py, pairs)?.unbind()))?.bind(py).clone())
}
