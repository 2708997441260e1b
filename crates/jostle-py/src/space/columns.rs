//! The columns of a space, and some of its shapes.

use jostle_base::ids::Id;
use jostle_index::geometry::Shape;
use jostle_index::{Each, Scalar};
use jostle_space::{ShapeChanges, Space};
use numpy::{Element, PyArray1};
use pyo3::prelude::*;

use super::{Either, PySpace, long};
use crate::arrays::{Argument, bit_sets, column, read_only, reals, segments, table};
use crate::error::refused;
use crate::ids::{Ids, rows_of_any_shape};
use crate::lock::Shared;
use crate::queries::result_of;
use crate::results;
use crate::shapes::{Positions, Where};

#[pymethods]
impl PySpace {
    /// Centres, ``(min + max) / 2`` for shapes given as boxes: ndarray of the space's dtype, shape
    /// (n, 2), a read-only copy in the order of adding.
    ///
    /// Assign to it to move all shapes, as :meth:`set` does. With a period they are in
    /// ``[0, period)``. As of every column, the row of a shape is that of its id in `ids`; the first
    /// reading after shapes were removed visits all of them.
    ///
    /// See Also
    /// --------
    /// rows : The rows of ids.
    /// get, set : Some shapes.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> ids = space.add([(0, 0), (3, 4)], radii=1.0)
    /// >>> space.positions = space.positions + (1, 0)
    /// >>> space.positions
    /// array([[1., 0.],
    ///        [4., 4.]])
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        with_space!(self, space => table_of(py, space, |shape| shape.center()))
    }

    #[setter]
    fn set_positions(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        with_space!(self, space => {
            let positions = Where::read([Some(value), None, None, None])?;
            assign(py, space, |len| Ok(moved(positions.rows(len)?)))
        })
    }

    /// Radii: ndarray of the space's dtype, shape (n,), a read-only copy. Assign a number or an array to
    /// it to change all.
    #[getter]
    fn radii<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        with_space!(self, space => column_of(py, space, |shape| shape.radius))
    }

    #[setter]
    fn set_radii(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        with_space!(self, space => assign(py, space, |len| {
            Ok(ShapeChanges { radii: reals("radii", Some(value), len)?, ..ShapeChanges::default() })
        }))
    }

    /// Half widths and half heights: ndarray of the space's dtype, shape (n, 2), a read-only copy; 0 for
    /// circles, ``(max - min) / 2`` for shapes given as boxes. Assign to it to change all.
    #[getter]
    fn half_sizes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        with_space!(self, space => table_of(py, space, |shape| shape.core_half_size()))
    }

    #[setter]
    fn set_half_sizes(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        with_space!(self, space => assign(py, space, |len| {
            let half_sizes = Some(Argument::reals("half_sizes", value)?.half_sizes(len)?);
            Ok(ShapeChanges { half_sizes, ..ShapeChanges::default() })
        }))
    }

    /// The sides of the shapes without their radii: ndarray of the space's dtype, shape (n, 4), a
    /// read-only copy. Assign to it to give all shapes boxes.
    ///
    /// They are min_x, min_y, max_x, max_y as they were given, or ``center ± half_size``; for a circle
    /// its centre as both corners.
    #[getter]
    fn boxes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        with_space!(self, space => table_of(py, space, |shape| shape.sides()))
    }

    #[setter]
    fn set_boxes(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        with_space!(self, space => {
            let boxes = Where::read([None, None, Some(value), None])?;
            assign(py, space, |len| Ok(moved(boxes.rows(len)?)))
        })
    }

    /// Start and end of the segments: ndarray of the space's dtype, shape (n, 2, 2), a read-only copy; NaN
    /// for shapes that are none.
    ///
    /// Assign to it to give all shapes segments. NaN is for shapes that are none and stay as they are.
    /// With a period the middle of a segment is in ``[0, period)``.
    ///
    /// See Also
    /// --------
    /// jostle.polyline : Segments between consecutive points.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> ids = space.add(segments=jostle.polyline([(0, 0), (2, 0), (2, 4)]))
    /// >>> space.segments[1]
    /// array([[2., 0.],
    ///        [2., 4.]])
    /// >>> space.set(ids[1], positions=(3, 2))
    /// >>> space.get(ids[1]).segments
    /// array([[3., 0.],
    ///        [3., 4.]])
    #[getter]
    fn segments<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        with_space!(self, space => {
            let ends = all(py, space, |shape| shape.segment().unwrap_or([[Scalar::NAN; 2]; 2]))?;
            Ok(read_only(segments(py, &ends)?).into_any())
        })
    }

    #[setter]
    fn set_segments(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        with_space!(self, space => {
            let len = space.lock_attached(py)?.len();
            let ends = Argument::reals("segments", value)?.segments_of(len)?;
            long(py, space, |space| space.set_segments(&ends))?.map_err(refused)
        })
    }

    /// The sides of the bounding boxes: min_x, min_y, max_x, max_y of each shape with its radius.
    ///
    /// Returns
    /// -------
    /// ndarray of the space's dtype, shape (n, 4)
    ///     In the order of adding.
    ///
    /// See Also
    /// --------
    /// boxes : Without the radii.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> ids = space.add([(0, 0), (3, 4)], radii=1.0)
    /// >>> space.bounds()
    /// array([[-1., -1.,  1.,  1.],
    ///        [ 2.,  3.,  4.,  5.]])
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        with_space!(self, space => {
            let of = |shape: Shape<_>| {
                let ([a, b, c, d], r) = (shape.sides(), shape.radius);
                [a - r, b - r, c + r, d + r]
            };
            Ok(table(py, all(py, space, of)?)?.into_any())
        })
    }

    /// Categories, sets of 32 bits: ndarray of uint32, shape (n,), a read-only copy. Assign a number or an
    /// array to it to change all.
    #[getter]
    fn categories<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        with_space!(self, space => column_of(py, space, |shape| shape.category))
    }

    #[setter]
    fn set_categories(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        with_space!(self, space => assign(py, space, |len| {
            let categories = bit_sets("categories", Some(value), len)?;
            Ok(ShapeChanges { categories, ..ShapeChanges::default() })
        }))
    }

    /// Masks, sets of 32 bits: ndarray of uint32, shape (n,), a read-only copy. Assign a number or an array
    /// to it to change all.
    #[getter]
    fn masks<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        with_space!(self, space => column_of(py, space, |shape| shape.mask))
    }

    #[setter]
    fn set_masks(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        with_space!(self, space => assign(py, space, |len| {
            let masks = bit_sets("masks", Some(value), len)?;
            Ok(ShapeChanges { masks, ..ShapeChanges::default() })
        }))
    }

    /// The ids of all shapes, in the order of adding: ndarray of int64, shape (n,), a read-only copy.
    #[getter]
    fn ids<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<Id>>> {
        with_space!(self, space => {
            let ids = long(py, space, |space| space.ids())?.map_err(refused)?;
            Ok(read_only(column(py, ids)))
        })
    }

    /// Return the rows that shapes have in the columns.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, of any shape
    ///     The shapes.
    ///
    /// Returns
    /// -------
    /// ndarray of int64 of the same shape, or int
    ///     Their rows, until a shape before them is removed.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If `ids` does not hold integers.
    /// IdError
    ///     If an id does not exist.
    ///
    /// See Also
    /// --------
    /// ids : The ids of all rows.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> ids = space.add([(0, 0), (1, 0), (9, 0)], radii=1.0)
    /// >>> space.remove(0)
    /// >>> space.rows(space.pairs(distance=9.0))
    /// array([[0, 1]])
    fn rows<'py>(&self, py: Python<'py>, ids: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        with_space!(self, space => rows_of_any_shape(ids, "shape", |ids| {
            long(py, space, |space| space.rows_of(ids))
        }))
    }

    /// Return some shapes.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,)
    ///     The shapes, in any order, also several times.
    ///
    /// Returns
    /// -------
    /// Shape or Shapes
    ///     Copies of their columns; of one id the values of one shape.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If `ids` does not hold integers.
    /// IdError
    ///     If an id does not exist.
    ///
    /// See Also
    /// --------
    /// set : Change some shapes.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> ids = space.add([(0, 0), (3, 4)], radii=[1.0, 2.0])
    /// >>> space.get(1).positions, space.get(1).radii
    /// (array([3., 4.]), 2.0)
    /// >>> space.get([1, 0]).radii
    /// array([2., 1.])
    fn get<'py>(&self, py: Python<'py>, ids: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        with_space!(self, space => {
            let Ids { all, single } = Ids::read(ids, "shape")?;
            let shapes = long(py, space, |space| space.read(&all, |shape| shape))?;
            results::shapes(py, &result_of(shapes, single)?, single)
        })
    }
}

/// The change to other positions.
pub(super) fn moved<T>(positions: Positions<T>) -> ShapeChanges<T>
where
    ShapeChanges<T>: Default,
{
    match positions {
        Positions::Centers(all) => {
            ShapeChanges { positions: Some(Each::Rows(all)), ..ShapeChanges::default() }
        }
        Positions::Segments(all) => {
            ShapeChanges { segments: Some(Each::Rows(all)), ..ShapeChanges::default() }
        }
        Positions::Boxes(all) => {
            ShapeChanges { boxes: Some(Each::Rows(all)), ..ShapeChanges::default() }
        }
    }
}

/// Changes all shapes; `read` reads the argument for their number.
fn assign<T: Scalar>(
    py: Python<'_>,
    space: &Shared<Space<T>>,
    read: impl FnOnce(usize) -> PyResult<ShapeChanges<T>>,
) -> PyResult<()> {
    let new = read(space.lock_attached(py)?.len())?;
    let set = |space: &mut Space<T>| space.ids().and_then(|ids| space.set(&ids, &new));
    long(py, space, set)?.map_err(refused)
}

/// A value of each shape, in the order of adding.
fn all<T: Scalar, V: Send>(
    py: Python<'_>,
    space: &Shared<Space<T>>,
    of: impl Fn(Shape<T>) -> V + Send,
) -> PyResult<Vec<V>> {
    let read = |space: &mut Space<T>| space.ids().and_then(|ids| space.read(&ids, of));
    long(py, space, read)?.map_err(refused)
}

fn column_of<'py, T: Scalar, V: Element>(
    py: Python<'py>,
    space: &Shared<Space<T>>,
    of: impl Fn(Shape<T>) -> V + Send,
) -> PyResult<Bound<'py, PyAny>> {
    Ok(read_only(column(py, all(py, space, of)?)).into_any())
}

fn table_of<'py, T: Scalar + Element, const W: usize>(
    py: Python<'py>,
    space: &Shared<Space<T>>,
    of: impl Fn(Shape<T>) -> [T; W] + Send,
) -> PyResult<Bound<'py, PyAny>> {
    Ok(read_only(table(py, all(py, space, of)?)?).into_any())
}
