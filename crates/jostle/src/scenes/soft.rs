//! Bodies of discs and springs.

use super::placing::Area;
use super::random::Random;
use super::{Start, boxed};
use crate::forces::{Force, Spring, Springs};
use crate::particles::Particles;
use crate::space::Id;
use crate::world::WorldSettings;

/// Particles of one room, which holds a cloth, a chain and some bodies. Where more are
/// asked for, rooms stand side by side and their walls are left out.
const ROOM_COUNT: usize = 800;
const ROOM: [f32; 2] = [1000.0, 625.0];

/// Radius of the discs in bodies and their distance at rest: a gap to squeeze.
const DISC: f32 = 6.0;
const PITCH: f32 = 14.0;

/// Bodies: their discs, and the square of the reach from the middle one, in pitches, within
/// which a triangular lattice has so many. These are the roundest.
const BODIES: [(usize, f32); 4] = [(85, 21.0), (31, 7.0), (55, 13.0), (19, 4.0)];
const SMALLEST: (usize, f32) = (7, 1.0);
const SINGLE: (usize, f32) = (1, 0.0);

/// Their fastest at the start, px/s, and the lower hem of the cloth.
const SPEED: f32 = 250.0;
const SWAY: f32 = 320.0;

/// The same for cloth and chain.
const THREAD: f32 = 3.5;
const MESH: f32 = 9.5;
const LINK: f32 = 4.5;
const LINK_PITCH: f32 = 9.5;
const BOB: f32 = 24.0;

/// Shares of the particles in the cloth and in the chain.
const IN_CLOTH: f32 = 0.34;
const IN_CHAIN: f32 = 0.058;

/// A way of tying: the square of the angular frequency of one disc on one spring, and
/// the share of critical damping.
#[derive(Clone, Copy)]
struct Tie {
    stiffness: f32,
    damping: f32,
}

const FLESH: Tie = Tie { stiffness: 1000.0, damping: 0.04 };
const CLOTH: Tie = Tie { stiffness: 20_000.0, damping: 0.02 };
const SHEAR: Tie = Tie { stiffness: 800.0, damping: 0.02 };
const CHAIN: Tie = Tie { stiffness: 60_000.0, damping: 0.05 };

/// Discs and the springs between them, as they are put together.
#[derive(Default)]
struct Tissue {
    particles: Particles,
    springs: Vec<Spring>,
}

impl Tissue {
    /// Adds a disc and returns its row.
    fn disc(&mut self, place: [f32; 2], velocity: [f32; 2], radius: f32, density: f32) -> u32 {
        let row = self.particles.len() as u32;
        self.particles.extend(&Particles::new(vec![place], vec![velocity], vec![radius], density));
        row
    }

    /// Ties two discs at their present distance.
    fn tie(&mut self, a: u32, b: u32, tie: Tie) {
        let [p, q] = [a, b].map(|row| self.particles.positions[row as usize]);
        let offset = [q[0] - p[0], q[1] - p[1]];
        let masses = [a, b].map(|row| self.particles.masses[row as usize]);
        let mass = masses[0].min(masses[1]);
        self.springs.push(Spring {
            pair: [a, b].map(Id::from),
            length: (offset[0] * offset[0] + offset[1] * offset[1]).sqrt(),
            stiffness: tie.stiffness * mass,
            damping: 2.0 * tie.damping * tie.stiffness.sqrt() * mass,
            max_stretch: f32::INFINITY,
        });
    }

    /// A sheet that hangs from its first row, which nothing moves.
    fn cloth(&mut self, [columns, rows]: [usize; 2], corner: [f32; 2]) {
        let first = self.particles.len();
        let row_of = |column: usize, row: usize| (first + row * columns + column) as u32;
        for row in 0..rows {
            for column in 0..columns {
                let place = [corner[0] + column as f32 * MESH, corner[1] + row as f32 * MESH];
                let sway = SWAY * row as f32 / rows as f32;
                let disc = self.disc(place, [sway, 0.0], THREAD, 1.0);
                self.particles.movable[disc as usize] = row > 0;
            }
        }
        for (column, row) in (0..rows).flat_map(|row| (0..columns).map(move |c| (c, row))) {
            let this = row_of(column, row);
            let (right, down) = (column + 1 < columns, row + 1 < rows);
            if right {
                self.tie(this, row_of(column + 1, row), CLOTH);
            }
            if down {
                self.tie(this, row_of(column, row + 1), CLOTH);
            }
            if right && down {
                self.tie(this, row_of(column + 1, row + 1), SHEAR);
                self.tie(row_of(column + 1, row), row_of(column, row + 1), SHEAR);
            }
        }
    }

    /// Links from an immovable one outwards, and a heavy bob at the end.
    fn chain(&mut self, links: usize, anchor: [f32; 2], along: [f32; 2]) {
        let mut last = self.disc(anchor, [0.0; 2], LINK, 2.0);
        self.particles.movable[last as usize] = false;
        for link in 1..=links {
            let end = link == links;
            let way = link as f32 * LINK_PITCH + if end { BOB - LINK } else { 0.0 };
            let place = [0, 1].map(|k| anchor[k] + along[k] * way);
            let radius = if end { BOB } else { LINK };
            let next = self.disc(place, [0.0; 2], radius, 2.0);
            self.tie(last, next, CHAIN);
            last = next;
        }
    }

    /// A round body on a triangular lattice. Springs to the nearest hold it together, cross
    /// springs to the second nearest keep its area.
    fn body(&mut self, square: f32, center: [f32; 2], velocity: [f32; 2], density: f32) {
        let first = self.particles.len();
        let most = (2.0 * square.sqrt()) as i32 + 1;
        for (row, column) in (-most..=most).flat_map(|r| (-most..=most).map(move |c| (r, c))) {
            if (row * row + row * column + column * column) as f32 <= square {
                let across = column as f32 + 0.5 * row as f32;
                let place = [across, row as f32 * 0.75f32.sqrt()];
                let place = [0, 1].map(|k| center[k] + place[k] * PITCH);
                self.disc(place, velocity, DISC, density);
            }
        }
        let rows = first..self.particles.len();
        for a in rows.clone() {
            for b in a + 1..rows.end {
                let [p, q] = [a, b].map(|row| self.particles.positions[row]);
                let offset = [q[0] - p[0], q[1] - p[1]];
                let square = offset[0] * offset[0] + offset[1] * offset[1];
                // The second nearest are √3 away, the third 2.
                if square < 3.5 * PITCH * PITCH {
                    self.tie(a as u32, b as u32, FLESH);
                }
            }
        }
    }
}

/// Rooms along x and y, and the size of each.
fn rooms(n: usize) -> ([usize; 2], [f32; 2]) {
    let count = (n / ROOM_COUNT).max(1);
    let columns = (1..).find(|columns| columns * columns >= count).unwrap_or(1);
    let share = n as f32 / (count * ROOM_COUNT) as f32;
    ([columns, count.div_ceil(columns)], ROOM.map(|v| v * share.sqrt().max(0.3)))
}

pub fn springs_view(n: usize) -> Area {
    let (rooms, size) = rooms(n);
    [0.0, 0.0, rooms[0] as f32 * size[0], rooms[1] as f32 * size[1]]
}

/// `n` particles in all, those included that hold cloths and chains.
pub fn springs(n: usize, random: &mut Random) -> Start {
    let (rooms, size) = rooms(n);
    let count = (n / ROOM_COUNT).max(1);
    let mut tissue = Tissue::default();
    for room in 0..count {
        let corner = [(room % rooms[0]) as f32 * size[0], (room / rooms[0]) as f32 * size[1]];
        furnish(n * (room + 1) / count - n * room / count, corner, size, &mut tissue, random);
    }
    let settings = WorldSettings {
        gravity: [0.0, 600.0],
        drag: 0.05,
        restitution: 0.4,
        ..boxed(springs_view(n))
    };
    Start::new(tissue.particles, settings).with(Force::Springs(Springs(tissue.springs)))
}

/// Fills a room with `n` particles: the cloth on the left, the chain on the right, and
/// bodies on shelves below.
fn furnish(n: usize, corner: [f32; 2], size: [f32; 2], tissue: &mut Tissue, random: &mut Random) {
    let at = |x: f32, y: f32| [corner[0] + x * size[0], corner[1] + y * size[1]];
    let before = tissue.particles.len();
    let columns = (0.6 * IN_CLOTH * n as f32).sqrt() as usize;
    let rows = columns * 5 / 3;
    if rows > 1 {
        tissue.cloth([columns, rows], at(0.36, 0.04));
    }
    let links = (IN_CHAIN * n as f32) as usize;
    if links > 3 {
        tissue.chain(links, at(0.69, 0.04), [0.6, 0.8]);
    }
    let mut left = n - (tissue.particles.len() - before);
    let (mut pen, mut shelf) = (at(0.03, 0.97), 0.0f32);
    for kind in 0.. {
        let wanted = BODIES[kind % BODIES.len()];
        let (count, square) = match left {
            0 => break,
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
        tissue.body(square, center, velocity, random.between(1.0, 4.0));
        pen[0] += 2.0 * radius + PITCH;
        shelf = shelf.max(2.0 * radius);
        left -= count;
    }
}
