//! The broad phase: simultaneous traversal of two trees (tree join) down to pairs of leaves.
//!
//! T. Brinkhoff, H.-P. Kriegel and B. Seeger, *Efficient Processing of Spatial Joins Using
//! R-trees*, SIGMOD (1993).

use super::images::Image;
use super::kernel::{Kernel, Scratch, Side, of_kind};
use super::output::{Budget, MapPairs, Output, PairScratch, filter_map};
use super::{Filters, Found, keep_overlapping};
use crate::geometry::{Bounds, Scalar};
use crate::quadtree::Quadtree;
use jostle_base::error::Result;
use jostle_base::parallel;
use jostle_simd::{Simd, Work};

/// Approximate number of tasks for several threads.
const TASKS: usize = 256;

/// Approximate number of values read for a pair of nodes, without its shapes.
const TASK_WORK: usize = 16;

/// The join of two trees, or of a tree with itself.
pub(super) struct Join<'a, T> {
    pub(super) a: &'a Quadtree<T>,
    pub(super) b: &'a Quadtree<T>,
    /// By how much the shapes of `a` are moved in the negative direction.
    pub(super) shift: [T; 2],
    /// By how much the shapes of `b` are moved in the negative direction.
    pub(super) other_shift: [T; 2],
    /// Whether both are the same tree, of which each unordered pair is found once.
    pub(super) is_same: bool,
    /// If given, nodes without a category in it are skipped. Pairs are not tested with it.
    pub(super) mask: Option<u32>,
    pub(super) filters: Filters,
}

/// A node of `a` and a node of `b` whose shapes are to be tested.
type Task = [u32; 2];

impl<'a, T: Scalar> Join<'a, T> {
    /// The join of a tree with itself.
    pub(super) fn within(tree: &'a Quadtree<T>, mask: Option<u32>) -> Self {
        Self { is_same: true, ..Self::between(tree, tree, mask) }
    }

    /// The join of two trees.
    pub(super) fn between(a: &'a Quadtree<T>, b: &'a Quadtree<T>, mask: Option<u32>) -> Self {
        let none = [T::ZERO; 2];
        let (shift, other_shift, filters) = (none, none, Filters::Apply);
        Self { a, b, shift, other_shift, is_same: false, mask, filters }
    }

    /// Finds all pairs of indices and converts them by `map`.
    pub(super) fn run(&self, max_pairs: usize, map: &MapPairs<'_>) -> Result<Found> {
        self.run_in(max_pairs, map, &mut JoinScratch::default())
    }

    /// As [`Join::run`], with the scratch of earlier calls. With one thread it allocates only if
    /// the result needs more memory.
    pub(super) fn run_in(
        &self,
        max_pairs: usize,
        map: &MapPairs<'_>,
        scratch: &mut JoinScratch,
    ) -> Result<Found> {
        let mut found = self.run_direct(max_pairs, map, scratch)?;
        let period = self.a.period();
        debug_assert_eq!(period, self.b.period());
        // The pairs of the plane without a period are found above. Each image is a join of its own,
        // with the shapes of one side moved; `is_first` keeps a pair in one image only. Bounds far
        // from the borders do not overlap in any image, so these joins end near the root.
        for image in Image::all(&period, self.is_same) {
            let [shift, other_shift] = image.shifts(&period);
            let join = Self { shift, other_shift, is_same: false, ..*self };
            // Not negative: a join with more pairs than its limit is an error.
            let left = max_pairs - found.pairs.len();
            let shapes = |pair: [u32; 2]| {
                let [a, b] = pair.map(|index| index as usize);
                [self.a.columns().shape(a), self.b.columns().shape(b)]
            };
            let map = |pairs: &mut [[u32; 2]]| {
                let kept =
                    filter_map(pairs, |pair| image.is_first(&period, shapes(pair)).then_some(pair));
                map(&mut pairs[..kept])
            };
            let more = join.run_direct(left, &map, scratch);
            scratch.keep(found.append(more, max_pairs)?);
        }
        Ok(found)
    }

    /// As [`Join::run_in`], without the images of a periodic plane.
    fn run_direct(
        &self,
        max_pairs: usize,
        map: &MapPairs<'_>,
        scratch: &mut JoinScratch,
    ) -> Result<Found> {
        let JoinScratch { pairs, tasks } = scratch;
        tasks.clear();
        if !self.a.is_empty() && !self.b.is_empty() {
            self.push([0, 0], &mut |task| tasks.push(task));
        }
        let shapes = if self.is_same { self.a.len() } else { self.a.len() + self.b.len() };
        let threads = parallel::worthwhile(self.a.settings().threads, shapes);
        let _awake = parallel::keep_awake(threads, shapes, parallel::WORTH_WAKING);
        // One thread needs no tasks. The order of the pairs is the same: a task is replaced by its
        // parts in their place, and the traversal of one task visits its parts in the same order.
        if parallel::is_parallel(threads) {
            self.split(tasks);
        }
        // The kernels compare bounding boxes. Where cores are something else, the exact test follows
        // here, while the pairs of a portion are in the cache.
        let (a, b, shifts) = (self.a.columns(), self.b.columns(), [self.shift, self.other_shift]);
        let exact = |pairs: &mut [[u32; 2]]| {
            let kept = keep_overlapping(a, b, shifts, pairs);
            map(&mut pairs[..kept])
        };
        let map: &MapPairs<'_> = if a.has_cores() || b.has_cores() { &exact } else { map };
        Budget::new(max_pairs).find(threads, tasks.len(), map, pairs, |task, output| {
            let mut stack = std::mem::take(output.stack());
            stack.push(tasks[task]);
            T::with_widest(Traversal { join: self, stack: &mut stack, output });
            stack.clear();
            *output.stack() = stack;
        })
    }

    /// Replaces tasks by their parts, in order, until there are [`TASKS`].
    fn split(&self, tasks: &mut Vec<Task>) {
        // Tasks differ in size, so there are many more than threads. The division takes one thread,
        // so not far more.
        while tasks.len() < TASKS {
            let mut parts = Vec::with_capacity(4 * tasks.len());
            for &task in &*tasks {
                if self.is_leaf(task) {
                    parts.push(task);
                } else {
                    self.expand(task, &mut |part| parts.push(part));
                }
            }
            // As many as before: only leaves are left, or parts vanish as fast as they are made.
            if parts.len() == tasks.len() {
                break;
            }
            *tasks = parts;
        }
    }

    #[inline(always)]
    fn is_leaf(&self, [a, b]: Task) -> bool {
        self.a.nodes()[a as usize].is_leaf() && self.b.nodes()[b as usize].is_leaf()
    }

    #[inline(always)]
    fn expand(&self, [a, b]: Task, push: &mut impl FnMut(Task)) {
        let (node_a, node_b) = (&self.a.nodes()[a as usize], &self.b.nodes()[b as usize]);
        // Why no pair is lost or found twice: every shape is in exactly one child of a node. Of one
        // node with itself the unordered pairs of children are taken, each with itself too. So a
        // pair of shapes has one way down: as long as both are in one node, then in the one pair of
        // children that has them.
        //
        // A task is left out only if the bounds of its nodes do not overlap, and bounds overlap
        // wherever two of their shapes do.
        if self.is_same && a == b {
            for first in node_a.children() {
                for second in first..node_a.children().end {
                    self.push([first as u32, second as u32], push);
                }
            }
        // One of two different nodes is expanded, so each pair of shapes goes to one of the parts.
        } else if node_b.is_leaf() || (!node_a.is_leaf() && self.first_is_larger(a, b)) {
            for child in node_a.children() {
                self.push([child as u32, b], push);
            }
        } else {
            for child in node_b.children() {
                self.push([a, child as u32], push);
            }
        }
    }

    /// Whether to expand the first of two nodes: within one tree the node with more shapes, between
    /// two trees the wider one, because the nodes of a tree of few shapes overlap many of the
    /// other.
    #[inline(always)]
    fn first_is_larger(&self, a: u32, b: u32) -> bool {
        let (a, b) = (a as usize, b as usize);
        if self.is_same {
            // Within a tree both nodes then have about as many shapes, so leaves meet leaves. A
            // leaf against a large node would be tested against all its descendants.
            return self.a.nodes()[a].len() >= self.b.nodes()[b].len();
        }
        let width =
            |bounds: &Bounds<T>| (bounds.max[0] - bounds.min[0]).max(bounds.max[1] - bounds.min[1]);
        width(&self.a.bounds()[a]) >= width(&self.b.bounds()[b])
    }

    /// Calls `push` with a task if any two of its shapes could overlap.
    #[inline(always)]
    fn push(&self, task: Task, push: &mut impl FnMut(Task)) {
        let (a, b) = (&self.a.bounds()[task[0] as usize], &self.b.bounds()[task[1] as usize]);
        let selected =
            self.mask.is_none_or(|mask| a.category & mask != 0 && b.category & mask != 0);
        // Copied only if they are moved: this is the innermost test of the traversal.
        let moved;
        let b = if self.other_shift == [T::ZERO; 2] {
            b
        } else {
            moved = b.moved(self.other_shift);
            &moved
        };
        let overlaps = match self.filters {
            Filters::Apply => a.overlaps(b, self.shift, self.min_gap()),
            Filters::Ignore => a.overlaps_unfiltered(b, self.shift, self.min_gap()),
        };
        if selected && overlaps {
            push(task);
        }
    }

    /// The argument `min_gap` of [`Bounds::overlaps`].
    #[inline(always)]
    fn min_gap(&self) -> T {
        let boxes = self.a.columns().has_boxes() || self.b.columns().has_boxes();
        if boxes { -T::INFINITY } else { T::ZERO }
    }
}

/// Scratch of a search for pairs, kept between calls.
#[derive(Clone, Debug, Default)]
pub struct JoinScratch {
    pub(super) pairs: PairScratch,
    pub(super) tasks: Vec<Task>,
}

impl JoinScratch {
    /// Keeps the memory of a list of pairs for the result of the next call.
    pub fn keep(&mut self, pairs: Vec<[u32; 2]>) {
        self.pairs.result = pairs;
    }

    /// Allocated bytes, used or not.
    pub(super) fn memory_bytes(&self) -> usize {
        self.pairs.memory_bytes() + self.tasks.capacity() * size_of::<Task>()
    }
}

/// The traversal of the tasks on a stack, to their leaves.
struct Traversal<'a, 'b, T> {
    join: &'a Join<'a, T>,
    stack: &'a mut Vec<Task>,
    output: &'a mut Output<'b>,
}

impl<T: Scalar> Work<T> for Traversal<'_, '_, T> {
    type Out = ();

    /// Depth first, in the order of the nodes.
    #[inline(always)]
    fn run<S: Simd<T>>(self, simd: S) {
        let Self { join, stack, output } = self;
        let Join { a, b, shift, other_shift, filters, .. } = *join;
        let is_moved = [shift, other_shift] != [[T::ZERO; 2]; 2];
        let (columns_a, columns_b) = (a.columns(), b.columns());
        let kernel = Kernel { simd, a: columns_a, b: columns_b, shift, other_shift, filters };
        let mut scratch = Scratch::default();
        while let Some(task) = stack.pop() {
            if output.is_over(TASK_WORK) {
                return;
            }
            let [first, second] = task.map(|node| node as usize);
            if !join.is_leaf(task) {
                let from = stack.len();
                join.expand(task, &mut |part| stack.push(part));
                // The last part pushed is the first popped. Reversed, the parts are visited in the
                // order of the nodes, which is that of memory.
                stack[from..].reverse();
            } else if join.is_same && first == second {
                let leaf = &a.nodes()[first];
                of_kind!(kernel.within_leaf(leaf.range(), a.strips(leaf), output));
            } else {
                let bounds = [&a.bounds()[first], &b.bounds()[second]];
                // Strips are known for the places where the shapes are. For moved leaves all shapes
                // are packed by the kernel, which excludes the far ones anyway.
                let ranges = if !is_moved {
                    [a.indices_near(first, bounds[1]), b.indices_near(second, bounds[0])]
                } else {
                    [a.nodes()[first].range(), b.nodes()[second].range()]
                };
                let [range, other] = ranges;
                let first = Side { range, bounds: bounds[0] };
                let second = Side { range: other, bounds: bounds[1] };
                of_kind!(kernel.leaf_pair(&first, &second, &mut scratch, output));
            }
        }
    }
}
