//! All shapes that a region overlaps.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::frontier::{Frontier, GROUP};
use super::window::Window;
use super::{NODE_WORK, QUESTIONS, along_a_curve, worthwhile};
use crate::error::{Error, Result};
use crate::geometry::{Cover, Scalar, Shape};
use crate::interrupt::{Pulse, Stop};
use crate::memory;
use crate::parallel;
use crate::quadtree::{Node, Quadtree};
use crate::simd::{LANES, Simd, Work, first_lanes, for_each_lane};
use crate::sorting;

/// Ids that are looked up at a time.
const CHUNK: usize = 1 << 14;

/// The shapes of a tree of so many are in the second-level cache anyway, and not prefetched.
const CACHED: usize = 1 << 15;

/// Most ids in one answer, a gibibyte of them.
pub const MOST_IDS: usize = 1 << 27;

/// A part of the plane that shapes may overlap.
pub trait Region<T>: Sync {
    /// Whether it is nothing but its window: a rectangle, or a disc.
    const PLAIN: bool;
    /// Something simple that holds all of it: whatever it touches touches the window.
    fn window(&self) -> Window<T>;
    /// Whether it overlaps the shape: the exact answer.
    fn touches(&self, shape: &Shape<T>) -> bool;
    /// Whether it certainly touches no shape of `cover`, which its window meets.
    fn misses(&self, cover: &Cover<T>) -> bool {
        let _ = cover;
        false
    }
}

/// Regions of one kind. The search does not depend on the kind and is compiled once.
trait Regions<T>: Sync {
    /// [`Region::PLAIN`] of the kind.
    fn are_plain(&self) -> bool;
    /// [`Region::window`] of one of them.
    fn window(&self, index: u32) -> Window<T>;
    /// [`Region::touches`] of one of them.
    fn touches(&self, index: u32, shape: &Shape<T>) -> bool;
    /// [`Region::misses`] of one of them.
    fn misses(&self, index: u32, cover: &Cover<T>) -> bool;
}

impl<T, R: Region<T>> Regions<T> for &[R] {
    fn are_plain(&self) -> bool {
        R::PLAIN
    }
    fn window(&self, index: u32) -> Window<T> {
        self[index as usize].window()
    }
    fn touches(&self, index: u32, shape: &Shape<T>) -> bool {
        self[index as usize].touches(shape)
    }
    fn misses(&self, index: u32, cover: &Cover<T>) -> bool {
        self[index as usize].misses(cover)
    }
}

/// Ids for each of many questions, one list behind the other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hits<I> {
    /// The ids of question q are `ids[offsets[q]..offsets[q + 1]]`.
    pub offsets: Vec<usize>,
    /// Ids, ascending for each question.
    pub ids: Vec<I>,
    /// Shapes tested.
    pub tests: u64,
}

impl<I> Hits<I> {
    /// No answers yet, and memory for the offsets of some questions.
    pub(crate) fn with_room_for(questions: usize) -> Result<Self> {
        let mut offsets = memory::with_room(questions + 1)?;
        offsets.push(0);
        Ok(Self { offsets, ids: Vec::new(), tests: 0 })
    }

    /// Ids of one question.
    pub fn of(&self, question: usize) -> &[I] {
        &self.ids[self.offsets[question]..self.offsets[question + 1]]
    }
}

/// Whether a question for the categories in `mask` is about what is of `category`.
#[inline(always)]
pub fn selects(mask: Option<u32>, category: u32) -> bool {
    mask.is_none_or(|mask| mask & category != 0)
}

/// The rows of all shapes that each region overlaps, ascending; only those with a category
/// in `mask`, if there is one.
pub fn search<T: Scalar, R: Region<T>>(
    tree: &Quadtree<T>,
    regions: &[R],
    mask: Option<u32>,
) -> Result<Hits<u32>> {
    let order = along_a_curve(regions.iter().map(|region| region.window().min))?;
    search_in_order(tree, &regions, &order, mask)
}

/// As [`search`], with the regions in the order in which to take them.
fn search_in_order<T: Scalar>(
    tree: &Quadtree<T>,
    regions: &dyn Regions<T>,
    order: &[u32],
    mask: Option<u32>,
) -> Result<Hits<u32>> {
    let threads = worthwhile(tree.settings().threads, order.len());
    let plain = regions.are_plain();
    let stop = Stop::current();
    let count = AtomicUsize::new(0);
    let parts: Vec<&[u32]> = order.chunks(QUESTIONS).collect();
    let found = parallel::map(threads, parts.len(), |part| {
        let (order, pulse) = (parts[part], Pulse::of(&stop));
        T::with_widest(Search { tree, regions, plain, order, mask, count: &count, pulse, len: 0 })
    });
    let count = count.into_inner();
    if count > MOST_IDS {
        return Err(Error::TooManyIds { most: MOST_IDS });
    }
    // The first part that failed may have needed little, while others held much.
    let sizes = found.iter().filter_map(|hits| hits.as_ref().err().map(Error::bytes));
    let bytes = sizes.max().unwrap_or(0).max(count * size_of::<u32>());
    let found = found.into_iter().collect::<Result<Vec<_>>>();
    together(&parts, found.map_err(|error| error.in_all(bytes))?)
}

/// Puts answers to questions in some order into the order of their numbers.
fn together(parts: &[&[u32]], mut found: Vec<Hits<u32>>) -> Result<Hits<u32>> {
    match found.len() {
        0 => return Hits::with_room_for(0),
        1 => return Ok(found.remove(0)),
        _ => {}
    }
    let mut pulse = Pulse::current();
    let questions = parts.iter().map(|part| part.len()).sum::<usize>();
    let answers = || parts.iter().zip(&found);
    let mut offsets = memory::filled(questions + 1, 0)?;
    for (part, hits) in answers() {
        for (place, &question) in part.iter().enumerate() {
            offsets[question as usize + 1] = hits.of(place).len();
        }
    }
    for question in 0..questions {
        offsets[question + 1] += offsets[question];
    }
    let mut ids = memory::zeroed(offsets[questions])?;
    for (part, hits) in answers() {
        for (place, &question) in part.iter().enumerate() {
            pulse.check(1 + hits.of(place).len())?;
            let question = question as usize;
            ids[offsets[question]..offsets[question + 1]].copy_from_slice(hits.of(place));
        }
    }
    let tests = found.iter().map(|hits| hits.tests).sum();
    Ok(Hits { offsets, ids, tests })
}

/// Some regions, asked one after the other.
struct Search<'a, T> {
    tree: &'a Quadtree<T>,
    regions: &'a dyn Regions<T>,
    plain: bool,
    order: &'a [u32],
    mask: Option<u32>,
    /// Ids found by all parts together.
    count: &'a AtomicUsize,
    pulse: Pulse,
    /// Ids found by this part; the list of them is longer.
    len: usize,
}

impl<T: Scalar> Work<T> for Search<'_, T> {
    type Out = Result<Hits<u32>>;

    #[inline(always)]
    fn run<S: Simd<T>>(mut self, simd: S) -> Result<Hits<u32>> {
        let mut hits = Hits::with_room_for(self.order.len())?;
        let (mut frontier, mut stack) = (Frontier::default(), Vec::new());
        let (mut ends, mut nodes) = (Vec::new(), Vec::new());
        for group in self.order.chunks(GROUP) {
            let windows = group.iter().map(|&question| self.regions.window(question));
            match windows.reduce(Window::join) {
                // What comes now is not asked for any more.
                Some(_) if self.count.load(Ordering::Relaxed) > MOST_IDS => frontier.len = 0,
                Some(window) => frontier.fill(self.tree, &window),
                None => {}
            }
            ends.clear();
            nodes.clear();
            for &question in group {
                self.find(simd, question, &frontier, &mut stack, &mut nodes)?;
                ends.push(nodes.len());
            }
            let (before, mut from) = (self.len, 0);
            for (&question, &end) in group.iter().zip(&ends) {
                self.answer(simd, question, &nodes[from..end], &mut hits).map_err(|error| {
                    let new = hits.offsets[hits.offsets.len() - 1] - before;
                    error.in_all((self.count.load(Ordering::Relaxed) + new) * size_of::<u32>())
                })?;
                from = end;
            }
            self.count.fetch_add(self.len - before, Ordering::Relaxed);
        }
        hits.ids.truncate(self.len);
        Ok(hits)
    }
}

impl<T: Scalar> Search<'_, T> {
    /// Adds the nodes in which one question finds something: leaves, and those that it
    /// takes as a whole. It begins at those of `frontier`.
    #[inline(always)]
    fn find<S: Simd<T>>(
        &mut self,
        simd: S,
        question: u32,
        frontier: &Frontier<T>,
        stack: &mut Vec<u32>,
        found: &mut Vec<u32>,
    ) -> Result<()> {
        let window = self.regions.window(question);
        for first in (0..frontier.len).step_by(LANES) {
            let bits = frontier.lanes(simd, &window, first) & first_lanes(frontier.len - first);
            for_each_lane(bits, |lane| {
                let node = frontier.nodes[first + lane];
                let cover = &self.tree.covers()[node as usize];
                if selects(self.mask, cover.category) && !self.misses(question, cover) {
                    stack.push(node);
                }
            });
        }
        while let Some(index) = stack.pop() {
            self.pulse.check(NODE_WORK)?;
            let node = &self.tree.nodes()[index as usize];
            if node.is_leaf() || self.takes_all(&window, index as usize) {
                memory::push(found, index)?;
                self.expect(simd, node);
                continue;
            }
            for child in node.children() {
                let cover = &self.tree.covers()[child];
                let near = selects(self.mask, cover.category) & window.meets(cover);
                if near && !self.misses(question, cover) {
                    stack.push(child as u32);
                }
            }
        }
        Ok(())
    }

    /// Prefetches what will be read of a leaf.
    #[inline(always)]
    fn expect<S: Simd<T>>(&self, simd: S, node: &Node) {
        if node.is_leaf() && self.tree.len() > CACHED {
            let shapes = self.tree.columns();
            simd.expect(&shapes.x[node.range()]);
            simd.expect(&shapes.y[node.range()]);
            simd.expect(&self.tree.rows()[node.range()]);
        }
    }

    /// Adds the answer to one question, from the nodes in which there is something.
    #[inline(always)]
    fn answer<S: Simd<T>>(
        &mut self,
        simd: S,
        question: u32,
        nodes: &[u32],
        hits: &mut Hits<u32>,
    ) -> Result<()> {
        let start = self.len;
        let window = self.regions.window(question);
        for &index in nodes {
            let places = self.tree.nodes()[index as usize].range();
            let room = room(&mut hits.ids, self.len, places.len())?;
            if self.takes_all(&window, index as usize) {
                self.pulse.check(places.len())?;
                self.len += places.len();
                room.iter_mut().zip(places).for_each(|(to, place)| *to = place as u32);
            } else {
                hits.tests += places.len() as u64;
                self.collect(simd, (question, &window), index as usize, room)?;
            }
        }
        let (rows, found) = (self.tree.rows(), &mut hits.ids[start..self.len]);
        for places in found.chunks_mut(CHUNK) {
            self.pulse.check(places.len())?;
            places.iter_mut().for_each(|place| *place = rows[*place as usize]);
        }
        sort(found, &mut self.pulse)?;
        hits.offsets.push(self.len);
        Ok(())
    }

    /// As [`Region::misses`]; of a plain region the window says it all.
    #[inline(always)]
    fn misses(&self, question: u32, cover: &Cover<T>) -> bool {
        !self.plain && self.regions.misses(question, cover)
    }

    /// Whether a region overlaps every shape in a node. Where a category can hide a shape,
    /// each has to be looked at.
    #[inline(always)]
    fn takes_all(&self, window: &Window<T>, node: usize) -> bool {
        self.plain && self.mask.is_none() && window.holds(&self.tree.covers()[node])
    }

    /// Writes the places of the shapes in a leaf that one region overlaps.
    #[inline(always)]
    fn collect<S: Simd<T>>(
        &mut self,
        simd: S,
        (question, window): (u32, &Window<T>),
        leaf: usize,
        room: &mut [u32],
    ) -> Result<()> {
        let shapes = self.tree.columns();
        let places = self.tree.nodes()[leaf].range();
        let round = self.tree.covers()[leaf].radius > T::ZERO;
        let mut count = 0;
        for first in places.clone().step_by(LANES) {
            self.pulse.check(LANES)?;
            let bits = window.lanes(simd, shapes, first, (round, self.plain));
            let mut bits = bits & first_lanes(places.end - first);
            if !self.plain || self.mask.is_some() {
                for lane in 0..LANES {
                    if bits >> lane & 1 != 0 {
                        let shape = shapes.shape_if(first + lane, round);
                        let hit = selects(self.mask, shape.category)
                            && (self.plain || self.regions.touches(question, &shape));
                        bits ^= u32::from(!hit) << lane;
                    }
                }
            }
            let to = room[count..].first_chunk_mut().expect("there is room for a block more");
            simd.pack_places(first as u32, bits, to);
            count += bits.count_ones() as usize;
        }
        self.len += count;
        Ok(())
    }
}

/// Room for `more` ids behind the first `len`, and for a block.
#[inline(always)]
fn room(ids: &mut Vec<u32>, len: usize, more: usize) -> Result<&mut [u32]> {
    let needed = len + more + LANES;
    if ids.len() < needed {
        memory::reserve(ids, needed - ids.len())?;
        ids.resize(ids.capacity(), 0);
    }
    Ok(&mut ids[len..])
}

/// Sorts different numbers; a few of them without a branch that depends on their order.
#[inline(always)]
fn sort(ids: &mut [u32], pulse: &mut Pulse) -> Result<()> {
    if ids.len() > LANES {
        return sorting::sort(ids, pulse);
    }
    let mut all = [0; LANES];
    all[..ids.len()].copy_from_slice(ids);
    let mut ranks = [0u32; LANES];
    for &id in &all[..ids.len()] {
        for (rank, other) in ranks.iter_mut().zip(&all) {
            *rank += u32::from(id < *other);
        }
    }
    for (id, rank) in all[..ids.len()].iter().zip(ranks) {
        ids[rank as usize] = *id;
    }
    Ok(())
}
