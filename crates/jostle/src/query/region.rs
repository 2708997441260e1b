//! All shapes that a region overlaps.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::{QUESTIONS, along_a_curve, worthwhile};
use crate::columns::Columns;
use crate::error::{Error, Result};
use crate::geometry::{Cover, Scalar, Shape};
use crate::parallel;
use crate::quadtree::Quadtree;
use crate::simd::{LANES, Simd, Work, block, first_lanes, for_each_lane};

/// Most ids in one answer, a gibibyte of them.
pub const MOST_IDS: usize = 1 << 27;

/// A rectangle and a distance from it: what lies beyond touches nothing in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window<T> {
    pub(super) min: [T; 2],
    pub(super) max: [T; 2],
    pub(super) radius: T,
}

impl<T: Scalar> Window<T> {
    /// How far each axis of a shape with this centre and half size lies outside;
    /// negative inside.
    #[inline(always)]
    pub(super) fn gap(&self, center: [T; 2], half_size: [T; 2]) -> [T; 2] {
        let along = |axis: usize| {
            let below = self.min[axis] - center[axis];
            let above = center[axis] - self.max[axis];
            below.most(above) - half_size[axis]
        };
        [along(0), along(1)]
    }

    /// Whether some shape of `cover` could touch it.
    #[inline(always)]
    fn meets(&self, cover: &Cover<T>) -> bool {
        let beyond = |axis: usize| {
            let below = self.min[axis] - cover.max[axis];
            let above = cover.min[axis] - self.max[axis];
            (below.most(above) - cover.half_size[axis]).most(T::ZERO)
        };
        let (x, y) = (beyond(0), beyond(1));
        let reach = self.radius + cover.radius;
        x * x + y * y <= reach * reach
    }

    /// Whether every shape whose centre is in `cover` overlaps it, however small.
    #[inline(always)]
    fn holds(&self, cover: &Cover<T>) -> bool {
        let beyond =
            |axis: usize| (self.min[axis] - cover.min[axis]).most(cover.max[axis] - self.max[axis]);
        let (dx, dy) = (beyond(0), beyond(1));
        let (x, y) = (dx.most(T::ZERO), dy.most(T::ZERO));
        (x * x + y * y < self.radius * self.radius) | ((dx < T::ZERO) & (dy < T::ZERO))
    }

    /// A bit for each shape of a block that could touch it.
    #[inline(always)]
    fn lanes<S: Simd<T>>(&self, simd: S, shapes: &Columns<T>, first: usize, round: bool) -> u32 {
        let x = self.beyond(simd, 0, &shapes.x, &shapes.half_x, first);
        let y = self.beyond(simd, 1, &shapes.y, &shapes.half_y, first);
        let mut reach = simd.splat(self.radius);
        if round {
            reach = simd.add(reach, simd.load(block(&shapes.radius, first)));
        }
        !simd.less(simd.mul(reach, reach), simd.add(simd.mul(x, x), simd.mul(y, y)))
    }

    /// How far the shapes of a block lie outside along one axis; 0 inside.
    #[inline(always)]
    fn beyond<S: Simd<T>>(
        &self,
        simd: S,
        axis: usize,
        centers: &[T],
        half_sizes: &[T],
        first: usize,
    ) -> S::Block {
        let center = simd.load(block(centers, first));
        let below = simd.sub(simd.splat(self.min[axis]), center);
        let above = simd.sub(center, simd.splat(self.max[axis]));
        let mut gap = simd.most(below, above);
        if !half_sizes.is_empty() {
            gap = simd.sub(gap, simd.load(block(half_sizes, first)));
        }
        simd.most(gap, simd.splat(T::ZERO))
    }
}

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
    let threads = worthwhile(tree.settings().threads, regions.len());
    let order = along_a_curve(regions.iter().map(|region| region.window().min));
    let count = AtomicUsize::new(0);
    let parts: Vec<&[u32]> = order.chunks(QUESTIONS).collect();
    let found = parallel::map(threads, parts.len(), |part| {
        T::with_widest(Search { tree, regions, order: parts[part], mask, count: &count })
    });
    if count.into_inner() > MOST_IDS {
        return Err(Error::TooManyIds { most: MOST_IDS });
    }
    Ok(together(&parts, found))
}

/// Puts answers to questions in some order into the order of their numbers.
fn together(parts: &[&[u32]], mut found: Vec<Hits<u32>>) -> Hits<u32> {
    match found.len() {
        0 => return Hits { offsets: vec![0], ids: Vec::new(), tests: 0 },
        1 => return found.remove(0),
        _ => {}
    }
    let questions = parts.iter().map(|part| part.len()).sum::<usize>();
    let answers = || parts.iter().zip(&found);
    let mut offsets = vec![0; questions + 1];
    for (part, hits) in answers() {
        for (place, &question) in part.iter().enumerate() {
            offsets[question as usize + 1] = hits.of(place).len();
        }
    }
    for question in 0..questions {
        offsets[question + 1] += offsets[question];
    }
    let mut ids = vec![0; offsets[questions]];
    for (part, hits) in answers() {
        for (place, &question) in part.iter().enumerate() {
            let question = question as usize;
            ids[offsets[question]..offsets[question + 1]].copy_from_slice(hits.of(place));
        }
    }
    let tests = found.iter().map(|hits| hits.tests).sum();
    Hits { offsets, ids, tests }
}

/// Some regions, asked one after the other.
struct Search<'a, T, R> {
    tree: &'a Quadtree<T>,
    regions: &'a [R],
    order: &'a [u32],
    mask: Option<u32>,
    /// Ids found by all parts together.
    count: &'a AtomicUsize,
}

impl<T: Scalar, R: Region<T>> Work<T> for Search<'_, T, R> {
    type Out = Hits<u32>;

    #[inline(always)]
    fn run<S: Simd<T>>(self, simd: S) -> Hits<u32> {
        let mut hits = Hits { offsets: vec![0], ids: Vec::new(), tests: 0 };
        let mut stack = Vec::new();
        let mut before = self.count.load(Ordering::Relaxed);
        for &question in self.order {
            let region = &self.regions[question as usize];
            let start = hits.ids.len();
            if before <= MOST_IDS {
                self.walk(simd, region, &mut stack, &mut hits);
                let rows = self.tree.rows();
                let found = &mut hits.ids[start..];
                found.iter_mut().for_each(|place| *place = rows[*place as usize]);
                found.sort_unstable();
                before = found.len() + self.count.fetch_add(found.len(), Ordering::Relaxed);
            }
            hits.offsets.push(hits.ids.len());
        }
        hits
    }
}

impl<T: Scalar, R: Region<T>> Search<'_, T, R> {
    /// Collects the places of the shapes that one region overlaps.
    #[inline(always)]
    fn walk<S: Simd<T>>(&self, simd: S, region: &R, stack: &mut Vec<u32>, hits: &mut Hits<u32>) {
        let (nodes, covers) = (self.tree.nodes(), self.tree.covers());
        let window = region.window();
        let near = |cover: &Cover<T>| {
            selects(self.mask, cover.category) && window.meets(cover) && !region.misses(cover)
        };
        // Where a category can hide a shape, every shape has to be looked at.
        let all_selected = self.mask.is_none();
        stack.extend(covers.first().filter(|cover| near(cover)).map(|_| 0));
        while let Some(index) = stack.pop() {
            let node = &nodes[index as usize];
            if R::PLAIN && all_selected && window.holds(&covers[index as usize]) {
                hits.ids.extend(node.range().map(|place| place as u32));
            } else if node.is_leaf() {
                let round = covers[index as usize].radius > T::ZERO;
                self.leaf(simd, region, (&window, round), node.range(), hits);
            } else {
                for child in node.children() {
                    if near(&covers[child]) {
                        stack.push(child as u32);
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn leaf<S: Simd<T>>(
        &self,
        simd: S,
        region: &R,
        (window, round): (&Window<T>, bool),
        places: Range<usize>,
        hits: &mut Hits<u32>,
    ) {
        let shapes = self.tree.columns();
        hits.tests += places.len() as u64;
        for first in places.clone().step_by(LANES) {
            let bits = window.lanes(simd, shapes, first, round) & first_lanes(places.end - first);
            for_each_lane(bits, |lane| {
                let shape = shapes.shape_if(first + lane, round);
                if selects(self.mask, shape.category) && region.touches(&shape) {
                    hits.ids.push((first + lane) as u32);
                }
            });
        }
    }
}
