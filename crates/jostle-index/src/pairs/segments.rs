//! Circles of a tree that are near line segments.
//!
//! Bounding boxes of segments that are not parallel to an axis are much larger than the segments,
//! so distances from the segments themselves are tested, sixteen circles at a time.

use std::ops::Range;

use super::output::{Budget, Output};
use super::{Found, JoinScratch, unchanged};
use crate::geometry::Bounds;
use crate::quadtree::{Node, Quadtree};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_base::parallel;
use jostle_simd::{LANES, Number, Simd, Work, block, first_lanes, for_each_lane};

/// Approximate number of values read for a node.
const NODE_WORK: usize = 8;

/// Relative size of the rounding in the computation of a distance, with a reserve.
const ROUNDING: f64 = 4e-6;

/// Sine of the angle between a segment and a path that certainly leads away from it.
const LEAVING: f32 = 1e-3;

/// A line segment in float32, with a margin, so that no circle that is near it is left out.
#[derive(Clone, Copy, Debug, Default)]
pub struct LineSegment {
    start: [f32; 2],
    /// Unit vector towards the other end.
    along: [f32; 2],
    length: f32,
    /// Smaller radii of circles count as this.
    least_radius: f32,
    /// Distance from a circle up to which it is near.
    margin: f32,
}

impl LineSegment {
    /// The segment between two points. Circles are near if their distance is at most `margin`;
    /// smaller radii than `least_radius` count as this.
    pub fn new([a, b]: [[f64; 2]; 2], least_radius: f64, margin: f64) -> Self {
        let offset = [0, 1].map(|k| b[k] - a[k]);
        let length = (offset[0] * offset[0] + offset[1] * offset[1]).sqrt();
        // float32 rounds a coordinate in proportion to its size, not to the length of the segment:
        // far from the origin the margin has to be larger. 4e-6 is more than 60 roundings, and the
        // test makes about ten.
        let size = [a, b].iter().flatten().map(|v| v.abs()).sum::<f64>();
        Self {
            start: a.map(|v| v as f32),
            along: offset.map(|v| (v / length) as f32),
            length: length as f32,
            least_radius: least_radius as f32,
            margin: (margin + ROUNDING * (size + least_radius)) as f32,
        }
    }

    /// The distance at which a circle is near.
    #[inline(always)]
    fn near_distance(&self, radius: f32) -> f32 {
        radius.max(self.least_radius) * (1.0 + ROUNDING as f32) + self.margin
    }

    /// Distance of a point from the line, negative on the right-hand side, and its position along
    /// it.
    #[inline(always)]
    fn seen(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        let [ux, uy] = self.along;
        [y * ux - x * uy, x * ux + y * uy]
    }

    /// Whether a circle may be near somewhere on a path; `extent` is added to its radius. False
    /// only if it certainly is not.
    #[inline(always)]
    pub fn may_touch(&self, path: &Path, radius: f32, extent: f32) -> bool {
        let [across, along] = self.seen([0, 1].map(|k| path.position[k] - self.start[k]));
        let [aside, ahead] = self.seen(path.displacement);
        let near_distance = self.near_distance(radius) + extent;
        // Both ends of the path on one side of the line, and farther than the distance: then the
        // whole path is, because it is straight. The same holds along the segment, before its start
        // and behind its end.
        let is_beside = (across.min(across + aside) > near_distance)
            | (across.max(across + aside) < -near_distance);
        let is_before = along.max(along + ahead) < -near_distance;
        let is_behind = along.min(along + ahead) > self.length + near_distance;
        // Corners beyond the ends of the segment are not excluded. That costs a few tests in
        // float64, no more.
        !(is_beside | is_before | is_behind)
    }

    /// Whether a path certainly begins beside the segment and leads away from it.
    #[inline(always)]
    pub fn is_left(&self, path: &Path, extent: f32) -> bool {
        let [across, along] = self.seen([0, 1].map(|k| path.position[k] - self.start[k]));
        let [aside, _] = self.seen(path.displacement);
        let [x, y] = path.displacement;
        let margin = self.margin + extent;
        let is_beside = (along > margin) & (along < self.length - margin) & (across.abs() > margin);
        // The distance grows along the path, and the angle is far above what float32 rounds. So
        // rounding cannot have hidden an approach.
        is_beside & (across * aside > LEAVING * across.abs() * (x.abs() + y.abs()))
    }
}

/// A straight path of the centre of a disc, in float32.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// Where it begins.
    pub position: [f32; 2],
    /// From its beginning to its end.
    pub displacement: [f32; 2],
}

/// Line segments in the order of a tree.
#[derive(Clone, Debug, Default)]
pub struct LineSegments {
    all: Vec<LineSegment>,
    /// Their middles, unit vectors, half lengths, least radii and margins, with spare rows.
    columns: [Vec<f32>; 7],
}

impl LineSegments {
    /// Replaces all segments.
    pub fn fill(&mut self, all: impl Iterator<Item = LineSegment>) -> Result<()> {
        self.all.clear();
        memory::extend(&mut self.all, all)?;
        for column in &mut self.columns {
            column.clear();
            memory::reserve(column, self.all.len() + LANES)?;
        }
        for &segment in &self.all {
            let LineSegment { start: [x, y], along: [u, v], length, least_radius, margin } =
                segment;
            let half = 0.5 * length;
            let numbers = [x + half * u, y + half * v, u, v, half, least_radius, margin];
            self.columns.iter_mut().zip(numbers).for_each(|(column, number)| column.push(number));
        }
        self.columns.iter_mut().for_each(|column| column.resize(self.all.len() + LANES, 0.0));
        Ok(())
    }

    /// The segment at an index.
    #[inline(always)]
    pub fn at(&self, index: u32) -> LineSegment {
        self.all[index as usize]
    }

    /// Which of sixteen segments from `start` on may be nearer than a distance to circles with
    /// these bounds, by their extents along both axes and across each segment (separating axes).
    #[inline(always)]
    fn reaching<S: Simd<f32>>(
        &self,
        simd: S,
        start: usize,
        bounds: &Bounds<f32>,
        distance: f32,
    ) -> u32 {
        let [x, y, u, v, length, least, margin] =
            [0, 1, 2, 3, 4, 5, 6].map(|k| simd.load(block(&self.columns[k], start)));
        let [zero, scale, distance, radius] =
            [0.0, 1.0 + ROUNDING as f32, distance, bounds.radius].map(|number| simd.splat(number));
        let absolute = |v| simd.max(v, simd.sub(zero, v));
        let half = |k: usize| {
            let half = simd.splat(0.5 * (bounds.max[k] - bounds.min[k]));
            simd.mul(half, scale)
        };
        let middle = |k: usize| simd.splat(0.5 * (bounds.max[k] + bounds.min[k]));
        let ([wide, high], [p, q]) = ([half(0), half(1)], [middle(0), middle(1)]);
        let [x, y] = [simd.sub(p, x), simd.sub(q, y)];
        let across = absolute(simd.sub(simd.mul(y, u), simd.mul(x, v)));
        let [x, y, u, v] = [x, y, u, v].map(absolute);
        let near_distance =
            simd.add(simd.mul(simd.max(radius, least), scale), simd.add(margin, distance));
        let far_x = simd.add(simd.add(wide, simd.mul(u, length)), near_distance);
        let far_y = simd.add(simd.add(high, simd.mul(v, length)), near_distance);
        // The half extent of the box across the segment. `u` and `v` are absolute values here,
        // those of the unit vector along it; its normal is (-v, u).
        let aside = simd.add(simd.add(simd.mul(v, wide), simd.mul(u, high)), near_distance);
        simd.at_most(x, far_x) & simd.at_most(y, far_y) & simd.at_most(across, aside)
    }
}

/// The indices of line segments and of circles that are nearer to them than a distance, and of a
/// few others. `tree` has the bounds of the segments, in the same order.
pub fn near_segments(
    tree: &Quadtree<f32>,
    (segments, distance): (&LineSegments, f32),
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
        f32::with_widest(Leaf {
            tree,
            segments,
            distance,
            circles,
            leaf,
            stack: &mut stack,
            output,
        });
        stack.clear();
        *output.stack() = stack;
    })
}

/// The search for the circles near the segments of a leaf.
struct Leaf<'a, 'b> {
    tree: &'a Quadtree<f32>,
    segments: &'a LineSegments,
    distance: f32,
    circles: &'a Quadtree<f32>,
    leaf: usize,
    stack: &'a mut Vec<[u32; 2]>,
    output: &'a mut Output<'b>,
}

impl Work<f32> for Leaf<'_, '_> {
    type Out = ();

    #[inline(always)]
    fn run<S: Simd<f32>>(self, simd: S) {
        let Self { tree, segments, distance, circles, leaf, stack, output } = self;
        let (own, indices) = (&tree.bounds()[leaf], tree.nodes()[leaf].range());
        while let Some([_, number]) = stack.pop() {
            if output.is_over(NODE_WORK) {
                return;
            }
            let bounds = &circles.bounds()[number as usize];
            let gaps = [0, 1].map(|k| (own.min[k] - bounds.max[k]).max(bounds.min[k] - own.max[k]));
            // By boxes here, by segments only at leaves of circles: a box is one test for a whole
            // leaf of segments.
            if gaps[0].max(gaps[1]) > own.radius + bounds.radius + distance {
                continue;
            }
            let node = &circles.nodes()[number as usize];
            if !node.is_leaf() {
                // Only the second number is used: the stack is that of the pair search, whose
                // memory is reused.
                stack.extend(node.children().map(|child| [0, child as u32]));
                continue;
            }
            for start in indices.clone().step_by(LANES) {
                let bits = segments.reaching(simd, start, bounds, distance);
                for_each_lane(bits & first_lanes(indices.end - start), |lane| {
                    let index = (start + lane) as u32;
                    let segment = (&segments.at(index), distance);
                    test(simd, segment, index, circles, node.range(), output);
                });
            }
        }
    }
}

/// Appends the circles of a range that are near a segment.
#[inline(always)]
fn test<S: Simd<f32>>(
    simd: S,
    (segment, distance): (&LineSegment, f32),
    index: u32,
    circles: &Quadtree<f32>,
    range: Range<usize>,
    output: &mut Output<'_>,
) {
    let columns = circles.columns();
    let ([px, py], [ux, uy]) = (segment.start, segment.along);
    let [px, py, ux, uy] = [px, py, ux, uy].map(|v| simd.splat(v));
    let (zero, length) = (simd.splat(0.0), simd.splat(segment.length));
    let (least, margin) = (simd.splat(segment.least_radius), simd.splat(segment.margin + distance));
    let scale = simd.splat(1.0 + ROUNDING as f32);
    for start in range.clone().step_by(LANES) {
        let x = simd.sub(simd.load(block(&columns.x, start)), px);
        let y = simd.sub(simd.load(block(&columns.y, start)), py);
        let along = simd.add(simd.mul(x, ux), simd.mul(y, uy));
        // The nearest point of the segment: the foot of the perpendicular, or an end.
        let along = simd.min(simd.max(along, zero), length);
        let [x, y] = [simd.sub(x, simd.mul(along, ux)), simd.sub(y, simd.mul(along, uy))];
        let square = simd.add(simd.mul(x, x), simd.mul(y, y));
        let radius = simd.max(simd.load(block(&columns.radius, start)), least);
        let near_distance = simd.add(simd.mul(radius, scale), margin);
        let near = simd.at_most(square, simd.mul(near_distance, near_distance));
        let bits = near & first_lanes(range.end - start);
        if bits == 0 {
            continue;
        }
        let Some(spare) = output.spare(LANES) else { return };
        let to = spare.first_chunk_mut().expect("there is spare");
        simd.pair_with_indices(index, start as u32, bits, to);
        output.accept(bits.count_ones() as usize);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A vector of any direction and of a length between powers of ten.
    fn vector(exponents: std::ops::Range<f64>) -> impl Strategy<Value = [f64; 2]> {
        (0.0..std::f64::consts::TAU, exponents).prop_map(|(angle, exponent)| {
            [angle.cos(), angle.sin()].map(|v| v * 10f64.powf(exponent))
        })
    }

    fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
        a[0] * b[0] + a[1] * b[1]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        /// A disc is led to a point at which its distance from a point of a segment is a share of
        /// its radius: near and far from the origin, short and long segments and displacements, and
        /// points.
        #[test]
        fn a_disc_that_touches_is_never_left_out(
            index in vector(-2.0..6.0),
            line in vector(-2.0..3.0),
            drift in prop_oneof![vector(-3.0..5.0), Just([0.0; 2])],
            radius in prop_oneof![Just(0.0f32), Just(1.0), Just(0.01), Just(30.0)],
            direction in vector(0.0..1e-9),
            (share, when) in (0.0..1.0, 0.0..1.0),
            at in prop_oneof![0.0..1.0, Just(0.0), Just(1.0)],
        ) {
            let ends = [index, [0, 1].map(|k| index[k] + line[k])];
            let segment = LineSegment::new(ends, 0.0, 0.0);
            let away = share * f64::from(radius);
            let start = [0, 1].map(|k| {
                index[k] + at * line[k] + away * direction[k] - when * drift[k]
            });
            let path =
                Path { position: start.map(|v| v as f32), displacement: drift.map(|v| v as f32) };
            let sizes = [start, drift].as_flattened().iter().map(|v| v.abs()).sum::<f64>();
            let extent = (1e-6 * (sizes + f64::from(radius))) as f32;
            prop_assert!(segment.may_touch(&path, radius, extent));
            if segment.is_left(&path, extent) {
                let offset = [0, 1].map(|k| start[k] - index[k]);
                let across = [-line[1], line[0]];
                prop_assert!((0.0..=dot(line, line)).contains(&dot(offset, line)));
                prop_assert!(dot(offset, across) * dot(drift, across) > 0.0);
            }
        }
    }

    #[test]
    fn most_discs_are_left_out() {
        let segment = LineSegment::new([[0.0, 0.0], [3.0, 4.0]], 0.0, 0.0);
        let path = |position, displacement| Path { position, displacement };
        // Above it, before it, behind it; and towards it from each of these.
        let starts = [[-4.0, 3.0], [-3.0, -4.0], [6.0, 8.0]];
        for (start, [x, y]) in starts.into_iter().zip([[4.0, -3.0], [3.0, 4.0], [-3.0, -4.0]]) {
            assert!(!segment.may_touch(&path(start, [0.0; 2]), 1.5, 0.0), "{start:?}");
            assert!(!segment.may_touch(&path(start, [-x, -y]), 1.5, 0.0), "{start:?}");
            assert!(segment.may_touch(&path(start, [x, y]), 1.5, 0.0), "{start:?}");
        }
        // Beside the middle, at a distance of 1: away from it, along it and towards it.
        let start = [0.7, 2.6];
        for (displacement, is_left) in
            [([-4.0, 3.0], true), ([3.0, 4.0], false), ([4.0, -3.0], false)]
        {
            assert_eq!(segment.is_left(&path(start, displacement), 1e-3), is_left);
        }
    }
}
