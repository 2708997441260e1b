//! Adding, changing and removing the shapes of a space.

use jostle_index::shapes::{DEFAULT_CATEGORY, DEFAULT_MASK};
use jostle_index::{Each, Scalar, Shapes};
use jostle_space::ShapeChanges;
use numpy::Element;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::columns::moved;
use super::{Either, PySpace, long};
use crate::arrays::{Argument, Given, bit_sets, column, reals};
use crate::ids::Ids;
use crate::keywords::{read, refuse_unknown};
use crate::queries::{Maybe, result_of};
use crate::shapes::{Positions, Where};

#[pymethods]
impl PySpace {
    /// Add one shape or many.
    ///
    /// Parameters
    /// ----------
    /// positions : array_like, shape (k, 2) or (2,), optional
    ///     Centres; required unless `boxes` or `segments` are given.
    /// radii : array_like, a number or shape (k,), default 0.0
    ///     Radii.
    /// half_sizes : array_like, a number, shape (2,) or (k, 2), optional
    ///     Half widths and half heights. If omitted, the shapes are circles.
    /// boxes : array_like, shape (k, 4) or (4,), optional
    ///     Sides min_x, min_y, max_x, max_y of each shape, in place of `positions` and `half_sizes`.
    ///     Objects with the attributes `left`, `top`, `right` and `bottom`, such as pygame's Rect,
    ///     are accepted, also in a list or a tuple, but not in an array, which NumPy fills with
    ///     x, y, width and height. The four numbers are compared without rounding: boxes that share
    ///     an edge never overlap, whereas sides computed as ``center ± half_size`` are rounded.
    /// segments : array_like, shape (k, 2, 2) or (2, 2), optional
    ///     Start and end of each shape, in place of `positions` and `half_sizes`: line segments, or
    ///     capsules with `radii`. Segments that cross overlap; those that share an end do not. With a
    ///     period the ends are at most one period apart along each axis.
    /// categories : array_like of int, a number or shape (k,), default 1
    ///     Categories of each shape, as a set of 32 bits.
    /// masks : array_like of int, a number or shape (k,), default 0xFFFFFFFF
    ///     Categories each shape may pair with, as a set of 32 bits. Shapes i and j may pair only
    ///     if both ``categories[i] & masks[j]`` and ``categories[j] & masks[i]`` are not 0.
    ///     A negative integer stands for its low 32 bits, so ``masks=~SHIP`` is every category
    ///     except SHIP. For a uint8 or uint16 array, ``~`` sets no bits above the 8th or 16th.
    ///
    /// Returns
    /// -------
    /// ndarray of int64, shape (k,), or int
    ///     Their ids; one id for one centre or one box. The first ids are 0, 1, 2, ... After
    ///     removals, later shapes have ids of 2**32 and more, in any order: do not use ids as
    ///     indices of arrays; :meth:`rows` gives those.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If an argument does not hold numbers, or if not exactly one of `positions`,
    ///     `boxes` and `segments` is given.
    /// ValueError
    ///     If a shape is wrong, a value is not finite, or a size is out of range: a radius is 0,
    ///     or between 1e-18 and 1e18 in float32 and between 1e-150 and 1e150 in float64.
    ///
    /// See Also
    /// --------
    /// set : Change shapes.
    /// remove : Remove shapes.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> space.add([(0, 0), (5, 0)], radii=1.0)
    /// array([0, 1])
    /// >>> space.add((2, 2), half_sizes=(1, 0.5))
    /// 2
    /// >>> space.add(boxes=[(0, 3, 0.1, 4), (0.1, 3, 0.2, 4)])
    /// array([3, 4])
    /// >>> space.add(segments=jostle.polyline([(-1, 1), (6, 1), (6, 9)]))
    /// array([5, 6])
    #[pyo3(
        signature = (
            positions=None, radii=Given::NOTHING, half_sizes=None, *, boxes=None, segments=None,
            categories=Given::NOTHING, masks=Given::NOTHING, **unknown),
        text_signature = "($self, positions=None, radii=0.0, half_sizes=None, *, boxes=None, \
                          segments=None, categories=1, masks=0xFFFFFFFF)"
    )]
    #[expect(clippy::too_many_arguments, reason = "they are Python's keywords")]
    fn add<'py>(
        &self,
        py: Python<'py>,
        positions: Maybe<'_, 'py>,
        radii: Given<'py>,
        half_sizes: Maybe<'_, 'py>,
        boxes: Maybe<'_, 'py>,
        segments: Maybe<'_, 'py>,
        categories: Given<'py>,
        masks: Given<'py>,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        refuse_unknown::<Self>("add", unknown)?;
        with_space!(self, space => {
            let (positions, len) = Where::read([positions, half_sizes, boxes, segments])?.one_or_rows()?;
            let filters = [categories.value(), masks.value()].map(|bits| bits.filter(|v| !v.is_none()));
            let new = Draft {
                radii: reals("radii", radii.value(), len.unwrap_or(1))?,
                half_sizes: sizes(half_sizes, len.unwrap_or(1))?,
                filters: bits(filters, len.unwrap_or(1))?,
            };
            let ids = long(py, space, |space| space.add(&new.shapes(positions)?))?;
            let ids = result_of(ids, len.is_none())?;
            if len.is_none() { ids[0].into_bound_py_any(py) } else { Ok(column(py, ids).into_any()) }
        })
    }

    /// Change some shapes. What is omitted stays the same.
    ///
    /// Shapes whose values are unchanged cost almost nothing. For shapes that slide, new positions or
    /// boxes are a motion along a straight line, however long: see :meth:`move_and_slide`. To put an
    /// obstacle elsewhere without a motion, remove it and add another one.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,)
    ///     The shapes, each at most once.
    /// positions : array_like, shape (k, 2), or (2,) for one id, optional
    ///     Centres. A shape that was given as a box, and whose centre changes, is stored as
    ///     ``center ± half_size`` from then on, with half the size of its box, and its sides are
    ///     rounded. Give `boxes` to keep them exact.
    /// radii : array_like, a number or shape (k,), optional
    ///     Radii.
    /// half_sizes : array_like, a number, shape (2,) or (k, 2), optional
    ///     Half widths and half heights. A shape that was given as a box, and whose size changes, is
    ///     stored as ``center ± half_size`` from then on.
    /// boxes : array_like, shape (k, 4), or (4,) for one id, optional
    ///     In place of `positions` and `half_sizes`, sides min_x, min_y, max_x, max_y of each shape,
    ///     or pygame's Rects, as in :meth:`add`.
    /// segments : array_like, shape (k, 2, 2), or (2, 2) for one id, optional
    ///     In place of `positions` and `half_sizes`, start and end of each shape.
    /// categories : array_like of int, a number or shape (k,), optional
    ///     Categories, sets of 32 bits.
    /// masks : array_like of int, a number or shape (k,), optional
    ///     Categories each shape may pair with.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If an argument does not hold numbers, or several of `positions`, `boxes` and
    ///     `segments` are given, or one of the last two beside `half_sizes`.
    /// IdError
    ///     If an id does not exist; then nothing changes.
    /// ValueError
    ///     If an id is given twice, a value is not finite or out of range, or a minimum is above its
    ///     maximum; then nothing changes.
    ///
    /// See Also
    /// --------
    /// get : Read some shapes.
    /// update : The pairs that enter and leave by it.
    /// move_and_slide : Moves shapes among obstacles, which push them if they have moved.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> ids = space.add([(0, 0), (5, 0)], radii=1.0)
    /// >>> space.set(ids, positions=[(1, 0), (6, 0)], radii=[1.0, 3.5])
    /// >>> space.set(0, positions=(2, 0))
    /// >>> space.update().entered
    /// array([[0, 1]])
    /// >>> space.set(0, masks=0)  # it can no longer pair
    /// >>> len(space.pairs())
    /// 0
    #[pyo3(
        signature = (
            ids=Given::NOTHING, *, positions=None, radii=None, half_sizes=None, boxes=None, segments=None,
            categories=None, masks=None, **unknown
        ),
        text_signature = "($self, ids, *, positions=None, radii=None, half_sizes=None, boxes=None, \
                          segments=None, categories=None, masks=None)"
    )]
    #[expect(clippy::too_many_arguments, reason = "they are Python's arguments")]
    fn set<'py>(
        &self,
        py: Python<'py>,
        ids: Given<'py>,
        positions: Maybe<'_, 'py>,
        radii: Maybe<'_, 'py>,
        half_sizes: Maybe<'_, 'py>,
        boxes: Maybe<'_, 'py>,
        segments: Maybe<'_, 'py>,
        categories: Maybe<'_, 'py>,
        masks: Maybe<'_, 'py>,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        let [ids] = read::<Self, 1>("set", unknown, [("ids", &ids)])?;
        with_space!(self, space => {
            let ids = Ids::read(ids, "shape")?;
            let len = ids.all.len();
            let mut new = ShapeChanges::default();
            if positions.is_some() || boxes.is_some() || segments.is_some() {
                let places = Where::read([positions, half_sizes, boxes, segments])?;
                new = moved(if ids.single { places.only() } else { places.rows(len) }?);
            }
            new.radii = reals("radii", radii, len)?;
            new.half_sizes = sizes(half_sizes, len)?;
            [new.categories, new.masks] = bits([categories, masks], len)?;
            ids.result_of(long(py, space, |space| space.set(&ids.all, &new))?)
        })
    }

    /// Remove shapes. Their ids are never used again.
    ///
    /// The next reading of a column, of `ids` or of rows visits all shapes once, however many were
    /// removed.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,)
    ///     The shapes, each at most once.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If `ids` does not hold integers.
    /// IdError
    ///     If an id does not exist; then none is removed.
    /// ValueError
    ///     If an id is given twice; then none is removed.
    ///
    /// See Also
    /// --------
    /// add : Add shapes.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> ids = space.add([(0, 0), (5, 0), (9, 0)])
    /// >>> space.remove(ids[:2])
    /// >>> space.ids
    /// array([2])
    fn remove(&self, py: Python<'_>, ids: &Bound<'_, PyAny>) -> PyResult<()> {
        with_space!(self, space => {
            let ids = Ids::read(ids, "shape")?;
            ids.result_of(long(py, space, |space| space.remove(&ids.all))?)
        })
    }
}

/// The arguments for new shapes, except their positions.
struct Draft<T> {
    radii: Option<Each<T>>,
    half_sizes: Option<Each<[T; 2]>>,
    filters: [Option<Each<u32>>; 2],
}

impl<T: Scalar> Draft<T> {
    /// The shapes of the core, with checked values; without the GIL.
    fn shapes(self, positions: Positions<T>) -> jostle_base::Result<Shapes<T>> {
        let radii = self.radii.unwrap_or(Each::One(T::ZERO));
        let filters = match self.filters {
            [None, None] => None,
            [categories, masks] => Some([
                categories.unwrap_or(Each::One(DEFAULT_CATEGORY)),
                masks.unwrap_or(Each::One(DEFAULT_MASK)),
            ]),
        };
        positions.shapes(radii, self.half_sizes, filters)
    }
}

fn sizes<T: Scalar + Element>(value: Maybe<'_, '_>, len: usize) -> PyResult<Option<Each<[T; 2]>>> {
    value.map(|value| Argument::reals("half_sizes", value)?.half_sizes(len)).transpose()
}

fn bits([categories, masks]: [Maybe<'_, '_>; 2], len: usize) -> PyResult<[Option<Each<u32>>; 2]> {
    Ok([bit_sets("categories", categories, len)?, bit_sets("masks", masks, len)?])
}
