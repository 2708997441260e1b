//! `jostle.Events`.

use jostle_base::ids::Id;
use jostle_space::{Events, WithCategories, between};
use numpy::PyArray2;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyTuple;

use crate::arrays::{Argument, column, long, single_mask, table};
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
/// Contacts.between : The same choice by categories, of contacts.
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
    source: Source,
    entered: PyOnceLock<Pairs>,
    stayed: PyOnceLock<Pairs>,
    exited: PyOnceLock<Pairs>,
    /// Of the pairs that stayed, when these are known.
    stayed_categories: PyOnceLock<Vec<[u32; 2]>>,
}

/// Where the pairs that stayed come from.
enum Source {
    /// They are known.
    Known,
    /// The space, until its next update.
    Space(Py<PySpace>),
    /// Those of other events that are between two sets of categories.
    Part(Py<PyEvents>, [u32; 2]),
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
    categories: &Bound<'_, PyAny>,
) -> PyResult<PyEvents> {
    let read = |name, value| Argument::integers(name, value)?.id_pairs();
    let bits = |index: usize| -> PyResult<Vec<[u32; 2]>> {
        let list = Argument::integers("categories", &categories.get_item(index)?)?;
        let len = list.len()?;
        Ok(list.bits_each(len)?.rows(len).as_chunks::<2>().0.to_vec())
    };
    let mut events = Events::default();
    events.entered = read("entered", entered)?;
    events.left = read("exited", exited)?;
    events.categories = [bits(0)?, bits(2)?];
    let pairs = table(py, read("stayed", stayed)?)?.unbind();
    let known = PyEvents::from(events, Source::Known);
    known.stayed.get_or_init(py, || pairs);
    let stayed_categories = bits(1)?;
    known.stayed_categories.get_or_init(py, || stayed_categories);
    Ok(known)
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
            let stayed = match &self.source {
                Source::Known => None,
                Source::Space(space) => space.get().stayed(py, &self.events)?,
                Source::Part(whole, categories) => {
                    Some(whole.get().stayed_between(py, *categories)?)
                }
            };
            let (pairs, categories) = stayed.ok_or_else(|| {
                PyRuntimeError::new_err(
                    "stayed is computed when it is first read, and the space has been updated \
                     since; read it before the next update",
                )
            })?;
            self.stayed_categories.get_or_init(py, || categories);
            Ok(pairs)
        })
    }

    /// Pairs that overlapped at the previous update and do not now, also because a shape was
    /// removed, of a swept update also those that met on the way: ndarray of int64, shape (m, 2).
    #[getter]
    fn exited<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<Id>>> {
        kept(py, &self.exited, || copied(py, &self.events.left))
    }

    /// Return the events between shapes of some categories and shapes of others.
    ///
    /// A pair is kept if one of its shapes has a category in `a` and the other one has a category in
    /// `b`. The shape in the first column then has one in `a`, and that in the second has one in
    /// `b`, so the smaller id may be the second. A pair that fits in both orders is kept once, as it is.
    ///
    /// Parameters
    /// ----------
    /// a, b : int
    ///     Categories, sets of 32 bits, which may be the same or have some in common.
    ///
    /// Returns
    /// -------
    /// Events
    ///     The pairs that are kept, in the same order.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If `a` or `b` is no integer.
    /// ValueError
    ///     If `a` or `b` has more than 32 bits.
    ///
    /// See Also
    /// --------
    /// Contacts.between : The same for contacts.
    ///
    /// Notes
    /// -----
    /// The categories are those that the shapes had at the update, also of shapes that were removed
    /// before or after it. Those of the pairs that stayed are read with `stayed`, and it can be read
    /// as long as that of the events from which these come.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> ROCK, SHOT = 2, 4
    /// >>> space = jostle.Space()
    /// >>> rocks = space.add([(0, 0), (1, 0)], radii=1.0, categories=ROCK)
    /// >>> shot = space.add((0, 1), radii=0.1, categories=SHOT)
    /// >>> events = space.update()
    /// >>> events.entered
    /// array([[0, 1],
    ///        [0, 2]])
    /// >>> events.between(SHOT, ROCK).entered
    /// array([[2, 0]])
    fn between(
        slf: &Bound<'_, Self>,
        a: &Bound<'_, PyAny>,
        b: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let (py, this) = (slf.py(), slf.get());
        let both = [single_mask("a", a)?, single_mask("b", b)?];
        let Events { entered, left, categories: [of_entered, of_left], .. } = &this.events;
        let entered = chosen(py, entered, of_entered, both)?;
        let left = chosen(py, left, of_left, both)?;
        let mut events = Events::default();
        events.categories = [entered.1, left.1];
        (events.entered, events.left) = (entered.0, left.0);
        Ok(Self::from(events, Source::Part(slf.clone().unbind(), both)))
    }

    /// What pickle and copy store: all three arrays, and their categories.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let restore = py.import("jostle._core")?.getattr("restore_events")?;
        let [entered, stayed, exited] = [self.entered(py)?, self.stayed(py)?, self.exited(py)?];
        let [of_entered, of_left] = &self.events.categories;
        let of_stayed = self.stayed_categories.get(py).map_or(&[][..], |categories| categories);
        let categories = [&of_entered[..], of_stayed, &of_left[..]];
        let categories = categories.map(|some| column(py, some.as_flattened().to_vec()));
        let categories = PyTuple::new(py, categories)?;
        let parts =
            [entered.into_any(), stayed.into_any(), exited.into_any(), categories.into_any()];
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
        Self::from(events, Source::Space(space))
    }

    fn from(events: Events, source: Source) -> Self {
        let [entered, stayed, exited] = [const { PyOnceLock::new() }; 3];
        let stayed_categories = PyOnceLock::new();
        Self { events, source, entered, stayed, exited, stayed_categories }
    }

    /// The pairs that stayed and are between two sets of categories.
    fn stayed_between(&self, py: Python<'_>, both: [u32; 2]) -> PyResult<WithCategories> {
        let stayed = self.stayed(py)?;
        let pairs = Argument::integers("stayed", stayed.as_any())?.id_pairs()?;
        let categories = self.stayed_categories.get(py).map_or(&[][..], |categories| categories);
        chosen(py, &pairs, categories, both)
    }
}

fn chosen(
    py: Python<'_>,
    pairs: &[[Id; 2]],
    categories: &[[u32; 2]],
    both: [u32; 2],
) -> PyResult<WithCategories> {
    detached(py, || between(pairs, categories, both))?.map_err(refused)
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
