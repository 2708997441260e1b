//! Taking out shapes that still overlap, and putting each at the nearest free position.
//!
//! Positions are searched along lines at the wanted x and at the sides of the shapes nearby. A grid
//! of cells finds these shapes.

use super::bodies::{Bodies, Body};
use super::push::Pusher;
use super::rules::Separation;
use super::taken::Taken;
use jostle_base::error::Result;
use jostle_base::interrupt::Pulse;
use jostle_base::memory;
use jostle_index::geometry::Scalar;

/// A search ends without a position if more shapes than this are nearby, and there is none.
const MAX_NEARBY: usize = 4096;

/// Positions along the width of a round shape that are tried, from its left to its right side.
const LINES_OF_ROUND: [f64; 7] = [-1.0, -0.87, -0.5, 0.0, 0.5, 0.87, 1.0];

/// As [`LINES_OF_ROUND`], for a box.
const LINES_OF_BOX: [f64; 2] = [-1.0, 1.0];

/// Moves the shapes at `indices`, which are movable, to free positions, one after another. One for
/// which no position is found stays.
pub(crate) fn insert<T: Scalar>(
    bodies: &mut Bodies<T>,
    indices: &[u32],
    pusher: &Pusher<T>,
    rules: &Separation<T>,
) -> Result<()> {
    // Without the shapes to be inserted: they are in nobody's way until they have their places.
    let mut grid = Grid::of(bodies, indices)?;
    let mut search = Search { taken: Taken::default(), nearby: Vec::new(), lines: Vec::new() };
    let mut pulse = Pulse::current();
    for &index in indices {
        pulse.check(grid.cells.len() / bodies.len())?;
        if let Some(free) =
            search.nearest(bodies, index as usize, (&grid, pusher, rules), &mut pulse)?
        {
            bodies.centers[index as usize] = free;
        }
        // Also if no place was found: the next shapes keep away from it, so that it is the only one
        // that overlaps.
        grid.put(index, bodies.centers[index as usize])?;
    }
    Ok(())
}

/// Scratch of the searches.
struct Search<T> {
    taken: Taken<T>,
    nearby: Vec<u32>,
    /// Positions along x to try, with their distances from the wanted one.
    lines: Vec<(T, T)>,
}

impl<T: Scalar> Search<T> {
    /// The free position of a shape nearest to its centre.
    fn nearest(
        &mut self,
        bodies: &Bodies<T>,
        index: usize,
        (grid, pusher, rules): (&Grid<T>, &Pusher<T>, &Separation<T>),
        pulse: &mut Pulse,
    ) -> Result<Option<[T; 2]>> {
        let extent = [0, 1].map(|axis| bodies.all[index].extent(axis));
        let mut range = extent[0].max(extent[1]).max(bodies.mean_extents[0]);
        // The range doubles until it contains a free place and everything that could be in its way.
        // So the search costs little where the crowd is loose, and no maximum distance has to be
        // chosen.
        range = range + range;
        let mut nearby_before = usize::MAX;
        loop {
            let wide = [range + extent[0] + rules.gap, range + extent[1] + rules.gap];
            grid.near(bodies, index, wide, &mut self.nearby)?;
            pulse.check(self.nearby.len())?;
            let x = |index: &u32| bodies.centers[*index as usize][0];
            self.nearby.sort_unstable_by(|a, b| x(a).total_order(&x(b)).then(a.cmp(b)));
            let found = self.along_lines(bodies, index, range, (pusher, rules), pulse)?;
            // A larger range with as many shapes: all of the cluster are in it already.
            let all = self.nearby.len() == nearby_before;
            match found {
                // Shapes beyond the range may be in the way of a position beyond it.
                Some((free, distance)) if distance <= range => return Ok(Some(free)),
                Some((_, distance)) if !all => range = distance.max(range + range),
                _ if self.nearby.len() > MAX_NEARBY => return Ok(None),
                _ if all && rules.bounds.is_some() => return Ok(None),
                Some((_, distance)) => range = distance.max(range + range),
                None => range = range + range,
            }
            nearby_before = self.nearby.len();
        }
    }

    /// The nearest position that is free of the shapes nearby, and its distance, if that is at most
    /// `range` along x.
    fn along_lines(
        &mut self,
        bodies: &Bodies<T>,
        index: usize,
        range: T,
        (pusher, rules): (&Pusher<T>, &Separation<T>),
        pulse: &mut Pulse,
    ) -> Result<Option<([T; 2], T)>> {
        let (body, wanted) = (&bodies.all[index], bodies.centers[index]);
        let limits = [0, 1].map(|axis| {
            let most = [-T::INFINITY, T::INFINITY];
            rules.bounds.map_or(most, |bounds| {
                [bounds[axis] + body.extent(axis), bounds[axis + 2] - body.extent(axis)]
            })
        });
        let widest = self.list_lines(bodies, index, range, (pusher, limits[0]))?;
        let mut best: Option<([T; 2], T)> = None;
        for line in 0..self.lines.len() {
            let (away, x) = self.lines[line];
            // Lines are sorted by their distance, and no place on a line is nearer than the line.
            if best.is_some_and(|(_, distance)| away >= distance) {
                break;
            }
            self.list_taken(bodies, body, x, (pusher, widest), pulse)?;
            let Some(y) = self.taken.nearest_free(wanted[1], Some(limits[1])) else { continue };
            let up = y - wanted[1];
            let distance = (away * away + up * up).sqrt();
            if best.is_none_or(|(_, nearest)| distance < nearest) {
                best = Some(([x, y], distance));
            }
        }
        Ok(best)
    }

    /// Lists the positions along x at which a shape would touch others, within limits, by their
    /// distance; returns the largest distance from the centre of another at which they touch.
    fn list_lines(
        &mut self,
        bodies: &Bodies<T>,
        index: usize,
        range: T,
        (pusher, limits): (&Pusher<T>, [T; 2]),
    ) -> Result<T> {
        let (body, wanted) = (&bodies.all[index], bodies.centers[index][0]);
        let mut widest = T::ZERO;
        self.lines.clear();
        memory::push(&mut self.lines, (T::ZERO, wanted))?;
        for &other in &self.nearby {
            let (second, center) = (&bodies.all[other as usize], bodies.centers[other as usize]);
            let needed = pusher.needed_along(0, body, second, T::ZERO) * pusher.size_factor();
            widest = widest.max(needed);
            let round = body.half[0] + second.half[0] < body.radius + second.radius;
            // The nearest free place of a box among boxes is beside one of them, on its left or
            // right line, or straight above or below. Around a disc it may be anywhere; the seven
            // lines are those at every 30 degrees.
            let shares = if round { &LINES_OF_ROUND[..] } else { &LINES_OF_BOX[..] };
            for &share in shares {
                let x = center[0] + needed * T::from_f64(share);
                let away = (x - wanted).abs();
                if limits[0] <= x && x <= limits[1] && away <= range {
                    memory::push(&mut self.lines, (away, x))?;
                }
            }
        }
        self.lines.sort_unstable_by(|a, b| a.0.total_order(&b.0).then(a.1.total_order(&b.1)));
        Ok(widest)
    }

    /// Lists the intervals along y that the shapes nearby take from a shape at a position along x.
    fn list_taken(
        &mut self,
        bodies: &Bodies<T>,
        body: &Body<T>,
        x: T,
        (pusher, widest): (&Pusher<T>, T),
        pulse: &mut Pulse,
    ) -> Result<()> {
        self.taken.intervals.clear();
        let x_of = |other: u32| bodies.centers[other as usize][0];
        // `nearby` is sorted by x, and no shape further away along x can touch this one on the
        // line.
        let first = self.nearby.partition_point(|&other| x_of(other) < x - widest);
        let last = self.nearby.partition_point(|&other| x_of(other) <= x + widest);
        pulse.check(last - first)?;
        for &other in &self.nearby[first..last] {
            let (second, center) = (&bodies.all[other as usize], bodies.centers[other as usize]);
            let needed = pusher.needed_along(1, body, second, center[0] - x) * pusher.size_factor();
            if needed > T::ZERO {
                let interval = [center[1] - needed, center[1] + needed];
                memory::push(&mut self.taken.intervals, interval)?;
            }
        }
        Ok(())
    }
}

/// Cells with the shapes whose centres they contain; shapes outside are in the cells at the
/// border.
struct Grid<T> {
    min: [T; 2],
    cell: [T; 2],
    counts: [usize; 2],
    cells: Vec<Vec<u32>>,
    /// Largest distance from a centre to a side.
    widest: [T; 2],
}

impl<T: Scalar> Grid<T> {
    /// A grid of all shapes but those at `indices`.
    fn of(bodies: &Bodies<T>, indices: &[u32]) -> Result<Self> {
        let (mut min, mut max) = ([T::INFINITY; 2], [-T::INFINITY; 2]);
        let mut widest = [T::ZERO; 2];
        for (body, center) in bodies.all.iter().zip(&bodies.centers) {
            for axis in 0..2 {
                min[axis] = min[axis].min(center[axis]);
                max[axis] = max[axis].max(center[axis]);
                widest[axis] = widest[axis].max(body.extent(axis));
            }
        }
        let most = ((bodies.len() as f64).sqrt() as usize + 1).min(1 << 12);
        let mut grid = Self { min, cell: [T::ONE; 2], counts: [1; 2], cells: Vec::new(), widest };
        for axis in 0..2 {
            // Two mean shapes wide. The number of cells is limited by the square root of the number
            // of shapes on each axis, so that one far shape does not make a grid of empty cells.
            let size = bodies.mean_extents[axis] * T::from_f64(4.0);
            let cells = ((max[axis] - min[axis]) / size).to_f64();
            // NaN and infinity become 1 and `most`.
            grid.counts[axis] = (cells.min(most as f64) as usize).clamp(1, most);
            let side = (max[axis] - min[axis]) / T::from_f64(grid.counts[axis] as f64);
            grid.cell[axis] = if side > T::ZERO { side } else { T::ONE };
        }
        grid.cells = memory::filled(grid.counts[0] * grid.counts[1], Vec::new())?;
        let mut taken_out = memory::filled(bodies.len(), false)?;
        indices.iter().for_each(|&index| taken_out[index as usize] = true);
        for (index, &center) in bodies.centers.iter().enumerate() {
            if !taken_out[index] {
                grid.put(index as u32, center)?;
            }
        }
        Ok(grid)
    }

    fn index(&self, value: T, axis: usize) -> usize {
        let along = ((value - self.min[axis]) / self.cell[axis]).to_f64();
        (along.max(0.0) as usize).min(self.counts[axis] - 1)
    }

    fn put(&mut self, index: u32, center: [T; 2]) -> Result<()> {
        let cell = self.index(center[1], 1) * self.counts[0] + self.index(center[0], 0);
        memory::push(&mut self.cells[cell], index)
    }

    /// Lists the shapes whose bounding boxes are within `range` of a centre along both axes.
    fn near(
        &self,
        bodies: &Bodies<T>,
        index: usize,
        range: [T; 2],
        nearby: &mut Vec<u32>,
    ) -> Result<()> {
        let center = bodies.centers[index];
        let ends = [0, 1].map(|axis| {
            let far = range[axis] + self.widest[axis];
            self.index(center[axis] - far, axis)..=self.index(center[axis] + far, axis)
        });
        nearby.clear();
        for y in ends[1].clone() {
            for x in ends[0].clone() {
                for &other in &self.cells[y * self.counts[0] + x] {
                    let (second, at) =
                        (&bodies.all[other as usize], bodies.centers[other as usize]);
                    let is_near = |axis: usize| {
                        (at[axis] - center[axis]).abs() < range[axis] + second.extent(axis)
                    };
                    if is_near(0) && is_near(1) {
                        memory::push(nearby, other)?;
                    }
                }
            }
        }
        Ok(())
    }
}
