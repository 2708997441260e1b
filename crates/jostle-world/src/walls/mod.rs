//! Walls: line segments with ends, solid from both sides or from their left alone. They stand still or move with a
//! constant velocity.
//!
//! A wall has three parts: its side, which acts on discs whose centres are beside it, and its two
//! ends, which act on the others. An end that lies on other walls does not act on discs beside
//! these, because they touch those walls first. So for every position of a centre one part of the
//! walls near it acts, without gaps, and a disc that rolls over the joint of two walls never hits
//! the end of the second.

mod around;
mod contact;
mod impact;
mod moving;
mod near;
mod one_way;
mod sensors;
mod torus;

use std::cmp::Ordering;

pub use crate::container::WallContact;
use crate::container::{Container, size};
use crate::motion::exact;
use crate::particles::FARTHEST;
use crate::surface::{MAX_SIDES, Sides, Surface};
use crate::tolerance::{PRECISION, ROUNDING};
use crate::trajectory::{Vector, dot, vector};
pub use around::Around;
pub use contact::OPPOSED;
use jostle_base::bytes::{Reader, Saved, Writer};
use jostle_base::error::{Error, Result};
use jostle_base::memory;
use jostle_base::saved;
use jostle_base::settings::Settings;
use jostle_index::geometry::filters_agree;
use jostle_index::pairs::{LineSegment, LineSegments};
use jostle_index::period::Period;
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::{Each, Filter, Shapes};
pub use moving::Clock;
pub use near::Near;
pub use one_way::may_stop;
use torus::{Image, check_torus, each_image, less, torus_offset};

/// The number of the first wall among all walls; smaller numbers are those of the container.
const FIRST: u32 = MAX_SIDES as u32;

/// The number of the wall at an index among all walls, those of the container included.
pub fn number_of(index: u32) -> u32 {
    FIRST + index
}

/// The index of the wall with a number; none if the number is that of a side of the container.
pub fn index_of(number: u32) -> Option<u32> {
    number.checked_sub(FIRST)
}

/// Maximum number of walls in a leaf of the tree.
const LEAF_CAPACITY: usize = 12;

/// Least distance of a point from a wall, in units of the rounding of positions with residuals.
const POINT: f64 = 16.0;

/// An end whose distance from another wall is at most this share of the radius of a disc lies on
/// that wall, for this disc.
/// So a floor of pieces may have gaps and steps of a thousandth of the radius (docs/physics.md).
const JOINED: f64 = 2e-3;

/// An end may lie on other walls up to this share of the length of the shorter wall.
const LONGEST_JOINT: f64 = 1.0 / 64.0;

/// Maximum number of walls of a world.
pub const MAX_WORLD_WALLS: usize = 1 << 24;

/// A line segment that discs cannot cross.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// Its ends.
    pub ends: [[f32; 2]; 2],
    /// What rounding to float32 removed from the ends while the wall moved.
    pub residuals: [[f32; 2]; 2],
    /// Its velocity. Nothing changes it.
    pub velocity: [f32; 2],
    /// Its coefficients of restitution and of friction.
    pub surface: Surface,
    /// Its categories, and those of the discs that it may touch.
    pub filter: Filter,
    /// Whether it is solid only for discs that come from its left, see [`one_way`].
    pub is_one_way: bool,
    /// Whether it acts on no disc and only reports which ones touch it, see [`sensors`].
    pub is_sensor: bool,
}

saved! { struct Wall { ends, residuals, velocity, surface, filter, is_one_way, is_sensor } }

impl Wall {
    /// A wall at rest that is solid for all discs from both sides, with the coefficients of the particles.
    pub fn new(ends: [[f32; 2]; 2]) -> Self {
        Self {
            ends,
            residuals: [[0.0; 2]; 2],
            velocity: [0.0; 2],
            surface: Surface::default(),
            filter: Filter::default(),
            is_one_way: false,
            is_sensor: false,
        }
    }

    /// Its ends, not rounded.
    fn exact_ends(&self) -> [Vector; 2] {
        [0, 1].map(|end| exact(self.ends[end], self.residuals[end]))
    }

    /// Whether the filters let it meet a disc.
    #[inline(always)]
    fn meets(&self, disc: Filter) -> bool {
        let Filter { category, mask } = self.filter;
        filters_agree([category, mask], [disc.category, disc.mask])
    }

    /// Whether it stops discs with this filter.
    #[inline(always)]
    fn stops(&self, disc: Filter) -> bool {
        !self.is_sensor && self.meets(disc)
    }

    /// Whether it stops every disc that another wall stops. Otherwise it cannot stand in for an end of that wall: a
    /// disc that only the other wall stops would pass through the joint of the two.
    fn stops_all_of(&self, other: &Self) -> bool {
        let (own, of) = (self.filter, other.filter);
        let passes_more = self.is_sensor || self.is_one_way && !other.is_one_way;
        of.category & !own.category == 0 && of.mask & !own.mask == 0 && !passes_more
    }
}

/// A wall in float64.
#[derive(Clone, Copy, Debug)]
struct Line {
    ends: [Vector; 2],
    /// Unit vector from the first end to the second.
    along: Vector,
    length: f64,
    /// Smaller radii count as this: a point needs a distance from the wall that shows on which side
    /// it is. About the rounding of positions with residuals.
    least_radius: f64,
    /// The rounding of the ends to float32, for searches in the tree.
    rounding: f64,
    /// Whether its ends act: of walls that share an end, that of the first does.
    has_end: [bool; 2],
    /// Length of its displacement in the step.
    displacement_length: f64,
    /// The offset that was added to the ends of the wall, see [`torus_offset`].
    torus_offset: Vector,
    /// Whether only what comes from its left is stopped, see [`one_way`].
    is_one_way: bool,
}

/// A wall, or its image on a torus, near an end of another wall.
#[derive(Clone, Copy, Debug)]
struct Covering {
    image: Image,
    /// Distance of the end from it; 0 if this is rounding.
    distance: f64,
}

/// A part of a wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Side,
    /// The first or the second end.
    End(usize),
}

/// All walls, with a tree of them.
#[derive(Debug, Default)]
pub struct Walls {
    all: Vec<Wall>,
    container: Container,
    /// The walls, and on a torus their images near it, by the row of the tree.
    images: Vec<Image>,
    /// In the order of the tree, so that discs near each other find their walls near each other.
    lines: Vec<Line>,
    /// The lines in float32, moved by the offsets of images.
    segments: LineSegments,
    /// The index of each wall in this order.
    indices: Vec<u32>,
    /// `covering[starts[2 k + e]..starts[2 k + e + 1]]` are the other walls on which the end e of
    /// wall k lies for discs that are large enough, the nearest first.
    starts: Vec<u32>,
    covering: Vec<Covering>,
    tree: Quadtree<f32>,
    /// The surfaces of the sides of the container.
    sides: Sides,
    /// Whether any wall has a velocity; then a step reads those of all walls.
    any_moves: bool,
    /// Whether the tree is older than the walls, because a step was undone.
    is_stale: bool,
    /// Whether elastic discs keep their energy at all walls, apart from the sides.
    are_elastic: bool,
    /// Whether any wall has a filter that is not the default.
    has_filters: bool,
    has_sensors: bool,
}

impl Saved for Walls {
    fn put(&self, to: &mut Writer) {
        self.all.put(to);
    }
    /// Only the list; [`Walls::new`] has the rest.
    fn get(from: &mut Reader<'_>) -> Result<Self> {
        Ok(Self { all: Saved::get(from)?, ..Self::default() })
    }
}

impl Line {
    fn of(wall: &Wall, torus_offset: Vector) -> Self {
        // With residuals, and where the wall is on the torus.
        let ends = wall.exact_ends().map(|end| vector(|k| end[k] + torus_offset[k]));
        let offset = vector(|k| ends[1][k] - ends[0][k]);
        let length = dot(offset, offset).sqrt();
        let largest = size(ends[0], 0.0).max(size(ends[1], 0.0));
        Self {
            ends,
            along: offset.map(|v| v / length),
            length,
            least_radius: POINT * PRECISION * largest,
            rounding: ROUNDING * largest,
            has_end: [true; 2],
            displacement_length: 0.0,
            torus_offset,
            is_one_way: wall.is_one_way,
        }
    }

    /// Unit vector a quarter turn from the wall.
    fn across(&self) -> Vector {
        [-self.along[1], self.along[0]]
    }

    /// How far a point is beyond an end, along the wall from the first end to the second.
    fn beyond(&self, end: usize, point: Vector) -> f64 {
        dot(vector(|k| point[k] - self.ends[end][k]), self.along)
    }

    /// The part of the wall that is closest to a point.
    fn part_at(&self, point: Vector) -> Part {
        if self.beyond(0, point) < 0.0 {
            Part::End(0)
        } else if self.beyond(1, point) > 0.0 {
            Part::End(1)
        } else {
            Part::Side
        }
    }

    /// The vector from the closest point of the wall to a point.
    fn offset(&self, point: Vector) -> Vector {
        match self.part_at(point) {
            Part::End(end) => vector(|k| point[k] - self.ends[end][k]),
            Part::Side => {
                let across = self.across();
                let distance = dot(vector(|k| point[k] - self.ends[0][k]), across);
                across.map(|v| v * distance)
            }
        }
    }

    /// Its distance from a point.
    fn distance(&self, point: Vector) -> f64 {
        let offset = self.offset(point);
        dot(offset, offset).sqrt()
    }

    /// The distance from centre to wall at which a disc touches it.
    fn contact_distance(&self, radius: f64) -> f64 {
        radius.max(self.least_radius)
    }
}

impl Walls {
    /// Walls in a container, with a tree. Refuses walls that are not finite, too large or without
    /// length.
    pub fn new(all: Vec<Wall>, container: Container, settings: Settings) -> Result<Self> {
        check_count(all.len())?;
        check_walls(&all, container, "walls")?;
        let any_moves = all.iter().any(Wall::moves);
        let are_elastic = are_elastic(&all);
        let has_filters = all.iter().any(|wall| wall.filter != Filter::default());
        let has_sensors = all.iter().any(|wall| wall.is_sensor);
        let mut walls = Self {
            all,
            any_moves,
            container,
            are_elastic,
            has_filters,
            has_sensors,
            ..Self::default()
        };
        walls.build(settings, 0.0)?;
        Ok(walls)
    }

    /// Builds the tree of the bounds that the walls have in a step of `dt` seconds.
    fn build(&mut self, settings: Settings, dt: f64) -> Result<()> {
        let period = &self.period();
        let Self { all, images, lines, segments, indices, tree, .. } = self;
        // The first rows are the walls themselves, in their order; images follow.
        images.clear();
        let own = (0..all.len() as u32).map(|wall| Image { wall, offset: [0.0; 2] });
        memory::extend(images, own)?;
        let mut bounds = memory::collect(all.iter().map(|wall| wall.swept_bounds(dt)))?;
        if !period.is_none() {
            add_images(all, period, images, &mut bounds)?;
        }
        let line = |image: &Image| {
            let wall = &all[image.wall as usize];
            Line {
                displacement_length: wall.displacement_length(dt),
                ..Line::of(wall, torus_offset(wall.exact_ends(), period))
            }
        };
        let radii = images.iter().map(|image| line(image).rounding.max(1e-18) as f32);
        let radii = memory::collect(radii)?;
        let shapes = Shapes::from_boxes(bounds, Each::Rows(radii), None)?;
        // A leaf of the walls is about as large as one of the bounds of particles.
        let leaf_capacity = settings.leaf_capacity.min(LEAF_CAPACITY);
        let tie = |a: usize, b: usize| {
            compare(all, images[a].wall as usize, images[b].wall as usize).then(a.cmp(&b))
        };
        tree.rebuild(&shapes, Settings { leaf_capacity, ..settings }, &tie)?;
        // Each wall keeps a line if memory is short here, because `restore` moves both.
        memory::reserve_len(lines, images.len())?;
        memory::reserve_len(indices, all.len())?;
        lines.clear();
        memory::extend(lines, tree.rows().iter().map(|&row| line(&images[row as usize])))?;
        memory::resize(indices, all.len(), 0)?;
        // Images have entries in `lines`, too. The index of a wall is that of the wall itself.
        let own = (0..).zip(tree.rows()).filter(|&(_, &row)| (row as usize) < all.len());
        own.for_each(|(index, &row)| indices[row as usize] = index);
        segments.fill(lines.iter().zip(tree.rows()).map(|(line, &row)| {
            let ends = line.ends.map(|end| vector(|k| end[k] + images[row as usize].offset[k]));
            LineSegment::new(ends, line.least_radius, line.displacement_length)
        }))?;
        self.find_covering()?;
        self.is_stale = false;
        Ok(())
    }

    /// The container.
    pub fn container(&self) -> Container {
        self.container
    }

    #[inline(always)]
    fn period(&self) -> Period<f64> {
        self.container.period().exact()
    }

    /// The public id of the wall with a number: its index, or the id of a side of the container.
    pub fn id_of(&self, number: u32) -> i64 {
        index_of(number).map_or_else(|| self.container.side_id(number), i64::from)
    }

    /// The walls, as given.
    pub fn all(&self) -> &[Wall] {
        &self.all
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Whether elastic discs keep their energy at all walls and sides.
    pub fn are_elastic(&self) -> bool {
        (self.all.is_empty() || self.are_elastic) && self.sides.are_elastic()
    }

    /// Sets the surfaces of the sides of the container.
    pub fn set_sides(&mut self, sides: Sides) {
        self.sides = sides;
    }

    /// Whether all sides of the container have the same coefficient of restitution.
    pub fn has_equal_sides(&self) -> bool {
        self.sides.bounce_alike()
    }

    /// The surface of the wall with a number.
    pub fn surface(&self, wall: u32) -> &Surface {
        self.get(wall).map_or_else(|| &self.sides.0[wall as usize], |of| &of.surface)
    }

    /// The distance from the wall with a number at which a disc touches it.
    pub fn contact_distance(&self, wall: u32, radius: f64) -> f64 {
        index_of(wall).map_or(radius, |index| self.line(index).contact_distance(radius))
    }

    /// Wall `index` in float64.
    #[inline(always)]
    fn line(&self, index: u32) -> &Line {
        &self.lines[self.indices[index as usize] as usize]
    }

    /// The wall with a number in float64.
    #[inline(always)]
    fn numbered(&self, wall: u32) -> &Line {
        self.line(wall - FIRST)
    }

    /// The wall with a number; none if the number is that of a wall of the container.
    fn get(&self, wall: u32) -> Option<&Wall> {
        index_of(wall).and_then(|index| self.all.get(index as usize))
    }

    /// Finds the walls that hide each end, and which of several equal ends acts.
    fn find_covering(&mut self) -> Result<()> {
        let mut starts = memory::with_capacity(2 * self.all.len() + 1)?;
        starts.push(0);
        let (mut covering, mut done) = (Vec::new(), Ok(()));
        let mut stack = Vec::new();
        let mut shared = Vec::new();
        for index in 0..self.all.len() as u32 {
            let line = self.line(index);
            for (end, &point) in line.ends.iter().enumerate() {
                let first = covering.len();
                let rounding = ROUNDING * size(point, 0.0);
                // The search takes the largest distance that may count. The exact limit also
                // depends on the other wall.
                let farthest = rounding.max(LONGEST_JOINT * line.length);
                self.each_near([point; 2], farthest, &mut stack, |other, offset| {
                    let (there, seen) = (self.line(other), less(point, offset));
                    let is_itself = other == index && offset == [0.0; 2];
                    let distance = there.distance(seen);
                    let most = rounding.max(LONGEST_JOINT * line.length.min(there.length));
                    let [own, of_other] = [index, other].map(|of| &self.all[of as usize]);
                    if !is_itself && distance <= most && of_other.stops_all_of(own) {
                        // Within rounding an end lies on the wall for discs of any size. Other
                        // distances are kept, because they depend on the radius, and are compared
                        // in `covering`.
                        let distance = if distance <= rounding { 0.0 } else { distance };
                        let found = Covering { image: Image { wall: other, offset }, distance };
                        let added = memory::push(&mut covering, found);
                        // On a torus the ends of one wall may be at the same point. Of two walls that do not stop
                        // the same discs the end of that which stops more acts.
                        let is_before = other < index || other == index && end == 1;
                        let is_before = is_before || !own.stops_all_of(of_other);
                        // Walls that are solid from one side keep their ends: each acts on what is left of its wall.
                        let is_shared = is_before && there.ends.contains(&seen) && !line.is_one_way;
                        let both = added.and_then(|()| match is_shared {
                            true => memory::push(&mut shared, (index, end)),
                            false => Ok(()),
                        });
                        if both.is_err() {
                            done = both;
                        }
                    }
                });
                // The nearest first: the search for a disc ends at the first that is too far for
                // its radius.
                covering[first..].sort_unstable_by(|a, b| {
                    let by_wall = a.image.wall.cmp(&b.image.wall);
                    a.distance.total_cmp(&b.distance).then(by_wall)
                });
                starts.push(covering.len() as u32);
            }
        }
        done?;
        (self.starts, self.covering) = (starts, covering);
        // Of several ends at one point the first acts. Otherwise one corner would give several
        // impulses.
        for (index, end) in shared {
            self.lines[self.indices[index as usize] as usize].has_end[end] = false;
        }
        Ok(())
    }

    /// The other walls on which an end lies, for a disc of this radius.
    fn covering(&self, index: u32, end: usize, radius: f64) -> impl Iterator<Item = &Image> {
        let at = 2 * index as usize + end;
        let all = &self.covering[self.starts[at] as usize..self.starts[at + 1] as usize];
        let is_on = move |of: &&Covering| of.distance <= JOINED * radius;
        all.iter().take_while(is_on).map(|of| &of.image)
    }

    /// Whether a part of a wall acts on a disc of this radius with its centre at a point.
    fn acts(&self, index: u32, part: Part, point: Vector, radius: f64) -> bool {
        let line = self.line(index);
        if line.part_at(point) != part {
            return false;
        }
        let Part::End(end) = part else { return true };
        let is_beside = |other: &Image| {
            let (there, seen) = (self.line(other.wall), less(point, other.offset));
            there.part_at(seen) == Part::Side && there.faces(seen)
        };
        line.has_end[end] && line.faces(point) && !self.covering(index, end, radius).any(is_beside)
    }
}

/// Appends the images of walls on a torus that discs near it may touch, and moves the bounds of the
/// walls to the torus.
fn add_images(
    all: &[Wall],
    period: &Period<f64>,
    images: &mut Vec<Image>,
    bounds: &mut Vec<[f32; 4]>,
) -> Result<()> {
    let mut done = Ok(());
    for (wall, index) in (0..).zip(0..all.len()) {
        // Discs begin a step on the torus, so the wall is moved there, too.
        let torus_offset = torus_offset(all[index].exact_ends(), period);
        let moved = |[a, b, c, d]: [f32; 4], by: Vector| {
            let add = |v: f32, by: f64| (f64::from(v) + by) as f32;
            [add(a, by[0]), add(b, by[1]), add(c, by[0]), add(d, by[1])]
        };
        let own = moved(bounds[index], torus_offset);
        bounds[index] = own;
        // The swept box decides which images are near, because the wall may move towards them.
        let [a, b, c, d] = own.map(f64::from);
        each_image([[a, b], [c, d]], period, |offset| {
            let image = memory::push(images, Image { wall, offset });
            let both = image.and_then(|()| memory::push(bounds, moved(own, offset)));
            if both.is_err() {
                done = both;
            }
        });
    }
    done
}

/// Whether elastic discs keep their energy at all of these walls.
fn are_elastic(all: &[Wall]) -> bool {
    all.iter().all(|wall| wall.is_sensor || wall.surface.is_elastic())
}

/// Refuses too many walls.
pub fn check_count(count: usize) -> Result<()> {
    if count > MAX_WORLD_WALLS {
        let rule = format!("a world holds at most {MAX_WORLD_WALLS} walls");
        return Err(Error::of("segments", format!("{count} walls"), &rule));
    }
    Ok(())
}

/// Refuses the first wall that is not finite, too large, without length, or too long for a torus. `argument` has its
/// ends.
pub fn check_walls(all: &[Wall], container: Container, argument: &'static str) -> Result<()> {
    for (index, wall) in all.iter().enumerate() {
        let Wall { ends: [[a, b], [c, d]], velocity: [u, v], surface, .. } = *wall;
        let refuse =
            |rule: &str| Err(Error::at(argument, index, format!("(({a}, {b}), ({c}, {d}))"), rule));
        if ![a, b, c, d].iter().all(|v| v.is_finite() && v.abs() <= FARTHEST) {
            return refuse("its coordinates must be finite and at most 1e18");
        }
        let exact = wall.exact_ends();
        if exact.map(|end| end.map(|v| v as f32)) != wall.ends {
            return refuse("its residuals must be those of rounding");
        }
        // In float64, so that only equal ends have no distance.
        if exact[0] == exact[1] {
            return refuse("its ends must differ");
        }
        if ![u, v].iter().all(|speed| speed.is_finite() && speed.abs() <= FARTHEST) {
            let rule = "both components must be finite and at most 1e18";
            return Err(Error::at("velocities", index, format!("({u}, {v})"), rule));
        }
        surface.validate(["restitution", "friction"], index)?;
    }
    check_torus(&container.period().exact(), all, argument)
}

/// Orders walls whose bounds have the same centre.
fn compare(all: &[Wall], a: usize, b: usize) -> Ordering {
    let numbers = |index: usize| {
        let Wall { ends, residuals, velocity, .. } = all[index];
        ends.into_iter().chain(residuals).chain([velocity]).flatten()
    };
    let pairs = numbers(a).zip(numbers(b));
    pairs.map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne()).unwrap_or(a.cmp(&b))
}

#[cfg(test)]
mod tests;
