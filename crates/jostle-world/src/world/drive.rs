//! Motors drive immovable particles and walls.

use std::collections::HashMap;

use super::bodies::Bodies;
use super::boundaries::Boundaries;
use crate::forces::{Influences, Role};
use crate::motion::exact;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::{memory, reserve};

/// The velocities of what motors drive, before a step.
#[derive(Default)]
pub(crate) struct Driven {
    /// Index, velocity and angular velocity.
    particles: Vec<(usize, [f32; 2], f32)>,
    /// Index and velocity.
    walls: Vec<(usize, [f32; 2])>,
}

/// Sets the velocities of all that motors drive, before a step of `dt` seconds, and notes those before in `before`.
pub(crate) fn drive(
    influences: &Influences,
    bodies: &mut Bodies,
    boundaries: &mut Boundaries,
    (time, dt): (f64, f64),
    before: &mut Driven,
) -> Result<()> {
    let period = boundaries.walls.container().period().exact();
    for motor in influences.motors() {
        let drive = motor.drive(time, dt);
        let rows = memory::collect(motor.ids.iter().map(|&row| row as u32))?;
        let indices = bodies.indices_of(&rows)?;
        // From here on this motor needs no memory.
        memory::reserve(&mut before.particles, indices.len())?;
        memory::reserve(&mut before.walls, motor.walls.0.len())?;
        if !indices.is_empty() && drive.angular_velocity != 0.0 {
            reserve!(bodies.awake.rows.len(); bodies.awake.particles.spins);
        }
        for index in indices {
            // It may have become movable, and may sleep then.
            if !bodies.is_immovable(index) {
                continue;
            }
            let (index, all) = (index as usize, &mut bodies.awake.particles);
            // Several motors may drive one particle that others have merged with. Each notes what it found, so restoring in
            // reverse order ends with the first velocity.
            before.particles.push((index, all.velocities[index], all.spin(index).velocity));
            let position = exact(all.positions[index], all.residuals[index]);
            // On a torus a particle turns about the nearest image of the centre.
            let offset = period.minimum_image(drive.offset(position));
            all.velocities[index] = drive.velocity_at(offset);
            all.set_angular_velocity(index, drive.angular_velocity);
        }
        for wall in motor.walls.0.iter().filter_map(|&wall| boundaries.ids.row(wall)) {
            let wall = wall as usize;
            before.walls.push((wall, boundaries.walls.all()[wall].velocity));
            boundaries.walls.set_velocity(wall, drive.velocity());
        }
    }
    Ok(())
}

impl Driven {
    /// Takes back what [`drive`] did before a step that failed, in reverse order: several
    /// motors may drive the same particle.
    pub(crate) fn restore(self, bodies: &mut Bodies, boundaries: &mut Boundaries) {
        if self.particles.is_empty() && self.walls.is_empty() {
            return;
        }
        let all = &mut bodies.awake.particles;
        for (index, velocity, angular_velocity) in self.particles.into_iter().rev() {
            all.velocities[index] = velocity;
            all.set_angular_velocity(index, angular_velocity);
        }
        for (wall, velocity) in self.walls.into_iter().rev() {
            boundaries.walls.set_velocity(wall, velocity);
        }
        // An angular velocity may have added the column of spins.
        all.simplify();
    }
}

/// Refuses motors of movable particles, and two motors of one particle or wall.
pub(crate) fn check_motors(influences: &Influences, bodies: &Bodies) -> Result<()> {
    let indices = bodies.indices()?;
    let mut drivers: [HashMap<Id, usize>; 2] = [HashMap::new(), HashMap::new()];
    for (index, influence) in influences.list().iter().enumerate() {
        let Role::Motor(motor) = influence.role() else { continue };
        let is_movable = |&&id: &&Id| {
            let row = bodies.ids.row(id).expect("it is in the world");
            !bodies.is_immovable(indices[row as usize])
        };
        if let Some(id) = motor.ids.iter().find(is_movable) {
            let value = format!("a motor of particle {id}");
            let rule = "it drives immovable particles only";
            return Err(Error::at("forces", index, value, rule));
        }
        let driven = [("particle", &motor.ids), ("wall", &motor.walls.0)];
        for ((noun, ids), drivers) in driven.into_iter().zip(&mut drivers) {
            for &id in ids {
                if let Some(other) = drivers.insert(id, index) {
                    let value = format!("a motor of {noun} {id}");
                    let rule = format!("forces[{other}] drives it already");
                    return Err(Error::at("forces", index, value, &rule));
                }
            }
        }
    }
    Ok(())
}
