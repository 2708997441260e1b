//! Reading the shapes of a space.

use jostle_base::ids::Id;
use jostle_index::Scalar;
use jostle_index::geometry::Shape;
use jostle_space::Space;
use numpy::{Element, PyArray1};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;

use super::{Either, PySpace, long};
use crate::arrays::{column, table};
use crate::error::refused;
use crate::ids::Ids;
use crate::lock::Shared;
use crate::queries::{Maybe, result_of};

#[pymethods]
impl PySpace {
    /// Return centres; ``(min + max) / 2`` for shapes given as boxes.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,), optional
    ///     The shapes; if omitted all of them, in the order of `ids`.
    ///
    /// Returns
    /// -------
    /// ndarray of the space's dtype, shape (k, 2), or (2,) for one id
    ///     A copy.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an id does not exist.
    ///
    /// See Also
    /// --------
    /// boxes : Sides instead of centres.
    /// half_sizes, radii : The sizes.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> ids = space.add([(0, 0), (3, 4)])
    /// >>> space.centers(1)
    /// array([3., 4.])
    #[pyo3(signature = (ids=None))]
    fn centers<'py>(&self, py: Python<'py>, ids: Maybe<'_, 'py>) -> PyResult<Bound<'py, PyAny>> {
        with_space!(self, space => read_rows(py, space, ids, |shape| shape.center()))
    }

    /// Return half widths and half heights; 0 for circles, ``(max - min) / 2`` for shapes given as
    /// boxes.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,), optional
    ///     The shapes; if omitted all of them.
    ///
    /// Returns
    /// -------
    /// ndarray of the space's dtype, shape (k, 2), or (2,) for one id
    ///     A copy.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an id does not exist.
    ///
    /// See Also
    /// --------
    /// boxes : Sides, without rounding.
    /// radii : The radii.
    #[pyo3(signature = (ids=None))]
    fn half_sizes<'py>(&self, py: Python<'py>, ids: Maybe<'_, 'py>) -> PyResult<Bound<'py, PyAny>> {
        with_space!(self, space => read_rows(py, space, ids, |shape| shape.core_half_size()))
    }

    /// Return boxes: the sides of the shapes without their radii.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,), optional
    ///     The shapes; if omitted all of them.
    ///
    /// Returns
    /// -------
    /// ndarray of the space's dtype, shape (k, 4), or (4,) for one id
    ///     A copy: min_x, min_y, max_x, max_y, as they were given, or ``center ± half_size``;
    ///     for a circle its centre as both corners.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an id does not exist.
    ///
    /// See Also
    /// --------
    /// centers, half_sizes : The same as centres and half sizes.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> ids = space.add(boxes=[(0, 0, 0.1, 0.1), (0.1, 0, 0.2, 0.1)])
    /// >>> space.boxes(1)
    /// array([0.1, 0. , 0.2, 0.1])
    #[pyo3(signature = (ids=None))]
    fn boxes<'py>(&self, py: Python<'py>, ids: Maybe<'_, 'py>) -> PyResult<Bound<'py, PyAny>> {
        with_space!(self, space => read_rows(py, space, ids, |shape| shape.core()))
    }

    /// Return radii.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,), optional
    ///     The shapes; if omitted all of them.
    ///
    /// Returns
    /// -------
    /// ndarray of the space's dtype, shape (k,), or float for one id
    ///     A copy.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an id does not exist.
    ///
    /// See Also
    /// --------
    /// half_sizes : Half widths and half heights.
    #[pyo3(signature = (ids=None))]
    fn radii<'py>(&self, py: Python<'py>, ids: Maybe<'_, 'py>) -> PyResult<Bound<'py, PyAny>> {
        with_space!(self, space => match read(py, space, ids, |shape| shape.radius)? {
            (radii, true) => radii[0].to_f64().into_bound_py_any(py),
            (radii, false) => Ok(column(py, radii).into_any()),
        })
    }

    /// Return categories.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,), optional
    ///     The shapes; if omitted all of them.
    ///
    /// Returns
    /// -------
    /// ndarray of uint32, shape (k,), or int for one id
    ///     A copy.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an id does not exist.
    ///
    /// See Also
    /// --------
    /// masks : The categories that each shape may pair with.
    /// set_filter : Change them.
    #[pyo3(signature = (ids=None))]
    fn categories<'py>(&self, py: Python<'py>, ids: Maybe<'_, 'py>) -> PyResult<Bound<'py, PyAny>> {
        with_space!(self, space => read_bits(py, space, ids, |shape| shape.category))
    }

    /// Return masks.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,), optional
    ///     The shapes; if omitted all of them.
    ///
    /// Returns
    /// -------
    /// ndarray of uint32, shape (k,), or int for one id
    ///     A copy.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an id does not exist.
    ///
    /// See Also
    /// --------
    /// categories : The categories of each shape.
    /// set_filter : Change them.
    #[pyo3(signature = (ids=None))]
    fn masks<'py>(&self, py: Python<'py>, ids: Maybe<'_, 'py>) -> PyResult<Bound<'py, PyAny>> {
        with_space!(self, space => read_bits(py, space, ids, |shape| shape.mask))
    }

    /// The ids of all shapes, ascending: ndarray of int64, shape (n,).
    #[getter]
    fn ids<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<Id>>> {
        with_space!(self, space => {
            let ids = long(py, space, |space| space.ids())?.map_err(refused)?;
            Ok(column(py, ids))
        })
    }
}

/// A value of each shape, and whether the argument was one id.
fn read<T: Scalar, V: Send>(
    py: Python<'_>,
    space: &Shared<Space<T>>,
    ids: Maybe<'_, '_>,
    of: impl Fn(Shape<T>) -> V + Send,
) -> PyResult<(Vec<V>, bool)> {
    let ids = ids.map(|ids| Ids::read(ids, "shape")).transpose()?;
    let single = ids.as_ref().is_some_and(|ids| ids.single);
    let values = long(py, space, |space| {
        let all = ids.map_or_else(|| space.ids(), |ids| Ok(ids.all))?;
        space.read(&all, of)
    })?;
    Ok((result_of(values, single)?, single))
}

fn read_rows<'py, T: Scalar + Element, const W: usize>(
    py: Python<'py>,
    space: &Shared<Space<T>>,
    ids: Maybe<'_, 'py>,
    of: impl Fn(Shape<T>) -> [T; W] + Send,
) -> PyResult<Bound<'py, PyAny>> {
    match read(py, space, ids, of)? {
        (rows, true) => Ok(column(py, rows[0].to_vec()).into_any()),
        (rows, false) => Ok(table(py, rows)?.into_any()),
    }
}

fn read_bits<'py, T: Scalar>(
    py: Python<'py>,
    space: &Shared<Space<T>>,
    ids: Maybe<'_, 'py>,
    of: impl Fn(Shape<T>) -> u32 + Send,
) -> PyResult<Bound<'py, PyAny>> {
    match read(py, space, ids, of)? {
        (bits, true) => bits[0].into_bound_py_any(py),
        (bits, false) => Ok(column(py, bits).into_any()),
    }
}
