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
    parts: Vec<Part<T>>,
    /// The part of each subtree, and its number in it.
    found: Vec<[u32; 2]>,
}

/// The subtrees that one thread has made.
#[derive(Clone, Debug, Default)]
pub(super) struct Part<T> {
    pub nodes: Vec<Node>,
    pub strips: Vec<Strips<T>>,
    pub ends: Vec<u32>,
    pub scratch: strips::Scratch,
    subtrees: Vec<Subtree>,
}

/// The subtree of one task: its ranges of the nodes, strips and ends of a [`Part`].
#[derive(Clone, Debug)]
pub(super) struct Subtree {
    task: usize,
    pub nodes: Range<usize>,
    pub strips: Range<usize>,
    pub ends: Range<usize>,
}

impl<T: Clone + Default + Send> Subtrees<T> {
    /// Makes a subtree of each leaf of `nodes`. `add` appends one to a part, and writes its shapes to the
    /// outputs.
    pub(super) fn build(
        &mut self,
        threads: Option<usize>,
        nodes: &[Node],
        mut outputs: Outputs<'_, T>,
        add: impl Fn(&mut Part<T>, Node, Outputs<'_, T>) -> Result<()> + Sync + Send,
    ) -> Result<()> {
        let Self { roots, parts, .. } = self;
        roots.clear();
        roots.extend((0..nodes.len() as u32).filter(|&node| nodes[node as usize].is_leaf()));
        roots.sort_unstable_by_key(|&node| nodes[node as usize].start);
        parts.iter_mut().for_each(Part::clear);
        let failed = Mutex::new(Ok(()));
        let idle = Mutex::new(parts);
        // The outputs are cut at the ends of the subtrees, which are in the order of their shapes.
        // So each task owns the part of the columns that it writes.
        let mut tasks = roots.iter().enumerate().map(|(task, &root)| {
            let root = nodes[root as usize];
            (task, root, outputs.split_off(root.len()))
        });
        parallel::for_each(threads, &mut tasks, |(task, root, outputs)| {
            // A thread appends all its subtrees to one part: as many lists as threads, not as
            // subtrees. Their memory is kept for the next tree.
            let mut part = locked(&idle).pop().unwrap_or_default();
            let start = [part.nodes.len(), part.strips.len(), part.ends.len()];
            if let Err(error) = add(&mut part, root, outputs) {
                *locked(&failed) = Err(error);
            }
            // After an error, too: the ranges of the part stay valid, and the whole tree is cleared
            // afterwards.
            part.end_subtree(task, start);
            locked(&idle).push(part);
        });
        failed.into_inner().unwrap_or_else(PoisonError::into_inner)?;
        self.find_all()
    }

    /// Finds the subtree of each task.
    fn find_all(&mut self) -> Result<()> {
        let Self { roots, parts, found } = self;
        memory::resize(found, roots.len(), [0; 2])?;
        for (part, of) in (0..).zip(parts) {
            for (number, subtree) in (0..).zip(&of.subtrees) {
                found[subtree.task] = [part, number];
            }
        }
        Ok(())
    }

    /// The root of each subtree, the subtree and its part, in the order of their shapes.
    pub(super) fn iter(&self) -> impl Iterator<Item = (u32, &Subtree, &Part<T>)> {
        self.roots.iter().zip(&self.found).map(|(&root, &[part, number])| {
            let part = &self.parts[part as usize];
            (root, &part.subtrees[number as usize], part)
        })
    }

    /// Numbers of nodes, of strips and of ends of all subtrees.
    pub(super) fn sizes(&self) -> [usize; 3] {
        let add = |sum: [usize; 3], part: &Part<T>| {
            [sum[0] + part.nodes.len(), sum[1] + part.strips.len(), sum[2] + part.ends.len()]
        };
        self.parts.iter().fold([0; 3], add)
    }

    /// Allocated bytes, used or not.
    pub(super) fn memory_bytes(&self) -> usize {
        let part = |part: &Part<T>| {
            part.nodes.capacity() * size_of::<Node>()
                + part.strips.capacity() * size_of::<Strips<T>>()
                + part.ends.capacity() * size_of::<u32>()
        };
        self.parts.iter().map(part).sum()
    }
}

impl<T> Part<T> {
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
