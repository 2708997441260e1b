//! Attractors: a central force towards a point or a particle.

use super::record::{Found, Record, Renamed, record, refers_to_nothing};
use super::{Force, ForceInput, Partners, Scratch, check_number, check_pair};
use crate::particles::FARTHEST;
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::parallel;
use jostle_base::saved;

/// The centre of an attraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pole {
    /// A fixed point.
    Point([f32; 2]),
    /// The particle with this id. If it is removed, the attractor is removed too.
    Particle(Id),
}

/// Force laws: the acceleration a as a function of the distance d.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Law {
    /// a = strength · d, as in the article.
    #[default]
    Harmonic,
    /// a = strength / d². At a distance r below the radius R of the particle, a = strength · r /
    /// R³, as inside a homogeneous ball, so that a is finite.
    InverseSquare,
}

record! {
    /// A force on all particles towards the pole, without a reaction force. With a negative strength it
    /// is repulsive.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Attractor {
        /// The centre of the force.
        pub pole: Pole,
        /// Acceleration per unit of distance (harmonic), or G · M (inverse square).
        pub strength: f32,
        /// The force law.
        pub law: Law,
    }
}

saved! { enum Pole("pole") { 0 => Point(point), 1 => Particle(id) } }
saved! { enum Law("force law") { 0 => Harmonic, 1 => InverseSquare } }
refers_to_nothing! { Law }

impl Record for Pole {
    fn list(&self, found: &mut Found<'_>) {
        if let Self::Particle(id) = self {
            id.list(found);
        }
    }
    fn renumber(&mut self, renamed: &Renamed<'_>) -> bool {
        match self {
            Self::Point(_) => true,
            Self::Particle(id) => id.renumber(renamed),
        }
    }
}

impl Attractor {
    /// Refuses numbers out of range.
    pub fn validate(&self) -> Result<()> {
        if let Pole::Point(point) = self.pole {
            check_pair("point", point)?;
        }
        check_number("strength", self.strength, -FARTHEST)
    }

    /// The position of the pole, and the index of its particle, if it is one.
    fn place(&self, bodies: &ForceInput<'_>) -> ([f32; 2], Option<usize>) {
        match self.pole {
            Pole::Point(point) => (point, None),
            Pole::Particle(row) => {
                let index = bodies.indices[row as usize] as usize;
                (bodies.positions[index], Some(index))
            }
        }
    }
}

impl Force for Attractor {
    fn accelerate(
        &self,
        bodies: &ForceInput<'_>,
        _: &mut Scratch,
        sums: &mut [[f32; 2]],
    ) -> Result<()> {
        let (pole, _) = self.place(bodies);
        let threads = parallel::worthwhile(bodies.threads, sums.len());
        parallel::for_chunks(threads, sums, |first, chunk| {
            let rows = bodies.positions[first..].iter().zip(&bodies.radii[first..]);
            for (acceleration, (position, &radius)) in chunk.iter_mut().zip(rows) {
                let offset =
                    bodies.container.period().minimum_image([0, 1].map(|k| pole[k] - position[k]));
                let pull = pull(self, offset, radius);
                *acceleration = [0, 1].map(|k| acceleration[k] + pull[k]);
            }
        });
        Ok(())
    }

    fn limit(&self, _: &ForceInput<'_>, _: &mut [[f32; 2]]) {}

    /// The pole is taken as fixed. It does not act on its own particle.
    fn energy(&self, bodies: &ForceInput<'_>) -> Result<f64> {
        let (pole, own) = self.place(bodies);
        let energy_of = |index: usize| {
            let offset = [0, 1].map(|k| pole[k] - bodies.positions[index][k]);
            let offset = bodies.container.period().minimum_image(offset);
            f64::from(bodies.masses[index]) * energy(self, offset, bodies.radii[index])
        };
        let is_moved = |&index: &usize| bodies.movable[index] && own != Some(index);
        Ok((0..bodies.positions.len()).filter(is_moved).map(energy_of).sum())
    }

    fn partners(&self) -> Partners {
        Partners::All
    }
}

/// Potential energy of a body of mass 1 at `offset` from the pole: 0 at the pole for the harmonic
/// law, 0 at infinity for the inverse square law.
fn energy(attractor: &Attractor, offset: [f32; 2], radius: f32) -> f64 {
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
            // As inside a homogeneous ball. Both formulas give −strength / R at the surface, so the
            // energy has no step there.
            strength * (square / (radius * radius) - 3.0) / (2.0 * radius)
        }
    }
}

fn pull(attractor: &Attractor, offset: [f32; 2], radius: f32) -> [f32; 2] {
    let strength = f64::from(attractor.strength);
    let [x, y] = offset.map(f64::from);
    let factor = match attractor.law {
        Law::Harmonic => strength,
        Law::InverseSquare => {
            // At the surface or inside, the divisor is R³, so the acceleration is finite and grows
            // with the distance from the centre.
            let distance = (x * x + y * y).sqrt().max(f64::from(radius));
            if distance == 0.0 {
                return [0.0; 2];
            }
            strength / (distance * distance * distance)
        }
    };
    [(x * factor) as f32, (y * factor) as f32]
}
