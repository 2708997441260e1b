//! Positions and velocities during a step, which all threads may read and write.
//!
//! A position is the sum of a float32 and a residual (T. J. Dekker, *A Floating-Point Technique for
//! Extending the Available Precision*, Numerische Mathematik 18, 1971).

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

use crate::particles::{Particles, Spin};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_index::period::Period;

/// The state of a particle during a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Centre.
    pub position: [f32; 2],
    /// What rounding to float32 removed from the centre.
    pub residual: [f32; 2],
    /// Velocity.
    pub velocity: [f32; 2],
}

impl Motion {
    /// The motion of a particle from its columns.
    #[inline(always)]
    pub fn of(particles: &Particles, index: usize) -> Self {
        Self {
            position: particles.positions[index],
            residual: particles.residuals[index],
            velocity: particles.velocities[index],
        }
    }
}

/// A position from its float32 part and its residual.
#[inline(always)]
pub fn exact(position: [f32; 2], residual: [f32; 2]) -> [f64; 2] {
    // Without rounding: a residual is the difference of a position in float64 and its float32, with
    // the last bits removed. So the sum fits into float64 again.
    [0, 1].map(|k| f64::from(position[k]) + f64::from(residual[k]))
}

/// What rounding to `rounded` removed from a position.
#[inline(always)]
pub fn residual(position: [f64; 2], rounded: [f32; 2]) -> [f32; 2] {
    // The difference is exact in float64, because both are nearly equal (P. H. Sterbenz, 1974).
    // Only the conversion to float32 rounds, relative to the residual.
    [0, 1].map(|k| (position[k] - f64::from(rounded[k])) as f32)
}

/// A position, with its residual, in the first period. On an axis that is not periodic nothing changes.
#[inline(always)]
pub fn wrapped(
    position: [f32; 2],
    residual: [f32; 2],
    period: &Period<f32>,
) -> ([f32; 2], [f32; 2]) {
    if period.is_none() {
        return (position, residual);
    }
    // Wrapped in float64 with the residual. Wrapped in float32 the position would change by a
    // rounding each time a disc crosses the seam.
    let mut inside = period.exact().wrap(exact(position, residual));
    let mut rounded = inside.map(|v| v as f32);
    for (k, &side) in period.sides().iter().enumerate() {
        // A position that rounds to the far side is at the near one.
        if period.is_along(k) && rounded[k] >= side {
            (inside[k], rounded[k]) = (inside[k] - f64::from(side), 0.0);
        }
    }
    (rounded, self::residual(inside, rounded))
}

/// The motions of all particles, a column for each quantity, so that contacts gather from them
/// without a copy. Contacts of one colour share no movable particle, so plain (relaxed) loads and
/// stores are enough, and safe. A row more, of zeros, is for the lanes of blocks without a contact.
#[derive(Debug, Default)]
pub struct Motions {
    /// Centres.
    pub positions: Vectors,
    /// What rounding to float32 removed from the centres.
    pub residuals: Vectors,
    velocities: Vectors,
    /// Displacements in the last flight, without position correction. Only merging reads them; empty
    /// if nothing merges.
    displacements: Vectors,
}

impl Motions {
    /// Resizes to `len` motions; their values are unspecified. Displacements are 0, if any are kept.
    pub fn resize(&mut self, len: usize, keeps_displacements: bool) -> Result<()> {
        let Self { positions, residuals, velocities, displacements } = self;
        // The spare row lets blocks gather all sixteen lanes without a test: unused lanes read
        // zeros.
        for column in [positions, residuals, velocities] {
            column.resize_with_spare(len)?;
        }
        // First to 0, because `resize` gives a value only to new vectors.
        displacements.resize(0)?;
        displacements.resize(if keeps_displacements { len } else { 0 })
    }

    /// The motion of the particle at `index`.
    #[inline(always)]
    pub fn get(&self, index: u32) -> Motion {
        Motion {
            position: self.position(index),
            residual: self.residual(index),
            velocity: self.velocity(index),
        }
    }

    /// Replaces the motion of the particle at `index`.
    #[inline(always)]
    pub fn set(&self, index: u32, motion: Motion) {
        self.positions.set(index, motion.position);
        self.residuals.set(index, motion.residual);
        self.velocities.set(index, motion.velocity);
    }

    /// Its position alone.
    #[inline(always)]
    pub fn position(&self, index: u32) -> [f32; 2] {
        self.positions.get(index)
    }

    /// Its position with what rounding removed from it.
    #[inline(always)]
    pub fn exact(&self, index: u32) -> [f64; 2] {
        exact(self.position(index), self.residual(index))
    }

    /// What rounding removed from its position.
    #[inline(always)]
    pub fn residual(&self, index: u32) -> [f32; 2] {
        self.residuals.get(index)
    }

    /// Its velocity alone.
    #[inline(always)]
    pub fn velocity(&self, index: u32) -> [f32; 2] {
        self.velocities.get(index)
    }

    /// Its displacement in the last flight, if displacements are kept.
    #[inline(always)]
    pub fn displacement(&self, index: u32) -> [f32; 2] {
        self.displacements.get(index)
    }

    /// Replaces its position, and chooses the float32 of it.
    #[inline(always)]
    pub fn place(&self, index: u32, exact: [f64; 2], rounded: [f32; 2]) {
        self.residuals.set(index, residual(exact, rounded));
        self.positions.set(index, rounded);
    }

    /// Adds a displacement to its position.
    #[inline(always)]
    pub fn displace(&self, index: u32, by: [f32; 2]) {
        // The sum is rounded once from float64. Added to the float32 position, a displacement below
        // its spacing would be lost.
        let old = self.exact(index);
        self.place_exactly(index, [0, 1].map(|k| old[k] + f64::from(by[k])));
    }

    /// Replaces position and velocity; the displacement is that from the `old` position.
    #[inline(always)]
    pub fn advance(&self, index: u32, old: [f64; 2], position: [f64; 2], velocity: [f64; 2]) {
        // The displacement is that of the flight and not the difference of two wrapped positions,
        // which may be on opposite sides of a torus.
        if !self.displacements.words().is_empty() {
            self.displacements.set(index, [0, 1].map(|k| (position[k] - old[k]) as f32));
        }
        self.place_exactly(index, position);
        self.velocities.set(index, velocity.map(|v| v as f32));
    }

    #[inline(always)]
    fn place_exactly(&self, index: u32, position: [f64; 2]) {
        self.place(index, position, position.map(|v| v as f32));
    }
}

/// Two numbers of each particle, as its velocity, in an array of their own. Both are in one word, so
/// that they are read and written together.
#[derive(Debug, Default)]
pub struct Vectors(Vec<AtomicU64>);

impl Vectors {
    /// Resizes to `len` vectors; new ones are 0.
    pub fn resize(&mut self, len: usize) -> Result<()> {
        memory::resize_default(&mut self.0, len)
    }

    /// Resizes to `len` vectors and one more, which is 0, for the lanes of blocks without a contact.
    pub fn resize_with_spare(&mut self, len: usize) -> Result<()> {
        self.resize(len + 1)?;
        self.set(len as u32, [0.0; 2]);
        Ok(())
    }

    /// The vector of the particle at `index`.
    #[inline(always)]
    pub fn get(&self, index: u32) -> [f32; 2] {
        // One load for both numbers: gathers of x and y apart would take twice as many.
        // `docs/benchmarks-notes.md` has the gain for a gas.
        jostle_simd::numbers_at(&self.0, index)
    }

    /// Replaces the vector of the particle at `index`.
    #[inline(always)]
    pub fn set(&self, index: u32, vector: [f32; 2]) {
        jostle_simd::set_numbers_at(&self.0, index, vector);
    }

    /// All vectors, as [`Simd::gather`](jostle_simd::Simd::gather) reads them.
    #[inline(always)]
    pub fn words(&self) -> &[AtomicU64] {
        &self.0
    }
}

/// The rotation of a disc in memory: angular velocity, and angle.
#[derive(Debug, Default)]
struct Turning(AtomicU32, AtomicU64);

/// The angular velocities and the angles of all discs during a step; empty if no disc turns or has
/// friction.
#[derive(Debug, Default)]
pub struct Spins(Vec<Turning>);

impl Spins {
    /// Replaces all of them.
    pub fn fill(&mut self, spins: &[Spin]) -> Result<()> {
        memory::resize_default(&mut self.0, spins.len())?;
        for (turning, spin) in self.0.iter_mut().zip(spins) {
            // Exclusive access here, so no atomic operation is needed.
            (*turning.0.get_mut(), *turning.1.get_mut()) =
                (spin.velocity.to_bits(), spin.angle.to_bits());
        }
        Ok(())
    }

    /// Whether no disc turns or has friction.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The angular velocity of the disc at `index`.
    #[inline(always)]
    pub fn velocity(&self, index: u32) -> f32 {
        // Relaxed, here and below: each parallel region writes a disc on one thread at most, and
        // other threads do not read it in that region. The end of a region orders its stores before
        // later loads. Atomic types make this safe without `unsafe`; the processor executes plain
        // loads and stores.
        f32::from_bits(self.0[index as usize].0.load(Ordering::Relaxed))
    }

    /// The angle of the disc at `index`, not wrapped.
    #[inline(always)]
    pub fn angle(&self, index: u32) -> f64 {
        f64::from_bits(self.0[index as usize].1.load(Ordering::Relaxed))
    }

    /// Replaces the angular velocity of the disc at `index`.
    #[inline(always)]
    pub fn set_velocity(&self, index: u32, velocity: f32) {
        self.0[index as usize].0.store(velocity.to_bits(), Ordering::Relaxed);
    }

    /// Turns the disc at `index` by an angle.
    #[inline(always)]
    pub fn turn(&self, index: u32, by: f64) {
        // A load and a store, and not one atomic addition: only one thread turns a disc. Angles are
        // float64, because a disc may turn many times.
        let angle = self.angle(index) + by;
        self.0[index as usize].1.store(angle.to_bits(), Ordering::Relaxed);
    }
}

/// A number for each particle, in a word of which the other half is 0.
#[derive(Debug, Default)]
pub struct Scalars(Vec<AtomicU64>);

impl Scalars {
    /// Resizes to `len` numbers; new ones are 0.
    pub fn resize(&mut self, len: usize) -> Result<()> {
        memory::resize_default(&mut self.0, len)
    }

    /// The number of the particle at `index`; 0 if there is none.
    #[inline(always)]
    pub fn get(&self, index: u32) -> f32 {
        let word = self.0.get(index as usize);
        // Relaxed, as in `Spins`. Several threads may write a particle that does not move, each the
        // value that it had.
        word.map_or(0.0, |word| f32::from_bits(word.load(Ordering::Relaxed) as u32))
    }

    /// Replaces the number of the particle at `index`, if there is one.
    #[inline(always)]
    pub fn set(&self, index: u32, number: f32) {
        if let Some(to) = self.0.get(index as usize) {
            // The word has 64 bits, as those of `Vectors`, so that the same gather reads both. See
            // `Spins` for the ordering.
            to.store(u64::from(number.to_bits()), Ordering::Relaxed);
        }
    }

    /// All words, as [`Simd::gather`](jostle_simd::Simd::gather) reads them.
    #[inline(always)]
    pub fn words(&self) -> &[AtomicU64] {
        &self.0
    }
}
