//! Scene: a column of grains with friction collapses into a heap.

use super::placing::{Area, immovable, lattice};
use super::random::Random;
use super::start::{Start, boxed};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_world::particles::Particles;
use jostle_world::world::WorldSettings;

/// Radii of the grains, and of the static discs of the rough ground.
const GRAINS: [f32; 2] = [2.5, 3.5];
const BEAD: f32 = 3.0;

/// Distance between grains at the start.
const PITCH: f32 = 2.02 * GRAINS[1];

/// Height of the column divided by its width.
const SLENDER: f32 = 1.5;

/// Half width of the ground divided by the height of the column.
const REACH: f32 = 2.5;

const FRICTION: f32 = 0.8;

/// Width and height of the column.
fn column(n: usize) -> [f32; 2] {
    let columns = (n as f32 / SLENDER).sqrt().ceil().max(1.0);
    [columns, (n as f32 / columns).ceil().max(1.0)].map(|count| count * PITCH)
}

fn half_width(n: usize) -> f32 {
    (REACH * column(n)[1]).max(20.0 * PITCH)
}

pub(crate) fn heap_view(n: usize) -> Area {
    let half_width = half_width(n);
    // The aspect ratio of a screen; the column is lower.
    [-half_width, -1.1 * half_width, half_width, 2.0 * BEAD]
}

/// The static discs of the ground, then `n` grains.
pub(crate) fn heap(n: usize, random: &mut Random) -> Result<Start> {
    // Counted from the middle, so that the ground is symmetric.
    let half_beads = (half_width(n) / (2.0 * BEAD)) as i32;
    let beads = (-half_beads..=half_beads).map(|at| [2.0 * BEAD * at as f32, 0.0]).collect();
    let mut particles = immovable(beads, BEAD)?;
    let [width, height] = column(n);
    let fill = [-0.5 * width, -BEAD - height, 0.5 * width, -BEAD];
    let places = lattice(n, fill, 0.005 * PITCH, random)?;
    let radii = memory::collect((0..n).map(|_| random.between(GRAINS[0], GRAINS[1])))?;
    let velocities = memory::collect((0..n).map(|_| random.in_disc().map(|v| v * 10.0)))?;
    particles.try_extend(&Particles::try_new(places, velocities, radii, 1.0)?)?;
    particles.try_spins_mut()?.iter_mut().for_each(|spin| spin.friction = FRICTION);
    let [min_x, min_y, max_x, max_y] = heap_view(n);
    let walls = [min_x - BEAD, min_y, max_x + BEAD, max_y];
    let settings = WorldSettings { gravity: [0.0, 900.0], ..boxed(walls) };
    Ok(Start::new(particles, settings).restitution(0.1))
}
