//! Motors: prescribed motion of immovable (kinematic) particles and walls.
//!
//! The motion is a function of time. A step uses the velocities that lead from the position at its
//! beginning to that at its end, so that the displacements sum to the motion for every step length.

use std::f64::consts::TAU;

use super::record::{WallIds, record};
use super::{check_distinct, check_number, check_pair};
use crate::particles::FARTHEST;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;

record! {
    /// A rotation about a pivot and a translation, both reversed in the second half of each cycle.
    #[derive(Clone, Debug, PartialEq)]
    pub struct Motor {
        /// The immovable particles that it drives.
        pub ids: Vec<Id>,
        /// The ids of the walls that it drives. Walls do not rotate.
        pub walls: WallIds,
        /// The centre of the rotation at time 0. It moves with the translation.
        pub pivot: [f32; 2],
        /// Radians per second.
        pub angular_velocity: f32,
        /// Units of length per second.
        pub velocity: [f32; 2],
        /// Seconds of the motion there and back; infinite if it is never reversed.
        pub cycle: f32,
    }
}

impl Motor {
    /// Refuses numbers out of range, and a particle or a wall that is named twice.
    pub fn validate(&self) -> Result<()> {
        check_pair("pivot", self.pivot)?;
        check_pair("velocity", self.velocity)?;
        check_number("angular_velocity", self.angular_velocity, -FARTHEST)?;
        if self.cycle.is_nan() || self.cycle <= 0.0 {
            return Err(Error::of("cycle", self.cycle, "it must be above 0"));
        }
        if self.angular_velocity != 0.0 && !self.walls.0.is_empty() {
            let rule = "walls do not turn, so it must be 0 for a motor that drives walls";
            return Err(Error::of("angular_velocity", self.angular_velocity, rule));
        }
        check_distinct("ids", &self.ids)?;
        self.walls.validate()
    }

    /// Seconds of forward motion minus seconds of backward motion since time 0.
    fn progress(&self, time: f64) -> f64 {
        let cycle = f64::from(self.cycle);
        if cycle == f64::INFINITY {
            return time;
        }
        // A triangle wave: forwards in the first half of each cycle, backwards in the second. It
        // is a function of the time, so no error adds up from step to step.
        let phase = time - cycle * (time / cycle).floor();
        phase.min(cycle - phase)
    }

    /// Its motion in a step of `dt` seconds that begins at `time`.
    pub fn drive(&self, time: f64, dt: f64) -> Drive {
        let (start, end) = (self.progress(time), self.progress(time + dt));
        let along = [0, 1].map(|k| f64::from(self.velocity[k]) * start);
        // The mean over the step, which may contain a reversal.
        let share = (end - start) / dt;
        Drive {
            seconds: dt,
            pivot: [0, 1].map(|k| f64::from(self.pivot[k]) + along[k]),
            turn: turn(f64::from(self.angular_velocity) * (end - start)),
            angular_velocity: (f64::from(self.angular_velocity) * share) as f32,
            velocity: self.velocity.map(|v| f64::from(v) * share),
        }
    }
}

/// The motion of a motor in a step.
#[derive(Clone, Copy, Debug)]
pub struct Drive {
    seconds: f64,
    pivot: [f64; 2],
    /// Cosine minus 1 and sine of the angle.
    turn: [f64; 2],
    /// Radians per second.
    pub angular_velocity: f32,
    velocity: [f64; 2],
}

impl Drive {
    /// The velocity of a wall.
    pub fn velocity(&self) -> [f32; 2] {
        self.velocity.map(|v| v as f32)
    }

    /// The velocity of a particle at `offset` from the centre of the rotation.
    pub fn velocity_at(&self, offset: [f64; 2]) -> [f32; 2] {
        let ([less, sine], [x, y]) = (self.turn, offset);
        let by = [less * x - sine * y, sine * x + less * y];
        [0, 1].map(|k| (by[k] / self.seconds + self.velocity[k]) as f32)
    }

    /// The offset of a position from the centre of the rotation.
    pub fn offset(&self, position: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| position[k] - self.pivot[k])
    }
}

/// Cosine minus 1 and sine of an angle, by sums and products only, so that the bits are the same on
/// every machine: a Taylor series after four halvings of the angle.
pub fn turn(angle: f64) -> [f64; 2] {
    const HALVINGS: i32 = 4;
    // At most π/16.
    let x = (angle - TAU * (angle / TAU).round()) / f64::from(1 << HALVINGS);
    // Cosine minus 1, because 1 − x²/2 would lose the digits of a small angle.
    let (mut less, mut sine, mut term) = (0.0, x, x);
    // Up to x¹⁵/15!. With x ≤ π/16 the next term is below 10⁻²⁴.
    for k in 1..8 {
        let n = f64::from(2 * k);
        term *= x / n;
        less += if k % 2 == 1 { -term } else { term };
        term *= x / (n + 1.0);
        sine += if k % 2 == 1 { -term } else { term };
    }
    for _ in 0..HALVINGS {
        // cos 2x − 1 = −2 sin² x, sin 2x = 2 sin x cos x.
        (less, sine) = (-2.0 * sine * sine, 2.0 * sine * (1.0 + less));
    }
    [less, sine]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cosine_and_sine_are_those_of_the_library() {
        for k in -1000..1000 {
            let angle = f64::from(k) * 0.0137;
            let [less, sine] = turn(angle);
            assert!((less - (angle.cos() - 1.0)).abs() < 1e-15 * 8.0, "{angle}");
            assert!((sine - angle.sin()).abs() < 1e-15 * 8.0, "{angle}");
        }
        let [less, sine] = turn(1e-5);
        assert!((less / -0.5e-10 - 1.0).abs() < 1e-10 && (sine / 1e-5 - 1.0).abs() < 1e-10);
    }

    #[test]
    fn it_goes_back_in_the_second_half_of_the_cycle() {
        let motor = Motor {
            ids: vec![],
            walls: WallIds(vec![0]),
            pivot: [0.0; 2],
            angular_velocity: 0.0,
            velocity: [2.0, 0.0],
            cycle: 4.0,
        };
        let velocity = |time, dt| motor.drive(time, dt).velocity()[0];
        assert_eq!([velocity(0.0, 1.0), velocity(1.0, 1.0)], [2.0; 2]);
        assert_eq!([velocity(2.0, 1.0), velocity(3.0, 1.0)], [-2.0; 2]);
        assert_eq!([velocity(1.5, 1.0), velocity(0.0, 4.0), velocity(8.5, 1.0)], [0.0, 0.0, 2.0]);
    }
}
