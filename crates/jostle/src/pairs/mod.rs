//! Which shapes overlap: a tree against itself, one tree against another, and
//! brute force, the oracle beside them.
//!
//! The join walks two trees at once. Nodes whose covers do not meet are left
//! behind with everything in them; what remains is leaf against leaf, tested in
//! blocks of [`LANES`](crate::simd::LANES) shapes whose results are bits of a mask. Every shape is
//! in one leaf, so every pair comes up once.

mod join;
mod kernel;
mod output;

use std::ops::Range;

use crate::columns::Columns;
use crate::error::Result;
use crate::geometry::{self, Scalar};
use crate::interrupt::Pulse;
use crate::memory;
use crate::parallel;
use crate::quadtree::Quadtree;
use crate::settings::{Method, Settings};
use crate::shapes::{Each, Shapes};
use crate::simd::{Simd, Work};
use crate::sorting;
use join::Join;
pub use join::JoinScratch;
use kernel::Kernel;
use output::{Budget, Memory, Output, keep};

/// Up to this many shapes brute force is faster than building a tree. Measured with AVX-512; it is the
/// same for all processors, or the order of the pairs would depend on the machine.
const BRUTE_FORCE_LIMIT: usize = 80;

/// As [`BRUTE_FORCE_LIMIT`] for circles of different radii, for which strips help less.
const DIFFERENT_CIRCLES_LIMIT: usize = 256;

/// Shapes that a leaf may hold in a tree that is used once, for pairs alone.
const LEAF_CAPACITY: usize = 320;

/// Shapes that brute force tests against one shape between two checks for an interruption.
const ALONG: usize = 1 << 14;

/// By brute force, fewer shapes than this are not worth sharing with other threads.
const BRUTE_WORTH_SHARING: usize = 2048;

/// By brute force, fewer shapes than this are not worth waking other threads for.
const BRUTE_WORTH_WAKING: usize = 8192;

/// Whether categories and masks decide which shapes may pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filters {
    /// They do.
    Apply,
    /// Every shape may pair with every other.
    Ignore,
}

/// Pairs, and how many shape tests it took to find them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Found {
    /// Each pair once.
    pub pairs: Vec<[u32; 2]>,
    /// Shapes tested against shapes.
    pub tests: u64,
}

impl Found {
    /// Sorts by first, then by second.
    pub fn sort(&mut self) -> Result<()> {
        sorting::sort(&mut self.pairs, &mut Pulse::current())
    }
}

/// All overlapping pairs of rows, `i < j`, in no promised order.
/// `None` chooses the faster method.
pub fn find<T: Scalar>(
    shapes: &Shapes<T>,
    method: Option<Method>,
    threads: Option<usize>,
    max_pairs: usize,
) -> Result<Found> {
    find_with(&mut Quadtree::default(), shapes, method, threads, max_pairs)
}

/// As [`find`]; if it takes a tree, it is built in the memory of the one given. Asking
/// the system for memory can cost a sixth of the time.
pub fn find_with<T: Scalar>(
    tree: &mut Quadtree<T>,
    shapes: &Shapes<T>,
    method: Option<Method>,
    threads: Option<usize>,
    max_pairs: usize,
) -> Result<Found> {
    let settings = Settings { threads, leaf_capacity: LEAF_CAPACITY, ..Settings::default() };
    settings.validate()?;
    let circles = shapes.half_sizes.is_none() && shapes.boxes.is_none();
    let different = circles && matches!(shapes.radii, Each::Rows(_));
    let limit = if different { DIFFERENT_CIRCLES_LIMIT } else { BRUTE_FORCE_LIMIT };
    let small = shapes.len() <= limit;
    if method == Some(Method::Brute) || (method.is_none() && small) {
        return brute(&Columns::of(shapes)?, threads, max_pairs);
    }
    tree.fill_unordered(shapes, settings)?;
    within(tree, max_pairs)
}

/// All overlapping pairs of rows of one tree, `i < j`, in an order that comes from the tree.
pub fn within<T: Scalar>(tree: &Quadtree<T>, max_pairs: usize) -> Result<Found> {
    let rows = tree.rows();
    let join = Join::within(tree, None);
    join.run(max_pairs, &|pairs| {
        for pair in &mut *pairs {
            let [i, j] = pair.map(|place| rows[place as usize]);
            *pair = [i.min(j), i.max(j)];
        }
        pairs.len()
    })
}

/// All overlapping pairs, the first a row of `a`, the second a row of `b`, in an order
/// that comes from the trees.
pub fn between<T: Scalar>(a: &Quadtree<T>, b: &Quadtree<T>, max_pairs: usize) -> Result<Found> {
    let join = Join::between(a, b, None);
    join.run(max_pairs, &|pairs| {
        for [i, j] in &mut *pairs {
            (*i, *j) = (a.rows()[*i as usize], b.rows()[*j as usize]);
        }
        pairs.len()
    })
}

/// As [`within`], only pairs of which both have a category in `mask`.
pub fn within_mask<T: Scalar>(tree: &Quadtree<T>, mask: u32, max_pairs: usize) -> Result<Found> {
    let join = Join::within(tree, Some(mask));
    let (rows, selected) = (tree.rows(), |place| has_category(tree, place, mask));
    join.run(max_pairs, &|pairs| {
        keep(pairs, |[a, b]| {
            let (i, j) = (rows[a as usize], rows[b as usize]);
            (selected(a) && selected(b)).then(|| [i.min(j), i.max(j)])
        })
    })
}

/// As [`between`], only pairs of which both have a category in `mask`.
pub fn between_mask<T: Scalar>(
    a: &Quadtree<T>,
    b: &Quadtree<T>,
    mask: u32,
    max_pairs: usize,
) -> Result<Found> {
    let join = Join::between(a, b, Some(mask));
    join.run(max_pairs, &|pairs| {
        keep(pairs, |[i, j]| {
            let both = has_category(a, i, mask) && has_category(b, j, mask);
            both.then(|| [a.rows()[i as usize], b.rows()[j as usize]])
        })
    })
}

fn has_category<T: Scalar>(tree: &Quadtree<T>, place: u32, mask: u32) -> bool {
    tree.columns().shape(place as usize).category & mask != 0
}

/// Approximate number of values read for a contact.
const CONTACT_WORK: usize = 16;

/// The pairs of [`within`] with the geometry of their overlap.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overlaps<T> {
    /// Rows, `i < j`, in the order of [`within`].
    pub pairs: Vec<[u32; 2]>,
    /// Unit vectors from `i` to `j`.
    pub normals: Vec<[T; 2]>,
    /// How far each pair overlaps along its normal.
    pub depths: Vec<T>,
    /// Shapes tested against shapes.
    pub tests: u64,
}

/// As [`within`], with normals and depths.
pub fn overlaps<T: Scalar>(tree: &Quadtree<T>, max_pairs: usize) -> Result<Overlaps<T>> {
    let Found { mut pairs, tests } = places_within(tree, max_pairs, &mut JoinScratch::default())?;
    let mut normals = memory::with_room(pairs.len())?;
    let mut depths = memory::with_room(pairs.len())?;
    let mut pulse = Pulse::current();
    for pair in &mut pairs {
        pulse.check(CONTACT_WORK)?;
        pair.sort_unstable_by_key(|&place| tree.rows()[place as usize]);
        let [a, b] = pair.map(|place| tree.columns().shape(place as usize));
        let (normal, depth) = geometry::contact(&a, &b);
        normals.push(normal);
        depths.push(depth);
        *pair = pair.map(|place| tree.rows()[place as usize]);
    }
    Ok(Overlaps { pairs, normals, depths, tests })
}

/// As [`within`], in places of the tree's order instead of rows.
pub fn places_within<T: Scalar>(
    tree: &Quadtree<T>,
    max_pairs: usize,
    memory: &mut JoinScratch,
) -> Result<Found> {
    let join = Join::within(tree, None);
    join.run_in(max_pairs, &as_they_are, memory)
}

/// As [`between`], in places, with every shape of `a` moved by `-shift`.
pub fn places_between<T: Scalar>(
    a: &Quadtree<T>,
    b: &Quadtree<T>,
    shift: [T; 2],
    filters: Filters,
    max_pairs: usize,
    memory: &mut JoinScratch,
) -> Result<Found> {
    let join = Join { shift, filters, ..Join::between(a, b, None) };
    join.run_in(max_pairs, &as_they_are, memory)
}

/// The same without a shift or filters, and only pairs of places that `is_wanted` accepts.
pub fn wanted_places_between<T: Scalar>(
    a: &Quadtree<T>,
    b: &Quadtree<T>,
    is_wanted: impl Fn([u32; 2]) -> bool + Sync,
    max_pairs: usize,
    memory: &mut JoinScratch,
) -> Result<Found> {
    let join = Join { filters: Filters::Ignore, ..Join::between(a, b, None) };
    let finish = |pairs: &mut [[u32; 2]]| keep(pairs, |pair| is_wanted(pair).then_some(pair));
    join.run_in(max_pairs, &finish, memory)
}

/// All overlapping pairs of rows, `i < j`, in no promised order, every row tested
/// against every other.
pub fn brute<T: Scalar>(
    columns: &Columns<T>,
    threads: Option<usize>,
    max_pairs: usize,
) -> Result<Found> {
    let len = columns.len();
    let threads = parallel::threads_for(threads, len, BRUTE_WORTH_SHARING, BRUTE_WORTH_WAKING);
    // Bands of rows with about equal numbers of tests below the diagonal.
    let bands = if len > 512 { 64 } else { 1 };
    let edge = |band: usize| {
        let rest = 1.0 - band as f64 / bands as f64;
        if band == bands { len } else { ((1.0 - rest.sqrt()) * len as f64) as usize }
    };
    let budget = Budget::new(max_pairs);
    budget.find(threads, bands, &as_they_are, &mut Memory::default(), |band, output| {
        T::with_widest(Brute {
            a: columns,
            b: columns,
            shift: [T::ZERO; 2],
            filters: Filters::Apply,
            rows: edge(band)..edge(band + 1),
            itself: true,
            output,
        })
    })
}

/// As [`places_between`] for two sets without trees, by brute force.
pub fn brute_between<T: Scalar>(
    a: &Columns<T>,
    b: &Columns<T>,
    shift: [T; 2],
    filters: Filters,
    max_pairs: usize,
) -> Result<Found> {
    let budget = Budget::new(max_pairs);
    let rows = 0..a.len();
    budget.find(Some(1), 1, &as_they_are, &mut Memory::default(), |_, output| {
        T::with_widest(Brute { a, b, shift, filters, rows: rows.clone(), itself: false, output });
    })
}

/// For pairs of places, which are returned unchanged.
fn as_they_are(pairs: &mut [[u32; 2]]) -> usize {
    pairs.len()
}

/// Every one of `rows` against all others, or all behind it where both sides are the same.
struct Brute<'a, 'b, T> {
    a: &'a Columns<T>,
    b: &'a Columns<T>,
    shift: [T; 2],
    filters: Filters,
    rows: Range<usize>,
    itself: bool,
    output: &'a mut Output<'b>,
}

impl<T: Scalar> Work<T> for Brute<'_, '_, T> {
    type Out = ();

    #[inline(always)]
    fn run<S: Simd<T>>(self, simd: S) {
        let Self { a, b, shift, filters, rows, itself, output } = self;
        let kernel = Kernel { simd, a, b, shift, filters };
        if itself {
            return kernel.itself(rows, b.len(), output);
        }
        for row in rows {
            for others in (0..b.len()).step_by(ALONG) {
                if output.is_over(ALONG) {
                    return;
                }
                kernel.row(row, others..b.len().min(others + ALONG), output);
            }
        }
    }
}

/// Sorts pairs of places below `len` by first, then by second, in `scratch`.
pub fn sort_places(pairs: &mut Vec<[u32; 2]>, len: usize, scratch: &mut SortScratch) -> Result<()> {
    let SortScratch { starts, spare } = scratch;
    starts.clear();
    memory::resize(starts, len + 1, 0)?;
    for pair in pairs.iter() {
        starts[pair[0] as usize + 1] += 1;
    }
    for place in 0..len {
        starts[place + 1] += starts[place];
    }
    spare.clear();
    memory::resize(spare, pairs.len(), [0; 2])?;
    for &pair in pairs.iter() {
        let start = &mut starts[pair[0] as usize];
        spare[*start as usize] = pair;
        *start += 1;
    }
    std::mem::swap(pairs, spare);
    let mut from = 0;
    for &end in &starts[..len] {
        pairs[from..end as usize].sort_unstable();
        from = end as usize;
    }
    Ok(())
}

/// Memory that [`sort_places`] keeps between calls.
#[derive(Clone, Debug, Default)]
pub struct SortScratch {
    starts: Vec<u32>,
    spare: Vec<[u32; 2]>,
}
