//! The subtrees of a large tree, each made by one task.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use super::Node;
use super::strips::{self, Outputs, Strips};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_base::parallel::{self, locked};

/// The subtrees below the upper nodes of a tree. Kept between trees for its memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Subtrees<T> {
    /// The upper nodes without children, in the order of their shapes: the root of each subtree.
    roots: Vec<u32>,
    by_thread: Vec<ThreadSubtrees<T>>,
    /// The entry of `by_thread` with each subtree, and its number in it.
    found: Vec<[u32; 2]>,
}

/// The subtrees that one thread has made.
#[derive(Clone, Debug, Default)]
pub(super) struct ThreadSubtrees<T> {
    pub nodes: Vec<Node>,
    pub strips: Vec<Strips<T>>,
    pub ends: Vec<u32>,
    pub scratch: strips::Scratch,
    subtrees: Vec<Subtree>,
}

/// The subtree of one task: its ranges of the nodes, strips and ends of a [`ThreadSubtrees`].
#[derive(Clone, Debug)]
pub(super) struct Subtree {
    task: usize,
    pub nodes: Range<usize>,
    pub strips: Range<usize>,
    pub ends: Range<usize>,
}

impl<T: Clone + Default + Send> Subtrees<T> {
    /// Makes a subtree of each leaf of `nodes`. `add` appends one to those of a thread, and
    /// writes its shapes to the outputs.
    pub(super) fn build(
        &mut self,
        threads: Option<usize>,
        nodes: &[Node],
        mut outputs: Outputs<'_, T>,
        add: impl Fn(&mut ThreadSubtrees<T>, Node, Outputs<'_, T>) -> Result<()> + Sync + Send,
    ) -> Result<()> {
        let Self { roots, by_thread, .. } = self;
        roots.clear();
        roots.extend((0..nodes.len() as u32).filter(|&node| nodes[node as usize].is_leaf()));
        roots.sort_unstable_by_key(|&node| nodes[node as usize].start);
        by_thread.iter_mut().for_each(ThreadSubtrees::clear);
        let failed = Mutex::new(Ok(()));
        let idle = Mutex::new(by_thread);
        // The outputs are cut at the ends of the subtrees, which are in the order of their shapes.
        // So each task owns the part of the columns that it writes.
        let mut tasks = roots.iter().enumerate().map(|(task, &root)| {
            let root = nodes[root as usize];
            (task, root, outputs.split_off(root.len()))
        });
        parallel::for_each(threads, &mut tasks, |(task, root, outputs)| {
            // A thread appends all its subtrees to one entry: as many lists as threads, not as
            // subtrees. Their memory is kept for the next tree.
            let mut thread = locked(&idle).pop().unwrap_or_default();
            let start = [thread.nodes.len(), thread.strips.len(), thread.ends.len()];
            if let Err(error) = add(&mut thread, root, outputs) {
                *locked(&failed) = Err(error);
            }
            // After an error, too: the ranges stay valid, and the whole tree is cleared
            // afterwards.
            thread.end_subtree(task, start);
            locked(&idle).push(thread);
        });
        failed.into_inner().unwrap_or_else(PoisonError::into_inner)?;
        self.find_all()
    }

    /// Finds the subtree of each task.
    fn find_all(&mut self) -> Result<()> {
        let Self { roots, by_thread, found } = self;
        memory::resize(found, roots.len(), [0; 2])?;
        for (index, thread) in (0..).zip(by_thread) {
            for (number, subtree) in (0..).zip(&thread.subtrees) {
                found[subtree.task] = [index, number];
            }
        }
        Ok(())
    }

    /// The root of each subtree, the subtree and the entry that has it, in the order of their shapes.
    pub(super) fn iter(&self) -> impl Iterator<Item = (u32, &Subtree, &ThreadSubtrees<T>)> {
        self.roots.iter().zip(&self.found).map(|(&root, &[index, number])| {
            let thread = &self.by_thread[index as usize];
            (root, &thread.subtrees[number as usize], thread)
        })
    }

    /// Numbers of nodes, of strips and of ends of all subtrees.
    pub(super) fn sizes(&self) -> [usize; 3] {
        let add = |sum: [usize; 3], thread: &ThreadSubtrees<T>| {
            [sum[0] + thread.nodes.len(), sum[1] + thread.strips.len(), sum[2] + thread.ends.len()]
        };
        self.by_thread.iter().fold([0; 3], add)
    }

    /// Allocated bytes, used or not.
    pub(super) fn memory_bytes(&self) -> usize {
        let bytes = |thread: &ThreadSubtrees<T>| {
            thread.nodes.capacity() * size_of::<Node>()
                + thread.strips.capacity() * size_of::<Strips<T>>()
                + thread.ends.capacity() * size_of::<u32>()
        };
        self.by_thread.iter().map(bytes).sum()
    }
}

impl<T> ThreadSubtrees<T> {
    fn clear(&mut self) {
        self.nodes.clear();
        self.strips.clear();
        self.ends.clear();
        self.subtrees.clear();
    }

    /// Lists the subtree of a task, which begins at these numbers of nodes, strips and ends.
    fn end_subtree(&mut self, task: usize, [nodes, strips, ends]: [usize; 3]) {
        self.subtrees.push(Subtree {
            task,
            nodes: nodes..self.nodes.len(),
            strips: strips..self.strips.len(),
            ends: ends..self.ends.len(),
        });
    }
}
