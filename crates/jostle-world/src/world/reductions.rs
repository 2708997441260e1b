//! Sums and maxima of numbers of all processes.

use super::World;
use crate::halo::Halo;
use jostle_base::error::Result;
use jostle_index::quadtree::extent_of;

/// Numbers from this one on, 2⁵², are whole.
const WHOLE: f64 = (1u64 << 52) as f64;
const WHOLE_BITS: u64 = WHOLE.to_bits();

impl World {
    /// The number of particles of all processes that are awake.
    pub(crate) fn count_of_all(&self) -> usize {
        self.halo.count(self.rows.len())
    }

    fn halo(&self) -> &dyn Halo {
        &*self.halo
    }

    /// The values of own particles from those of all indices, and another value for ghosts. Loops over
    /// them have no branches.
    pub(crate) fn own_or<V: Copy>(
        &self,
        of_ghosts: V,
        all: impl Iterator<Item = V>,
    ) -> impl Iterator<Item = V> {
        let own = self.halo.own_rows();
        all.zip(&self.rows).map(move |(value, &row)| if row < own { value } else { of_ghosts })
    }

    /// The largest x, y, −x and −y of the own ones of some positions, by index.
    pub(crate) fn farthest_of_own(&self, positions: &[[f32; 2]]) -> [f32; 4] {
        let least = [f32::MIN; 4];
        let own = self.own_or(least, positions.iter().map(|&[x, y]| [x, y, -x, -y]));
        own.fold(least, |most, own| [0, 1, 2, 3].map(|k| most[k].max(own[k])))
    }

    /// Whether a condition is true on any process.
    pub(crate) fn any_of_all(&self, own: bool) -> Result<bool> {
        self.halo().any(own)
    }

    /// Waits for all processes. Returns an error if one has failed.
    pub(crate) fn wait_for_all(&self) -> Result<()> {
        self.halo().wait()
    }

    /// The largest of each number of all processes.
    pub(crate) fn largest_of_all<const N: usize>(&self, own: [f64; N]) -> Result<[f64; N]> {
        self.halo().largest(own)
    }

    /// The sum of each number of all processes.
    pub(crate) fn sum_of_all<const N: usize>(&self, own: [u64; N]) -> Result<[u64; N]> {
        self.halo().sum(own)
    }

    /// The AABB of the centres of all processes; None if it is that of the own ones.
    pub(crate) fn extent_of_all(&mut self) -> Result<Option<[[f32; 2]; 2]>> {
        if self.halo.is_alone() {
            return Ok(None);
        }
        if let Some(known) = self.halo.take_extent() {
            return Ok(Some(known));
        }
        let [right, bottom, left, top] = self.farthest()?.map(|v| v as f32);
        Ok(Some([[-left, -top], [right, bottom]]))
    }

    /// The same of the positions at which forces act.
    pub(crate) fn extent_of_halfway(&self) -> Result<Option<[[f32; 2]; 2]>> {
        if self.halo.is_alone() {
            return Ok(None);
        }
        let own = self.farthest_of_own(&self.scratch.forces.halfway);
        let [right, bottom, left, top] = self.largest_of_all(own.map(f64::from))?.map(|v| v as f32);
        Ok(Some([[-left, -top], [right, bottom]]))
    }

    /// The largest x, y, −x and −y of all centres.
    pub(crate) fn farthest(&self) -> Result<[f64; 4]> {
        let (positions, least) = (&self.particles.positions, [f32::MIN; 4]);
        let most = if positions.is_empty() {
            least
        } else if self.halo.is_alone() {
            let [[left, top], [right, bottom]] = extent_of(positions);
            [right, bottom, -left, -top]
        } else {
            self.farthest_of_own(positions)
        };
        self.largest_of_all(most.map(f64::from))
    }

    /// The mean of a number of all particles, none negative; the same whatever their order and
    /// processes.
    pub(crate) fn mean<V>(&self, column: &[V], number: impl Fn(&V) -> f32 + Copy) -> Result<f64> {
        let own = self.own_or(0.0, column.iter().map(number));
        let [most] = self.largest_of_all([f64::from(largest(own))])?;
        if most == 0.0 {
            return Ok(0.0);
        }
        // Whole numbers have sums without rounding. To add 2⁵² rounds a number below 2³¹ and puts
        // it into the last bits.
        let scale = f64::from(i32::MAX) / most;
        let whole = |value: &V| (f64::from(number(value)) * scale + WHOLE).to_bits() - WHOLE_BITS;
        let [sum] = self.sum_of_all([self.own_or(0, column.iter().map(whole)).sum()])?;
        Ok(sum as f64 / scale / self.count_of_all() as f64)
    }

    /// Area of the smallest AABB around all particles.
    pub(crate) fn area_of_extent(&self) -> Result<f64> {
        let [right, bottom, left, top] = self.farthest()?;
        Ok((right + left) * (bottom + top))
    }
}

/// The largest of some numbers, none negative, which have the order of their bits; 0 if there are
/// none.
pub(crate) fn largest(numbers: impl Iterator<Item = f32>) -> f32 {
    f32::from_bits(numbers.map(|number| number.to_bits() as i32).fold(0, i32::max) as u32)
}
