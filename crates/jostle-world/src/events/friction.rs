//! Friction of surfaces that collide, and the rotation that it causes.
//!
//! The impulse along the surfaces makes them stick, if that takes at most μ times the impulse along
//! the normal; otherwise it is μ times that impulse, against their sliding (O. R. Walton, *Numerical
//! simulation of inelastic, frictional particle-particle interactions*, 1993, with a tangential
//! restitution of 0). The moment of inertia of a disc is m r²/2.

use super::flight::TimeWindow;
use super::impulses::{Constraint, MAX_ITERATIONS, TOLERANCE};
use super::simulation::Simulation;
use crate::surface::mean;
use crate::trajectory::{Piece, Vector, dot, vector};
use jostle_base::error::Result;
use jostle_base::reserve;

/// The rotation of a disc during a flight.
#[derive(Clone, Copy, Debug, Default)]
pub struct Turning {
    /// Angular velocity.
    velocity: f64,
    /// Since when, in seconds since the beginning of the flight.
    time: f64,
    /// The angle by which the disc has turned until then.
    angle: f64,
}

impl Turning {
    /// The angle by which the disc has turned at `time`.
    fn angle_at(&self, time: f64) -> f64 {
        self.angle + self.velocity * (time - self.time)
    }

    fn change(&mut self, velocity: f64, time: f64) {
        *self = Self { velocity, time, angle: self.angle_at(time) };
    }
}

/// The rotation of a disc of a group.
#[derive(Clone, Copy, Debug)]
pub struct Rotor {
    /// Angular velocity times radius.
    surface_speed: f64,
    /// Change of the surface speed by an impulse along the surface: r²/I, 0 for points.
    softness: f64,
}

impl Constraint {
    /// Unit vector along the surfaces, a quarter turn from the normal.
    fn tangent(&self) -> Vector {
        [-self.normal[1], self.normal[0]]
    }

    /// The speed at which the surface of the second slides along that of the first.
    fn sliding_speed(&self, velocities: &[Vector], rotors: &[Rotor]) -> f64 {
        let turning = |body: Option<usize>| body.map_or(0.0, |body| rotors[body].surface_speed);
        let [a, b] = self.bodies.map(turning);
        let turning = (a + b) + self.carried_turning;
        dot(self.tangent(), self.relative_velocity(velocities)) - turning
    }

    /// Change of the sliding speed by an impulse along the surfaces.
    fn tangential_softness(&self, rotors: &[Rotor]) -> f64 {
        let turning = |body: Option<usize>| body.map_or(0.0, |body| rotors[body].softness);
        let [a, b] = self.bodies.map(turning);
        (self.inverse_masses[0] + self.inverse_masses[1]) + (a + b)
    }

    /// Corrects the impulse of friction. Returns the change of the sliding speed.
    fn rub(
        &self,
        velocities: &mut [Vector],
        rotors: &mut [Rotor],
        [normal, friction]: &mut [f64; 2],
    ) -> f64 {
        let softness = self.tangential_softness(rotors);
        // Two surfaces that no impulse moves.
        if softness == 0.0 {
            return 0.0;
        }
        // Coulomb's limit follows the present impulse along the normal, which `press` may raise in
        // the same turn.
        let most = self.friction * *normal;
        let wanted = *friction - self.sliding_speed(velocities, rotors) / softness;
        // The sum is limited, as along the normal. The change alone could be clamped in one
        // direction and never return.
        let change = wanted.max(-most).min(most) - *friction;
        *friction += change;
        self.push(self.tangent(), change, velocities);
        for body in self.bodies.into_iter().flatten() {
            rotors[body].surface_speed -= change * rotors[body].softness;
        }
        change.abs() * softness
    }

    /// Corrects the impulse along the normal, which is at least `least`, so that the surfaces do not
    /// approach. Returns the change of the speed of separation.
    fn press(&self, velocities: &mut [Vector], least: f64, [normal, _]: &mut [f64; 2]) -> f64 {
        let softness = self.inverse_masses[0] + self.inverse_masses[1];
        if softness == 0.0 {
            return 0.0;
        }
        // The target is a speed of 0, without restitution. Energy would be added if a push caused
        // by friction made surfaces bounce.
        let wanted = *normal - self.separation_speed(velocities) / softness;
        let change = wanted.max(least) - *normal;
        *normal += change;
        self.push(self.normal, change, velocities);
        change.abs() * softness
    }
}

/// Scratch.
#[derive(Debug, Default)]
pub struct FrictionScratch {
    /// The discs of the group.
    rotors: Vec<Rotor>,
    /// The impulses along the normals before the friction.
    bounced: Vec<f64>,
}

impl FrictionScratch {
    /// Reserves memory for so many discs and contacts.
    pub fn reserve(&mut self, len: usize) -> Result<()> {
        reserve!(len; self.rotors, self.bounced);
        Ok(())
    }

    /// Changes velocities and surface speeds by the friction of all `touches` after the impulses
    /// along their normals, and makes surfaces that approach because of that stay together. Each of
    /// `impulses` begins as the impulse along the normal, and ends as that and that of friction.
    ///
    /// This adds no energy: friction opposes the sliding, and impulses along normals act only where
    /// the surfaces end without separating.
    fn run(
        &mut self,
        touches: &[Constraint],
        velocities: &mut [Vector],
        impulses: &mut [[f64; 2]],
    ) {
        let Self { rotors, bounced } = self;
        bounced.clear();
        bounced.extend(impulses.iter().map(|[normal, _]| *normal));
        impulses.iter_mut().for_each(|[_, friction]| *friction = 0.0);
        // The discs are those of a world without friction then.
        if touches.iter().all(|touch| touch.friction == 0.0) {
            return;
        }
        let mut fastest = 0.0f64;
        for iteration in 0..MAX_ITERATIONS {
            let mut largest = 0.0f64;
            for (at, (touch, impulses)) in touches.iter().zip(impulses.iter_mut()).enumerate() {
                largest = largest.max(touch.rub(velocities, rotors, impulses));
                if touches.len() > 1 {
                    // The impulse of the bounce is the least value. Friction must not take back
                    // what restitution has given.
                    largest = largest.max(touch.press(velocities, bounced[at], impulses));
                }
            }
            if iteration == 0 {
                fastest = largest;
            }
            if touches.len() == 1 || largest <= TOLERANCE * fastest {
                break;
            }
        }
    }
}

impl TimeWindow<'_> {
    /// The rotation with which a disc begins the window.
    pub fn turning(&self, index: u32) -> Turning {
        if let Some(turning) = self.carried.turning(index) {
            return *turning;
        }
        let velocity = f64::from(self.flight.spins.velocity(index));
        Turning { velocity, ..Turning::default() }
    }

    /// Writes the rotation of a disc at the end of the flight.
    pub fn turn(&self, index: u32, turning: &Turning) {
        let flow = &self.flight.flow;
        // The flight is shorter than the sub-step if there is damping.
        let longer = flow.seconds / flow.duration;
        self.flight.spins.turn(index, turning.angle_at(self.end) * longer);
        self.flight.spins.set_velocity(index, turning.velocity as f32);
    }

    /// Coefficient of friction of two discs.
    pub fn pair_friction(&self, pair: [u32; 2]) -> f64 {
        if !self.flight.has_friction {
            return 0.0;
        }
        let [a, b] = pair.map(|index| self.friction(index));
        mean(a, b)
    }

    /// Coefficient of friction of a disc and a wall.
    pub fn wall_friction(&self, index: u32, wall: u32) -> f64 {
        self.flight.walls.walls.surface(wall).friction_with(self.friction(index))
    }

    fn friction(&self, index: u32) -> f64 {
        f64::from(self.flight.particles.spin(index as usize).friction)
    }

    /// Angular velocity times radius of a disc that impacts do not turn.
    pub fn surface_speed(&self, index: u32) -> f64 {
        if !self.flight.has_friction {
            return 0.0;
        }
        f64::from(self.flight.spins.velocity(index)) * self.radius(index)
    }

    /// Radius of a disc.
    pub fn radius(&self, index: u32) -> f64 {
        f64::from(self.starts[index as usize].radius)
    }
}

impl Simulation<'_> {
    /// The rotation of the disc with the trajectory `number`.
    fn rotor(&self, number: u32) -> Rotor {
        let trajectory = &self.history.trajectories[number as usize];
        let radius = self.window.radius(trajectory.index);
        if radius == 0.0 {
            return Rotor { surface_speed: 0.0, softness: 0.0 };
        }
        let velocity = self.history.turnings[number as usize].velocity;
        // r²/I = 2/m for a disc, so the radius does not appear.
        Rotor { surface_speed: velocity * radius, softness: 2.0 * trajectory.inverse_mass }
    }

    /// Writes the rotation of the disc with the trajectory `number`, if an impact has changed it.
    fn set_rotor(&mut self, number: u32, rotor: &Rotor, time: f64) {
        // The speed is written only if it has changed: a product and a quotient with the radius do
        // not return the same bits.
        if rotor.softness > 0.0 && rotor.surface_speed != self.rotor(number).surface_speed {
            let radius = self.window.radius(self.history.trajectories[number as usize].index);
            let velocity = rotor.surface_speed / radius;
            self.history.turnings[number as usize].change(velocity, time);
        }
    }

    /// Lets friction change the velocities of the discs with the trajectories `numbers` and their
    /// [`Rotor`]s, after the impulses of `touches` along their normals.
    pub(super) fn rub(
        &mut self,
        touches: &[Constraint],
        numbers: impl Iterator<Item = u32>,
        velocities: &mut [Vector],
    ) {
        let mut friction_scratch = std::mem::take(&mut self.scratch.friction_scratch);
        friction_scratch.rotors.clear();
        friction_scratch.rotors.extend(numbers.map(|number| self.rotor(number)));
        friction_scratch.run(touches, velocities, &mut self.scratch.impulses);
        self.scratch.friction_scratch = friction_scratch;
    }

    /// Writes the rotations after [`Simulation::rub`].
    pub(super) fn set_rotors(&mut self, numbers: impl Iterator<Item = u32>, time: f64) {
        for (position, number) in numbers.enumerate() {
            let rotor = self.scratch.friction_scratch.rotors[position];
            self.set_rotor(number, &rotor, time);
        }
    }

    /// Lets friction change the velocities and the rotations of the discs of the group.
    pub(super) fn rub_group(&mut self, time: f64) {
        let group = std::mem::take(&mut self.scratch.group);
        let touches = std::mem::take(&mut self.scratch.touches);
        let mut velocities = std::mem::take(&mut self.scratch.velocities);
        let numbers = group.iter().map(|own| own.number);
        self.rub(&touches, numbers.clone(), &mut velocities);
        self.set_rotors(numbers, time);
        self.scratch.group = group;
        (self.scratch.touches, self.scratch.velocities) = (touches, velocities);
    }

    /// Friction of a disc that slides along a surface until the end of the flight, where gravity
    /// presses it against the surface with the speed `pressing`. The velocity of another movable disc
    /// counts as 0.
    /// Returns the change of the speed of the second surface along the first.
    pub(super) fn brake(
        &mut self,
        number: u32,
        piece: &mut Piece,
        touch: &Constraint,
        is_second: bool,
        pressing: f64,
    ) -> f64 {
        let mut rotor = self.rotor(number);
        // Everything here is divided by the mass: 1 for the velocity of the centre and 2 for the
        // surface of a disc.
        let softness = 1.0 + if rotor.softness > 0.0 { 2.0 } else { 0.0 };
        let side = if is_second { 1.0 } else { -1.0 };
        let tangent = touch.tangent();
        let carried = dot(tangent, touch.carried) - touch.carried_turning;
        let own = dot(tangent, piece.velocity) - side * rotor.surface_speed;
        let sliding = own + side * carried;
        // Gravity presses for the rest of the flight, and friction acts for the same time at once,
        // as `hold` does with gravity.
        let most = touch.friction * pressing;
        let change = (-sliding / softness).max(-most).min(most);
        piece.velocity = vector(|k| piece.velocity[k] + tangent[k] * change);
        rotor.surface_speed -= side * change * (softness - 1.0);
        self.set_rotor(number, &rotor, piece.time);
        side * change
    }
}
