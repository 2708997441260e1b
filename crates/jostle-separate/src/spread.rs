//! Enlarging regions that are too small for their shapes.
//!
//! The set of movable shapes is halved at the median of its longer side, and so on (a k-d tree).
//! Each cell has a box. If a half has more area of shapes than its box, the dividing line moves
//! until it has enough, and the shapes of both halves move with their boxes, linearly. So shapes
//! keep their order along both axes, and regions that are large enough do not change. Coincident
//! shapes are divided by their order.
//!
//! C. Alpert et al., *Handbook of Algorithms for Physical Design Automation* (2008), chapter 15,
//! for spreading by moving lines of division.

use std::cmp::Ordering;

use super::bodies::{Bodies, Body};
use super::rules::Separation;
use jostle_base::error::Result;
use jostle_base::interrupt::Pulse;
use jostle_base::memory;
use jostle_index::geometry::Scalar;
use jostle_index::quadtree::Quadtree;

/// Nodes with fewer shapes do not show whether shapes are crowded.
const MIN_SHAPES: usize = 24;

/// Regions are enlarged in which shapes have more than this share of the area: more than fits.
pub(crate) const FULL: f64 = 1.0;

/// As [`FULL`], if rounds do not succeed with a smaller area.
pub(crate) const LOOSE: f64 = 0.6;

/// Share of its area that shapes have in a region that has been enlarged.
const FILL: f64 = 0.5;

/// Whether a node of the tree of the centres has less area than its shapes.
pub(crate) fn is_crowded<T: Scalar, K: Scalar>(
    tree: &Quadtree<K>,
    bodies: &Bodies<T>,
    gap: T,
) -> Result<bool> {
    // Nodes are ranges of the order of the bodies. With sums of all before each index the area in a
    // node is one difference, at every level of the tree.
    let mut sums = memory::with_capacity(bodies.len() + 1)?;
    let mut sum = [0.0; 3];
    sums.push(sum);
    for body in &bodies.all {
        let [width, height] = sides(body, gap);
        sum = [sum[0] + width, sum[1] + height, sum[2] + area(body, gap)];
        sums.push(sum);
    }
    Ok(tree.nodes().iter().zip(tree.bounds()).any(|(node, bounds)| {
        let range = node.range();
        let sum = |which: usize| sums[range.end][which] - sums[range.start][which];
        let side = |axis: usize| {
            (bounds.max[axis] - bounds.min[axis]).to_f64() + sum(axis) / range.len() as f64
        };
        // The box around centres is enlarged by one mean size, half on each side: shapes extend
        // beyond their centres. With few shapes that edge is most of the box, and the ratio says
        // nothing.
        range.len() >= MIN_SHAPES && sum(2) > FULL * side(0) * side(1)
    }))
}

fn sides<T: Scalar>(body: &Body<T>, gap: T) -> [f64; 2] {
    [0, 1].map(|axis| 2.0 * body.extent(axis).to_f64() + gap.to_f64())
}

/// The area of a shape with half the gap around it.
fn area<T: Scalar>(body: &Body<T>, gap: T) -> f64 {
    let [width, height] = body.half.map(|half| 2.0 * half.to_f64());
    let radius = body.radius.to_f64() + gap.to_f64() / 2.0;
    width * height + 2.0 * (width + height) * radius + std::f64::consts::PI * radius * radius
}

/// A set of shapes, as a range of the order, and its box.
#[derive(Clone, Copy)]
struct Cell {
    start: usize,
    end: usize,
    min: [f64; 2],
    max: [f64; 2],
    /// Whether the box has been enlarged, or the boxes around it.
    enlarged: bool,
}

/// Moves the movable shapes until they have at most a share of the area of each region.
pub(crate) fn spread<T: Scalar>(
    bodies: &mut Bodies<T>,
    rules: &Separation<T>,
    most: f64,
) -> Result<()> {
    let gap = rules.gap;
    let mut order: Vec<u32> = memory::with_capacity(bodies.len())?;
    order.extend((0..bodies.len() as u32).filter(|&i| !bodies.all[i as usize].is_fixed()));
    if order.is_empty() {
        return Ok(());
    }
    // In units of the mean extents shapes are about as wide as high.
    let unit = bodies.mean_extents.map(|extent| {
        let size = extent.to_f64() + gap.to_f64() / 2.0;
        if size > 0.0 { size } else { 1.0 }
    });
    let mut state = Spread { bodies, gap, unit, most };
    let root = state.root(&order, rules.bounds);
    // Not recursive: no recursion of the core grows with the data.
    let mut stack = vec![root];
    let mut pulse = Pulse::current();
    while let Some(cell) = stack.pop() {
        pulse.check(cell.end - cell.start)?;
        if cell.end - cell.start == 1 {
            state.enter(&cell, order[cell.start] as usize);
        } else {
            stack.extend(state.halve(cell, &mut order[cell.start..cell.end]));
        }
    }
    Ok(())
}

struct Spread<'a, T> {
    bodies: &'a mut Bodies<T>,
    gap: T,
    unit: [f64; 2],
    most: f64,
}

impl<T: Scalar> Spread<'_, T> {
    fn at(&self, index: u32, axis: usize) -> f64 {
        self.bodies.centers[index as usize][axis].to_f64()
    }

    fn area_of(&self, indices: &[u32]) -> f64 {
        indices.iter().map(|&index| area(&self.bodies.all[index as usize], self.gap)).sum()
    }

    /// All movable shapes, in a box that is large enough for them unless the bounds are too small.
    fn root(&mut self, order: &[u32], bounds: Option<[T; 4]>) -> Cell {
        let (mut min, mut max) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for &index in order {
            for axis in 0..2 {
                min[axis] = min[axis].min(self.at(index, axis) - self.unit[axis]);
                max[axis] = max[axis].max(self.at(index, axis) + self.unit[axis]);
            }
        }
        // Discs cover at most 91 % of a plane, and about 84 % without order (random close packing).
        // At half, rounds have room to sort out the rest.
        let needed = self.area_of(order) / FILL;
        let old = [max[0] - min[0], max[1] - min[1]];
        let most = bounds.map_or([f64::INFINITY; 2], |bounds| {
            [0, 1].map(|axis| (bounds[axis + 2] - bounds[axis]).to_f64())
        });
        let new = enlarged(old, needed, self.unit, most);
        let was = Cell { start: 0, end: order.len(), min, max, enlarged: new != old };
        let mut now = was;
        for axis in 0..2 {
            let middle = (min[axis] + max[axis]) / 2.0;
            let (mut low, mut high) = (middle - new[axis] / 2.0, middle + new[axis] / 2.0);
            if let Some(bounds) = bounds {
                let [least, most] = [bounds[axis].to_f64(), bounds[axis + 2].to_f64()];
                let shift = (least - low).max(0.0) - (high - most).max(0.0);
                (low, high) = (low + shift, high + shift);
            }
            (now.min[axis], now.max[axis]) = (low, high);
            self.stretch(order, axis, [was.min[axis], was.max[axis]], [low, high]);
        }
        now
    }

    /// Moves shapes linearly, as an interval along an axis becomes another.
    fn stretch(&mut self, indices: &[u32], axis: usize, from: [f64; 2], to: [f64; 2]) {
        if from == to {
            return;
        }
        let width = from[1] - from[0];
        let scale = if width > 0.0 { (to[1] - to[0]) / width } else { 0.0 };
        for &index in indices {
            let along = if width > 0.0 { self.at(index, axis) - from[0] } else { 0.0 };
            // Not `clamp`: rounding may exchange the two ends of an empty range.
            let moved = (to[0] + along * scale).max(to[0]).min(to[1]);
            self.bodies.centers[index as usize][axis] = T::from_f64(moved);
        }
    }

    /// Divides a cell into two, which are large enough for their shapes if it is.
    fn halve(&mut self, cell: Cell, order: &mut [u32]) -> [Cell; 2] {
        let side = |axis: usize| (cell.max[axis] - cell.min[axis]) / self.unit[axis];
        let axis = usize::from(side(1) > side(0));
        let middle = order.len() / 2;
        let compare = |a: &u32, b: &u32| -> Ordering {
            self.at(*a, axis).total_cmp(&self.at(*b, axis)).then(a.cmp(b))
        };
        // The median in linear time. Ties by index, and those by the canonical order, so a heap of
        // coincident shapes is divided in the same way whatever the order of the input.
        order.select_nth_unstable_by(middle, compare);
        let (first, second) = order.split_at(middle);
        let highest =
            first.iter().map(|&index| self.at(index, axis)).fold(cell.min[axis], f64::max);
        // Between the last shape of one half and the first of the other, so no centre lies on the
        // other side of it.
        let line = (highest + self.at(second[0], axis)) / 2.0;
        let across = cell.max[1 - axis] - cell.min[1 - axis];
        let (low, high) = (cell.min[axis], cell.max[axis]);
        let areas = [self.area_of(first), self.area_of(second)];
        let new = divide([low, line, high], areas, across, self.most);
        self.stretch(first, axis, [low, line], [low, new]);
        self.stretch(second, axis, [line, high], [new, high]);
        let mut halves = [cell; 2];
        (halves[0].end, halves[1].start) = (cell.start + middle, cell.start + middle);
        (halves[0].max[axis], halves[1].min[axis]) = (new, new);
        // Where no line has moved, no shape is moved either, not even by the rounding of `enter`.
        halves.map(|half| Cell { enlarged: cell.enlarged || new != line, ..half })
    }

    /// Moves a single shape into its box, if boxes have been enlarged; into its middle if it is
    /// larger.
    fn enter(&mut self, cell: &Cell, index: usize) {
        if !cell.enlarged {
            return;
        }
        let size = sides(&self.bodies.all[index], self.gap);
        for (axis, side) in size.into_iter().enumerate() {
            let (low, high) = (cell.min[axis] + side / 2.0, cell.max[axis] - side / 2.0);
            let center = self.at(index as u32, axis);
            let new = if low > high { (low + high) / 2.0 } else { center.clamp(low, high) };
            self.bodies.centers[index][axis] = T::from_f64(new);
        }
    }
}

/// The sides of a box that has become at least as large as `needed`; the shorter side, in the
/// given units, grows first. No side becomes longer than `most`.
fn enlarged(old: [f64; 2], needed: f64, unit: [f64; 2], most: [f64; 2]) -> [f64; 2] {
    // Large enough already: regions with room keep their places.
    if old[0] * old[1] >= needed {
        return [old[0].min(most[0]), old[1].min(most[1])];
    }
    let shorter = usize::from(old[1] / unit[1] < old[0] / unit[0]);
    let longer = 1 - shorter;
    let mut new = old;
    new[shorter] = needed / old[longer];
    // The shorter side would become the longer one. Then both grow, to a square in units of the
    // shapes, which moves shapes least.
    if new[shorter] / unit[shorter] > old[longer] / unit[longer] {
        let side = (needed / (unit[0] * unit[1])).sqrt();
        new = [side * unit[0], side * unit[1]];
    }
    for axis in 0..2 {
        if new[axis] > most[axis] {
            new[axis] = most[axis];
            new[1 - axis] = new[1 - axis].max(needed / new[axis]).min(most[1 - axis]);
        }
    }
    new
}

/// Where the line between two halves of a box must lie so that each is large enough for its shapes,
/// as near as possible to where it is.
fn divide([low, line, high]: [f64; 3], areas: [f64; 2], across: f64, most: f64) -> f64 {
    let room = [(line - low) * across, (high - line) * across];
    if areas[0] <= room[0] * most && areas[1] <= room[1] * most {
        return line;
    }
    let total = areas[0] + areas[1];
    // If the whole box is too small for the aim, both halves get the same share, which is the best
    // there is.
    let fill = FILL.max(total / ((high - low) * across));
    let least = low + areas[0] / (fill * across);
    let greatest = high - areas[1] / (fill * across);
    // A region without width cannot be enlarged across.
    if !(least.is_finite() && greatest.is_finite()) {
        return line;
    }
    line.clamp(least.min(greatest), greatest.max(least))
}
