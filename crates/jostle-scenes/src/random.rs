//! Random numbers from a seed, the same on every platform.

use jostle_world::forces::chance::mixed;

/// SplitMix64 (G. Steele et al., *Fast Splittable Pseudorandom Number Generators*, 2014).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// A generator with a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        // The state is a counter with steps of 2⁶⁴ / golden ratio; `mixed` makes each count look
        // random. So any state is a good one, also that of seed 0.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mixed(self.0)
    }

    /// Uniform in [0, 1), with 24 bits.
    pub fn unit(&mut self) -> f32 {
        // As many bits as the mantissa of a float32 has: each number is exact, and none is rounded
        // up to 1.
        (self.next() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// Uniform in [low, high).
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// A uniform integer from `low` to `high`, inclusive.
    pub fn whole(&mut self, low: u32, high: u32) -> f32 {
        (low + (self.next() >> 32) as u32 % (high - low + 1)) as f32
    }

    /// Uniform in the unit disc, by rejection, because a library sine differs between platforms.
    pub fn in_disc(&mut self) -> [f32; 2] {
        loop {
            let point = [self.between(-1.0, 1.0), self.between(-1.0, 1.0)];
            if point[0] * point[0] + point[1] * point[1] <= 1.0 {
                return point;
            }
        }
    }
}
