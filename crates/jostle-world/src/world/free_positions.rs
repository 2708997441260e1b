//! Random positions at which new discs touch nothing: random sequential addition (B. Widom, *Random Sequential
//! Addition of Hard Spheres to a Volume*, Journal of Chemical Physics 44, 1966).

use std::cell::RefCell;
use std::cmp::Reverse;

use super::World;
use crate::container::Container;
use crate::forces::chance::{Chance, mixed};
use crate::particles::{self, Particles};
use crate::trajectory::{dot, vector};
use crate::walls::Walls;
use jostle_base::error::{Error, Result};
use jostle_base::interrupt;
use jostle_base::memory;
use jostle_index::period::Period;
use jostle_index::quadtree::Quadtree;
use jostle_index::query::nearest;
use jostle_index::shapes::{Each, Shapes};

/// Positions that are tried for one disc. If a share f of the region is free, all miss it with the probability
/// exp(−f · ATTEMPTS): a share of a ten-thousandth is found but for one time in 20,000. They take about 10 ms.
const ATTEMPTS: usize = 100_000;

/// The tree answers in float32. A distance that may be smaller than wanted by its rounding counts as too small.
const ROUNDING: f32 = 1e-6;

/// What [`World::free_positions`] places.
#[derive(Debug)]
pub struct NewDiscs<'a> {
    /// Their number.
    pub count: usize,
    /// Their radii.
    pub radii: &'a Each<f32>,
    /// Where they are to lie; None is the container or the period of the world.
    pub region: Option<Container>,
    /// Least distance of their surfaces from each other, from particles and from walls.
    pub gap: f32,
    /// Seed of the random numbers.
    pub seed: u32,
}

impl World {
    /// Random positions for new discs, in their order, at which they touch neither each other nor particles, walls or
    /// sides. Sensors and filters do not count. Nothing is added. An error with the number of discs that found room
    /// if one finds none.
    pub fn free_positions(&self, discs: &NewDiscs<'_>) -> Result<Vec<[f32; 2]>> {
        let region = self.region_of(discs)?;
        let mut order = memory::collect(0..discs.count as u32)?;
        // Large discs find no room between many small ones. Radii are not negative, so their bits have their order.
        order.sort_by_key(|&nth| Reverse(discs.radii.at(nth as usize).to_bits()));
        let mut search = Search::new(self, discs, region)?;
        let mut positions = memory::filled(discs.count, [0.0; 2])?;
        for (found, nth) in order.into_iter().enumerate() {
            interrupt::check()?;
            let radius = discs.radii.at(nth as usize);
            let position = search.position_for(radius)?.ok_or_else(|| {
                let rule = format!(
                    "there is room for {found}, and none was found for the next one, of radius {radius}; \
                     random positions fill at most about half of a region"
                );
                Error::of("n", discs.count, &rule)
            })?;
            positions[nth as usize] = position;
            search.placed.add(position, radius)?;
        }
        Ok(positions)
    }

    /// The region in which the discs are to lie. Refuses arguments out of range.
    fn region_of(&self, discs: &NewDiscs<'_>) -> Result<Container> {
        if discs.count >= NONE as usize {
            return Err(Error::of("n", discs.count, &format!("it must be below {NONE}")));
        }
        discs.radii.check_len("radii", discs.count)?;
        discs.radii.check(particles::check_radii)?;
        if !(discs.gap >= 0.0 && discs.gap <= particles::FARTHEST) {
            return Err(Error::of("gap", discs.gap, "it must be finite and at least 0"));
        }
        let region = discs.region.unwrap_or(self.settings.container);
        if region == Container::None {
            let rule = "a world without container and period needs a Box or a Circle";
            return Err(Error::of("region", "None", rule));
        }
        discs.radii.check(|radii| region.check_fit(radii))?;
        discs.radii.check(|radii| self.settings.container.check_fit(radii))?;
        Ok(region)
    }
}

/// The search for free positions.
struct Search<'a> {
    region: Container,
    container: Container,
    walls: &'a Walls,
    /// The particles that there are, without sensors.
    particles: Quadtree<f32>,
    placed: Placed,
    gap: f32,
    chance: Chance,
    stack: RefCell<Vec<u32>>,
}

impl<'a> Search<'a> {
    fn new(world: &'a World, discs: &NewDiscs<'_>, region: Container) -> Result<Self> {
        let container = world.settings.container;
        Ok(Self {
            region,
            container,
            walls: &world.boundaries.walls,
            particles: tree_of_solids(world)?,
            placed: Placed::new(discs.count, discs.gap, container.period())?,
            gap: discs.gap,
            chance: Chance::of(discs.seed, &[]),
            stack: RefCell::default(),
        })
    }

    /// A free position for a disc; None if no attempt finds one.
    fn position_for(&mut self, radius: f32) -> Result<Option<[f32; 2]>> {
        for _ in 0..ATTEMPTS {
            let position = random_position(&mut self.chance, &self.region, radius);
            if self.is_free(position, radius)? {
                return Ok(Some(position));
            }
        }
        Ok(None)
    }

    fn is_free(&self, position: [f32; 2], radius: f32) -> Result<bool> {
        let extent = radius + self.gap;
        Ok(self.region.clamp(position, radius) == position
            && self.container.clamp(position, extent) == position
            && self.placed.are_far(position, radius)
            && self.walls_are_far(position, extent)
            && self.particles_are_far(position, extent)?)
    }

    fn walls_are_far(&self, position: [f32; 2], extent: f32) -> bool {
        if self.walls.is_empty() {
            return true;
        }
        let (position, extent) = (position.map(f64::from), f64::from(extent));
        let mut are_far = true;
        self.walls.each_distance(position, extent, &mut self.stack.borrow_mut(), |distance| {
            are_far &= distance >= extent;
        });
        are_far
    }

    fn particles_are_far(&self, position: [f32; 2], extent: f32) -> Result<bool> {
        if self.particles.is_empty() {
            return Ok(true);
        }
        let extent = extent + ROUNDING * (extent + position[0].abs() + position[1].abs());
        let found = nearest(&self.particles, &[position], (1, extent), None)?;
        Ok(found.distances.iter().all(|&distance| distance >= extent))
    }
}

/// A tree of the particles that are no sensors.
fn tree_of_solids(world: &World) -> Result<Quadtree<f32>> {
    let all = world.bodies.particles()?;
    let Particles { positions, radii, .. } = &all;
    let mut solid = Vec::new();
    memory::extend(&mut solid, (0..all.len()).filter(|&row| !all.is_sensor(row)))?;
    let centers = memory::collect(solid.iter().map(|&row| positions[row]))?;
    let radii = memory::collect(solid.iter().map(|&row| radii[row]))?;
    let shapes = Shapes::circles(centers, Each::Rows(radii))?;
    Quadtree::new(&shapes.in_period(world.settings.container.period())?, world.settings.tree)
}

/// A random position in a region, nearly always one at which a disc is inside.
fn random_position(chance: &mut Chance, region: &Container, radius: f32) -> [f32; 2] {
    let radius = f64::from(radius);
    let mut between = |low: f64, high: f64| low + (high - low) * chance.unit();
    match region {
        Container::None => [0.0; 2],
        Container::Box { min, max } => {
            [0, 1].map(|k| between(f64::from(min[k]) + radius, f64::from(max[k]) - radius) as f32)
        }
        // In the square around the circle: a position outside of the circle is not free.
        Container::Circle { center, radius: outer } => {
            let far = f64::from(*outer) - radius;
            center.map(|at| between(f64::from(at) - far, f64::from(at) + far) as f32)
        }
        Container::Torus { size } => {
            let period = region.period();
            period.wrap(size.map(|side| between(0.0, f64::from(side)) as f32))
        }
    }
}

/// The discs that were placed, each not larger than those before.
///
/// They are in grids, one for each range of radii. A cell is as wide as the largest distance at which a disc of the
/// grid touches one of those after it. So a disc touches only discs in the nine cells around it. All grids share
/// one table of lists: unequal cells may have the same entry, which costs tests and changes no result.
struct Placed {
    period: Period<f64>,
    gap: f64,
    grids: Vec<Grid>,
    discs: Vec<([f32; 2], f32)>,
    /// The last disc of each list, [`NONE`] if it is empty.
    last: Vec<u32>,
    /// The disc before each in its list.
    before: Vec<u32>,
}

/// The end of a list.
const NONE: u32 = u32::MAX;

/// A grid of discs with radii from `largest` to its half.
struct Grid {
    largest: f32,
    /// Width and height of a cell: whole parts of a period.
    cell: [f64; 2],
    /// Number of cells along each axis of a period; 0 without one.
    count: [i64; 2],
}

impl Placed {
    fn new(len: usize, gap: f32, period: Period<f32>) -> Result<Self> {
        Ok(Self {
            period: period.exact(),
            gap: f64::from(gap),
            grids: Vec::new(),
            discs: memory::with_capacity(len)?,
            last: memory::filled((2 * len).next_power_of_two(), NONE)?,
            before: memory::with_capacity(len)?,
        })
    }

    /// Adds a disc that is not larger than those before.
    fn add(&mut self, position: [f32; 2], radius: f32) -> Result<()> {
        if self.grids.last().is_none_or(|grid| 2.0 * radius < grid.largest) {
            let width = 2.0 * f64::from(radius) + self.gap;
            memory::push(&mut self.grids, Grid::new(radius, width, &self.period))?;
        }
        let number = self.grids.len() - 1;
        let list = self.list(number, self.grids[number].cell_of(position));
        self.before.push(self.last[list]);
        self.last[list] = self.discs.len() as u32;
        self.discs.push((position, radius));
        Ok(())
    }

    /// Whether a disc that is not larger than those before is farther than the gap from all.
    fn are_far(&self, position: [f32; 2], radius: f32) -> bool {
        let offsets = (-1..=1).flat_map(|y| (-1..=1).map(move |x| [x, y]));
        let mut cells = self.grids.iter().enumerate().flat_map(|(number, grid)| {
            let [x, y] = grid.cell_of(position);
            let near =
                offsets.clone().map(move |[i, j]| [x.saturating_add(i), y.saturating_add(j)]);
            near.map(move |cell| (number, grid.wrap(cell)))
        });
        cells.all(|(number, cell)| self.are_far_in(self.list(number, cell), position, radius))
    }

    fn are_far_in(&self, list: usize, position: [f32; 2], radius: f32) -> bool {
        let mut next = self.last[list];
        while let Some(&(other, other_radius)) = self.discs.get(next as usize) {
            let offset = vector(|k| f64::from(position[k]) - f64::from(other[k]));
            let offset = self.period.minimum_image_within(offset);
            let least = f64::from(radius) + f64::from(other_radius) + self.gap;
            if dot(offset, offset) < least * least {
                return false;
            }
            next = self.before[next as usize];
        }
        true
    }

    /// The list of a cell.
    fn list(&self, grid: usize, [x, y]: [i64; 2]) -> usize {
        let word = mixed(mixed(x as u64 ^ (grid as u64) << 48) ^ y as u64);
        word as usize & (self.last.len() - 1)
    }
}

impl Grid {
    fn new(largest: f32, width: f64, period: &Period<f64>) -> Self {
        let sides = period.sides();
        // Points without a gap touch nothing, so any cells will do.
        let width = if width > 0.0 { width } else { 1.0 };
        let count = [0, 1].map(|k| ((sides[k] / width) as i64).max(i64::from(period.is_along(k))));
        let cell = [0, 1].map(|k| if count[k] > 0 { sides[k] / count[k] as f64 } else { width });
        Self { largest, cell, count }
    }

    /// The cell of a position.
    fn cell_of(&self, position: [f32; 2]) -> [i64; 2] {
        self.wrap([0, 1].map(|k| (f64::from(position[k]) / self.cell[k]).floor() as i64))
    }

    /// The same cell in the first period.
    fn wrap(&self, cell: [i64; 2]) -> [i64; 2] {
        [0, 1].map(|k| match self.count[k] {
            0 => cell[k],
            count => cell[k].rem_euclid(count),
        })
    }
}
