//! Overlapping pairs of shapes: within a tree, between two trees, and by brute force.
//!
//! The broad phase (`join`) traverses two trees at once and skips pairs of nodes whose bounds do
//! not overlap. The narrow phase (`kernel`) tests the shapes of the remaining pairs of leaves, a
//! block of [`LANES`](jostle_simd::LANES) at a time. Every shape is in one leaf, so every pair
//! is found once. Brute force gives the same pairs.

mod contacts;
mod grid;
mod images;
mod join;
mod kernel;
mod output;
mod segments;

use std::ops::Range;

use crate::columns::Columns;
use crate::geometry::{Scalar, cores_overlap};
use crate::quadtree::Quadtree;
use crate::shapes::{Each, Shapes};
pub use contacts::{Overlaps, overlaps};
use grid::Grid;
use join::Join;
pub use join::JoinScratch;
use jostle_base::error::Result;
use jostle_base::interrupt::Pulse;
use jostle_base::memory;
use jostle_base::parallel;
use jostle_base::settings::{Method, Settings};
use jostle_base::sorting;
use jostle_simd::{Simd, Work};
use kernel::{Kernel, of_kind};
use output::{Budget, Output, PairScratch, filter_map, map_each};
pub use segments::{LineSegment, LineSegments, Path, near_segments};

/// Up to this number of shapes brute force is faster than a tree. Measured with AVX-512; the same
/// for all processors, because the order of the pairs depends on it.
const BRUTE_FORCE_LIMIT: usize = 80;

/// As [`BRUTE_FORCE_LIMIT`], for circles of different radii, for which strips are less effective.
const DIFFERENT_CIRCLES_LIMIT: usize = 256;

/// Maximum number of shapes in a leaf of a tree that is used for one search of pairs only.
pub const LEAF_CAPACITY: usize = 320;

/// Number of shapes that brute force tests against one shape between two checks for interruption.
const ROW_TESTS: usize = 1 << 14;

/// Minimum number of shapes for which brute force uses threads that are awake.
const BRUTE_WORTH_SHARING: usize = 2048;

/// Minimum number of shapes for which brute force wakes threads.
const BRUTE_WORTH_WAKING: usize = 8192;

/// Whether categories and masks are applied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filters {
    /// Shapes pair only if their categories and masks allow it.
    Apply,
    /// Every shape may pair with every other.
    Ignore,
}

/// The result of a search of pairs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Found {
    /// Each pair once.
    pub pairs: Vec<[u32; 2]>,
    /// Number of pairs of shapes that were tested.
    pub tests: u64,
}

impl Found {
    /// Sorts the pairs by first, then by second.
    pub fn sort(&mut self) -> Result<()> {
        sorting::sort(&mut self.pairs, &mut Pulse::current())
    }

    /// Adds the result of a search that had the rest of `max_pairs`; returns its memory for pairs.
    fn append(&mut self, more: Result<Self>, max_pairs: usize) -> Result<Vec<[u32; 2]>> {
        let more = more.map_err(|error| error.with_max_pairs(max_pairs))?;
        memory::reserve(&mut self.pairs, more.pairs.len())?;
        self.pairs.extend_from_slice(&more.pairs);
        self.tests += more.tests;
        Ok(more.pairs)
    }
}

/// All overlapping pairs of rows, `i < j`, in unspecified order. `None` chooses the faster method.
pub fn find<T: Scalar>(
    shapes: &Shapes<T>,
    method: Option<Method>,
    threads: Option<usize>,
    max_pairs: usize,
) -> Result<Found> {
    find_with(&mut FindScratch::default(), shapes, method, threads, max_pairs)
}

/// Scratch of [`find_with`], kept between calls.
#[derive(Debug, Default)]
pub struct FindScratch<T> {
    /// The tree of the last search by a tree.
    pub tree: Quadtree<T>,
    grid: Grid<T>,
    join: JoinScratch,
}

impl<T: Scalar> FindScratch<T> {
    /// Keeps the memory of a list of pairs for the result of the next call.
    pub fn keep(&mut self, pairs: Vec<[u32; 2]>) {
        self.join.keep(pairs);
    }

    /// Allocated bytes, used or not.
    pub fn memory_bytes(&self) -> usize {
        self.tree.memory_bytes() + self.grid.memory_bytes() + self.join.memory_bytes()
    }
}

/// As [`find`], in the memory of earlier calls. Allocation would take up to a third of the time.
pub fn find_with<T: Scalar>(
    scratch: &mut FindScratch<T>,
    shapes: &Shapes<T>,
    method: Option<Method>,
    threads: Option<usize>,
    max_pairs: usize,
) -> Result<Found> {
    let settings = Settings { threads, leaf_capacity: LEAF_CAPACITY, ..Settings::default() };
    settings.validate()?;
    let FindScratch { tree, grid, join } = scratch;
    let circles = shapes.half_sizes.is_none() && shapes.boxes.is_none();
    // Strips are as high as the largest circle of a leaf, so they exclude less if radii differ, and
    // the tree is worth its construction later. `examples/pair_methods` measures both.
    let different = circles && matches!(shapes.radii, Each::Rows(_));
    let limit = if different { DIFFERENT_CIRCLES_LIMIT } else { BRUTE_FORCE_LIMIT };
    let small = shapes.len() <= limit;
    let periodic = !shapes.period.is_none();
    // Its own loop, one pair at a time: the two gaps of a periodic axis are not in the kernel. The
    // tree joins images instead.
    if method == Some(Method::Brute) && periodic {
        return images::brute(shapes, max_pairs);
    }
    if method == Some(Method::Brute) || (method.is_none() && small && !periodic) {
        return brute(&Columns::of(shapes)?, threads, max_pairs);
    }
    if method.is_none()
        // Grids first. They are the fastest where they apply, and find out quickly where they do
        // not.
        && let Some(part) = grid.find(shapes, threads, max_pairs, &mut join.pairs)
    {
        let grid::GridPairs { mut found, rest } = part?;
        add_rest(&mut found, shapes, &rest, threads, max_pairs)?;
        return Ok(found);
    }
    // Nobody else reads this tree, so its leaves need no order but that of their strips, and may be
    // large: with 320 shapes instead of 96 the join takes 11 instead of 17 ns a shape and the tree
    // 18 instead of 13.
    tree.fill_unordered(shapes, settings)?;
    within_in(tree, None, max_pairs, join)
}

/// Adds the pairs of some rows, in ascending order, with each other.
fn add_rest<T: Scalar>(
    found: &mut Found,
    shapes: &Shapes<T>,
    rest: &[u32],
    threads: Option<usize>,
    max_pairs: usize,
) -> Result<()> {
    if rest.len() < 2 {
        return Ok(());
    }
    // Never the grid again: it has just said that it does not suit these shapes.
    let method = (rest.len() > DIFFERENT_CIRCLES_LIMIT).then_some(Method::Quadtree);
    let method = method.or(Some(Method::Brute));
    let left = max_pairs - found.pairs.len();
    let mut more = find(&shapes.select(rest), method, threads, left);
    if let Ok(more) = &mut more {
        more.pairs.iter_mut().for_each(|pair| *pair = pair.map(|row| rest[row as usize]));
    }
    found.append(more, max_pairs).map(drop)
}

/// Number of brute force tests that take as long as inserting one shape into a tree.
const TESTS_FOR_A_SHAPE: usize = 64;

/// All overlapping pairs, the first a row of `a`, the second a row of `b`, in unspecified order, by
/// the faster method.
pub fn find_between<T: Scalar>(
    a: &Shapes<T>,
    b: &Shapes<T>,
    threads: Option<usize>,
    max_pairs: usize,
) -> Result<Found> {
    // Brute force makes |a| · |b| tests and no trees. With a few shapes on one side it wins however
    // many are on the other: two trees cost about the time of 64 tests for each shape.
    // `brute_between` and `between` of two trees, timed with the same shapes, measure it.
    if a.len().saturating_mul(b.len()) <= TESTS_FOR_A_SHAPE * (a.len() + b.len()) {
        let (a, b) = (Columns::of(a)?, Columns::of(b)?);
        return brute_between(&a, &b, [T::ZERO; 2], Filters::Apply, max_pairs);
    }
    let settings = Settings { threads, ..Settings::default() };
    let (a, b) = (Quadtree::new(a, settings)?, Quadtree::new(b, settings)?);
    between(&a, &b, None, max_pairs)
}

/// All overlapping pairs of rows of one tree, `i < j`, in an order that depends on the tree. If
/// there is a `mask`, both shapes must have a category in it.
pub fn within<T: Scalar>(tree: &Quadtree<T>, mask: Option<u32>, max_pairs: usize) -> Result<Found> {
    within_in(tree, mask, max_pairs, &mut JoinScratch::default())
}

/// As [`within`], in the memory of earlier calls.
fn within_in<T: Scalar>(
    tree: &Quadtree<T>,
    mask: Option<u32>,
    max_pairs: usize,
    scratch: &mut JoinScratch,
) -> Result<Found> {
    let rows = tree.rows();
    // Indices of the tree become rows here, portion by portion, while the pairs are in the
    // first-level cache.
    let ordered = |[a, b]: [u32; 2]| {
        let (i, j) = (rows[a as usize], rows[b as usize]);
        [i.min(j), i.max(j)]
    };
    let join = Join::within(tree, mask);
    let Some(mask) = mask else {
        return join.run_in(max_pairs, &|pairs| map_each(pairs, ordered), scratch);
    };
    let select = |pairs: &mut [[u32; 2]]| {
        // The traversal skips nodes without a category of the mask, but a node with one may contain
        // shapes without it. So each pair is tested once more.
        let selected = |index: u32| has_category(tree, index, mask);
        filter_map(pairs, |pair| pair.into_iter().all(selected).then(|| ordered(pair)))
    };
    join.run_in(max_pairs, &select, scratch)
}

/// All overlapping pairs, the first a row of `a`, the second a row of `b`, in an order that
/// depends on the trees. If there is a `mask`, both shapes must have a category in it.
pub fn between<T: Scalar>(
    a: &Quadtree<T>,
    b: &Quadtree<T>,
    mask: Option<u32>,
    max_pairs: usize,
) -> Result<Found> {
    let rows = |[i, j]: [u32; 2]| [a.rows()[i as usize], b.rows()[j as usize]];
    let join = Join::between(a, b, mask);
    let Some(mask) = mask else { return join.run(max_pairs, &|pairs| map_each(pairs, rows)) };
    join.run(max_pairs, &|pairs| {
        filter_map(pairs, |[i, j]| {
            let both = has_category(a, i, mask) && has_category(b, j, mask);
            both.then(|| rows([i, j]))
        })
    })
}

/// As [`within`], or as [`between`] if there is an `other` tree, of all pairs whose gap is below
/// `distance`.
pub fn near<T: Scalar>(
    tree: &Quadtree<T>,
    other: Option<&Quadtree<T>>,
    distance: T,
    mask: Option<u32>,
    max_pairs: usize,
) -> Result<Found> {
    if distance == T::ZERO {
        return match other {
            None => within(tree, mask, max_pairs),
            Some(other) => between(tree, other, mask, max_pairs),
        };
    }
    let tree = tree.grown(distance)?;
    match other {
        None => within(&tree, mask, max_pairs),
        Some(other) => between(&tree, &other.grown(distance)?, mask, max_pairs),
    }
}

fn has_category<T: Scalar>(tree: &Quadtree<T>, index: u32, mask: u32) -> bool {
    tree.columns().shape(index as usize).category & mask != 0
}

/// As [`within`], as indices in Morton order instead of rows.
pub fn indices_within<T: Scalar>(
    tree: &Quadtree<T>,
    max_pairs: usize,
    scratch: &mut JoinScratch,
) -> Result<Found> {
    let join = Join::within(tree, None);
    join.run_in(max_pairs, &unchanged, scratch)
}

/// As [`between`], as indices, with every shape of `a` moved by `-shift`.
pub fn indices_between<T: Scalar>(
    a: &Quadtree<T>,
    b: &Quadtree<T>,
    shift: [T; 2],
    filters: Filters,
    max_pairs: usize,
    scratch: &mut JoinScratch,
) -> Result<Found> {
    let join = Join { shift, filters, ..Join::between(a, b, None) };
    join.run_in(max_pairs, &unchanged, scratch)
}

/// All overlapping pairs of rows, `i < j`, in unspecified order; every row is tested against every
/// other.
pub fn brute<T: Scalar>(
    columns: &Columns<T>,
    threads: Option<usize>,
    max_pairs: usize,
) -> Result<Found> {
    let len = columns.len();
    let threads = parallel::threads_for(threads, len, BRUTE_WORTH_SHARING, BRUTE_WORTH_WAKING);
    // Bands of rows with about equal numbers of tests.
    // Fixed numbers: the order of the pairs is that of the bands, whatever the number of threads.
    let bands = if len > 512 { 64 } else { 1 };
    let edge = |band: usize| {
        // Row i is tested against the rows after it. Those from a fraction f on make (1 - f)² of
        // all tests, so the edges are where this falls evenly.
        let rest = 1.0 - band as f64 / bands as f64;
        if band == bands { len } else { ((1.0 - rest.sqrt()) * len as f64) as usize }
    };
    let budget = Budget::new(max_pairs);
    let map = |pairs: &mut [[u32; 2]]| keep_overlapping(columns, columns, [[T::ZERO; 2]; 2], pairs);
    budget.find(threads, bands, &map, &mut PairScratch::default(), |band, output| {
        T::with_widest(Brute {
            a: columns,
            b: columns,
            shift: [T::ZERO; 2],
            filters: Filters::Apply,
            rows: edge(band)..edge(band + 1),
            is_same: true,
            output,
        })
    })
}

/// As [`indices_between`], for shapes without trees, by brute force.
pub fn brute_between<T: Scalar>(
    a: &Columns<T>,
    b: &Columns<T>,
    shift: [T; 2],
    filters: Filters,
    max_pairs: usize,
) -> Result<Found> {
    let budget = Budget::new(max_pairs);
    let rows = 0..a.len();
    let map = |pairs: &mut [[u32; 2]]| keep_overlapping(a, b, [shift, [T::ZERO; 2]], pairs);
    budget.find(Some(1), 1, &map, &mut PairScratch::default(), |_, output| {
        T::with_widest(Brute { a, b, shift, filters, rows: rows.clone(), is_same: false, output });
    })
}

/// [`MapPairs`] that leaves pairs of indices unchanged.
fn unchanged(pairs: &mut [[u32; 2]]) -> usize {
    pairs.len()
}

/// [`MapPairs`] that keeps the pairs whose cores overlap, of those whose bounding boxes do: shapes
/// of `a` and of `b`, moved by minus `shifts`.
fn keep_overlapping<T: Scalar>(
    a: &Columns<T>,
    b: &Columns<T>,
    [shift, other_shift]: [[T; 2]; 2],
    pairs: &mut [[u32; 2]],
) -> usize {
    if !a.has_cores() && !b.has_cores() {
        return pairs.len();
    }
    filter_map(pairs, |[i, j]| {
        let first = a.shape(i as usize).moved(shift);
        let second = b.shape(j as usize).moved(other_shift);
        cores_overlap(&first, &second).then_some([i, j])
    })
}

/// Tests each of `rows` of `a` against all shapes of `b`, or against later rows if both are the
/// same.
struct Brute<'a, 'b, T> {
    a: &'a Columns<T>,
    b: &'a Columns<T>,
    shift: [T; 2],
    filters: Filters,
    rows: Range<usize>,
    is_same: bool,
    output: &'a mut Output<'b>,
}

impl<T: Scalar> Work<T> for Brute<'_, '_, T> {
    type Out = ();

    #[inline(always)]
    fn run<S: Simd<T>>(self, simd: S) {
        let Self { a, b, shift, filters, rows, is_same, output } = self;
        let kernel = Kernel { simd, a, b, shift, other_shift: [T::ZERO; 2], filters };
        if is_same {
            return of_kind!(kernel.self_block(rows, b.len(), output));
        }
        for row in rows {
            for others in (0..b.len()).step_by(ROW_TESTS) {
                // At most 16,384 tests between two checks, however many shapes there are.
                if output.is_over(ROW_TESTS) {
                    return;
                }
                let others = others..b.len().min(others + ROW_TESTS);
                of_kind!(kernel.row_block(row, others, output));
            }
        }
    }
}

/// Sorts pairs of indices below `len` by first, then by second.
pub fn sort_indices(
    pairs: &mut Vec<[u32; 2]>,
    len: usize,
    scratch: &mut SortScratch,
) -> Result<()> {
    let SortScratch { ends, spare } = scratch;
    memory::resize(ends, len, 0)?;
    spare.clear();
    memory::resize(spare, pairs.len(), [0; 2])?;
    sorting::counting_sort(pairs.iter(), |pair| pair[0] as usize, |pair| *pair, ends, spare);
    std::mem::swap(pairs, spare);
    let mut from = 0;
    for &end in &*ends {
        // One index has few pairs. They are sorted by comparison after all have been sorted by
        // their first index by counting, which takes two passes.
        pairs[from..end as usize].sort_unstable();
        from = end as usize;
    }
    Ok(())
}

/// Scratch of [`sort_indices`], kept between calls.
#[derive(Clone, Debug, Default)]
pub struct SortScratch {
    ends: Vec<u32>,
    spare: Vec<[u32; 2]>,
}
