//! `jostle.Space`.

use jostle::geometry::Shape;
use jostle::interrupt::Pulse;
use jostle::shapes::{DEFAULT_CATEGORY, DEFAULT_MASK};
use jostle::space::{Events, Id, Saved, Wanted};
use jostle::{Each, Period, Scalar, Shapes, Space, sorting};
use numpy::{Element, PyArray1, PyArray2};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::{
    Argument, Given, bit_sets, column, number, read_only, reals, segments, table, truth,
};
use crate::error::{refused, value_error};
use crate::events::{PyEvents, Reduced};
use crate::ids::{Ids, one_id};
use crate::interrupt::detached;
use crate::lock::Shared;
use crate::queries::{self, Cast, Maybe, result_of};
use crate::query_methods::{Index, query_methods};
use crate::results;
use crate::settings;
use crate::shapes::{Places, Where};
use crate::slide;

/// A collection of shapes that can be added, moved, changed and removed, and of the pairs that
/// overlap.
///
/// A shape is a rounded box: every point within `radius` of its core, the axis-aligned box
/// ``center ± half_size`` or one of `boxes`. A circle has half size 0, a rectangle radius 0.
/// Each shape has an id, which is never used again for another shape. The cost depends on the
/// shapes that change: a million shapes at rest cost almost nothing beside a thousand that move.
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
/// >>> space.move(ids[1], (1.5, 0))
/// >>> space.update().entered
/// array([[0, 1]])
/// >>> space.remove(0)
/// >>> space.update().left
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

/// Runs the same expression for either precision.
macro_rules! with_space {
    ($self:ident, $name:ident => $do:expr) => {
        match &$self.space {
            Either::Single($name) => $do,
            Either::Double($name) => $do,
        }
    };
}

query_methods!(
    PySpace,
    with_space,
    "space",
    "space = jostle.Space()\n>>> ids = space.add(",
    "Ids",
    "id"
);

#[pymethods]
impl PySpace {
    #[new]
    #[pyo3(
        signature = (
            *, dtype=Given::NOTHING, period=None, leaf_capacity=Given::NOTHING,
            max_depth=Given::NOTHING, threads=None,
        ),
        text_signature = "(*, dtype='float64', period=None, leaf_capacity=96, max_depth=4096, \
                          threads=None)"
    )]
    fn new<'py>(
        dtype: Given<'py>,
        period: Maybe<'_, 'py>,
        leaf_capacity: Given<'py>,
        max_depth: Given<'py>,
        threads: Maybe<'_, 'py>,
    ) -> PyResult<Self> {
        let settings = settings::tree(&leaf_capacity, &max_depth, threads)?;
        let period = settings::period(period)?;
        let space = if is_single(&dtype)? {
            Either::Single(empty(settings, period).map_err(refused)?)
        } else {
            Either::Double(empty(settings, period).map_err(refused)?)
        };
        Ok(Self { space })
    }

    /// Add one shape or many.
    ///
    /// Parameters
    /// ----------
    /// centers : array_like, shape (k, 2) or (2,), optional
    ///     Centres; required unless `boxes` is given.
    /// radii : array_like, a number or shape (k,), default 0.0
    ///     Radii.
    /// half_sizes : array_like, a number, shape (2,) or (k, 2), optional
    ///     Half widths and half heights. If omitted, the shapes are circles.
    /// boxes : array_like, shape (k, 4) or (4,), optional
    ///     Sides min_x, min_y, max_x, max_y of each shape, in place of `centers` and `half_sizes`.
    ///     Objects with the attributes `left`, `top`, `right` and `bottom`, such as pygame's Rect,
    ///     are accepted, also in a list or a tuple, but not in an array, which NumPy fills with
    ///     x, y, width and height. The four numbers are compared without rounding: boxes that share
    ///     an edge never overlap, whereas sides computed as ``center ± half_size`` are rounded.
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
    ///     Their ids; one id for one centre or one box. Ids start at 0: 0, 1, 2, ...
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If an argument does not hold numbers, or if not exactly one of `centers` and
    ///     `boxes` is given.
    /// ValueError
    ///     If a shape is wrong, a value is not finite, or a size is out of range: a radius is 0,
    ///     or between 1e-18 and 1e18 in float32 and between 1e-150 and 1e150 in float64.
    ///
    /// See Also
    /// --------
    /// move : Change centres or boxes.
    /// resize : Change radii or half sizes.
    /// set_filter : Change categories and masks.
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
    #[pyo3(
        signature = (
            centers=None, radii=Given::NOTHING, half_sizes=None, *, boxes=None,
            categories=Given::NOTHING, masks=Given::NOTHING,
        ),
        text_signature = "($self, centers=None, radii=0.0, half_sizes=None, *, boxes=None, \
                          categories=1, masks=0xFFFFFFFF)"
    )]
    #[expect(clippy::too_many_arguments, reason = "they are Python's keywords")]
    fn add<'py>(
        &self,
        py: Python<'py>,
        centers: Maybe<'_, 'py>,
        radii: Given<'py>,
        half_sizes: Maybe<'_, 'py>,
        boxes: Maybe<'_, 'py>,
        categories: Given<'py>,
        masks: Given<'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        with_space!(self, space => {
            let (places, len) = Where::read(centers, half_sizes, boxes)?.one_or_rows()?;
            let filters = [categories.value(), masks.value()].map(|bits| bits.filter(|v| !v.is_none()));
            let new = Draft {
                radii: reals("radii", radii.value(), len.unwrap_or(1))?,
                half_sizes: sizes(half_sizes, len.unwrap_or(1))?,
                filters: bits(filters, len.unwrap_or(1))?,
            };
            let ids = long(py, space, |space| space.add(&new.shapes(places)?))?;
            let ids = result_of(ids, len.is_none())?;
            if len.is_none() { ids[0].into_bound_py_any(py) } else { Ok(column(py, ids).into_any()) }
        })
    }

    /// Change the centres or the boxes of shapes.
    ///
    /// Shapes whose values are unchanged cost almost nothing.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,)
    ///     The shapes, each at most once.
    /// centers : array_like, shape (k, 2), or (2,) for one id, optional
    ///     The new centres. A shape that was given as a box, and whose centre changes, is stored as
    ///     ``center ± half_size`` from then on, with half the size of its box, and its sides are
    ///     rounded. Give `boxes` to keep them exact.
    /// boxes : array_like, shape (k, 4), or (4,) for one id, optional
    ///     In place of `centers`, sides min_x, min_y, max_x, max_y of each shape, or pygame's Rects,
    ///     as in :meth:`add`. The size may change too. Radii stay the same.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If an argument does not hold numbers, or if not exactly one of `centers` and
    ///     `boxes` is given.
    /// ValueError
    ///     If an id does not exist or is given twice, a coordinate is not finite, or a
    ///     minimum is above its maximum; then nothing moves.
    ///
    /// See Also
    /// --------
    /// resize : Change radii or half sizes.
    /// update : The pairs that enter and leave by it.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> ids = space.add([(0, 0), (5, 0)], radii=1.0)
    /// >>> space.move(ids, [(1, 0), (6, 0)])
    /// >>> space.move(0, (2, 0))
    /// >>> space.centers(ids)
    /// array([[2., 0.],
    ///        [6., 0.]])
    /// >>> tile = space.add(boxes=(0, 0, 0.1, 0.1))
    /// >>> space.move(tile, boxes=(0.1, 0, 0.2, 0.1))
    #[pyo3(name = "move", signature = (ids, centers=None, *, boxes=None))]
    fn move_to<'py>(
        &self,
        py: Python<'py>,
        ids: &Bound<'py, PyAny>,
        centers: Maybe<'_, 'py>,
        boxes: Maybe<'_, 'py>,
    ) -> PyResult<()> {
        with_space!(self, space => {
            let ids = Ids::read(ids, "shape")?;
            let places = Where::read(centers, None, boxes)?;
            let places = if ids.single { places.only() } else { places.rows(ids.all.len()) }?;
            ids.result_of(long(py, space, |space| match &places {
                Places::Centers(centers) => space.move_to(&ids.all, centers),
                Places::Boxes(boxes) => space.move_to_boxes(&ids.all, boxes),
            })?)
        })
    }

    /// Move shapes by displacements; they slide along the others and never enter them.
    ///
    /// A shape moves until it meets an obstacle, then along the surface of the obstacle, and so
    /// on. The time of impact is computed along the whole path, so nothing passes through an
    /// obstacle at any speed. A shape that touches an obstacle does not overlap it, and the
    /// joints between tiles do not stop it. Discs, boxes and rounded boxes move among discs,
    /// boxes, rounded boxes and the line segments of `walls`.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,)
    ///     The shapes to move, each at most once. A shape that was given as a box, and that moves,
    ///     is stored as ``center ± half_size`` from then on.
    /// displacements : array_like, shape (k, 2), or (2,) for one id
    ///     By how much each is to move: its velocity times the duration of a step.
    /// mask : int, optional
    ///     The categories of the shapes that are obstacles, as a set of bits; all if omitted. Shapes
    ///     that may not pair by their own categories and masks are no obstacles either.
    /// max_slides : int, default 4
    ///     Maximum number of obstacles along which a shape slides, at most 1000; it stops at the
    ///     last one.
    /// up : array_like, shape (2,), default (0, -1)
    ///     The direction in which floors face; y grows downwards on screens. With (0, 0), as seen
    ///     from above, every obstacle is a wall.
    /// floor_angle : float, default pi / 4
    ///     Largest angle between the normal of a floor and `up`, in radians. A shape stands on a
    ///     floor without sliding down, and climbs it; a steeper slope is a wall.
    /// one_way : int, default 0
    ///     Categories of the obstacles that stop only shapes that are above them and move down.
    ///
    /// Returns
    /// -------
    /// Slides or Slide
    ///     One `Slide` for one id. displacements : how far each shape has moved; remaining : the
    ///     displacements without their components into the obstacles, for the velocity of the next
    ///     step; hits : the ids of the obstacles that each has met; normals : one for each hit;
    ///     on_floor, on_wall, on_ceiling : whether it has met one; floors : the id of the last
    ///     floor, or -1. A wall has the number -2 minus its index.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If an argument has the wrong type.
    /// ValueError
    ///     If an id does not exist or is given twice, or a value is not finite or out of range;
    ///     then nothing moves.
    ///
    /// See Also
    /// --------
    /// move : Sets centres, also where other shapes are.
    /// walls : Line segments, for slopes and outlines of polygons.
    /// tiles : Merges the tiles of a grid into few boxes.
    ///
    /// Notes
    /// -----
    /// Shapes of one call that may meet move one after another, in the order of `ids`; the order
    /// of others has no effect. A shape that overlaps obstacles at the start, because they have
    /// moved, is first moved out of them; those that it cannot leave do not stop it. A shape that
    /// met a floor in its last call is carried by it: if the floor has moved since, also in the
    /// same call, the shape moves by the same vector first. What stops it then is in `hits` too.
    ///
    /// Examples
    /// --------
    /// A player falls onto a floor and slides along it; then a wall stops it.
    ///
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> floor, wall = space.add(boxes=[(0, 10, 100, 20), (50, 0, 60, 10)])
    /// >>> player = space.add((10, 5), half_sizes=(2, 4))
    /// >>> slide = space.move_and_slide(player, (8, 5))
    /// >>> slide.on_floor, slide.remaining
    /// (True, array([8., 0.]))
    /// >>> space.centers(player).round(6)
    /// array([18.,  6.])
    /// >>> slide = space.move_and_slide(player, (1000, 5))
    /// >>> slide.on_floor, slide.on_wall, space.centers(player).round(6)
    /// (True, True, array([48.,  6.]))
    #[pyo3(
        signature = (
            ids, displacements, *, mask=None, max_slides=Given::NOTHING, up=Given::NOTHING,
            floor_angle=Given::NOTHING, one_way=Given::NOTHING,
        ),
        text_signature = "($self, ids, displacements, *, mask=None, max_slides=4, up=(0, -1), \
                          floor_angle=0.7853981633974483, one_way=0)"
    )]
    #[expect(clippy::too_many_arguments, reason = "they are Python's keywords")]
    fn move_and_slide<'py>(
        &self,
        py: Python<'py>,
        ids: &Bound<'py, PyAny>,
        displacements: &Bound<'py, PyAny>,
        mask: Maybe<'_, 'py>,
        max_slides: Given<'py>,
        up: Given<'py>,
        floor_angle: Given<'py>,
        one_way: Given<'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let rules = slide::Rules::read(mask, &max_slides, &up, &floor_angle, &one_way)?;
        with_space!(self, space => rules.run(py, space, ids, displacements))
    }

    /// Change the radii or the half sizes of shapes, or both.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,)
    ///     The shapes, each at most once.
    /// radii : array_like, a number or shape (k,), optional
    ///     If omitted, they stay the same.
    /// half_sizes : array_like, a number, shape (2,) or (k, 2), optional
    ///     If omitted, they stay the same. A shape that was given as a box, and whose size
    ///     changes, is stored as ``center ± half_size`` from then on; ``move(ids, boxes=...)``
    ///     gives it another box.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If an argument does not hold numbers.
    /// ValueError
    ///     If an id does not exist or is given twice, or a size is not finite or out of
    ///     range; then nothing changes.
    ///
    /// See Also
    /// --------
    /// move : Change centres or boxes.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> ids = space.add([(0, 0), (3, 0)], radii=1.0)
    /// >>> space.resize(ids, 2.0)
    /// >>> space.update().entered
    /// array([[0, 1]])
    #[pyo3(signature = (ids, radii=None, half_sizes=None))]
    fn resize(
        &self,
        py: Python<'_>,
        ids: &Bound<'_, PyAny>,
        radii: Maybe<'_, '_>,
        half_sizes: Maybe<'_, '_>,
    ) -> PyResult<()> {
        with_space!(self, space => {
            let ids = Ids::read(ids, "shape")?;
            let radii = reals("radii", radii, ids.all.len())?;
            let sizes = sizes(half_sizes, ids.all.len())?;
            let (radii, sizes) = (radii.as_ref(), sizes.as_ref());
            ids.result_of(long(py, space, |space| space.resize(&ids.all, radii, sizes))?)
        })
    }

    /// Change the categories or the masks of shapes, or both.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,)
    ///     The shapes, each at most once.
    /// categories : array_like of int, a number or shape (k,), optional
    ///     If omitted, they stay the same.
    /// masks : array_like of int, a number or shape (k,), optional
    ///     If omitted, they stay the same.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If an argument does not hold integers.
    /// ValueError
    ///     If an id does not exist or is given twice, or a set of bits has more than 32;
    ///     then nothing changes.
    ///
    /// See Also
    /// --------
    /// categories, masks : The present ones.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> ids = space.add([(0, 0), (1, 0)], radii=1.0)
    /// >>> space.set_filter(0, masks=0)  # it can no longer pair
    /// >>> len(space.pairs())
    /// 0
    #[pyo3(signature = (ids, categories=None, masks=None))]
    fn set_filter(
        &self,
        py: Python<'_>,
        ids: &Bound<'_, PyAny>,
        categories: Maybe<'_, '_>,
        masks: Maybe<'_, '_>,
    ) -> PyResult<()> {
        with_space!(self, space => {
            let ids = Ids::read(ids, "shape")?;
            let [categories, masks] = bits([categories, masks], ids.all.len())?;
            let (categories, masks) = (categories.as_ref(), masks.as_ref());
            ids.result_of(long(py, space, |space| space.set_filter(&ids.all, categories, masks))?)
        })
    }

    /// Remove shapes. Their ids are never used again.
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
    /// ValueError
    ///     If an id does not exist or is given twice; then none is removed.
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

    /// Find the pairs that entered and left since the last update.
    ///
    /// The current state is compared with the state at the last update; the first update
    /// compares with an empty space. A shape that was both added and removed in between has no
    /// effect. The cost depends on the shapes that changed.
    ///
    /// Parameters
    /// ----------
    /// max_pairs : int, default 134217728
    ///     Maximum number of overlapping pairs of shapes that changed.
    ///
    /// Returns
    /// -------
    /// Events
    ///     Three arrays:
    ///
    ///     entered, stayed, left : ndarray of int64, shape (m, 2)
    ///         Pairs of ids, the smaller first, sorted. `left` may contain the ids of removed
    ///         shapes. `stayed` is computed when it is first read.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If there are more than `max_pairs`; then the call has no effect.
    ///
    /// See Also
    /// --------
    /// pairs : All overlapping pairs, without events.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> ids = space.add([(0, 0), (1, 0), (8, 0)], radii=1.0)
    /// >>> entered, stayed, left = space.update()
    /// >>> entered
    /// array([[0, 1]])
    /// >>> space.move(2, (2, 0))
    /// >>> entered, stayed, left = space.update()
    /// >>> entered, stayed
    /// (array([[1, 2]]), array([[0, 1]]))
    #[pyo3(
        signature = (*, max_pairs=Given::NOTHING),
        text_signature = "($self, *, max_pairs=134217728)"
    )]
    fn update(slf: &Bound<'_, Self>, max_pairs: Given<'_>) -> PyResult<PyEvents> {
        let max_pairs = settings::max_pairs(&max_pairs)?;
        let this = slf.get();
        let events = with_space!(this, space => {
            long(slf.py(), space, |space| space.update(max_pairs))?.map_err(refused)
        });
        Ok(PyEvents::of(events?, slf.clone().unbind()))
    }

    /// Find every pair of overlapping shapes.
    ///
    /// Parameters
    /// ----------
    /// sort : bool, default False
    ///     Whether to sort the pairs by the first, then by the second id. If False, their order
    ///     depends on previous calls, but not on the number of threads.
    /// max_pairs : int, default 134217728
    ///     Maximum number of pairs to return; the default corresponds to 2 GiB.
    /// mask : int, optional
    ///     Find only pairs whose shapes both have a category in this set of bits.
    /// distance : float, default 0.0
    ///     Find pairs whose gap is below this, in units of length: each radius is increased by half
    ///     of it. If 0, the shapes must overlap.
    ///
    /// Returns
    /// -------
    /// ndarray of int64, shape (m, 2)
    ///     Ids of each pair, the smaller first, every pair once.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If more than `max_pairs` pairs overlap.
    ///
    /// See Also
    /// --------
    /// update : The pairs that entered and left.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> ids = space.add([(0, 0), (3, 0), (4, 0)], radii=1.0)
    /// >>> space.pairs()
    /// array([[1, 2]])
    #[pyo3(
        signature = (
            *, sort=Given::NOTHING, max_pairs=Given::NOTHING, mask=None, distance=Given::NOTHING,
        ),
        text_signature = "($self, *, sort=False, max_pairs=134217728, mask=None, distance=0.0)"
    )]
    fn pairs<'py>(
        &self,
        py: Python<'py>,
        sort: Given<'py>,
        max_pairs: Given<'py>,
        mask: Maybe<'_, 'py>,
        distance: Given<'py>,
    ) -> PyResult<Bound<'py, PyArray2<Id>>> {
        let (mask, distance) = (queries::mask(mask)?, settings::distance(&distance)?);
        let (sort, max_pairs) = (truth("sort", &sort)?, settings::max_pairs(&max_pairs)?);
        with_space!(self, space => {
            let pairs = long(py, space, |space| {
                let distance = Scalar::from_f64(distance);
                let mut pairs = space.pairs_within(&Wanted { distance, mask, max_pairs })?;
                if sort {
                    sorting::sort(&mut pairs, &mut Pulse::current())?;
                }
                Ok(pairs)
            })?;
            table(py, pairs.map_err(refused)?)
        })
    }

    /// Find every pair of overlapping shapes, and how each overlaps.
    ///
    /// Parameters
    /// ----------
    /// sort : bool, default False
    ///     Whether to sort the contacts by the first, then by the second id of the pair. If False,
    ///     they come in the order of :meth:`pairs`.
    /// max_pairs : int, default 134217728
    ///     Maximum number of pairs to return.
    /// mask : int, optional
    ///     Find only pairs whose shapes both have a category in this set of bits.
    ///
    /// Returns
    /// -------
    /// Contacts
    ///     The pairs with their normals and depths.
    ///
    ///     pairs : ndarray of int64, shape (m, 2)
    ///         Ids i and j of each pair, the smaller first, every pair once.
    ///     normals : ndarray of the space's dtype, shape (m, 2)
    ///         Unit vectors from i to j. If the cores of the shapes overlap, the axis
    ///         of least penetration; +x for coincident centres.
    ///     depths : ndarray of the space's dtype, shape (m,)
    ///         Penetration: the distance that j must move along the normal until the two only
    ///         touch.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If more than `max_pairs` pairs overlap.
    ///
    /// See Also
    /// --------
    /// Quadtree.contacts : The same for a tree, or for two.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> ids = space.add([(0, 0), (0, 1.5)], radii=1.0)
    /// >>> space.contacts()
    /// Contacts(pairs=array([[0, 1]]), normals=array([[0., 1.]]), depths=array([0.5]))
    #[pyo3(
        signature = (*, sort=Given::NOTHING, max_pairs=Given::NOTHING, mask=None),
        text_signature = "($self, *, sort=False, max_pairs=134217728, mask=None)"
    )]
    fn contacts<'py>(
        &self,
        py: Python<'py>,
        sort: Given<'py>,
        max_pairs: Given<'py>,
        mask: Maybe<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let filter = (queries::mask(mask)?, truth("sort", &sort)?);
        let max_pairs = settings::max_pairs(&max_pairs)?;
        with_space!(self, space => {
            let found = long(py, space, |space| space.contacts(filter, max_pairs))?;
            results::contacts(py, found.map_err(refused)?)
        })
    }

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

    /// Walls: ndarray of the space's precision, shape (m, 2, 2), a read-only copy of the ends of
    /// line segments in units of length.
    ///
    /// They are obstacles of `move_and_slide`, solid from both sides, and nothing else: pairs and
    /// queries ignore them, and they have neither ids nor categories. Assign an array of this shape,
    /// or None for no walls. In the `hits` and `floors` of `move_and_slide` the wall with the index
    /// k has the number -2 - k.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the shape is wrong, or a coordinate is not finite.
    ///
    /// See Also
    /// --------
    /// jostle.polyline : Walls between consecutive points.
    /// move_and_slide : Moves shapes along walls.
    ///
    /// Examples
    /// --------
    /// A character walks up a slope.
    ///
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> space.walls = jostle.polyline([(-10, 0), (0, 0), (40, -30)])
    /// >>> player = space.add((-5, -2), radii=2.0)
    /// >>> slide = space.move_and_slide(player, (25, 1))
    /// >>> slide.on_floor, slide.floor
    /// (True, -3)
    #[getter]
    fn walls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        with_space!(self, space => {
            let walls = long(py, space, |space| space.walls().to_vec())?;
            Ok(read_only(segments(py, &walls)?).into_any())
        })
    }

    #[setter]
    fn set_walls(&self, py: Python<'_>, value: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        with_space!(self, space => {
            let value = value.map(|value| Argument::reals("walls", value)).transpose()?;
            let ends = value.map_or(Ok(Vec::new()), |value| value.segments())?;
            long(py, space, |space| space.set_walls(ends))?.map_err(refused)
        })
    }

    /// The ids of all shapes, ascending: ndarray of int64, shape (n,).
    #[getter]
    fn ids<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<Id>>> {
        with_space!(self, space => {
            let ids = long(py, space, |space| space.ids())?.map_err(refused)?;
            Ok(column(py, ids))
        })
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

    /// A space with copies of the shapes, with the same ids and the same pairs at the last update.
    fn __copy__(&self, py: Python<'_>) -> PyResult<Self> {
        let space = match &self.space {
            Either::Single(space) => {
                Either::Single(shared(long(py, space, |space| space.clone())?))
            }
            Either::Double(space) => {
                Either::Double(shared(long(py, space, |space| space.clone())?))
            }
        };
        Ok(Self { space })
    }

    /// As `copy.copy`: it holds nothing but numbers.
    fn __deepcopy__(&self, py: Python<'_>, memo: &Bound<'_, PyAny>) -> PyResult<Self> {
        let _ = memo;
        self.__copy__(py)
    }

    /// What pickle stores: the shapes with their ids, and the pairs of the last update.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let restore = py.import("jostle._core")?.getattr("restore_space")?;
        let (settings, state) = with_space!(self, space => {
            let saved = long(py, space, |space| Ok((space.settings(), space.save()?)))?;
            let (settings, saved) = saved.map_err(refused)?;
            (settings, state_of(py, saved)?)
        });
        let options = PyDict::new(py);
        options.set_item("dtype", self.dtype())?;
        options.set_item("period", self.period(py)?)?;
        options.set_item("leaf_capacity", settings.leaf_capacity)?;
        options.set_item("max_depth", settings.max_depth)?;
        options.set_item("threads", settings.threads)?;
        Ok((restore, PyTuple::new(py, [options.into_any(), state.into_any()])?))
    }

    fn __contains__(&self, py: Python<'_>, id: &Bound<'_, PyAny>) -> PyResult<bool> {
        let id = one_id(id, "np.isin(ids, space.ids) tests many")?;
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

impl PySpace {
    /// The pairs that overlapped at both updates, unless there has been another since.
    pub fn stayed(&self, py: Python<'_>, events: &Events) -> PyResult<Option<Vec<[Id; 2]>>> {
        with_space!(self, space => {
            long(py, space, |space| space.stayed(events))?.map_err(refused)
        })
    }
}

/// A space with a lock.
fn shared<T>(space: Space<T>) -> Shared<Space<T>> {
    Shared::new(space, "space", "make a new one")
}

fn empty<T: Scalar>(
    settings: jostle::Settings,
    period: Period<f64>,
) -> jostle::Result<Shared<Space<T>>> {
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

/// The contents of a space as a tuple of arrays.
fn state_of<T: Scalar + Element>(py: Python<'_>, saved: Saved<T>) -> PyResult<Bound<'_, PyTuple>> {
    let columns = [
        table(py, saved.corners)?.into_any(),
        column(py, saved.radii).into_any(),
        table(py, saved.half_sizes)?.into_any(),
        column(py, saved.filters.into_flattened()).into_any(),
        column(py, saved.generations).into_any(),
        column(py, saved.free).into_any(),
        column(py, saved.pairs.into_flattened()).into_any(),
        column(py, saved.changed).into_any(),
        column(py, saved.leaving).into_any(),
        saved.updates.into_bound_py_any(py)?,
        table(py, saved.rides)?.into_any(),
        table(py, saved.ride_centers)?.into_any(),
        segments(py, &saved.walls)?.into_any(),
    ];
    PyTuple::new(py, columns)
}

/// A space with the contents that pickle has stored.
#[pyfunction]
pub fn restore_space<'py>(
    py: Python<'py>,
    options: &Bound<'py, PyDict>,
    state: &Bound<'py, PyTuple>,
) -> PyResult<PySpace> {
    let option = |name: &str| Ok::<_, PyErr>(options.get_item(name)?.filter(|v| !v.is_none()));
    let (leaf_capacity, max_depth) = (option("leaf_capacity")?, option("max_depth")?);
    let settings = settings::tree(
        &Given::of(leaf_capacity),
        &Given::of(max_depth),
        option("threads")?.as_ref(),
    )?;
    let period = settings::period(option("period")?.as_ref())?;
    let space = if is_single(&Given::of(option("dtype")?))? {
        Either::Single(restored(py, settings, period, state)?)
    } else {
        Either::Double(restored(py, settings, period, state)?)
    };
    Ok(PySpace { space })
}

fn restored<T: Scalar + Element>(
    py: Python<'_>,
    settings: jostle::Settings,
    period: Period<f64>,
    state: &Bound<'_, PyTuple>,
) -> PyResult<Shared<Space<T>>> {
    let item = |index: usize| state.get_item(index);
    let list = |index: usize| -> PyResult<Vec<u32>> {
        let list = Argument::integers("state", &item(index)?)?;
        let len = list.len()?;
        Ok(list.bits_each(len)?.rows(len))
    };
    let pairs = |index: usize| Ok::<_, PyErr>(list(index)?.as_chunks::<2>().0.to_vec());
    let corners = Argument::reals("state", &item(0)?)?;
    let count = corners.boxes_len()?;
    let half_sizes = Argument::reals("state", &item(2)?)?;
    let rides = Argument::integers("state", &item(10)?)?.id_pairs()?;
    let saved = Saved {
        corners: corners.boxes(count)?,
        radii: Argument::reals("state", &item(1)?)?.real_each(count)?.rows(count),
        half_sizes: half_sizes.pairs(half_sizes.pairs_len()?)?,
        filters: pairs(3)?,
        generations: list(4)?,
        free: list(5)?,
        pairs: pairs(6)?,
        changed: list(7)?,
        leaving: list(8)?,
        updates: item(9)?.extract()?,
        ride_centers: Argument::reals("state", &item(11)?)?.pairs(rides.len())?,
        rides,
        walls: Argument::reals("state", &item(12)?)?.segments()?,
    };
    let restore = || Space::restore(settings, settings::period_in(period)?, saved);
    Ok(shared(detached(py, restore)?.map_err(refused)?))
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

/// The arguments for new shapes, except their positions.
struct Draft<T> {
    radii: Option<Each<T>>,
    half_sizes: Option<Each<[T; 2]>>,
    filters: [Option<Each<u32>>; 2],
}

impl<T: Scalar> Draft<T> {
    /// The shapes of the core, with checked values; without the GIL.
    fn shapes(self, places: Places<T>) -> jostle::Result<Shapes<T>> {
        let radii = self.radii.unwrap_or(Each::One(T::ZERO));
        let filters = match self.filters {
            [None, None] => None,
            [categories, masks] => Some([
                categories.unwrap_or(Each::One(DEFAULT_CATEGORY)),
                masks.unwrap_or(Each::One(DEFAULT_MASK)),
            ]),
        };
        places.shapes(radii, self.half_sizes, filters)
    }
}

fn sizes<T: Scalar + Element>(value: Maybe<'_, '_>, len: usize) -> PyResult<Option<Each<[T; 2]>>> {
    value.map(|value| Argument::reals("half_sizes", value)?.half_sizes(len)).transpose()
}

fn bits([categories, masks]: [Maybe<'_, '_>; 2], len: usize) -> PyResult<[Option<Each<u32>>; 2]> {
    Ok([bit_sets("categories", categories, len)?, bit_sets("masks", masks, len)?])
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
