//! Walls that are sensors: they stop no disc. Which discs touch them, also within a step.

use super::torus::less;
use super::{Around, Part, Walls, number_of};
use crate::motion::exact;
use crate::particles::Particles;
use crate::tolerance::Tolerance;
use crate::trajectory::{Piece, Relative, Vector, dot};
use jostle_base::error::Result;
use jostle_base::memory;

impl Walls {
    /// Whether any wall is a sensor.
    pub fn has_sensors(&self) -> bool {
        self.has_sensors
    }

    /// Whether a disc on a piece, seen from the wall with a number, touches the wall before `until`.
    fn is_touched(
        &self,
        wall: u32,
        piece: &Piece,
        until: f64,
        radius: f64,
        gravity: Vector,
    ) -> bool {
        let line = self.numbered(wall);
        let contact_distance = line.contact_distance(radius);
        let acceleration = if piece.falls { gravity } else { [0.0; 2] };
        let touches_end = |end: &Vector| {
            let relative = Relative {
                start: piece.time,
                offset: less(*end, piece.position),
                velocity: piece.velocity.map(|v| -v),
                acceleration: acceleration.map(|v| -v),
            };
            relative.touches(contact_distance, until)
        };
        // Beside the wall the distance is least at the beginning, at the end, on the line or where the path turns
        // along it. Where the disc comes beside the wall, its distance is that from an end.
        let touches_side = |time: f64| {
            let at = piece.position_at(time, gravity);
            time >= piece.time
                && time <= until
                && line.part_at(at) == Part::Side
                && line.left_of(at).abs() <= contact_distance
        };
        let first = line.crossing_of_line(piece, gravity, piece.time);
        let second = line.crossing_of_line(piece, gravity, first);
        let turn =
            piece.time - dot(piece.velocity, line.across()) / dot(acceleration, line.across());
        line.ends.iter().any(touches_end)
            || [piece.time, until, first, second, turn].into_iter().any(touches_side)
    }

    /// The walls and sides that some discs touch where they are now: indices of discs, and numbers.
    pub fn touching(
        &self,
        particles: &Particles,
        indices: impl Iterator<Item = usize>,
    ) -> Result<Vec<[u32; 2]>> {
        let (mut all, mut stack, mut done) = (Vec::new(), Vec::new(), Ok(()));
        for index in indices {
            let position = exact(particles.positions[index], particles.residuals[index]);
            let radius = f64::from(particles.radii[index]);
            let (filter, moves) = (particles.filter(index), particles.movable[index]);
            let near = |size: f64| Tolerance::of(size, position).rounding();
            let mut add = |number: u32| {
                let added = memory::push(&mut all, [index as u32, number]);
                if added.is_err() {
                    done = added;
                }
            };
            for (number, side) in self.container.sides() {
                if moves && side.contact(number, position, radius).gap <= near(radius) {
                    add(number);
                }
            }
            self.each_near([position; 2], radius + near(radius), &mut stack, |wall, offset| {
                let (of, line, seen) =
                    (&self.all[wall as usize], self.line(wall), less(position, offset));
                let contact_distance = line.contact_distance(radius);
                let is_solid = || moves && line.is_solid_for(seen, radius);
                if of.meets(filter)
                    && (of.is_sensor || is_solid())
                    && line.distance(seen) - contact_distance <= near(contact_distance)
                {
                    add(number_of(wall));
                }
            });
        }
        done.map(|()| all)
    }
}

impl Around<'_> {
    /// Calls `act` with the index of each disc near a sensor, with the number of this wall and its offset.
    pub fn each_near_sensor(&self, mut act: impl FnMut(u32, u32, Vector)) {
        self.near.sensors.iter().for_each(|&(index, wall, offset)| act(index, wall, offset));
    }

    /// Whether a disc on a piece touches the wall with a number and an offset before `until`.
    pub fn is_touched(
        &self,
        index: u32,
        (wall, offset): (u32, Vector),
        piece: &Piece,
        until: f64,
        gravity: Vector,
    ) -> bool {
        let radius = f64::from(self.particles.radii[index as usize]);
        let seen = self.seen_from(wall, offset, piece);
        self.walls.is_touched(wall, &seen, until, radius, gravity)
    }

    /// Calls `act` with each sensor near a piece of a disc that leaves the bounds in which walls were searched.
    pub fn each_sensor_beyond(
        &self,
        index: u32,
        piece: &Piece,
        until: f64,
        gravity: Vector,
        mut act: impl FnMut(u32, Vector),
    ) {
        let span = until - piece.time;
        let fastest =
            dot(piece.velocity, piece.velocity).sqrt() + dot(gravity, gravity).sqrt() * span;
        if self.stays_near(index, piece.position, fastest * span) {
            return;
        }
        let filter = self.particles.filter(index as usize);
        let radius = f64::from(self.particles.radii[index as usize]);
        let [min, max] = super::around::bounds(piece, [piece.time, until], gravity);
        let margin = radius * (1.0 + super::near::MARGIN);
        let mut stack = Vec::new();
        self.walls.each_near([min, max], margin, &mut stack, |wall, offset| {
            let of = &self.walls.all[wall as usize];
            if of.is_sensor && of.meets(filter) {
                act(number_of(wall), offset);
            }
        });
    }
}
