//! Scenes with gravity in which discs fall and come to rest.

use std::ops::Range;

use super::placing::{Area, kept, lattice_places, scatter};
use super::random::Random;
use super::start::{Start, area_of, boxed};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_world::particles::Particles;
use jostle_world::world::WorldSettings;

/// The article's display, in pixels, and its number of particles.
const DISPLAY: [f32; 2] = [800.0, 500.0];
const DISPLAY_COUNT: f32 = 500.0;

/// The article's frames per second; its units are pixels and frames.
const FRAMES: f32 = 30.0;

pub(crate) fn article_view(n: usize) -> Area {
    // The area grows with the number, so that the density is that of the article.
    let scale = (n as f32 / DISPLAY_COUNT).sqrt().max(1.0);
    [0.0, 0.0, DISPLAY[0] * scale, DISPLAY[1] * scale]
}

/// The article's particles, converted to pixels and seconds.
pub(crate) fn article(n: usize, random: &mut Random) -> Result<Start> {
    let area = article_view(n);
    let radii: Vec<f32> = memory::collect((0..n).map(|_| random.whole(5, 10)))?;
    let places = scatter(&radii, area, random)?;
    let velocities = memory::collect((0..n).map(|_| random.in_disc().map(|v| v * FRAMES)))?;
    let mut particles = Particles::try_new(places, velocities, radii, 1.0)?;
    // After the radii and velocities: random numbers are drawn in this order, and a hash of the
    // state is pinned.
    particles.masses.iter_mut().for_each(|mass| *mass *= random.whole(1, 20));
    // Gravity is 0.5 px per frame²; drag is about 0.3 % per frame for a particle of medium size.
    let settings =
        WorldSettings { gravity: [0.0, 0.5 * FRAMES * FRAMES], drag: 0.08, ..boxed(area) };
    Ok(Start::new(particles, settings).restitution(0.75))
}

const PILE_RADII: [f32; 2] = [5.0, 10.0];

fn pile_width(n: usize) -> f32 {
    800.0 * (n as f32 / 1000.0).sqrt().max(0.2)
}

pub(crate) fn pile_view(n: usize) -> Area {
    [0.0, 0.0, pile_width(n), pile_width(n) * 0.75]
}

pub(crate) fn pile(n: usize, random: &mut Random, kept_rows: Range<usize>) -> Result<Start> {
    let [_, _, width, height] = pile_view(n);
    // More than two of the largest radius, so that the displacement by `lattice` makes no overlaps.
    let spacing = 2.2 * PILE_RADII[1];
    // The lattice is as wide as the box and as high as the number requires: discs above the view
    // fall into it.
    let columns = (width / spacing).floor().max(1.0);
    let rows = (n as f32 / columns).ceil();
    let fill = [0.0, height - rows * spacing, columns * spacing, height];
    let places = kept(&kept_rows, lattice_places(n, fill, 0.05 * spacing, random))?;
    let radius = |_| random.between(PILE_RADII[0], PILE_RADII[1]);
    let radii = kept(&kept_rows, (0..n).map(radius))?;
    let velocities = kept(&kept_rows, (0..n).map(|_| random.in_disc().map(|v| v * 40.0)))?;
    let walls = [0.0, fill[1].min(0.0) - height, width, height];
    let settings = WorldSettings { gravity: [0.0, 900.0], ..boxed(walls) };
    let discs = Particles::try_new(places, velocities, radii, 1.0)?;
    Ok(Start::new(discs, settings).restitution(0.2))
}

const RAIN_RADII: [f32; 2] = [3.0, 6.0];

/// Fraction of the area that the drops cover at the start.
const RAIN_COVERAGE: f32 = 0.08;

pub(crate) fn rain_view(n: usize) -> Area {
    let width = 800.0 * (n as f32 / 2000.0).sqrt().max(0.2);
    [0.0, 0.0, width, width * 0.625]
}

pub(crate) fn rain(n: usize, random: &mut Random) -> Result<Start> {
    let [_, _, width, height] = rain_view(n);
    let middle = (RAIN_RADII[0] + RAIN_RADII[1]) / 2.0;
    // The height at which the drops cover the chosen fraction of the width times the height.
    let sky = n as f32 * area_of(middle) / (RAIN_COVERAGE * width) + 4.0 * RAIN_RADII[1];
    let radii: Vec<f32> =
        memory::collect((0..n).map(|_| random.between(RAIN_RADII[0], RAIN_RADII[1])))?;
    // The lowest drops start at half of the height.
    let clouds = [0.0, height * 0.5 - sky, width, height * 0.5];
    let places = scatter(&radii, clouds, random)?;
    let velocities = memory::filled(n, [0.0, 200.0])?;
    // The terminal velocity is 600 px/s.
    let settings = WorldSettings {
        gravity: [0.0, 900.0],
        drag: 1.5,
        ..boxed([0.0, clouds[1], width, height])
    };
    let drops = Particles::try_new(places, velocities, radii, 1.0)?;
    Ok(Start::new(drops, settings).restitution(0.3))
}
