//! Torques that callers give: they change angular velocities as forces change velocities.
//!
//! Half of the change in a sub-step comes before the flight and half after it, so a free disc turns by the exact angle.
//! The resting contacts begin with the whole change. If their friction changes the angular velocity, what they find is
//! that at the end of the sub-step. The disc turns with it from the beginning, as a supported particle flies.

use std::cell::Cell;

use super::bodies::discs::Discs;
use super::distribution::Distribution;
use super::external::External;
use crate::halo::Halo;
use crate::motion::Spins;
use jostle_base::error::Result;
use jostle_base::memory;

/// The torques of a part of a step.
#[derive(Debug, Default)]
pub(crate) struct Torques(Vec<Torque>);

#[derive(Clone, Copy, Debug)]
struct Torque {
    index: u32,
    /// Angular acceleration.
    acceleration: f64,
    /// The angular velocity at the beginning of the sub-step.
    before: f32,
    /// Whether half of the change comes after the flight.
    is_halved: bool,
}

impl Torque {
    /// The angular velocity after some seconds without contacts.
    fn after(&self, seconds: f64) -> f32 {
        (f64::from(self.before) + self.acceleration * seconds) as f32
    }
}

impl Torques {
    /// Lists the particles of this process and of its ghosts that have a torque.
    pub(crate) fn list(
        &mut self,
        external: &External,
        Discs { particles, rows, .. }: &Discs,
        halo: &dyn Distribution,
    ) -> Result<()> {
        self.0.clear();
        if !external.turns() {
            return Ok(());
        }
        let mut all: Vec<f32> = Vec::new();
        memory::extend(&mut all, rows.iter().map(|&row| external.of(row)[2]))?;
        // The rows of ghosts have none.
        let cells = Cell::from_mut(&mut all[..]).as_slice_of_cells();
        let halo: &dyn Halo = halo;
        halo.wait()?;
        let (get, set) = (
            |index: u32| [cells[index as usize].get()],
            |index: u32, [of]: [f32; 1]| {
                cells[index as usize].set(of);
            },
        );
        halo.refresh(get, set)?;
        let torque = |(index, &acceleration): (usize, &f32)| {
            (acceleration != 0.0 && particles.movable[index]).then_some(Torque {
                index: index as u32,
                acceleration: f64::from(acceleration),
                before: 0.0,
                is_halved: false,
            })
        };
        memory::extend(&mut self.0, all.iter().enumerate().filter_map(torque))
    }

    /// Gives the discs their whole changes of a sub-step of `h` seconds.
    pub(crate) fn begin(&mut self, spins: &Spins, h: f64) {
        for torque in &mut self.0 {
            torque.before = spins.velocity(torque.index);
            spins.set_velocity(torque.index, torque.after(h));
        }
    }

    /// Leaves the discs that no friction at rest has turned half of their changes.
    pub(crate) fn halve(&mut self, spins: &Spins, h: f64) {
        for torque in &mut self.0 {
            torque.is_halved = spins.velocity(torque.index) == torque.after(h);
            if torque.is_halved {
                spins.set_velocity(torque.index, torque.after(0.5 * h));
            }
        }
    }

    /// Adds the other halves.
    pub(crate) fn end(&self, spins: &Spins, h: f64) {
        for torque in self.0.iter().filter(|torque| torque.is_halved) {
            let flown = f64::from(spins.velocity(torque.index));
            spins.set_velocity(torque.index, (flown + 0.5 * torque.acceleration * h) as f32);
        }
    }
}
