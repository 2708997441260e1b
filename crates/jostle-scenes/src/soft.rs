//! Scene: soft bodies, a cloth and a chain of discs and springs.

use super::placing::Area;
use super::random::Random;
use super::start::{Start, boxed};
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::memory;
use jostle_world::forces::{Influence, Spring, Springs};
use jostle_world::particles::Particles;
use jostle_world::world::WorldSettings;

/// Number of particles of one cell, which has a cloth, a chain and some bodies. Larger scenes have
/// several cells side by side, without walls between them.
const ROOM_COUNT: usize = 800;
const ROOM: [f32; 2] = [1000.0, 625.0];

/// Radius of the discs in bodies, and their distance at rest, with a gap for compression.
const DISC: f32 = 6.0;
const PITCH: f32 = 14.0;

/// Bodies: the number of discs, and the squared radius, in pitches, of the circle that contains
/// this number of points of a triangular lattice.
const BODIES: [(usize, f32); 4] = [(85, 21.0), (31, 7.0), (55, 13.0), (19, 4.0)];
const SMALLEST: (usize, f32) = (7, 1.0);
const SINGLE: (usize, f32) = (1, 0.0);

/// Maximum speed at the start, px/s, of bodies and of the lower edge of the cloth.
const SPEED: f32 = 250.0;
const CLOTH_SPEED: f32 = 320.0;

/// Radii and distances of the discs of the cloth and of the chain, and the radius of the last disc.
const THREAD: f32 = 3.5;
const MESH: f32 = 9.5;
const LINK: f32 = 4.5;
const LINK_PITCH: f32 = 9.5;
const BOB: f32 = 24.0;

/// Fractions of the particles in the cloth and in the chain.
const IN_CLOTH: f32 = 0.34;
const IN_CHAIN: f32 = 0.058;

/// A kind of springs: the squared angular frequency of one disc on one spring, and the damping
/// ratio.
#[derive(Clone, Copy)]
struct SpringKind {
    stiffness: f32,
    damping: f32,
}

const BODY: SpringKind = SpringKind { stiffness: 1000.0, damping: 0.04 };
const CLOTH: SpringKind = SpringKind { stiffness: 20_000.0, damping: 0.02 };
const SHEAR: SpringKind = SpringKind { stiffness: 800.0, damping: 0.02 };
const CHAIN: SpringKind = SpringKind { stiffness: 60_000.0, damping: 0.05 };

/// Discs and springs under construction.
#[derive(Default)]
struct SoftBodies {
    particles: Particles,
    springs: Vec<Spring>,
}

impl SoftBodies {
    /// Adds a disc and returns its row.
    fn disc(
        &mut self,
        place: [f32; 2],
        velocity: [f32; 2],
        radius: f32,
        density: f32,
    ) -> Result<u32> {
        let row = self.particles.len() as u32;
        let disc = Particles::new(vec![place], vec![velocity], vec![radius], density);
        self.particles.try_extend(&disc)?;
        Ok(row)
    }

    /// Adds a spring between two discs with their present distance as rest length.
    fn connect(&mut self, a: u32, b: u32, kind: SpringKind) -> Result<()> {
        let [p, q] = [a, b].map(|row| self.particles.positions[row as usize]);
        let offset = [q[0] - p[0], q[1] - p[1]];
        let masses = [a, b].map(|row| self.particles.masses[row as usize]);
        // Stiffness and damping are given for one disc on one spring. In proportion to the lighter
        // mass the frequency, and with it the step that a spring needs, is the same for all sizes.
        let mass = masses[0].min(masses[1]);
        let spring = Spring {
            pair: [a, b].map(Id::from),
            length: (offset[0] * offset[0] + offset[1] * offset[1]).sqrt(),
            stiffness: kind.stiffness * mass,
            damping: 2.0 * kind.damping * kind.stiffness.sqrt() * mass,
            max_stretch: f32::INFINITY,
        };
        memory::push(&mut self.springs, spring)
    }

    /// A cloth that hangs from its first row, which is immovable.
    fn cloth(&mut self, [columns, rows]: [usize; 2], corner: [f32; 2]) -> Result<()> {
        let first = self.particles.len();
        let row_of = |column: usize, row: usize| (first + row * columns + column) as u32;
        for row in 0..rows {
            for column in 0..columns {
                let place = [corner[0] + column as f32 * MESH, corner[1] + row as f32 * MESH];
                let sway = CLOTH_SPEED * row as f32 / rows as f32;
                let disc = self.disc(place, [sway, 0.0], THREAD, 1.0)?;
                self.particles.movable[disc as usize] = row > 0;
            }
        }
        for (column, row) in (0..rows).flat_map(|row| (0..columns).map(move |c| (c, row))) {
            let this = row_of(column, row);
            let (right, down) = (column + 1 < columns, row + 1 < rows);
            if right {
                // Stiff along the threads and soft across: a square mesh has no resistance to shear
                // without diagonals.
                self.connect(this, row_of(column + 1, row), CLOTH)?;
            }
            if down {
                self.connect(this, row_of(column, row + 1), CLOTH)?;
            }
            if right && down {
                self.connect(this, row_of(column + 1, row + 1), SHEAR)?;
                self.connect(row_of(column + 1, row), row_of(column, row + 1), SHEAR)?;
            }
        }
        Ok(())
    }

    /// A chain from an immovable disc to a heavy one at the end.
    fn chain(&mut self, links: usize, anchor: [f32; 2], along: [f32; 2]) -> Result<()> {
        let mut last = self.disc(anchor, [0.0; 2], LINK, 2.0)?;
        self.particles.movable[last as usize] = false;
        for link in 1..=links {
            let end = link == links;
            let distance = link as f32 * LINK_PITCH + if end { BOB - LINK } else { 0.0 };
            let place = [0, 1].map(|k| anchor[k] + along[k] * distance);
            let radius = if end { BOB } else { LINK };
            let next = self.disc(place, [0.0; 2], radius, 2.0)?;
            self.connect(last, next, CHAIN)?;
            last = next;
        }
        Ok(())
    }

    /// A round body on a triangular lattice, with springs between nearest neighbours and, for its
    /// shear stiffness, between second neighbours.
    fn body(
        &mut self,
        square: f32,
        center: [f32; 2],
        velocity: [f32; 2],
        density: f32,
    ) -> Result<()> {
        let first = self.particles.len();
        // Axial coordinates of a triangular lattice: the squared distance of a site is row² + row ·
        // column + column².
        let most = (2.0 * square.sqrt()) as i32 + 1;
        for (row, column) in (-most..=most).flat_map(|r| (-most..=most).map(move |c| (r, c))) {
            if (row * row + row * column + column * column) as f32 <= square {
                let across = column as f32 + 0.5 * row as f32;
                let place = [across, row as f32 * 0.75f32.sqrt()];
                let place = [0, 1].map(|k| center[k] + place[k] * PITCH);
                self.disc(place, velocity, DISC, density)?;
            }
        }
        let rows = first..self.particles.len();
        for a in rows.clone() {
            for b in a + 1..rows.end {
                let [p, q] = [a, b].map(|row| self.particles.positions[row]);
                let offset = [q[0] - p[0], q[1] - p[1]];
                let square = offset[0] * offset[0] + offset[1] * offset[1];
                // Second neighbours are at the distance √3, third ones at 2.
                if square < 3.5 * PITCH * PITCH {
                    self.connect(a as u32, b as u32, BODY)?;
                }
            }
        }
        Ok(())
    }
}

/// Number of cells along x and y, and the size of each.
fn cells(n: usize) -> ([usize; 2], [f32; 2]) {
    let count = (n / ROOM_COUNT).max(1);
    let columns = (1..).find(|columns| columns * columns >= count).unwrap_or(1);
    let share = n as f32 / (count * ROOM_COUNT) as f32;
    ([columns, count.div_ceil(columns)], ROOM.map(|v| v * share.sqrt().max(0.3)))
}

pub(crate) fn springs_view(n: usize) -> Area {
    let (counts, size) = cells(n);
    [0.0, 0.0, counts[0] as f32 * size[0], counts[1] as f32 * size[1]]
}

/// `n` particles in all, including the immovable ones of cloths and chains.
pub(crate) fn springs(n: usize, random: &mut Random) -> Result<Start> {
    let (counts, size) = cells(n);
    let count = (n / ROOM_COUNT).max(1);
    let mut tissue = SoftBodies::default();
    for cell in 0..count {
        let corner = [(cell % counts[0]) as f32 * size[0], (cell / counts[0]) as f32 * size[1]];
        fill_cell(n * (cell + 1) / count - n * cell / count, corner, size, &mut tissue, random)?;
    }
    let settings = WorldSettings { gravity: [0.0, 600.0], drag: 0.05, ..boxed(springs_view(n)) };
    let springs = Influence::Springs(Springs(tissue.springs));
    Ok(Start::new(tissue.particles, settings).restitution(0.4).with(springs))
}

/// Fills a cell with `n` particles: the cloth on the left, the chain on the right, and rows of
/// bodies below.
fn fill_cell(
    n: usize,
    corner: [f32; 2],
    size: [f32; 2],
    tissue: &mut SoftBodies,
    random: &mut Random,
) -> Result<()> {
    let at = |x: f32, y: f32| [corner[0] + x * size[0], corner[1] + y * size[1]];
    let before = tissue.particles.len();
    // Five rows for three columns.
    let columns = (0.6 * IN_CLOTH * n as f32).sqrt() as usize;
    let rows = columns * 5 / 3;
    if rows > 1 {
        tissue.cloth([columns, rows], at(0.36, 0.04))?;
    }
    let links = (IN_CHAIN * n as f32) as usize;
    if links > 3 {
        tissue.chain(links, at(0.69, 0.04), [0.6, 0.8])?;
    }
    let mut left = n - (tissue.particles.len() - before);
    let (mut pen, mut shelf) = (at(0.03, 0.97), 0.0f32);
    for kind in 0.. {
        let wanted = BODIES[kind % BODIES.len()];
        let (count, square) = match left {
            0 => break,
            // Bodies in turn while they fit, then the smallest, then single discs: exactly `n`
            // particles for every n.
            _ if wanted.0 <= left => wanted,
            _ if left >= SMALLEST.0 => SMALLEST,
            _ => SINGLE,
        };
        let radius = square.sqrt() * PITCH + DISC;
        if pen[0] + 2.0 * radius > at(0.75, 0.0)[0] && shelf > 0.0 {
            pen = [at(0.03, 0.0)[0], pen[1] - shelf - PITCH];
            shelf = 0.0;
        }
        let center = [pen[0] + radius, pen[1] - radius];
        let velocity = random.in_disc().map(|v| v * SPEED);
        tissue.body(square, center, velocity, random.between(1.0, 4.0))?;
        pen[0] += 2.0 * radius + PITCH;
        shelf = shelf.max(2.0 * radius);
        left -= count;
    }
    Ok(())
}
