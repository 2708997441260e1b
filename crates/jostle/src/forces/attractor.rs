//! A pull to a point, or to a particle.

use super::{Bodies, check_number, nearest};
use crate::error::{Error, Result};
use crate::parallel;
use crate::particles::{FARTHEST, check_vectors};

/// Where an attractor pulls to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pole {
    /// A place that does not move.
    Point([f32; 2]),
    /// The particle in this row. The attractor goes when the particle does.
    Particle(u32),
}

/// How the pull depends on the distance d.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Law {
    /// a = strength · d, as in the article.
    #[default]
    Harmonic,
    /// a = strength / d²; nearer than its own radius, a particle is pulled as by a
    /// ball of that radius, so that nothing is ever flung away.
    InverseSquare,
}

/// Pulls everything to its pole, and feels nothing itself. A negative strength pushes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attractor {
    /// Where to.
    pub pole: Pole,
    /// Acceleration for each unit of distance, or G · M.
    pub strength: f32,
    /// Which of the two.
    pub law: Law,
}

impl Attractor {
    /// Refuses numbers that no world can work with.
    pub fn validate(&self) -> Result<()> {
        if let Pole::Point([x, y]) = self.pole {
            check_vectors("point", &[[x, y]]).map_err(|_| {
                let rule = format!("both coordinates must be finite and within ±{FARTHEST:e}");
                Error::of("point", format!("({x}, {y})"), &rule)
            })?;
        }
        check_number("strength", self.strength, -FARTHEST)
    }
}

/// Energy of a body of mass 1 at `offset` from the pole: 0 there for the harmonic law, far
/// away for the other.
pub fn energy(attractor: &Attractor, offset: [f32; 2], radius: f32) -> f64 {
    let strength = f64::from(attractor.strength);
    let [x, y] = offset.map(f64::from);
    let square = x * x + y * y;
    match attractor.law {
        Law::Harmonic => 0.5 * strength * square,
        Law::InverseSquare => {
            let (distance, radius) = (square.sqrt(), f64::from(radius));
            if distance >= radius {
                return if distance > 0.0 { -strength / distance } else { 0.0 };
            }
            strength * (square / (radius * radius) - 3.0) / (2.0 * radius)
        }
    }
}

/// Adds the pull on every body.
pub fn add(attractor: &Attractor, bodies: &Bodies<'_>, accelerations: &mut [[f32; 2]]) {
    let pole = match attractor.pole {
        Pole::Point(point) => point,
        Pole::Particle(row) => bodies.positions[bodies.places[row as usize] as usize],
    };
    let threads = parallel::worthwhile(bodies.threads, accelerations.len());
    parallel::for_chunks(threads, accelerations, |first, chunk| {
        let rows = bodies.positions[first..].iter().zip(&bodies.radii[first..]);
        for (acceleration, (position, &radius)) in chunk.iter_mut().zip(rows) {
            let offset = nearest(&bodies.container, [0, 1].map(|k| pole[k] - position[k]));
            let pull = pull(attractor, offset, radius);
            *acceleration = [0, 1].map(|k| acceleration[k] + pull[k]);
        }
    });
}

fn pull(attractor: &Attractor, offset: [f32; 2], radius: f32) -> [f32; 2] {
    let strength = f64::from(attractor.strength);
    let [x, y] = offset.map(f64::from);
    let factor = match attractor.law {
        Law::Harmonic => strength,
        Law::InverseSquare => {
            let distance = (x * x + y * y).sqrt().max(f64::from(radius));
            if distance == 0.0 {
                return [0.0; 2];
            }
            strength / (distance * distance * distance)
        }
    };
    [(x * factor) as f32, (y * factor) as f32]
}
