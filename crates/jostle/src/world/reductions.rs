//! Collective reductions: sums and maxima of numbers of all ranks, and what their particles require.

use super::World;
use super::contacts::loses_energy;
use super::domain::halo_of;
use crate::error::Result;
use crate::parallel::locked;
use crate::quadtree::extent_of;

/// Numbers from this one on, 2⁵², are whole.
const WHOLE: f64 = (1u64 << 52) as f64;
const WHOLE_BITS: u64 = WHOLE.to_bits();

impl World {
    /// The number of particles of all ranks that are awake.
    pub(super) fn count_of_all(&self) -> usize {
        halo_of(&self.domain).count(self.rows.len())
    }

    /// Whether something is so on any rank.
    pub(super) fn any_of_all(&self, own: bool) -> Result<bool> {
        halo_of(&self.domain).any(own)
    }

    /// Waits for all ranks. Returns an error if one has failed.
    pub(super) fn wait_for_all(&self) -> Result<()> {
        halo_of(&self.domain).wait()
    }

    /// The largest of each number of all ranks.
    pub(super) fn largest_of_all<const N: usize>(&self, own: [f64; N]) -> Result<[f64; N]> {
        halo_of(&self.domain).largest(own)
    }

    /// The sum of each number of all ranks.
    pub(super) fn sum_of_all<const N: usize>(&self, own: [u64; N]) -> Result<[u64; N]> {
        halo_of(&self.domain).sum(own)
    }

    /// The AABB of the centres of all ranks; None if the world is not distributed.
    pub(super) fn extent_of_all(&mut self) -> Result<Option<[[f32; 2]; 2]>> {
        let Some(domain) = &mut self.domain else { return Ok(None) };
        if let Some(known) = domain.extent.take() {
            return Ok(Some(known));
        }
        let [right, bottom, left, top] = self.farthest()?.map(|v| v as f32);
        Ok(Some([[-left, -top], [right, bottom]]))
    }

    /// The largest x, y, −x and −y of all centres.
    pub(super) fn farthest(&self) -> Result<[f64; 4]> {
        let (positions, least) = (&self.particles.positions, [f32::MIN; 4]);
        let most = match &self.domain {
            _ if positions.is_empty() => least,
            Some(domain) if domain.has_ghosts() => {
                let all = positions.iter().map(|&[x, y]| [x, y, -x, -y]);
                let own = domain.own_or(least, all, &self.rows);
                own.fold(least, |most, own| [0, 1, 2, 3].map(|k| most[k].max(own[k])))
            }
            _ => {
                let [[left, top], [right, bottom]] = extent_of(positions);
                [right, bottom, -left, -top]
            }
        };
        self.largest_of_all(most.map(f64::from))
    }

    /// The mean of a number of all particles, none negative; the same whatever their order and
    /// ranks.
    pub(super) fn mean<V>(&self, column: &[V], number: impl Fn(&V) -> f32 + Copy) -> Result<f64> {
        let most = match &self.domain {
            None => f64::from(largest(column.iter().map(number))),
            Some(domain) => {
                let own = domain.own_or(0.0, column.iter().map(number), &self.rows);
                self.largest_of_all([f64::from(largest(own))])?[0]
            }
        };
        if most == 0.0 {
            return Ok(0.0);
        }
        // Whole numbers have sums without rounding. To add 2⁵² rounds a number below 2³¹ and puts
        // it into the last bits.
        let scale = f64::from(i32::MAX) / most;
        let whole = |value: &V| (f64::from(number(value)) * scale + WHOLE).to_bits() - WHOLE_BITS;
        let sum = match &self.domain {
            None => column.iter().map(whole).sum(),
            Some(domain) => {
                let own = domain.own_or(0, column.iter().map(whole), &self.rows);
                self.sum_of_all([own.sum()])?[0]
            }
        };
        Ok(sum as f64 / scale / self.count_of_all() as f64)
    }

    /// Area of the smallest AABB around all particles.
    pub(super) fn area_of_extent(&self) -> Result<f64> {
        let [right, bottom, left, top] = self.farthest()?;
        Ok((right + left) * (bottom + top))
    }

    /// Finds out whether any rank has collisions that lose energy, on which the automatic number of
    /// sub-steps depends. All ranks call it after a change.
    pub fn agree_on_losses(&mut self) -> Result<()> {
        let Some(domain) = &self.domain else { return Ok(()) };
        let own = (0..).zip(&self.rows).filter(|(_, row)| domain.owns(**row));
        let is_lossy = self.settings.restitution != 1.0
            || !self.walls.are_elastic()
            || own.map(|of| of.0).any(|index| loses_energy(&self.particles, index));
        let is_lossy = self.any_of_all(is_lossy)?;
        if let Some(domain) = &mut self.domain {
            domain.is_lossless = !is_lossy;
        }
        Ok(())
    }

    /// Finds out what the particles that are awake require on all ranks, and how many these are.
    pub(super) fn sum_up_ranks(&mut self) -> Result<()> {
        let has_friction = self.particles.has_friction();
        let moving = (0..self.rows.len()).any(|index| !self.particles.is_static(index));
        let flags = [!self.are_own_lossless(), has_friction, moving].map(u64::from);
        let counts = [self.rows.len(), self.asleep.len()].map(|count| count as u64);
        let own = [flags[0], flags[1], flags[2], counts[0], counts[1]];
        let Some(domain) = &mut self.domain else { return Ok(()) };
        let load =
            [domain.work * self.rows.len() as f64, domain.received.iter().sum::<usize>() as f64]
                .map(f64::to_bits);
        let all = locked(&domain.group)
            .gather([own[0], own[1], own[2], own[3], own[4], load[0], load[1]])?;
        let sum = |k: usize| all.iter().map(|of| of[k]).sum::<u64>();
        let [inelastic, frictions, moving, awake, asleep] = [0, 1, 2, 3, 4].map(sum);
        let loads = |k: usize| all.iter().map(move |of| f64::from_bits(of[k]));
        domain.note_load(loads(5), loads(6).sum());
        (domain.is_lossless, domain.has_friction) = (inelastic == 0, frictions > 0);
        (domain.awake, domain.asleep) = (awake as usize, asleep as usize);
        domain.is_still = asleep > 0 && moving == 0;
        if frictions > 0 {
            self.particles.spins_mut();
        }
        Ok(())
    }
}

/// The largest of some numbers, none negative, which have the order of their bits; 0 if there are
/// none.
pub(super) fn largest(numbers: impl Iterator<Item = f32>) -> f32 {
    f32::from_bits(numbers.map(|number| number.to_bits() as i32).fold(0, i32::max) as u32)
}
