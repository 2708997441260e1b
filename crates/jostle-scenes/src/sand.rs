//! Scene: an hourglass.

use super::placing::Area;
use super::random::Random;
use super::start::{Start, boxed};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_world::particles::Particles;
use jostle_world::world::WorldSettings;

/// Radii of the grains.
const GRAINS: [f32; 2] = [2.7, 3.3];

/// Width of the neck for 2,000 grains, and its minimum.
const NECK: f32 = 23.5;

/// Number of layers, and the factor between their densities, which differ only to distinguish the
/// layers.
const LAYERS: usize = 6;
const HEAVIER: f32 = 0.04;

/// Distance between grains at the start.
const PITCH: f32 = 2.02 * GRAINS[1];

/// The walls of the glass, symmetric about y = 0.
struct Glass {
    /// Half width of the bulbs.
    half_width: f32,
    /// Half width of the neck.
    half_neck: f32,
    /// |y| at which the neck begins to widen.
    neck_end: f32,
    /// |y| at which the bulb has its full width.
    shoulder: f32,
    /// |y| of the floor.
    end: f32,
}

impl Glass {
    fn of(n: usize) -> Self {
        let scale = (n as f32 / 2000.0).sqrt().max(0.35);
        // The flow is proportional to the width of the neck to the power 1.5, so every glass takes
        // about the same time. A neck below the minimum width would jam.
        let neck = (NECK * scale * scale.sqrt()).max(NECK);
        let half_width = 150.0 * scale;
        let half_neck = neck / 2.0;
        let neck_end = 5.0;
        let shoulder = neck_end + 1.35 * (half_width - half_neck);
        let mut glass = Self { half_width, half_neck, neck_end, shoulder, end: shoulder };
        glass.end = glass.rows(n).last().map_or(shoulder, |(y, _)| y.max(shoulder)) + 40.0 * scale;
        glass
    }

    /// Half of the inner width at a height.
    fn half_free(&self, y: f32) -> f32 {
        let slope = (self.half_width - self.half_neck) / (self.shoulder - self.neck_end);
        let sloping = self.half_neck + (y - self.neck_end).max(0.0) * slope;
        sloping.min(self.half_width)
    }

    /// Rows of grains that fill a bulb, starting at the neck: heights and numbers of grains.
    fn rows(&self, n: usize) -> Vec<(f32, usize)> {
        let mut rows = Vec::new();
        let (mut left, mut y) = (n, self.neck_end + GRAINS[1]);
        while left > 0 {
            // A row as wide as the glass at its height, less the radius of the largest grain on
            // either side.
            let room = 2.0 * (self.half_free(y) - GRAINS[1]);
            let count = ((room / PITCH) as usize).min(left);
            rows.push((y, count));
            left -= count;
            y += 0.87 * PITCH;
        }
        rows
    }

    /// The closed outline of both bulbs.
    fn corners(&self) -> Vec<[f32; 2]> {
        let Self { half_width, half_neck, neck_end, shoulder, end } = *self;
        let right = [[half_width, end], [half_width, shoulder], [half_neck, neck_end]];
        let upper_right = right.iter().rev().map(|&[x, y]| [x, -y]);
        let half: Vec<[f32; 2]> = right.into_iter().chain(upper_right).collect();
        let other = half.iter().rev().map(|&[x, y]| [-x, y]);
        let mut all: Vec<[f32; 2]> = half.iter().copied().chain(other).collect();
        all.push(all[0]);
        all
    }
}

pub(crate) fn sand_view(n: usize) -> Area {
    let floor = Glass::of(n).end;
    [-1.3 * floor, -1.05 * floor, 1.3 * floor, 1.02 * floor]
}

/// `n` grains in a glass.
pub(crate) fn sand(n: usize, random: &mut Random) -> Result<Start> {
    let glass = Glass::of(n);
    let mut places = memory::with_capacity(n)?;
    for (index, (y, count)) in glass.rows(n).into_iter().enumerate() {
        // Alternate rows are shifted by half a distance in all, so that grains lie in the gaps of
        // the row below.
        let first = -0.5 * (count as f32 - 1.0) + if index % 2 == 0 { 0.25 } else { -0.25 };
        places.extend((0..count).map(|k| [(first + k as f32) * PITCH, -y]));
    }
    let radii = memory::collect((0..n).map(|_| random.between(GRAINS[0], GRAINS[1])))?;
    let velocities = memory::collect((0..n).map(|_| random.in_disc().map(|v| v * 10.0)))?;
    let mut grains = Particles::try_new(places, velocities, radii, 1.0)?;
    for (index, mass) in grains.masses.iter_mut().enumerate() {
        // The mass marks the layer: the simulator can colour by it, and 4 % have no visible effect
        // on the flow.
        *mass *= 1.0 + HEAVIER * (index * LAYERS / n) as f32;
    }
    let settings = WorldSettings { gravity: [0.0, 900.0], drag: 1.5, ..boxed(sand_view(n)) };
    Ok(Start::new(grains, settings).restitution(0.0).walled(&glass.corners()))
}
