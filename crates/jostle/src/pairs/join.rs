//! Two trees walked together, down to leaf against leaf.

use super::Found;
use super::kernel::{Block, Wanted};
use super::output::{Budget, Output};
use crate::error::Result;
use crate::geometry::Scalar;
use crate::parallel;
use crate::quadtree::Quadtree;
use crate::simd;

/// Work is cut into about this many tasks when several threads share it.
const TASKS: usize = 256;

/// Two trees with fewer shapes than this together are joined by one thread: to wake
/// another one costs more than it would save.
const WORTHWHILE: usize = 32_768;

/// Two trees to be walked together; `itself` where they are the same tree and
/// each unordered pair is wanted once.
pub(super) struct Join<'a, T> {
    pub(super) a: &'a Quadtree<T>,
    pub(super) b: &'a Quadtree<T>,
    pub(super) shift: [T; 2],
    pub(super) itself: bool,
}

/// A node of `a` and a node of `b` whose shapes are to be tested.
type Task = (u32, u32);

impl<T: Scalar> Join<'_, T> {
    pub(super) fn run(&self, max_pairs: usize) -> Result<Found> {
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
