//! Neighbours within a cutoff, for forces of short range.
//!
//! The bodies are sorted by a tree of their own. In its order, every [`LANES`] bodies are a block.
//! For each group of bodies, the tree gives the blocks that may have neighbours. The neighbours of
//! a body are then packed into dense columns, in the order of blocks and bodies. So a law sums them
//! in an order that depends only on the state, and not on the blocks that were tested in vain.

use std::sync::Mutex;

use super::sorted::Sorted;
use super::{ForceInput, total_of};
use jostle_base::error::Result;
use jostle_base::interrupt::Stop;
use jostle_base::parallel::{self, locked};
use jostle_base::settings::Method;
use jostle_base::{memory, reserve};
use jostle_index::period::{NINE_IMAGES, Period};
use jostle_index::quadtree::Quadtree;
use jostle_simd::{LANES, Number, Simd, Work, block, block_mut};

/// Maximum number of bodies in a group.
const MAX_GROUP: usize = 32;

/// Number of groups in a task.
const TASK_GROUPS: usize = 16;

/// Minimum number of bodies for which threads that are awake are used, and are woken.
const WORTH_SHARING: usize = 512;
const WORTH_WAKING: usize = 2048;

/// Maximum number of columns that a law reads in addition to positions.
const COLUMNS: usize = 3;

/// The effect of its neighbours on a body.
pub trait Law: Sync {
    /// The force or acceleration on the body at an index of the columns. Must be inlined.
    fn act<S: Simd<f32>>(&self, simd: S, own: Own<'_>, found: &Found) -> [f64; 2];
}

/// A body, as an index of the columns of a law.
#[derive(Clone, Copy, Debug)]
pub struct Own<'a> {
    index: usize,
    columns: &'a [Vec<f32>],
}

impl Own<'_> {
    /// Its number in the column `k`.
    #[inline(always)]
    pub fn of(self, k: usize) -> f32 {
        self.columns[k][self.index]
    }
}

/// The neighbours of a body, with itself: dense columns whose last block is filled up with the
/// numbers of the body, and offsets of 0.
#[derive(Debug, Default)]
pub struct Found {
    /// Offsets from the body.
    pub x: Vec<f32>,
    /// Offsets from the body.
    pub y: Vec<f32>,
    /// The other columns of the law.
    pub columns: [Vec<f32>; COLUMNS],
    /// Number of neighbours.
    pub len: usize,
}

/// Scratch of all forces of short range in one evaluation: the bodies in the order of a tree.
#[derive(Debug, Default)]
pub struct Scratch {
    sorted: Sorted,
    x: Vec<f32>,
    y: Vec<f32>,
    /// The columns of the current law.
    columns: [Vec<f32>; COLUMNS],
    sums: Vec<[f64; 2]>,
    lists: Mutex<Vec<List>>,
}

/// A block that may have neighbours of a group, at one image.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Near {
    block: u32,
    /// Offset of the image.
    image: [f32; 2],
}

/// Scratch of one thread.
#[derive(Debug, Default)]
struct List {
    near: Vec<Near>,
    stack: Vec<u32>,
    found: Found,
}

impl Scratch {
    /// Sorts the bodies.
    pub fn sort(&mut self, bodies: &ForceInput<'_>) -> Result<()> {
        // Only positions, velocities, masses and kinds enter the sums, so only these order bodies
        // at the same place.
        self.sorted.sort(bodies, MAX_GROUP, &|a, b| bodies.compare(a, b))?;
        let (tree, len) = (&self.sorted.tree, self.sorted.tree.len());
        let columns = tree.columns();
        for (to, from) in [(&mut self.x, &columns.x), (&mut self.y, &columns.y)] {
            reserve!(len.next_multiple_of(LANES); *to);
            to.clear();
            to.extend_from_slice(&from[..len]);
            // The bodies after the last are no neighbours.
            to.resize(len.next_multiple_of(LANES), f32::NAN);
        }
        Ok(())
    }

    /// Fills the column `k` of the next law; `value` returns the number of a row.
    pub fn fill(&mut self, k: usize, value: impl Fn(usize) -> f32) -> Result<()> {
        let column = &mut self.columns[k];
        column.clear();
        reserve!(self.x.len(); *column);
        column.extend(self.sorted.tree.rows().iter().map(|&row| value(row as usize)));
        column.resize(self.x.len(), 0.0);
        Ok(())
    }

    /// The columns of the law in the order of the tree.
    pub fn columns(&self) -> &[Vec<f32>; COLUMNS] {
        &self.columns
    }

    /// Calls `add` with each row and the result of the law for it. `count` is the number of columns
    /// of the law.
    pub fn sum<L: Law>(
        &mut self,
        bodies: &ForceInput<'_>,
        cutoff: f32,
        count: usize,
        law: &L,
        mut add: impl FnMut(usize, [f64; 2]),
    ) -> Result<()> {
        let mut sums = std::mem::take(&mut self.sums);
        sums.clear();
        memory::resize(&mut sums, self.sorted.tree.len(), [0.0; 2])?;
        // The order of a sum follows from the state alone: blocks in Morton order, the images of a
        // block in the order of the nine, the bodies in a block. Blocks that are tested in vain
        // leave no trace in it, because neighbours are packed first. So the tree and brute force
        // give the same bits.
        let search = self.search(bodies, cutoff, count);
        let tasks = self.sorted.tasks(TASK_GROUPS, &mut sums);
        let (threads, stop) = (threads(bodies), Stop::current());
        parallel::try_for_each(threads, tasks, |(groups, sums)| {
            // An interruption is reported by the caller, which then does not use the sums.
            if stop.is_set() {
                return Ok(());
            }
            let mut list = locked(&self.lists).pop().unwrap_or_default();
            let done = f32::with_widest(Share { search, law, groups, sums, list: &mut list });
            locked(&self.lists).push(list);
            done
        })?;
        // The tasks write sums in the order of the tree; one thread hands them to the rows.
        sums.iter().zip(self.sorted.tree.rows()).for_each(|(&sum, &row)| add(row as usize, sum));
        self.sums = sums;
        Ok(())
    }

    /// The sums of `value` over all ordered pairs of neighbours: it gets their indices and the offset
    /// from the first to the second.
    pub fn sum_of_pairs<const N: usize>(
        &self,
        bodies: &ForceInput<'_>,
        cutoff: f32,
        value: impl Fn([usize; 2], [f64; 2]) -> [f64; N] + Sync + Send,
    ) -> Result<[f64; N]> {
        let search = self.search(bodies, cutoff, 0);
        let groups = &self.sorted.groups;
        let stop = Stop::current();
        let mut parts = memory::filled(groups.len(), [0.0; N])?;
        let tasks = parts.iter_mut().zip(groups);
        parallel::try_for_each(threads(bodies), tasks, |(part, &group)| {
            if stop.is_set() {
                return Ok(());
            }
            let mut list = List::default();
            search.list(group, &mut list)?;
            let own = |index| search.sum_of_body(index, &list.near, &value);
            *part = total_of(self.sorted.range(group).map(own));
            Ok(())
        })?;
        Ok(total_of(parts.into_iter()))
    }

    fn search(&self, bodies: &ForceInput<'_>, cutoff: f32, count: usize) -> Search<'_> {
        Search {
            tree: &self.sorted.tree,
            x: &self.x,
            y: &self.y,
            columns: &self.columns[..count],
            period: bodies.container.period(),
            square: cutoff * cutoff,
            is_brute: bodies.method == Method::Brute,
        }
    }
}

fn threads(bodies: &ForceInput<'_>) -> Option<usize> {
    let len = bodies.positions.len();
    parallel::threads_for(bodies.threads, len, WORTH_SHARING, WORTH_WAKING)
}

/// The input of a search.
#[derive(Clone, Copy)]
struct Search<'a> {
    tree: &'a Quadtree<f32>,
    x: &'a [f32],
    y: &'a [f32],
    columns: &'a [Vec<f32>],
    period: Period<f32>,
    /// Of the cutoff.
    square: f32,
    is_brute: bool,
}

impl Search<'_> {
    /// Lists the blocks that may have neighbours of a group.
    fn list(&self, group: u32, list: &mut List) -> Result<()> {
        list.near.clear();
        // A group near a corner may have neighbours in any of the nine images of the torus.
        if !self.period.is_none() {
            for turns in NINE_IMAGES {
                self.list_image(group, self.period.span(turns), list)?;
            }
            // Stable, so that the images of a block stay in order.
            if !list.near.is_sorted_by_key(|near| near.block) {
                list.near.sort_by_key(|near| near.block);
            }
        } else {
            self.list_image(group, [0.0; 2], list)?;
        }
        Ok(())
    }

    fn list_image(&self, group: u32, image: [f32; 2], list: &mut List) -> Result<()> {
        let List { near, stack, .. } = list;
        if self.is_brute {
            let blocks = 0..(self.x.len() / LANES) as u32;
            return memory::extend(near, blocks.map(|block| Near { block, image }));
        }
        // Blocks are sixteen bodies of the sorted columns, whatever the leaves. Two leaves may
        // share a block, which must be listed once, or its bodies would count twice.
        let mut next = 0;
        stack.clear();
        memory::push(stack, 0)?;
        while let Some(number) = stack.pop() {
            let node = &self.tree.nodes()[number as usize];
            if !self.is_near(group, number, image) {
                continue;
            }
            if !node.is_leaf() {
                // In reverse order, so that leaves and blocks are listed in ascending order.
                memory::extend(stack, node.children().rev().map(|child| child as u32))?;
                continue;
            }
            let range = node.range();
            let [first, last] = [range.start, range.end - 1].map(|index| (index / LANES) as u32);
            let blocks = first.max(next)..last + 1;
            memory::extend(near, blocks.map(|block| Near { block, image }))?;
            next = next.max(last + 1);
        }
        Ok(())
    }

    /// Whether an image of a node may have neighbours of a group. The test rounds as that of two
    /// bodies does, and rounding is monotone, so it needs no tolerance.
    #[inline]
    fn is_near(&self, group: u32, node: u32, image: [f32; 2]) -> bool {
        let [target, source] = [group, node].map(|index| &self.tree.bounds()[index as usize]);
        let [x, y] = [0, 1].map(|k| {
            let above = (source.min[k] - target.max[k]) + image[k];
            let below = (target.min[k] - source.max[k]) - image[k];
            above.max(below).max(0.0)
        });
        x * x + y * y < self.square
    }

    /// Packs the neighbours of the body at `index` into columns.
    #[inline(always)]
    fn collect<S: Simd<f32>>(&self, simd: S, index: usize, near: &[Near], found: &mut Found) {
        let (own_x, own_y) = (simd.splat(self.x[index]), simd.splat(self.y[index]));
        let limit = simd.splat(self.square);
        let mut len = 0;
        for &Near { block: number, image } in near {
            // First the difference, then the image, as in `is_near`. In another order of operations
            // a neighbour could lie in a block that was not listed.
            let start = number as usize * LANES;
            let x = simd.sub(simd.load(block(self.x, start)), own_x);
            let y = simd.sub(simd.load(block(self.y, start)), own_y);
            let (x, y) = (simd.add(x, simd.splat(image[0])), simd.add(y, simd.splat(image[1])));
            let bits = simd.less(simd.add(simd.mul(x, x), simd.mul(y, y)), limit);
            if bits == 0 {
                continue;
            }
            // `pack` writes a whole block. Numbers behind the packed ones are overwritten by the
            // next block.
            simd.pack(x, bits, block_mut(&mut found.x, len));
            simd.pack(y, bits, block_mut(&mut found.y, len));
            for (from, to) in self.columns.iter().zip(&mut found.columns) {
                simd.pack(simd.load(block(from, start)), bits, block_mut(to, len));
            }
            len += bits.count_ones() as usize;
        }
        found.len = len;
        *block_mut(&mut found.x, len) = [0.0; LANES];
        *block_mut(&mut found.y, len) = [0.0; LANES];
        // So that differences from its own numbers are 0.
        for (from, to) in self.columns.iter().zip(&mut found.columns) {
            *block_mut(to, len) = [from[index]; LANES];
        }
    }

    /// The sums of `value` over the neighbours of a body.
    fn sum_of_body<const N: usize>(
        &self,
        index: usize,
        near: &[Near],
        value: impl Fn([usize; 2], [f64; 2]) -> [f64; N],
    ) -> [f64; N] {
        let mut sum = [0.0; N];
        for &Near { block: number, image } in near {
            let start = number as usize * LANES;
            // A body does not act on itself.
            for other in (start..start + LANES).filter(|&other| other != index) {
                let x = (self.x[other] - self.x[index]) + image[0];
                let y = (self.y[other] - self.y[index]) + image[1];
                if x * x + y * y < self.square {
                    let own = value([index, other], [x, y].map(f64::from));
                    sum = total_of([sum, own].into_iter());
                }
            }
        }
        sum
    }
}

impl Found {
    /// Reserves memory for the neighbours in so many blocks.
    fn reserve(&mut self, blocks: usize) -> Result<()> {
        // One more block, because `pack` writes a whole one at any place.
        let len = (blocks + 1) * LANES;
        for column in [&mut self.x, &mut self.y].into_iter().chain(&mut self.columns) {
            memory::lengthen(column, len, 0.0)?;
        }
        Ok(())
    }
}

/// The work of one task.
struct Share<'a, L> {
    search: Search<'a>,
    law: &'a L,
    groups: &'a [u32],
    sums: &'a mut [[f64; 2]],
    list: &'a mut List,
}

impl<L: Law> Work<f32> for Share<'_, L> {
    type Out = Result<()>;

    #[inline(always)]
    fn run<S: Simd<f32>>(self, simd: S) -> Result<()> {
        let Self { search, law, groups, sums, list } = self;
        let mut sums = sums.iter_mut();
        for &group in groups {
            search.list(group, list)?;
            let List { near, found, .. } = &mut *list;
            found.reserve(near.len())?;
            for index in search.tree.nodes()[group as usize].range() {
                search.collect(simd, index, near, found);
                let own = Own { index, columns: search.columns };
                let sum = law.act(simd, own, found);
                *sums.next().expect("one for each body") = sum;
            }
        }
        Ok(())
    }
}

/// The numbers of a block added in order, in float64.
#[inline(always)]
pub fn total<S: Simd<f32>>(simd: S, numbers: S::Block) -> f64 {
    // Lane by lane: a tree of sums in vector instructions would have another order on another
    // machine.
    let mut lanes = [0.0f32; LANES];
    simd.store(numbers, &mut lanes);
    let mut sum = 0.0;
    for lane in lanes {
        sum += f64::from(lane);
    }
    sum
}
