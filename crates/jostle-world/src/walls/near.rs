//! The broad phase of walls: which of them each disc may touch during a step.

use super::{Image, Wall, Walls, less, number_of};
use crate::trajectory::Vector;
use jostle_base::error::{Error, Result};
use jostle_base::settings::Method;
use jostle_base::{memory, reserve, sorting};
use jostle_index::columns::Columns;
use jostle_index::geometry::Shape;
use jostle_index::pairs::{self, Filters, JoinScratch, LineSegment};
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::Filter;

/// Relative size of the rounding of bounds in float32, with a large reserve.
pub(super) const MARGIN: f64 = 1e-6;

/// A wall near a disc.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NearWall {
    /// Number of the wall.
    pub(super) number: u32,
    /// The wall, or its image, in float32, adjacent in memory to those of the same disc.
    pub(super) segment: LineSegment,
}

/// The walls near each disc in the bounds of a step, in one array (compressed sparse rows).
#[derive(Debug, Default)]
pub struct Near {
    /// `walls[starts[i]..starts[i + 1]]` are the walls near disc i.
    pub(super) starts: Vec<u32>,
    pub(super) walls: Vec<NearWall>,
    /// Their offsets on a torus; empty elsewhere.
    offsets: Vec<Vector>,
    /// Distances from their positions at the beginning of the step within which discs were
    /// searched.
    pub(super) reaches: Vec<f32>,
    /// Displacements up to which discs certainly touch no wall; at most these distances.
    pub(super) free: Vec<f32>,
    /// The sensors near discs: the indices of the discs, the numbers and the offsets of the walls.
    pub(super) sensors: Vec<(u32, u32, Vector)>,
    /// Walls and discs that were found, and the same sorted by discs.
    found: Vec<[u32; 2]>,
    sorted: Vec<[u32; 2]>,
    join: JoinScratch,
}

impl Near {
    /// Finds the walls that overlap the circles of `bounds`, which are in the order of the discs,
    /// or whose distance from a circle is less than `usual` (on a torus 0). With this distance
    /// fewer discs leave the bounds in which their walls are known. Walls that a filter keeps from a disc are left
    /// out.
    pub fn fill(
        &mut self,
        walls: &Walls,
        bounds: &Quadtree<f32>,
        (reaches, usual): (&[f32], f32),
        method: Method,
        most: usize,
    ) -> Result<()> {
        self.starts.clear();
        self.walls.clear();
        self.sensors.clear();
        if walls.is_empty() {
            return Ok(());
        }
        // The tree has the images that discs may touch in their bounds.
        let usual = if !walls.period().is_none() { 0.0 } else { usual };
        let is_near = |[wall, index]: [u32; 2]| {
            let circle = bounds.columns().shape(index as usize);
            let line = &walls.lines[wall as usize];
            let distance = line.distance(less(circle.min.map(f64::from), walls.offset_at(wall)));
            let near = line.contact_distance(f64::from(circle.radius)) * (1.0 + MARGIN)
                + line.displacement_length;
            distance <= near + f64::from(usual)
        };
        // The memory of the last list is used again.
        let Self { join, found, .. } = self;
        join.keep(std::mem::take(found));
        let pairs = match method {
            Method::Quadtree => {
                pairs::near_segments(&walls.tree, (&walls.segments, usual), bounds, most, join)
            }
            Method::Brute => {
                let mut lines = walls.tree.columns().copied()?;
                lines.grow(usual);
                pairs::brute_between(&lines, bounds.columns(), [0.0; 2], Filters::Ignore, most)
            }
        };
        *found = pairs
            .map_err(|error| match error {
                Error::TooManyPairs { max_pairs } => Error::TooManyCandidates { limit: max_pairs },
                other => other,
            })?
            .pairs;
        // Brute force finds boxes that overlap; the distance from the segment leaves out most of
        // these.
        if method == Method::Brute {
            found.retain(|&pair| is_near(pair));
        }
        if walls.has_sensors || walls.has_filters || bounds.columns().has_filters() {
            let filter = |index: u32| {
                let Shape { category, mask, .. } = bounds.columns().shape(index as usize);
                Filter { category, mask }
            };
            let sensed = found.iter().filter(|&&[wall, index]| {
                walls.at(wall).is_sensor && walls.at(wall).meets(filter(index))
            });
            let sensed = sensed.map(|&[wall, index]| {
                let Image { wall, offset } = *walls.image_at(wall);
                (index, number_of(wall), offset)
            });
            memory::extend(&mut self.sensors, sensed)?;
            found.retain(|&[wall, index]| walls.at(wall).stops(filter(index)));
        }
        // Walls were searched in larger bounds than pairs, so discs may go farther before a new
        // search.
        self.reaches.clear();
        let farther = reaches.iter().map(|most| most + usual);
        memory::extend(&mut self.reaches, farther)?;
        memory::assign(&mut self.free, &self.reaches)?;
        self.arrange(walls, bounds, reaches)
    }

    /// Sorts the walls that were found by discs, and computes the displacements up to which these
    /// touch none.
    fn arrange(&mut self, walls: &Walls, bounds: &Quadtree<f32>, reaches: &[f32]) -> Result<()> {
        let Self { starts, walls: near, offsets, free, found, sorted, .. } = self;
        reserve!(bounds.len() + 1; *starts);
        reserve!(found.len(); *sorted, *near);
        reserve!(if walls.period().is_none() { 0 } else { found.len() }; *offsets);
        starts.resize(bounds.len() + 1, 0);
        sorted.resize(found.len(), [0; 2]);
        // Counting sort: walls of a disc lie side by side in memory, and its cost is linear.
        let disc = |pair: &&[u32; 2]| pair[1] as usize;
        sorting::counting_sort(found.iter(), disc, |pair| *pair, &mut starts[1..], sorted);
        offsets.clear();
        for &[wall, index] in &*sorted {
            let image = &walls.images[walls.tree.rows()[wall as usize] as usize];
            let (number, segment) = (number_of(image.wall), walls.segments.at(wall));
            near.push(NearWall { number, segment });
            if !walls.period().is_none() {
                offsets.push(image.offset);
            }
            let (line, at) = (&walls.lines[wall as usize], index as usize);
            let Columns { x, y, radius, .. } = bounds.columns();
            let center = [x[at], y[at]].map(f64::from);
            // The radius of the disc, with the reserve of the circle for rounding.
            let radius = line.contact_distance(f64::from(radius[at]) - f64::from(reaches[at]));
            let distance = line.distance(less(center, walls.offset_at(wall)));
            // The wall may come as near as it moves in the step, wherever the disc goes.
            let left = distance - radius * (1.0 + MARGIN) - line.displacement_length;
            free[at] = free[at].min(left as f32);
        }
        Ok(())
    }

    /// Calls `act` with the number and the offset of each wall near a disc.
    pub(super) fn each(&self, index: u32, mut act: impl FnMut(u32, Vector)) {
        let [first, end] = [index, index + 1].map(|at| self.starts[at as usize] as usize);
        for (at, wall) in (first..).zip(&self.walls[first..end]) {
            act(wall.number, self.offsets.get(at).copied().unwrap_or_default());
        }
    }
}

impl Walls {
    /// The wall at an index of the tree.
    pub(super) fn at(&self, index: u32) -> &Wall {
        &self.all[self.image_at(index).wall as usize]
    }

    /// The wall at an index of the tree, with its offset.
    fn image_at(&self, index: u32) -> &Image {
        &self.images[self.tree.rows()[index as usize] as usize]
    }

    /// The offset of the wall at an index of the tree.
    #[inline(always)]
    fn offset_at(&self, index: u32) -> Vector {
        if self.period().is_none() {
            return [0.0; 2];
        }
        self.images[self.tree.rows()[index as usize] as usize].offset
    }
}
