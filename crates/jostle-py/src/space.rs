//! `jostle.Space`: its constructor; the files in this folder have its methods, by subject.

/// Runs the same expression for either precision. Above the modules, which use it.
macro_rules! with_space {
    ($self:ident, $name:ident => $do:expr) => {
        match &$self.space {
            Either::Single($name) => $do,
            Either::Double($name) => $do,
        }
    };
}

mod columns;
mod edits;
mod saved;
mod searching;
mod walking;

use jostle_index::{Period, Scalar};
use jostle_space::Space;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::{Given, number};
use crate::error::{refused, value_error};
use crate::ids::left_operand;
use crate::interrupt::detached;
use crate::keywords::Keywords;
use crate::lock::Shared;
use crate::queries::{self, Cast, Maybe};
use crate::query_methods::{Index, NeighborIndex, query_methods};
use crate::settings;
pub use saved::restore_space;

/// A collection of shapes that can be added, moved, changed and removed, and of the pairs that
/// overlap.
///
/// A shape is every point within `radius` of its core: the axis-aligned box ``center ± half_size``,
/// one of `boxes`, or one of `segments`. A circle has half size 0, a rectangle radius 0.
/// Each shape has an id, which is never used again for another shape. The cost depends on the
/// shapes that change: a million shapes at rest cost much less than a thousand that move.
/// Every query includes all previous changes.
///
/// Parameters
/// ----------
/// dtype : {"float64", "float32"}, default "float64"
///     Precision of all arithmetic. Other numbers are converted.
/// period : float or (float, float), optional
///     Width and height of a periodic plane, one number for both; 0 or None on an axis that is
///     not periodic. Centres are moved into ``[0, period)``; positions that differ by a multiple of
///     the period are equal in every method, and each shape is found once.
/// leaf_capacity : int, default 96
///     Shapes that a box of a tree may hold before it splits into four. Small trees in a
///     space with many shapes use a smaller number.
/// max_depth : int, default 4096
///     Maximum number of subdivisions; the default never prevents a split.
/// threads : int, optional
///     Number of threads, at most one for each core, which is the default. Every answer
///     is the same for every number.
///
/// Raises
/// ------
/// TypeError
///     If an argument has the wrong type.
/// ValueError
///     If a setting is out of range.
///
/// See Also
/// --------
/// Quadtree : An index of shapes that do not change.
/// World : Particles that move and collide; in other libraries this may be called a space.
///
/// Notes
/// -----
/// Where ids are an argument, one id may be given instead of an array; then the other arguments
/// are one value each. A refused call changes nothing.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> space = jostle.Space()
/// >>> ids = space.add([(0, 0), (5, 0)], radii=1.0)
/// >>> space.set(ids[1], positions=(1.5, 0))
/// >>> space.update().entered
/// array([[0, 1]])
/// >>> space.remove(0)
/// >>> space.update().exited
/// array([[0, 1]])
#[pyclass(module = "jostle", name = "Space", frozen)]
pub struct PySpace {
    space: Either,
}

/// A space of the core, in either precision.
enum Either {
    Single(Shared<Space<f32>>),
    Double(Shared<Space<f64>>),
}

query_methods!(PySpace, with_space);

#[pymethods]
impl PySpace {
    #[new]
    #[pyo3(
        signature = (*arguments, **keywords),
        text_signature = "(*, dtype='float64', period=None, leaf_capacity=96, max_depth=4096, \
                          threads=None)"
    )]
    fn new(arguments: &Bound<'_, PyTuple>, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let mut given = Keywords::of_all("Space()", &[], arguments, keywords)?;
        let dtype = given.given("dtype");
        let (settings, period) = settings::index(&mut given)?;
        given.end()?;
        let space = if is_single(&dtype)? {
            Either::Single(empty(settings, period).map_err(refused)?)
        } else {
            Either::Double(empty(settings, period).map_err(refused)?)
        };
        Ok(Self { space })
    }

    /// The precision of its arithmetic: "float32" or "float64".
    #[getter]
    fn dtype(&self) -> &'static str {
        match self.space {
            Either::Single(_) => "float32",
            Either::Double(_) => "float64",
        }
    }

    /// Width and height of the period: a tuple of two floats, 0 on an axis that is not periodic.
    #[getter]
    fn period(&self, py: Python<'_>) -> PyResult<(f64, f64)> {
        with_space!(self, space => {
            let [x, y] = space.lock_attached(py)?.period().sides().map(Scalar::to_f64);
            Ok((x, y))
        })
    }

    fn __contains__(&self, py: Python<'_>, id: &Bound<'_, PyAny>) -> PyResult<bool> {
        let id = left_operand(id, "np.isin(ids, space.ids) tests many")?;
        let Some(id) = id else { return Ok(false) };
        with_space!(self, space => Ok(space.lock_attached(py)?.contains(id)))
    }

    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        with_space!(self, space => Ok(space.lock_attached(py)?.len()))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("<jostle.Space of {} shapes, {}>", self.__len__(py)?, self.dtype()))
    }
}

/// A space with a lock.
fn shared<T>(space: Space<T>) -> Shared<Space<T>> {
    Shared::new(space, "space", "make a new one")
}

fn empty<T: Scalar>(
    settings: jostle_base::Settings,
    period: Period<f64>,
) -> jostle_base::Result<Shared<Space<T>>> {
    Ok(shared(Space::with_period(settings, settings::period_in(period)?)?))
}

/// Calls `act` with a space, without the GIL.
fn long<T: Scalar, R: Send>(
    py: Python<'_>,
    space: &Shared<Space<T>>,
    act: impl FnOnce(&mut Space<T>) -> R + Send,
) -> PyResult<R> {
    detached(py, || Ok(act(&mut *space.lock()?)))?
}

/// Whether the requested precision is float32.
fn is_single(dtype: &Given<'_>) -> PyResult<bool> {
    const RULE: &str = "'float32' or 'float64'";
    let Some(dtype) = dtype.value() else { return Ok(false) };
    let wrong = || PyTypeError::new_err(format!("dtype must be {RULE}, not {dtype}"));
    if dtype.is_none() {
        return Err(wrong());
    }
    let found =
        dtype.py().import("numpy")?.getattr("dtype")?.call1((dtype,)).map_err(|_| wrong())?;
    match found.getattr("name")?.extract::<String>()?.as_str() {
        "float32" => Ok(true),
        "float64" => Ok(false),
        other => Err(value_error("dtype", format!("'{other}'"), RULE)),
    }
}
