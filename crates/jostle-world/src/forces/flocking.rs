//! Flocking: separation, alignment and cohesion of neighbours.
//!
//! C. W. Reynolds, *Flocks, herds and schools: a distributed behavioral model*, SIGGRAPH (1987).

use super::neighbors::{Found, Law, Own, total};
use super::pair::check_cutoff;
use super::record::record;
use super::{Force, ForceInput, Partners, Scratch, check_number};
use crate::particles::MAX_KINDS;
use jostle_base::error::Result;
use jostle_simd::{LANES, Simd, block};

/// Lower limit of squared distances, which prevents a division by 0.
const MIN_SQUARE: f32 = 1e-24;

record! {
    /// The acceleration of each particle is the mean over its neighbours of separation (1 − d/cutoff)
    /// away from the neighbour, alignment times the difference of velocities, and cohesion times the
    /// offset d.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Flocking {
        /// Distance below which particles are neighbours.
        pub cutoff: f32,
        /// Acceleration away from a neighbour at distance 0.
        pub separation: f32,
        /// Rate at which velocities become equal, per second.
        pub alignment: f32,
        /// Acceleration towards a neighbour per unit of distance.
        pub cohesion: f32,
        /// Speed limit; no limit if infinite.
        pub max_speed: f32,
        /// Lower limit of the speed of particles that move.
        pub min_speed: f32,
    }
}

impl Flocking {
    /// Refuses numbers out of range.
    pub fn validate(&self) -> Result<()> {
        check_cutoff(self.cutoff)?;
        check_number("separation", self.separation, 0.0)?;
        check_number("alignment", self.alignment, 0.0)?;
        check_number("cohesion", self.cohesion, 0.0)?;
        if self.max_speed != f32::INFINITY {
            check_number("max_speed", self.max_speed, 0.0)?;
        }
        check_number("min_speed", self.min_speed, 0.0)?;
        if self.min_speed <= self.max_speed {
            return Ok(());
        }
        let rule = format!("it must be at most max_speed, {}", self.max_speed);
        Err(jostle_base::error::Error::of("min_speed", self.min_speed, &rule))
    }
}

impl Force for Flocking {
    fn accelerate(
        &self,
        bodies: &ForceInput<'_>,
        scratch: &mut Scratch,
        sums: &mut [[f32; 2]],
    ) -> Result<()> {
        let neighbors = &mut scratch.neighbors;
        neighbors.fill(0, |row| bodies.velocities[row][0])?;
        neighbors.fill(1, |row| bodies.velocities[row][1])?;
        neighbors.sum(bodies, self.cutoff, 2, self, |row, by| {
            sums[row] = [0, 1].map(|k| sums[row][k] + by[k] as f32);
        })
    }

    /// Keeps the speeds within the limits.
    fn limit(&self, bodies: &ForceInput<'_>, sums: &mut [[f32; 2]]) {
        for (acceleration, &velocity) in sums.iter_mut().zip(bodies.velocities) {
            *acceleration = self.limited(velocity, *acceleration, bodies.seconds);
        }
    }

    fn energy(&self, _: &ForceInput<'_>) -> Result<f64> {
        Ok(0.0)
    }

    fn partners(&self) -> Partners {
        Partners::Neighbors { cutoff: self.cutoff, kinds: MAX_KINDS }
    }
}

impl Flocking {
    /// The acceleration that keeps the speed within the limits: that of a particle whose velocity
    /// changes to v + a h.
    #[inline]
    pub fn limited(&self, velocity: [f32; 2], acceleration: [f32; 2], h: f32) -> [f32; 2] {
        let new = [0, 1].map(|k| velocity[k] + acceleration[k] * h);
        let speed = (new[0] * new[0] + new[1] * new[1]).sqrt();
        let right = speed.min(self.max_speed).max(self.min_speed);
        // A velocity of 0 has no direction in which it could become faster.
        if speed == right || speed == 0.0 || !speed.is_finite() {
            return acceleration;
        }
        [0, 1].map(|k| (new[k] * (right / speed) - velocity[k]) / h)
    }
}

impl Law for Flocking {
    #[inline(always)]
    fn act<S: Simd<f32>>(&self, simd: S, own: Own<'_>, found: &Found) -> [f64; 2] {
        // The body itself is one of those that were found.
        let others = found.len - 1;
        if others == 0 {
            return [0.0; 2];
        }
        let Flocking { cutoff, separation, alignment, cohesion, .. } = *self;
        let (one, zero) = (simd.splat(1.0), simd.splat(0.0));
        let own = [0, 1].map(|k| simd.splat(own.of(k)));
        let (least, per_cutoff) = (simd.splat(MIN_SQUARE), simd.splat(1.0 / cutoff));
        let [mut away_x, mut away_y] = [zero; 2];
        let [mut sum_x, mut sum_y, mut sum_u, mut sum_v] = [zero; 4];
        let mut start = 0;
        while start < found.len {
            let x = simd.load(block(&found.x, start));
            let y = simd.load(block(&found.y, start));
            let square = simd.add(simd.mul(x, x), simd.mul(y, y));
            // For the body itself, and what fills the last block, the weight is finite and the
            // offset 0. So they add nothing, and need no branch.
            let distance = simd.sqrt(simd.max(square, least));
            let weight = simd.max(simd.sub(one, simd.mul(distance, per_cutoff)), zero);
            let weight = simd.div(weight, distance);
            away_x = simd.add(away_x, simd.mul(weight, x));
            away_y = simd.add(away_y, simd.mul(weight, y));
            sum_x = simd.add(sum_x, x);
            sum_y = simd.add(sum_y, y);
            // Differences, because the velocities of a fast flock are large and nearly equal.
            let [u, v] =
                [0, 1].map(|k| simd.sub(simd.load(block(&found.columns[k], start)), own[k]));
            sum_u = simd.add(sum_u, u);
            sum_v = simd.add(sum_v, v);
            start += LANES;
        }
        // Lanes are added in float64 and in their order: the sum does not depend on the
        // instructions.
        let (away, offset) = ([away_x, away_y], [sum_x, sum_y]);
        let velocity = [sum_u, sum_v];
        let mut by = [0.0f64; 2];
        for k in 0..2 {
            let sum = f64::from(alignment) * total(simd, velocity[k])
                + f64::from(cohesion) * total(simd, offset[k])
                - f64::from(separation) * total(simd, away[k]);
            by[k] = sum / others as f64;
        }
        by
    }
}
