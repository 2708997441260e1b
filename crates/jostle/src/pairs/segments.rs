//! Circles of a tree that are near line segments.
//!
//! Bounding boxes of segments that are not parallel to an axis are much larger than the segments, so
//! distances from the segments themselves are tested, sixteen circles at a time.

use std::ops::Range;

use super::output::{Budget, Output};
use super::{Found, JoinScratch, unchanged};
use crate::error::Result;
use crate::geometry::Bounds;
use crate::parallel;
use crate::quadtree::{Node, Quadtree};
use crate::simd::{LANES, Number, Simd, Work, block, first_lanes};

/// Approximate number of values read for a node.
const NODE_WORK: usize = 8;

/// Relative size of the rounding in the computation of a distance, with a reserve.
const ROUNDING: f64 = 4e-6;

/// A line segment in float32, with margins, so that no circle that is near it is left out.
#[derive(Clone, Copy, Debug)]
pub struct LineSegment {
    start: [f32; 2],
    /// Unit vector towards the other end.
    along: [f32; 2],
    length: f32,
    /// The corners of its bounding box.
    min: [f32; 2],
    max: [f32; 2],
    /// Smaller radii of circles count as this.
    least_radius: f32,
    /// Distance from a circle up to which it is near.
    margin: f32,
}

impl LineSegment {
    /// The segment between two points. Circles are near if their distance is at most `margin`; smaller
    /// radii than `least_radius` count as this.
    pub fn new([a, b]: [[f64; 2]; 2], least_radius: f64, margin: f64) -> Self {
        let offset = [0, 1].map(|k| b[k] - a[k]);
        let length = (offset[0] * offset[0] + offset[1] * offset[1]).sqrt();
        let size = [a, b].iter().flatten().map(|v| v.abs()).sum::<f64>();
        Self {
            start: a.map(|v| v as f32),
            along: offset.map(|v| (v / length) as f32),
            length: length as f32,
            min: [0, 1].map(|k| a[k].min(b[k]) as f32),
            max: [0, 1].map(|k| a[k].max(b[k]) as f32),
            least_radius: least_radius as f32,
            margin: (margin + ROUNDING * (size + least_radius)) as f32,
        }
    }

    /// Whether circles with these bounds may be near.
    #[inline(always)]
    fn may_reach(&self, bounds: &Bounds<f32>) -> bool {
        let reach = self.reach(bounds.radius);
        let is_apart = |k: usize| {
            (self.min[k] - bounds.max[k] > reach) | (bounds.min[k] - self.max[k] > reach)
        };
        !(is_apart(0) | is_apart(1))
    }

    /// The distance at which a circle is near.
    #[inline(always)]
    fn reach(&self, radius: f32) -> f32 {
        radius.max(self.least_radius) * (1.0 + ROUNDING as f32) + self.margin
    }
}

/// The places of line segments and of circles that are near them, and of a few others. `tree` has the
/// bounds of the segments, in the order of `segments`.
pub fn near_segments(
    tree: &Quadtree<f32>,
    segments: &[LineSegment],
    circles: &Quadtree<f32>,
    max_pairs: usize,
    scratch: &mut JoinScratch,
) -> Result<Found> {
    let JoinScratch { pairs, tasks } = scratch;
    let is_leaf = |node: &Node| node.is_leaf() && !circles.is_empty();
    let leaves = (0..).zip(tree.nodes()).filter(|&(_, node)| is_leaf(node));
    tasks.clear();
    tasks.extend(leaves.map(|(leaf, _)| [leaf, 0]));
    let threads = parallel::worthwhile(circles.settings().threads, tree.len() + circles.len());
    Budget::new(max_pairs).find(threads, tasks.len(), &unchanged, pairs, |task, output| {
        let leaf = tasks[task][0] as usize;
        let mut stack = std::mem::take(output.stack());
        stack.push([leaf as u32, 0]);
        f32::with_widest(Leaf { tree, segments, circles, leaf, stack: &mut stack, output });
        stack.clear();
        *output.stack() = stack;
    })
}

/// The search for the circles near the segments of a leaf.
struct Leaf<'a, 'b> {
    tree: &'a Quadtree<f32>,
    segments: &'a [LineSegment],
    circles: &'a Quadtree<f32>,
    leaf: usize,
    stack: &'a mut Vec<[u32; 2]>,
    output: &'a mut Output<'b>,
}

impl Work<f32> for Leaf<'_, '_> {
    type Out = ();

    #[inline(always)]
    fn run<S: Simd<f32>>(self, simd: S) {
        let Self { tree, segments, circles, leaf, stack, output } = self;
        let (own, places) = (&tree.bounds()[leaf], tree.nodes()[leaf].range());
        while let Some([_, index]) = stack.pop() {
            if output.is_over(NODE_WORK) {
                return;
            }
            let bounds = &circles.bounds()[index as usize];
            if !own.overlaps_unfiltered(bounds, [0.0; 2], f32::NEG_INFINITY) {
                continue;
            }
            let node = &circles.nodes()[index as usize];
            if !node.is_leaf() {
                stack.extend(node.children().map(|child| [0, child as u32]));
                continue;
            }
            for place in places.clone() {
                if segments[place].may_reach(bounds) {
                    test(simd, &segments[place], place as u32, circles, node.range(), output);
                }
            }
        }
    }
}

/// Appends the circles of a range that are near a segment.
#[inline(always)]
fn test<S: Simd<f32>>(
    simd: S,
    segment: &LineSegment,
    place: u32,
    circles: &Quadtree<f32>,
    range: Range<usize>,
    output: &mut Output<'_>,
) {
    let columns = circles.columns();
    let ([px, py], [ux, uy]) = (segment.start, segment.along);
    let [px, py, ux, uy] = [px, py, ux, uy].map(|v| simd.splat(v));
    let (zero, length) = (simd.splat(0.0), simd.splat(segment.length));
    let (least, margin) = (simd.splat(segment.least_radius), simd.splat(segment.margin));
    let scale = simd.splat(1.0 + ROUNDING as f32);
    for start in range.clone().step_by(LANES) {
        let x = simd.sub(simd.load(block(&columns.x, start)), px);
        let y = simd.sub(simd.load(block(&columns.y, start)), py);
        let along = simd.add(simd.mul(x, ux), simd.mul(y, uy));
        let along = simd.min(simd.max(along, zero), length);
        let [x, y] = [simd.sub(x, simd.mul(along, ux)), simd.sub(y, simd.mul(along, uy))];
        let square = simd.add(simd.mul(x, x), simd.mul(y, y));
        let radius = simd.max(simd.load(block(&columns.radius, start)), least);
        let reach = simd.add(simd.mul(radius, scale), margin);
        let near = simd.at_most(square, simd.mul(reach, reach));
        let bits = near & first_lanes(range.end - start);
        if bits == 0 {
            continue;
        }
        let Some(room) = output.room(LANES) else { return };
        let to = room.first_chunk_mut().expect("there is room");
        simd.pair_with_places(place, start as u32, bits, to);
        output.accept(bits.count_ones() as usize);
    }
}
