//! Motors drive immovable particles and walls.

use super::World;
use crate::forces::{Influences, Role};
use crate::motion::exact;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;

/// The velocities of what motors drive, before a step.
#[derive(Default)]
pub(crate) struct Driven {
    /// Index, velocity and angular velocity.
    particles: Vec<(usize, [f32; 2], f32)>,
    /// Index and velocity.
    walls: Vec<(usize, [f32; 2])>,
}

impl World {
    /// Gives the particles and walls of motors their velocities in a step of `dt` seconds; returns
    /// those before.
    pub(crate) fn drive(&mut self, dt: f64) -> Driven {
        let mut before = Driven::default();
        for motor in self.influences.motors() {
            let drive = motor.drive(self.time, dt);
            let rows: Vec<u32> = motor.ids.iter().map(|&row| row as u32).collect();
            for index in self.bodies.indices_of(&rows) {
                let index = index as usize;
                let all = &mut self.bodies.awake.particles;
                // It may have become movable, and may sleep then.
                if all.movable.get(index) != Some(&false) {
                    continue;
                }
                // Several motors may drive one particle. Each notes what it found, so restoring in
                // reverse order ends with the first velocity.
                before.particles.push((index, all.velocities[index], all.spin(index).velocity));
                let position = exact(all.positions[index], all.residuals[index]);
                // On a torus a particle turns about the nearest image of the centre.
                let offset =
                    self.settings.container.period().exact().minimum_image(drive.offset(position));
                all.velocities[index] = drive.velocity_at(offset);
                all.set_angular_velocity(index, drive.angular_velocity);
            }
            for &wall in &motor.walls {
                let wall = wall as usize;
                before.walls.push((wall, self.walls()[wall].velocity));
                self.boundaries.walls.set_velocity(wall, drive.velocity());
            }
        }
        before
    }

    /// Takes back what [`World::drive`] did before a step that failed, in reverse order: several
    /// motors may drive the same particle.
    pub(crate) fn restore_driven(&mut self, before: Driven) {
        if before.particles.is_empty() && before.walls.is_empty() {
            return;
        }
        for (index, velocity, angular_velocity) in before.particles.into_iter().rev() {
            self.bodies.awake.particles.velocities[index] = velocity;
            self.bodies.awake.particles.set_angular_velocity(index, angular_velocity);
        }
        for (wall, velocity) in before.walls.into_iter().rev() {
            self.boundaries.walls.set_velocity(wall, velocity);
        }
        // An angular velocity may have added the column of spins.
        self.bodies.awake.particles.simplify();
    }

    /// Refuses motors of movable particles.
    pub(crate) fn check_motors(&self, influences: &Influences) -> Result<()> {
        let indices = self.bodies.indices();
        for (index, influence) in influences.list().iter().enumerate() {
            let Role::Motor(motor) = influence.role() else { continue };
            let is_movable = |&&id: &&Id| {
                let row = self.bodies.ids.row(id).expect("it is in the world");
                // Immovable particles never sleep.
                self.bodies.awake.particles.movable.get(indices[row as usize] as usize)
                    != Some(&false)
            };
            if let Some(id) = motor.ids.iter().find(is_movable) {
                let value = format!("a motor of particle {id}");
                let rule = "it drives immovable particles only";
                return Err(Error::at("forces", index, value, rule));
            }
        }
        Ok(())
    }
}
