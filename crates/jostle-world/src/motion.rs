//! Positions and velocities during a step, which all threads may read and write.
//!
//! A position is the sum of a float32 and a residual (T. J. Dekker, *A Floating-Point Technique for
//! Extending the Available Precision*, Numerische Mathematik 18, 1971).

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

use crate::particles::{Particles, Spin};

/// The state of a particle during a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Centre.
    pub position: [f32; 2],
    /// What rounding to float32 removed from the centre.
    pub residual: [f32; 2],
    /// Velocity.
    pub velocity: [f32; 2],
    /// Displacement during the last window, without position correction.
    pub displacement: [f32; 2],
}

impl Motion {
    /// The motion of a particle from its columns, without a displacement.
    #[inline(always)]
    pub fn of(particles: &Particles, index: usize) -> Self {
        Self {
            position: particles.positions[index],
            residual: particles.residuals[index],
            velocity: particles.velocities[index],
            ..Self::default()
        }
    }
}

/// A position from its float32 part and its residual.
#[inline(always)]
pub fn exact(position: [f32; 2], residual: [f32; 2]) -> [f64; 2] {
    [0, 1].map(|k| f64::from(position[k]) + f64::from(residual[k]))
}

/// What rounding to `rounded` removed from a position.
#[inline(always)]
pub fn residual(position: [f64; 2], rounded: [f32; 2]) -> [f32; 2] {
    [0, 1].map(|k| (position[k] - f64::from(rounded[k])) as f32)
}

/// Two numbers in one word, so that they are read and written together.
#[derive(Debug, Default)]
struct Two(AtomicU64);

impl Two {
    #[inline(always)]
    fn get(&self) -> [u32; 2] {
        let word = self.0.load(Ordering::Relaxed);
        [word as u32, (word >> 32) as u32]
    }

    #[inline(always)]
    fn set(&self, [a, b]: [u32; 2]) {
        self.0.store(u64::from(a) | u64::from(b) << 32, Ordering::Relaxed);
    }

    #[inline(always)]
    fn vector(&self) -> [f32; 2] {
        self.get().map(f32::from_bits)
    }

    #[inline(always)]
    fn set_vector(&self, vector: [f32; 2]) {
        self.set(vector.map(f32::to_bits));
    }
}

/// A motion's numbers in memory.
#[derive(Debug, Default)]
struct Row {
    position: Two,
    residual: Two,
    velocity: Two,
    displacement: Two,
}

impl Row {
    #[inline(always)]
    fn set_exact(&self, position: [f64; 2]) {
        let rounded = position.map(|v| v as f32);
        self.position.set_vector(rounded);
        self.residual.set_vector(residual(position, rounded));
    }
}

/// The motions of all particles. Contacts of one colour share no movable particle, so plain
/// (relaxed) loads and stores are enough, and safe.
#[derive(Debug, Default)]
pub struct Motions(Vec<Row>);

impl Motions {
    /// Resizes to `len` motions; their values are unspecified.
    pub fn resize(&mut self, len: usize) {
        self.0.resize_with(len, Default::default);
    }

    /// The motion of the particle at `index`.
    #[inline(always)]
    pub fn get(&self, index: u32) -> Motion {
        let row = &self.0[index as usize];
        Motion {
            position: row.position.vector(),
            residual: row.residual.vector(),
            velocity: row.velocity.vector(),
            displacement: row.displacement.vector(),
        }
    }

    /// Replaces the motion of the particle at `index`.
    #[inline(always)]
    pub fn set(&self, index: u32, motion: Motion) {
        let row = &self.0[index as usize];
        row.position.set_vector(motion.position);
        row.residual.set_vector(motion.residual);
        row.velocity.set_vector(motion.velocity);
        row.displacement.set_vector(motion.displacement);
    }

    /// Its position alone.
    #[inline(always)]
    pub fn position(&self, index: u32) -> [f32; 2] {
        self.0[index as usize].position.vector()
    }

    /// Its position with what rounding removed from it.
    #[inline(always)]
    pub fn exact(&self, index: u32) -> [f64; 2] {
        exact(self.position(index), self.residual(index))
    }

    /// What rounding removed from its position.
    #[inline(always)]
    pub fn residual(&self, index: u32) -> [f32; 2] {
        self.0[index as usize].residual.vector()
    }

    /// Its velocity alone.
    #[inline(always)]
    pub fn velocity(&self, index: u32) -> [f32; 2] {
        self.0[index as usize].velocity.vector()
    }

    /// Its displacement in the last window.
    #[inline(always)]
    pub fn displacement(&self, index: u32) -> [f32; 2] {
        self.0[index as usize].displacement.vector()
    }

    /// Replaces its position, and chooses the float32 of it.
    #[inline(always)]
    pub fn place(&self, index: u32, exact: [f64; 2], rounded: [f32; 2]) {
        let row = &self.0[index as usize];
        row.residual.set_vector(residual(exact, rounded));
        row.position.set_vector(rounded);
    }

    /// Adds a displacement to its position.
    #[inline(always)]
    pub fn displace(&self, index: u32, by: [f32; 2]) {
        let row = &self.0[index as usize];
        let old = exact(row.position.vector(), row.residual.vector());
        row.set_exact([0, 1].map(|k| old[k] + f64::from(by[k])));
    }

    /// Replaces position and velocity; the displacement is that from the `old` position.
    #[inline(always)]
    pub fn advance(&self, index: u32, old: [f64; 2], position: [f64; 2], velocity: [f64; 2]) {
        let row = &self.0[index as usize];
        row.displacement.set_vector([0, 1].map(|k| (position[k] - old[k]) as f32));
        row.set_exact(position);
        row.velocity.set_vector(velocity.map(|v| v as f32));
    }
}

/// Two numbers of each particle, as its velocity, in an array of their own.
#[derive(Debug, Default)]
pub struct Vectors(Vec<AtomicU64>);

impl Vectors {
    /// Resizes to `len` vectors; new ones are 0.
    pub fn resize(&mut self, len: usize) {
        self.0.resize_with(len, Default::default);
    }

    /// The vector of the particle at `index`.
    #[inline(always)]
    pub fn get(&self, index: u32) -> [f32; 2] {
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
    pub fn fill(&mut self, spins: &[Spin]) {
        self.0.resize_with(spins.len(), Default::default);
        for (turning, spin) in self.0.iter_mut().zip(spins) {
            (*turning.0.get_mut(), *turning.1.get_mut()) =
                (spin.velocity.to_bits(), spin.angle.to_bits());
        }
    }

    /// Whether no disc turns or has friction.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The angular velocity of the disc at `index`.
    #[inline(always)]
    pub fn velocity(&self, index: u32) -> f32 {
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
        let angle = self.angle(index) + by;
        self.0[index as usize].1.store(angle.to_bits(), Ordering::Relaxed);
    }
}

/// A number for each particle, in a word of which the other half is 0.
#[derive(Debug, Default)]
pub struct Scalars(Vec<AtomicU64>);

impl Scalars {
    /// Resizes to `len` numbers; new ones are 0.
    pub fn resize(&mut self, len: usize) {
        self.0.resize_with(len, Default::default);
    }

    /// The number of the particle at `index`; 0 if there is none.
    #[inline(always)]
    pub fn get(&self, index: u32) -> f32 {
        let word = self.0.get(index as usize);
        word.map_or(0.0, |word| f32::from_bits(word.load(Ordering::Relaxed) as u32))
    }

    /// Replaces the number of the particle at `index`, if there is one.
    #[inline(always)]
    pub fn set(&self, index: u32, number: f32) {
        if let Some(to) = self.0.get(index as usize) {
            to.store(u64::from(number.to_bits()), Ordering::Relaxed);
        }
    }

    /// All words, as [`Simd::gather`](jostle_simd::Simd::gather) reads them.
    #[inline(always)]
    pub fn words(&self) -> &[AtomicU64] {
        &self.0
    }
}
