//! Two trees walked together, down to leaf against leaf.

use super::kernel::{Kernel, Scratch, Side};
use super::output::{Budget, Finish, Memory, Output};
use super::{Filters, Found};
use crate::error::Result;
use crate::geometry::{Cover, Scalar};
use crate::parallel;
use crate::quadtree::Quadtree;
use crate::simd::{Simd, Work};

/// Work is cut into about this many tasks when several threads share it.
const TASKS: usize = 256;

/// Approximate number of values read for a task, in addition to its shapes.
const TASK_WORK: usize = 16;

/// Two trees to be walked together; `itself` where they are the same tree and
/// each unordered pair is wanted once.
pub(super) struct Join<'a, T> {
    pub(super) a: &'a Quadtree<T>,
    pub(super) b: &'a Quadtree<T>,
    pub(super) shift: [T; 2],
    pub(super) itself: bool,
    /// Only what has a category in it is of interest, if it is there; what else is in the
    /// same leaf comes along.
    pub(super) mask: Option<u32>,
    pub(super) filters: Filters,
}

/// A node of `a` and a node of `b` whose shapes are to be tested.
type Task = [u32; 2];

impl<'a, T: Scalar> Join<'a, T> {
    /// A tree with itself.
    pub(super) fn within(tree: &'a Quadtree<T>, mask: Option<u32>) -> Self {
        Self { itself: true, ..Self::between(tree, tree, mask) }
    }

    /// Two trees.
    pub(super) fn between(a: &'a Quadtree<T>, b: &'a Quadtree<T>, mask: Option<u32>) -> Self {
        Self { a, b, shift: [T::ZERO; 2], itself: false, mask, filters: Filters::Apply }
    }

    /// All pairs, each turned from places into what `finish` makes of it.
    pub(super) fn run(&self, max_pairs: usize, finish: &Finish<'_>) -> Result<Found> {
        self.run_in(max_pairs, finish, &mut JoinScratch::default())
    }

    /// As [`Join::run`], in the memory of earlier calls. With one thread it allocates only if the
    /// result needs more.
    pub(super) fn run_in(
        &self,
        max_pairs: usize,
        finish: &Finish<'_>,
        memory: &mut JoinScratch,
    ) -> Result<Found> {
        let JoinScratch { memory, tasks } = memory;
        tasks.clear();
        if !self.a.is_empty() && !self.b.is_empty() {
            self.push([0, 0], &mut |task| tasks.push(task));
        }
        let shapes = if self.itself { self.a.len() } else { self.a.len() + self.b.len() };
        let threads = parallel::worthwhile(self.a.settings().threads, shapes);
        if parallel::is_parallel(threads) {
            self.cut(tasks);
        }
        Budget::new(max_pairs).find(threads, tasks.len(), finish, memory, |task, output| {
            let mut stack = std::mem::take(output.stack());
            stack.push(tasks[task]);
            T::with_widest(Walk { join: self, stack: &mut stack, output });
            stack.clear();
            *output.stack() = stack;
        })
    }

    /// Replaces tasks by their parts, in place, until there are enough.
    fn cut(&self, tasks: &mut Vec<Task>) {
        while tasks.len() < TASKS {
            let mut parts = Vec::with_capacity(4 * tasks.len());
            for &task in &*tasks {
                if self.is_leaf(task) {
                    parts.push(task);
                } else {
                    self.expand(task, &mut |part| parts.push(part));
                }
            }
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
        if self.itself && a == b {
            for first in node_a.children() {
                for second in first..node_a.children().end {
                    self.push([first as u32, second as u32], push);
                }
            }
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

    /// Which of two nodes to look into: within one tree the one with more shapes, between two
    /// the wider one, or a few shapes would meet every node of many in between.
    #[inline(always)]
    fn first_is_larger(&self, a: u32, b: u32) -> bool {
        let (a, b) = (a as usize, b as usize);
        if self.itself {
            return self.a.nodes()[a].len() >= self.b.nodes()[b].len();
        }
        let width =
            |cover: &Cover<T>| (cover.max[0] - cover.min[0]).most(cover.max[1] - cover.min[1]);
        width(&self.a.covers()[a]) >= width(&self.b.covers()[b])
    }

    /// Passes a task on if any two of its shapes could overlap.
    #[inline(always)]
    fn push(&self, task: Task, push: &mut impl FnMut(Task)) {
        let (a, b) = (&self.a.covers()[task[0] as usize], &self.b.covers()[task[1] as usize]);
        let selected =
            self.mask.is_none_or(|mask| a.category & mask != 0 && b.category & mask != 0);
        let meets = match self.filters {
            Filters::Apply => a.meets(b, self.shift, self.least_gap()),
            Filters::Ignore => a.reaches(b, self.shift, self.least_gap()),
        };
        if selected && meets {
            push(task);
        }
    }

    /// The least gap that there can be between two shapes, for [`Cover::meets`].
    #[inline(always)]
    fn least_gap(&self) -> T {
        let boxes = self.a.columns().has_boxes() || self.b.columns().has_boxes();
        if boxes { -T::INFINITY } else { T::ZERO }
    }
}

/// Memory that [`Join::run_in`] keeps between calls.
#[derive(Clone, Debug, Default)]
pub struct JoinScratch {
    memory: Memory,
    tasks: Vec<Task>,
}

impl JoinScratch {
    /// Keeps the memory of some pairs for the result of the next call.
    pub fn keep(&mut self, pairs: Vec<[u32; 2]>) {
        self.memory.result = pairs;
    }
}

/// Some tasks with all their parts.
struct Walk<'a, 'b, T> {
    join: &'a Join<'a, T>,
    stack: &'a mut Vec<Task>,
    output: &'a mut Output<'b>,
}

impl<T: Scalar> Work<T> for Walk<'_, '_, T> {
    type Out = ();

    /// Goes through the parts in order.
    #[inline(always)]
    fn run<S: Simd<T>>(self, simd: S) {
        let Self { join, stack, output } = self;
        let Join { a, b, shift, filters, .. } = *join;
        let kernel = Kernel { simd, a: a.columns(), b: b.columns(), shift, filters };
        let mut scratch = Scratch::default();
        while let Some(task) = stack.pop() {
            if output.is_over(TASK_WORK) {
                return;
            }
            let [first, second] = task.map(|node| node as usize);
            if !join.is_leaf(task) {
                let from = stack.len();
                join.expand(task, &mut |part| stack.push(part));
                stack[from..].reverse();
            } else if join.itself && first == second {
                let leaf = &a.nodes()[first];
                kernel.within_leaf(leaf.range(), a.strips(leaf), output);
            } else {
                let covers = [&a.covers()[first], &b.covers()[second]];
                let ranges = if shift == [T::ZERO; 2] {
                    [a.places_near(first, covers[1]), b.places_near(second, covers[0])]
                } else {
                    [a.nodes()[first].range(), b.nodes()[second].range()]
                };
                let [range, other] = ranges;
                let first = Side { range, cover: covers[0] };
                let second = Side { range: other, cover: covers[1] };
                kernel.leaves(&first, &second, &mut scratch, output);
            }
        }
    }
}
