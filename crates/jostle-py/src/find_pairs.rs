//! `jostle.find_pairs`.

use std::sync::{Mutex, TryLockError};

use jostle_base::Method;
use jostle_index::pairs::FindScratch;
use jostle_index::{Period, Scalar, pairs};
use numpy::{Element, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Given, long, table, truth};
use crate::error::refused;
use crate::interrupt::detached;
use crate::keywords::refuse_unknown_of_function;
use crate::queries::Maybe;
use crate::settings;
use crate::shapes::{Rows, Shapes};

/// Find every pair of overlapping shapes.
///
/// A shape is every point within `radius` of its core: the axis-aligned box ``center ± half_size``,
/// one of `boxes`, or one of `segments`. A circle has half size 0, a rectangle radius 0.
/// Touching is not overlapping.
///
/// Parameters
/// ----------
/// positions : array_like, shape (n, 2), optional
///     Centres, in any unit of length; required unless `boxes` or `segments` are given.
/// radii : array_like, a number or shape (n,), default 0.0
///     Radii, in the same unit.
/// half_sizes : array_like, a number, shape (2,) or (n, 2), optional
///     Half widths and half heights. If omitted, every shape is a circle.
/// boxes : array_like, shape (n, 4), optional
///     Sides min_x, min_y, max_x, max_y of each shape, in place of `positions` and `half_sizes`.
///     Objects with the attributes `left`, `top`, `right` and `bottom`, such as pygame's Rect,
///     are accepted in a list or a tuple, but not in an array, which NumPy fills with x, y,
///     width and height. The four numbers are compared without rounding:
///     boxes that share an edge never overlap, whereas sides computed as
///     ``center ± half_size`` are rounded. With `radii`, the shapes are rounded boxes.
/// segments : array_like, shape (n, 2, 2), optional
///     Start and end of each shape, in place of `positions` and `half_sizes`: line segments, or
///     capsules with `radii`. Segments that cross overlap; those that share an end, or lie on one
///     line, do not. With a period the ends are at most one period apart along each axis.
/// categories, masks : array_like of int, a number or shape (n,), optional
///     Bit sets of 32 bits: shapes i and j may pair only if ``categories[i] & masks[j]`` and
///     ``categories[j] & masks[i]``. If omitted, categories are 1 and masks have all bits.
/// distance : float, default 0.0
///     Find pairs whose gap is below this, in units of length: each radius is increased by half of
///     it. If 0, the shapes must overlap.
/// period : float or (float, float), optional
///     Width and height of a periodic plane, one number for both; 0 or None on an axis that is
///     not periodic. Positions that differ by a multiple of the period are equal, and the gap along
///     an axis is that of the minimum image.
/// method : {"auto", "brute", "quadtree"}, default "auto"
///     How the pairs are found; the pairs are the same. "auto" uses brute force for few shapes, a
///     uniform grid for circles of one radius unless they are sparse, and otherwise the tree.
/// sort : bool, default False
///     Whether to sort the pairs by the first, then by the second shape. If False, their
///     order is not specified.
/// max_pairs : int, default 134217728
///     Maximum number of pairs to return; the default corresponds to 2 GiB.
/// threads : int, optional
///     Number of threads, at most one for each core, which is the default. The answer is the
///     same for every number.
///
/// Returns
/// -------
/// ndarray of int64, shape (m, 2)
///     Row numbers ``i < j`` of each pair, every pair once.
///
/// Raises
/// ------
/// TypeError
///     If an argument does not hold numbers, or if not exactly one of `positions`, `boxes`
///     and `segments` is given.
/// ValueError
///     If a shape is wrong, a value is not finite, a size is negative or out of range, or
///     more than `max_pairs` pairs overlap.
/// MemoryError
///     If there is no memory for the pairs.
///
/// See Also
/// --------
/// Quadtree : A tree of the same shapes, for several queries.
/// Space : Shapes that move, with ids and events.
///
/// Notes
/// -----
/// Arithmetic is float32 if every given array is float32, otherwise float64; lists of numbers
/// count as float64. A plain number, or a plain pair of half sizes, takes the precision of the
/// given arrays.
///
/// Centres may be anywhere. A radius is 0, or between 1e-18 and 1e18 in float32 and between
/// 1e-150 and 1e150 in float64: squares of other numbers overflow or lose digits. A half size
/// is at most an eighth of the largest number of the type, a box at most twice as wide and
/// high as that.
///
/// References
/// ----------
/// T. Brinkhoff, H.-P. Kriegel and B. Seeger, *Efficient Processing of Spatial Joins Using R-trees*,
/// SIGMOD (1993): the traversal of two trees at once.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> jostle.find_pairs([(0, 0), (3, 0), (4, 0)], radii=1.0)
/// array([[1, 2]])
/// >>> jostle.find_pairs([(0, 0), (1, 0), (2, 0)], radii=0.8, categories=[1, 2, 1], masks=[2, 3, 2])
/// array([[0, 1],
///        [1, 2]])
/// >>> jostle.find_pairs(boxes=[(0, 0, 0.1, 1), (0.1, 0, 0.3, 1), (0.2, 0, 0.4, 1)])
/// array([[1, 2]])
/// >>> jostle.find_pairs(segments=[[(0, 0), (2, 2)], [(0, 2), (2, 0)], [(2, 2), (4, 2)]])
/// array([[0, 1]])
/// >>> jostle.find_pairs([(0.5, 0), (3, 0), (9.5, 0)], distance=2.0, period=10)
/// array([[0, 2]])
#[pyfunction]
#[pyo3(
    signature = (
        positions=None, radii=Given::NOTHING, half_sizes=None,
        *, boxes=None, segments=None, categories=None, masks=None, distance=Given::NOTHING, period=None,
        method=Given::NOTHING, sort=Given::NOTHING, max_pairs=Given::NOTHING, threads=None, **unknown),
    text_signature = "(positions=None, radii=0.0, half_sizes=None, *, boxes=None, segments=None, categories=None, \
                      masks=None, distance=0.0, period=None, method='auto', sort=False, \
                      max_pairs=134217728, threads=None)"
)]
#[expect(clippy::too_many_arguments, reason = "they are Python's keywords")]
pub fn find_pairs<'py>(
    py: Python<'py>,
    positions: Maybe<'_, 'py>,
    radii: Given<'py>,
    half_sizes: Maybe<'_, 'py>,
    boxes: Maybe<'_, 'py>,
    segments: Maybe<'_, 'py>,
    categories: Maybe<'_, 'py>,
    masks: Maybe<'_, 'py>,
    distance: Given<'py>,
    period: Maybe<'_, 'py>,
    method: Given<'py>,
    sort: Given<'py>,
    max_pairs: Given<'py>,
    threads: Option<&Bound<'py, PyAny>>,
    unknown: Option<&Bound<'_, PyDict>>,
) -> PyResult<Bound<'py, PyArray2<i64>>> {
    refuse_unknown_of_function("find_pairs", unknown)?;
    let search = Search {
        distance: settings::distance(&distance)?,
        period: settings::period(period)?,
        method: settings::method_or_auto(&method)?,
        sort: truth("sort", &sort)?,
        max_pairs: settings::max_pairs(&max_pairs)?,
        threads: settings::threads(threads)?,
    };
    let shapes =
        Shapes::read([positions, half_sizes, boxes, segments], &radii, [categories, masks])?;
    let pairs = detached(py, || match shapes {
        Shapes::Single(rows) => search.run(rows),
        Shapes::Double(rows) => search.run(rows),
    })?;
    table(py, pairs.map_err(refused)?)
}

struct Search {
    distance: f64,
    period: Period<f64>,
    method: Option<Method>,
    sort: bool,
    max_pairs: usize,
    threads: Option<usize>,
}

impl Search {
    fn run<T: Kept + Element>(&self, rows: Rows<T>) -> jostle_base::Result<Vec<[i64; 2]>> {
        let shapes = rows.checked()?.grown(T::from_f64(self.distance))?;
        let shapes = shapes.in_period(settings::period_in(self.period)?)?;
        with_kept(|scratch| {
            let Self { method, threads, max_pairs, .. } = *self;
            let mut found = pairs::find_with(scratch, &shapes, method, threads, max_pairs)?;
            if self.sort {
                found.sort()?;
            }
            let pairs = long(&found.pairs)?;
            scratch.keep(found.pairs);
            Ok(pairs)
        })
    }
}

/// Number types, each with scratch that is kept between calls.
trait Kept: Scalar {
    fn scratch() -> &'static KeptScratch<Self>;
}

type KeptScratch<T> = Mutex<Option<FindScratch<T>>>;

macro_rules! kept {
    ($t:ty) => {
        impl Kept for $t {
            fn scratch() -> &'static KeptScratch<Self> {
                static SCRATCH: KeptScratch<$t> = Mutex::new(None);
                &SCRATCH
            }
        }
    };
}
kept!(f32);
kept!(f64);

/// Maximum number of bytes that are kept for each of the two types: enough for a million circles.
const MAX_KEPT: usize = 64 << 20;

/// Calls `work` with scratch that is kept between calls, because allocation takes up to a third of
/// the time of a call; with new scratch if another thread uses it.
fn with_kept<T: Kept, R>(work: impl FnOnce(&mut FindScratch<T>) -> R) -> R {
    let mut kept = match T::scratch().try_lock() {
        Ok(kept) => kept,
        Err(TryLockError::Poisoned(poisoned)) => {
            T::scratch().clear_poison();
            let mut kept = poisoned.into_inner();
            *kept = None;
            kept
        }
        Err(TryLockError::WouldBlock) => return work(&mut FindScratch::default()),
    };
    let scratch = kept.get_or_insert_default();
    let result = work(scratch);
    if scratch.memory_bytes() > MAX_KEPT {
        *kept = None;
    }
    result
}
