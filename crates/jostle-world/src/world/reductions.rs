//! Sums and largest values of numbers of the particles of all processes.

use super::World;
use crate::halo::Halo;
use jostle_base::error::Result;
use jostle_index::quadtree::extent_of;

/// Numbers from this one on, 2⁵², are whole.
const WHOLE: f64 = (1u64 << 52) as f64;
const WHOLE_BITS: u64 = WHOLE.to_bits();

/// The particles of all processes that are awake. Columns are by index and contain those of this process and ghosts.
#[derive(Clone, Copy)]
pub(crate) struct Everywhere<'a> {
    halo: &'a dyn Halo,
    rows: &'a [u32],
    /// Rows below it are those of this process.
    own_rows: u32,
}

impl World {
    /// What this process exchanges with others.
    pub(crate) fn halo(&self) -> &dyn Halo {
        &*self.halo
    }

    /// The particles of all processes.
    pub(crate) fn everywhere(&self) -> Everywhere<'_> {
        Everywhere {
            halo: self.halo(),
            rows: &self.bodies.awake.rows,
            own_rows: self.halo.own_rows(),
        }
    }
}

impl Everywhere<'_> {
    /// Their number.
    pub(crate) fn count(self) -> usize {
        self.halo.count(self.rows.len())
    }

    /// The values of own particles from those of all indices, and another value for ghosts. Loops over
    /// them have no branches.
    fn own_or<V: Copy>(
        self,
        of_ghosts: V,
        all: impl Iterator<Item = V>,
    ) -> impl Iterator<Item = V> {
        let own = self.own_rows;
        all.zip(self.rows).map(move |(value, &row)| if row < own { value } else { of_ghosts })
    }

    /// The largest of some numbers, none negative; 0 if there are no particles.
    pub(crate) fn largest(self, numbers: impl Iterator<Item = f64>) -> Result<f64> {
        let [most] = self.halo.largest([self.own_or(0.0, numbers).fold(0.0, f64::max)])?;
        Ok(most)
    }

    /// The AABB of some positions; None if there is one process, and it is that of all indices.
    pub(crate) fn extent(self, positions: &[[f32; 2]]) -> Result<Option<[[f32; 2]; 2]>> {
        if self.halo.is_alone() {
            return Ok(None);
        }
        let [right, bottom, left, top] = self.farthest(positions)?.map(|v| v as f32);
        Ok(Some([[-left, -top], [right, bottom]]))
    }

    /// The largest x, y, −x and −y of some positions.
    pub(crate) fn farthest(self, positions: &[[f32; 2]]) -> Result<[f64; 4]> {
        let least = [f32::MIN; 4];
        let most = if positions.is_empty() {
            least
        } else if self.halo.is_alone() {
            let [[left, top], [right, bottom]] = extent_of(positions);
            [right, bottom, -left, -top]
        } else {
            let own = self.own_or(least, positions.iter().map(|&[x, y]| [x, y, -x, -y]));
            own.fold(least, |most, own| [0, 1, 2, 3].map(|k| most[k].max(own[k])))
        };
        self.halo.largest(most.map(f64::from))
    }

    /// Area of the smallest AABB around some positions.
    pub(crate) fn area(self, positions: &[[f32; 2]]) -> Result<f64> {
        let [right, bottom, left, top] = self.farthest(positions)?;
        Ok((right + left) * (bottom + top))
    }

    /// The mean of a number, none negative; the same whatever the order of the particles and their
    /// processes.
    pub(crate) fn mean<V>(self, column: &[V], number: impl Fn(&V) -> f32 + Copy) -> Result<f64> {
        let own = self.own_or(0.0, column.iter().map(number));
        // The sum of floating-point numbers depends on their order, and so on ranks and threads.
        // The numbers are scaled to whole ones by the largest of all ranks, which is the same in
        // any order.
        let [most] = self.halo.largest([f64::from(largest(own))])?;
        // There is nothing to scale by.
        if most == 0.0 {
            return Ok(0.0);
        }
        // Whole numbers have sums without rounding. To add 2⁵² rounds a number below 2³¹ and puts
        // it into the last bits.
        // A world has fewer than 2³¹ particles, so the sum is below 2⁶².
        let scale = f64::from(i32::MAX) / most;
        let whole = |value: &V| (f64::from(number(value)) * scale + WHOLE).to_bits() - WHOLE_BITS;
        let [sum] = self.halo.sum([self.own_or(0, column.iter().map(whole)).sum()])?;
        Ok(sum as f64 / scale / self.count() as f64)
    }
}

/// The largest of some numbers, none negative, which have the order of their bits; 0 if there are
/// none.
pub(crate) fn largest(numbers: impl Iterator<Item = f32>) -> f32 {
    f32::from_bits(numbers.map(|number| number.to_bits() as i32).fold(0, i32::max) as u32)
}
