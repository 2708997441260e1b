//! New values of some particles: writing them, and what they change.

use super::{Changes, Particles};
use jostle_base::table::{dense, sparse};

/// What changes of one particle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Nothing.
    None,
    /// The velocity or the angular velocity alone.
    Velocity,
    /// Anything else.
    Other,
}

impl Effect {
    /// What changes of the particle in a row.
    pub fn of(before: &Particles, after: &Particles, row: usize) -> Self {
        let mut effect = Self::None;
        // The least effect that covers all differences: a velocity only if nothing else differs.
        for name in before.differences(after, row) {
            match name {
                "velocities" | "angular_velocities" => effect = Self::Velocity,
                _ => return Self::Other,
            }
        }
        effect
    }
}

impl Changes {
    /// Whether centres, radii, categories or masks may change: what a tree of the particles has.
    pub fn is_of_shapes(&self) -> bool {
        self.positions.is_some()
            || self.radii.is_some()
            || self.categories.is_some()
            || self.masks.is_some()
    }

    /// Writes the values over those of the particles in some rows. Rows that `particles` does not have are
    /// left out.
    pub fn write(&self, particles: &mut Particles, rows: &[u32]) {
        self.write_fields(particles, rows);
        let len = particles.len();
        let Particles { residuals, radii, spins, .. } = particles;
        // A residual is what rounding removed from the old centre.
        if self.positions.is_some() && self.residuals.is_none() {
            dense::change(residuals, len, rows, |_, residual| *residual = [0.0; 2]);
        }
        // Points do not turn, and angles stay in their range, whatever the caller gave.
        if self.radii.is_some() || self.angles.is_some() || self.angular_velocities.is_some() {
            sparse::change(spins, len, rows, |nth, spin| {
                *spin = spin.of_disc(radii[rows[nth] as usize]);
            });
        }
    }
}
