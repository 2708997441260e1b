//! Counter-based random numbers: functions of a seed and of the state, the same on every platform.
//!
//! The distributions use only comparisons, products, quotients and square roots, which are
//! correctly rounded on every platform. Library functions such as logarithm and sine are not.

/// A generator whose state is a hash of a seed and some numbers: SplitMix64 (G. Steele et al.,
/// *Fast Splittable Pseudorandom Number Generators*, 2014).
#[derive(Clone, Debug)]
pub struct Chance(u64);

/// The output function of SplitMix64.
pub fn mixed(word: u64) -> u64 {
    let word = (word ^ word >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let word = (word ^ word >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    word ^ word >> 31
}

impl Chance {
    /// The generator for a seed and some numbers of the state.
    pub fn of(seed: u32, numbers: &[f64]) -> Self {
        // The rotation makes the order of the numbers count.
        let hash = |sum: u64, number: &f64| mixed(sum.rotate_left(23) ^ number.to_bits());
        // Not from 0, which the function maps to 0.
        Self(numbers.iter().fold(mixed(u64::from(seed) + 1), hash))
    }

    fn next(&mut self) -> u64 {
        // The increment of SplitMix64: 2⁶⁴ over the golden ratio, an odd number, so the period is
        // 2⁶⁴.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mixed(self.0)
    }

    /// Uniform in the open interval (0, 1).
    pub fn unit(&mut self) -> f64 {
        // 52 bits and a half: the result is exact, and neither 0 nor 1.
        ((self.next() >> 12) as f64 + 0.5) / (1u64 << 52) as f64
    }

    /// Exponentially distributed with the mean 1, by comparisons of uniform numbers (J. von
    /// Neumann, *Various techniques used in connection with random digits*, 1951).
    pub fn exponential(&mut self) -> f64 {
        // The first number of a descending run of odd length has the distribution of the fraction
        // of the result; the number of attempts before has that of its integer part.
        let mut whole = 0.0;
        loop {
            let first = self.unit();
            let (mut last, mut is_odd) = (first, true);
            loop {
                let next = self.unit();
                if next >= last {
                    break;
                }
                (last, is_odd) = (next, !is_odd);
            }
            if is_odd {
                return whole + first;
            }
            whole += 1.0;
        }
    }

    /// Rayleigh distribution, that of the length of a vector of two normally distributed numbers:
    /// p(v) = v e^(−v²/2).
    pub fn flux(&mut self) -> f64 {
        // Half of the square of such a length is exponentially distributed.
        (2.0 * self.exponential()).sqrt()
    }

    /// Two independent normally distributed numbers with mean 0 and variance 1 (polar method: G.
    /// Marsaglia and T. A. Bray, 1964).
    pub fn normal(&mut self) -> [f64; 2] {
        // The direction is that of a random point in the unit disc, the length comes from `flux`.
        // So no sine and no logarithm is needed, which differ between platforms.
        let length = self.flux();
        loop {
            let [x, y] = [0, 1].map(|_| 2.0 * self.unit() - 1.0);
            let square = x * x + y * y;
            if square <= 1.0 && square > 0.0 {
                let scale = length / square.sqrt();
                return [x * scale, y * scale];
            }
        }
    }
}
