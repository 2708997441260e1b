//! Which shapes overlap: a tree against itself, one tree against another, and
//! brute force, the oracle beside them.
//!
//! The join walks two trees at once. Nodes whose covers do not meet are left
//! behind with everything in them; what remains is leaf against leaf, tested in
//! blocks of [`LANES`] shapes whose results are bits of a mask. Every shape is
//! in one leaf, so every pair comes up once.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::columns::{Columns, DEFAULT_CATEGORY, DEFAULT_MASK, LANES};
use crate::error::{Error, Result};
use crate::geometry::{self, Cover, Scalar, Shape, overlap};
use crate::parallel;
use crate::quadtree::Quadtree;
use crate::settings::{Method, Settings};
use crate::simd;

/// Below this many shapes brute force is faster than building a tree.
const BRUTE_FORCE_LIMIT: usize = 160;

/// Work is cut into about this many tasks when several threads share it.
const TASKS: usize = 256;

/// Two trees with fewer shapes than this together are joined by one thread: to wake
/// another one costs more than it would save.
const WORTHWHILE: usize = 32_768;

/// New pairs are reported to the common count in portions of this size.
const PORTION: usize = 1 << 16;

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
    pub fn sort(&mut self) {
        self.pairs.sort_unstable();
    }
}

/// All overlapping pairs of rows, `i < j`, in no promised order.
/// `None` chooses the faster method.
pub fn find<T: Scalar>(
    columns: &Columns<T>,
    method: Option<Method>,
    threads: Option<usize>,
    max_pairs: usize,
) -> Result<Found> {
    let settings = Settings { threads, ..Settings::default() };
    settings.validate()?;
    let small = columns.len() <= BRUTE_FORCE_LIMIT;
    match method {
        Some(Method::Brute) => brute(columns, threads, max_pairs),
        None if small => brute(columns, threads, max_pairs),
        _ => within(&Quadtree::new(columns, settings)?, max_pairs),
    }
}

/// All overlapping pairs of rows of one tree, `i < j`, in the tree's order.
pub fn within<T: Scalar>(tree: &Quadtree<T>, max_pairs: usize) -> Result<Found> {
    let mut found = places_within(tree, max_pairs)?;
    let rows = tree.rows();
    for pair in &mut found.pairs {
        let (i, j) = (rows[pair[0] as usize], rows[pair[1] as usize]);
        *pair = [i.min(j), i.max(j)];
    }
    Ok(found)
}

/// All overlapping pairs, the first a row of `a`, the second a row of `b`, in
/// the order of `a`'s tree.
pub fn between<T: Scalar>(a: &Quadtree<T>, b: &Quadtree<T>, max_pairs: usize) -> Result<Found> {
    let mut found = places_between(a, b, [T::ZERO; 2], max_pairs)?;
    for pair in &mut found.pairs {
        *pair = [a.rows()[pair[0] as usize], b.rows()[pair[1] as usize]];
    }
    Ok(found)
}

/// The pairs of [`within`] with the geometry of their overlap.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overlaps<T> {
    /// Rows, `i < j`, in the tree's order.
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
    let Found { mut pairs, tests } = places_within(tree, max_pairs)?;
    let (mut normals, mut depths) =
        (Vec::with_capacity(pairs.len()), Vec::with_capacity(pairs.len()));
    for pair in &mut pairs {
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
pub fn places_within<T: Scalar>(tree: &Quadtree<T>, max_pairs: usize) -> Result<Found> {
    Join { a: tree, b: tree, shift: [T::ZERO; 2], itself: true }.run(max_pairs)
}

/// As [`between`], in places, with every shape of `a` moved by `-shift`.
pub fn places_between<T: Scalar>(
    a: &Quadtree<T>,
    b: &Quadtree<T>,
    shift: [T; 2],
    max_pairs: usize,
) -> Result<Found> {
    Join { a, b, shift, itself: false }.run(max_pairs)
}

/// All overlapping pairs of rows, `i < j`, sorted, every row tested against
/// every other.
pub fn brute<T: Scalar>(
    columns: &Columns<T>,
    threads: Option<usize>,
    max_pairs: usize,
) -> Result<Found> {
    let len = columns.len();
    // Bands of rows with about equal numbers of tests below the diagonal.
    let bands = if parallel::is_parallel(threads) && len > 512 { 64 } else { 1 };
    let edge = |band: usize| {
        let rest = 1.0 - band as f64 / bands as f64;
        if band == bands { len } else { ((1.0 - rest.sqrt()) * len as f64) as usize }
    };
    let budget = Budget::new(max_pairs);
    let parts = parallel::map(threads, bands, |band| {
        let mut output = Output::new(&budget);
        let block =
            Block { a: columns, rows: edge(band)..edge(band + 1), b: columns, others: 0..len };
        simd::widest(
            #[inline(always)]
            || block.test([T::ZERO; 2], Wanted::Behind, &mut output),
        );
        output.finish()
    });
    budget.collect(parts)
}

/// As [`places_between`] for two sets without trees, by brute force.
pub fn brute_between<T: Scalar>(
    a: &Columns<T>,
    b: &Columns<T>,
    shift: [T; 2],
    max_pairs: usize,
) -> Result<Found> {
    let budget = Budget::new(max_pairs);
    let mut output = Output::new(&budget);
    Block { a, rows: 0..a.len(), b, others: 0..b.len() }.test(shift, Wanted::All, &mut output);
    let part = output.finish();
    budget.collect(vec![part])
}

/// Sorts pairs of places below `len` by first, then by second, in `scratch`.
pub fn sort_places(pairs: &mut Vec<[u32; 2]>, len: usize, scratch: &mut SortScratch) {
    let SortScratch { starts, spare } = scratch;
    starts.clear();
    starts.resize(len + 1, 0);
    for pair in pairs.iter() {
        starts[pair[0] as usize + 1] += 1;
    }
    for place in 0..len {
        starts[place + 1] += starts[place];
    }
    spare.clear();
    spare.resize(pairs.len(), [0; 2]);
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
}

/// Memory that [`sort_places`] keeps between calls.
#[derive(Clone, Debug, Default)]
pub struct SortScratch {
    starts: Vec<u32>,
    spare: Vec<[u32; 2]>,
}

/// Two trees to be walked together; `itself` where they are the same tree and
/// each unordered pair is wanted once.
struct Join<'a, T> {
    a: &'a Quadtree<T>,
    b: &'a Quadtree<T>,
    shift: [T; 2],
    itself: bool,
}

/// A node of `a` and a node of `b` whose shapes are to be tested.
type Task = (u32, u32);

impl<T: Scalar> Join<'_, T> {
    fn run(&self, max_pairs: usize) -> Result<Found> {
        let mut tasks: Vec<Task> = Vec::new();
        if !self.a.is_empty() && !self.b.is_empty() {
            self.push((0, 0), &mut |task| tasks.push(task));
        }
        let threads = self.a.settings().threads;
        if parallel::is_parallel(threads) && self.a.len() + self.b.len() > WORTHWHILE {
            tasks = self.cut(tasks);
        }
        let budget = Budget::new(max_pairs);
        let parts = parallel::map(threads, tasks.len(), |index| {
            let mut output = Output::new(&budget);
            simd::widest(
                #[inline(always)]
                || self.walk(tasks[index], &mut output),
            );
            output.finish()
        });
        budget.collect(parts)
    }

    /// Replaces tasks by their parts, in place, until there are enough.
    fn cut(&self, mut tasks: Vec<Task>) -> Vec<Task> {
        while tasks.len() < TASKS {
            let mut parts = Vec::with_capacity(4 * tasks.len());
            for &task in &tasks {
                if self.is_leaf(task) {
                    parts.push(task);
                } else {
                    self.expand(task, &mut |part| parts.push(part));
                }
            }
            if parts.len() == tasks.len() {
                break;
            }
            tasks = parts;
        }
        tasks
    }

    /// Does a task with all its parts, in order, on a stack of its own.
    #[inline(always)]
    fn walk(&self, task: Task, output: &mut Output) {
        let mut stack = vec![task];
        while let Some(task) = stack.pop() {
            if output.is_full() {
                return;
            }
            if self.is_leaf(task) {
                self.test(task, output);
            } else {
                let from = stack.len();
                self.expand(task, &mut |part| stack.push(part));
                stack[from..].reverse();
            }
        }
    }

    #[inline(always)]
    fn is_leaf(&self, (a, b): Task) -> bool {
        self.a.nodes()[a as usize].is_leaf() && self.b.nodes()[b as usize].is_leaf()
    }

    #[inline(always)]
    fn expand(&self, (a, b): Task, push: &mut impl FnMut(Task)) {
        let (node_a, node_b) = (&self.a.nodes()[a as usize], &self.b.nodes()[b as usize]);
        if self.itself && a == b {
            for first in node_a.children() {
                for second in first..node_a.children().end {
                    self.push((first as u32, second as u32), push);
                }
            }
        } else if node_b.is_leaf() || (!node_a.is_leaf() && node_a.len() >= node_b.len()) {
            for child in node_a.children() {
                self.push((child as u32, b), push);
            }
        } else {
            for child in node_b.children() {
                self.push((a, child as u32), push);
            }
        }
    }

    /// Passes a task on if any two of its shapes could overlap.
    #[inline(always)]
    fn push(&self, task: Task, push: &mut impl FnMut(Task)) {
        let (a, b) = (&self.a.covers()[task.0 as usize], &self.b.covers()[task.1 as usize]);
        if a.meets(b, self.shift) {
            push(task);
        }
    }

    #[inline(always)]
    fn test(&self, (a, b): Task, output: &mut Output) {
        let rows = self.a.nodes()[a as usize].range();
        let others = self.b.nodes()[b as usize].range();
        let itself = self.itself && a == b;
        let block = Block { a: self.a.columns(), rows, b: self.b.columns(), others };
        let near = Wanted::Near(&self.b.covers()[b as usize]);
        block.test(self.shift, if itself { Wanted::Behind } else { near }, output);
    }
}

/// Some rows of `a` to be tested against some rows of `b`.
struct Block<'a, T> {
    a: &'a Columns<T>,
    rows: Range<usize>,
    b: &'a Columns<T>,
    others: Range<usize>,
}

/// Which pairs of a block are wanted.
#[derive(Clone, Copy)]
enum Wanted<'a, T> {
    /// Every row with every other.
    All,
    /// Both sides are the same rows: the second has to lie behind the first.
    Behind,
    /// Every row that reaches this cover of the others with every other.
    Near(&'a Cover<T>),
}

impl<T: Scalar> Block<'_, T> {
    /// Emits every wanted overlapping pair. The kernels for circles and for what
    /// pairs with everything are spared the other numbers.
    #[inline(always)]
    fn test(&self, shift: [T; 2], wanted: Wanted<'_, T>, output: &mut Output) {
        let boxes = self.a.has_boxes() || self.b.has_boxes();
        let filters = self.a.has_filters() || self.b.has_filters();
        match (boxes, filters) {
            (false, false) => self.rows::<false, false>(shift, wanted, output),
            (true, false) => self.rows::<true, false>(shift, wanted, output),
            (false, true) => self.rows::<false, true>(shift, wanted, output),
            (true, true) => self.rows::<true, true>(shift, wanted, output),
        }
    }

    #[inline(always)]
    fn rows<const BOXES: bool, const FILTERS: bool>(
        &self,
        shift: [T; 2],
        wanted: Wanted<'_, T>,
        output: &mut Output,
    ) {
        let Range { start, end } = self.rows;
        match wanted {
            Wanted::All => {
                for row in start..end {
                    self.row::<BOXES, FILTERS>(row, self.others.start, shift, output);
                }
            }
            Wanted::Behind => {
                for row in start..end {
                    let from = self.others.start.max(row + 1);
                    self.row::<BOXES, FILTERS>(row, from, shift, output);
                }
            }
            Wanted::Near(cover) => {
                for block in (start..end).step_by(LANES) {
                    let near = reaching(self.a, block, shift, cover) & first_lanes(end - block);
                    for_each_bit(near, |lane| {
                        let from = self.others.start;
                        self.row::<BOXES, FILTERS>(block + lane, from, shift, output);
                    });
                }
            }
        }
    }

    /// Tests one row against the others from `from`.
    #[inline(always)]
    fn row<const BOXES: bool, const FILTERS: bool>(
        &self,
        row: usize,
        from: usize,
        shift: [T; 2],
        output: &mut Output,
    ) {
        let end = self.others.end;
        if from >= end || output.is_full() {
            return;
        }
        let mut shape = self.a.shape(row);
        shape.center = [shape.center[0] - shift[0], shape.center[1] - shift[1]];
        output.tests += (end - from) as u64;
        for start in (from..end).step_by(LANES) {
            let hits = hits::<T, BOXES, FILTERS>(&shape, self.b, start) & first_lanes(end - start);
            for_each_bit(hits, |lane| output.push([row as u32, (start + lane) as u32]));
        }
    }
}

/// Bits of the first `count` lanes.
#[inline(always)]
fn first_lanes(count: usize) -> u32 {
    if count < LANES { (1 << count) - 1 } else { u32::MAX }
}

#[inline(always)]
fn for_each_bit(mut bits: u32, mut act: impl FnMut(usize)) {
    while bits != 0 {
        act(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}

/// A bit for each of the [`LANES`] rows from `start` that `shape` overlaps.
#[inline(always)]
fn hits<T: Scalar, const BOXES: bool, const FILTERS: bool>(
    shape: &Shape<T>,
    others: &Columns<T>,
    start: usize,
) -> u32 {
    let block = start..start + LANES;
    let (x, y) = (&others.x[block.clone()], &others.y[block.clone()]);
    let radius = &others.radius[block.clone()];
    let mut near = [false; LANES];
    if BOXES && others.has_boxes() {
        let half_x = &others.half_x[block.clone()];
        let half_y = &others.half_y[block.clone()];
        for lane in 0..LANES {
            let half_sum = [shape.half_size[0] + half_x[lane], shape.half_size[1] + half_y[lane]];
            near[lane] = reaches(shape, x[lane], y[lane], half_sum, radius[lane]);
        }
    } else if BOXES {
        for lane in 0..LANES {
            near[lane] = reaches(shape, x[lane], y[lane], shape.half_size, radius[lane]);
        }
    } else {
        for lane in 0..LANES {
            let dx = shape.center[0] - x[lane];
            let dy = shape.center[1] - y[lane];
            let reach = shape.radius + radius[lane];
            near[lane] = dx * dx + dy * dy < reach * reach;
        }
    }
    let mut bits = as_bits(&near);
    if FILTERS && bits != 0 {
        bits &= allowed(shape, others, block);
    }
    bits
}

/// A bit for each of the [`LANES`] rows from `start` that, moved by `-shift`, could
/// overlap something under `cover`. Filters are left to the pairs themselves.
#[inline(always)]
fn reaching<T: Scalar>(rows: &Columns<T>, start: usize, shift: [T; 2], cover: &Cover<T>) -> u32 {
    let block = start..start + LANES;
    let (x, y) = (&rows.x[block.clone()], &rows.y[block.clone()]);
    let radius = &rows.radius[block.clone()];
    let gap = |v: T, axis: usize| {
        let v = v - shift[axis];
        (cover.min[axis] - v).most(v - cover.max[axis]).most(T::ZERO)
    };
    let mut near = [false; LANES];
    if rows.has_boxes() {
        let (half_x, half_y) = (&rows.half_x[block.clone()], &rows.half_y[block]);
        for lane in 0..LANES {
            let half_sum = [half_x[lane] + cover.half_size[0], half_y[lane] + cover.half_size[1]];
            let gaps = [gap(x[lane], 0), gap(y[lane], 1)];
            near[lane] = overlap(gaps, half_sum, radius[lane] + cover.radius);
        }
    } else {
        for lane in 0..LANES {
            let gaps = [gap(x[lane], 0), gap(y[lane], 1)];
            near[lane] = overlap(gaps, cover.half_size, radius[lane] + cover.radius);
        }
    }
    as_bits(&near)
}

/// Lane k as bit k.
#[inline(always)]
fn as_bits(lanes: &[bool; LANES]) -> u32 {
    lanes.iter().enumerate().fold(0, |bits, (lane, &set)| bits | u32::from(set) << lane)
}

/// The overlap formula for one lane.
#[inline(always)]
fn reaches<T: Scalar>(shape: &Shape<T>, x: T, y: T, half_sum: [T; 2], radius: T) -> bool {
    let distance = [(shape.center[0] - x).abs(), (shape.center[1] - y).abs()];
    overlap(distance, half_sum, shape.radius + radius)
}

/// A bit for each row whose filter and the shape's agree.
#[inline(always)]
fn allowed<T: Scalar>(shape: &Shape<T>, others: &Columns<T>, block: Range<usize>) -> u32 {
    let mut bits = 0;
    for (lane, row) in block.enumerate() {
        let (category, mask) = if others.has_filters() {
            (others.category[row], others.mask[row])
        } else {
            (DEFAULT_CATEGORY, DEFAULT_MASK)
        };
        let agree = (shape.category & mask) != 0 && (category & shape.mask) != 0;
        bits |= u32::from(agree) << lane;
    }
    bits
}

/// How many pairs all tasks together may still find.
struct Budget {
    max_pairs: usize,
    count: AtomicUsize,
}

impl Budget {
    fn new(max_pairs: usize) -> Self {
        Self { max_pairs, count: AtomicUsize::new(0) }
    }

    fn collect(&self, parts: Vec<Found>) -> Result<Found> {
        let count: usize = parts.iter().map(|part| part.pairs.len()).sum();
        if count > self.max_pairs || self.count.load(Ordering::Relaxed) > self.max_pairs {
            return Err(Error::TooManyPairs { max_pairs: self.max_pairs });
        }
        let mut parts = parts.into_iter();
        let mut all = parts.next().unwrap_or_default();
        all.pairs.reserve(count - all.pairs.len());
        for part in parts {
            all.pairs.extend_from_slice(&part.pairs);
            all.tests += part.tests;
        }
        Ok(all)
    }
}

/// What one task has found so far.
struct Output<'a> {
    pairs: Vec<[u32; 2]>,
    tests: u64,
    budget: &'a Budget,
    reported: usize,
    /// Pairs at which the next portion is reported.
    report_at: usize,
    full: bool,
}

impl<'a> Output<'a> {
    fn new(budget: &'a Budget) -> Self {
        let report_at = PORTION.min(budget.max_pairs.saturating_add(1));
        Self { pairs: Vec::new(), tests: 0, budget, reported: 0, report_at, full: false }
    }

    #[inline(always)]
    fn push(&mut self, pair: [u32; 2]) {
        self.pairs.push(pair);
        if self.pairs.len() >= self.report_at {
            self.report();
        }
    }

    #[cold]
    fn report(&mut self) {
        let new = self.pairs.len() - self.reported;
        let before = self.budget.count.fetch_add(new, Ordering::Relaxed);
        self.reported = self.pairs.len();
        self.report_at = self.reported + PORTION;
        self.full = before + new > self.budget.max_pairs;
    }

    /// Whether there is no point in going on.
    fn is_full(&self) -> bool {
        self.full
    }

    fn finish(self) -> Found {
        Found { pairs: self.pairs, tests: self.tests }
    }
}
