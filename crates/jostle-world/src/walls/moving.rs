//! Walls that move with a constant velocity.
//!
//! The trajectory of a disc is computed in the frame of reference of the wall. It is a parabola or
//! a straight line too, so the same formulas give the time of impact. Walls that share an end
//! should have the same velocity: which part of a wall acts on a disc is decided with the others
//! seen from that wall.

use super::{Line, Wall, Walls, are_elastic};
use crate::motion::residual;
use crate::particles::FARTHEST;
use crate::trajectory::{Vector, dot, vector};
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::settings::Settings;

impl Wall {
    /// Whether it moves.
    pub fn moves(&self) -> bool {
        self.velocity != [0.0; 2]
    }

    /// Its displacement in `dt` seconds.
    fn displacement(&self, dt: f64) -> Vector {
        self.velocity.map(|v| f64::from(v) * dt)
    }

    /// Length of the displacement.
    pub(super) fn displacement_length(&self, dt: f64) -> f64 {
        let by = self.displacement(dt);
        dot(by, by).sqrt()
    }

    /// The bounding box of its positions in a step of `dt` seconds.
    pub(super) fn swept_bounds(&self, dt: f64) -> [f32; 4] {
        let ([a, b], by) = (self.ends, self.displacement(dt).map(|v| v as f32));
        // Rounding is covered by the radius that the shape of the wall has in the tree.
        let low = |k: usize| a[k].min(b[k]) + by[k].min(0.0);
        let high = |k: usize| a[k].max(b[k]) + by[k].max(0.0);
        [low(0), low(1), high(0), high(1)]
    }

    /// Moves it for `dt` seconds.
    fn advance(&mut self, dt: f64) {
        // The residuals keep what float32 cannot hold, so slow walls move far from the origin, too.
        let (ends, by) = (self.exact_ends(), self.displacement(dt));
        for (end, exact) in ends.into_iter().enumerate() {
            let new = vector(|k| exact[k] + by[k]);
            self.ends[end] = new.map(|v| v as f32);
            self.residuals[end] = residual(new, self.ends[end]);
        }
    }
}

impl Walls {
    /// Whether any wall moves.
    pub fn move_any(&self) -> bool {
        self.any_moves
    }

    /// The velocity of the wall with a number; 0 at the container.
    #[inline(always)]
    pub fn velocity(&self, wall: u32) -> [f32; 2] {
        // Most worlds need not read the wall.
        if self.any_moves { self.get(wall).map_or([0.0; 2], |of| of.velocity) } else { [0.0; 2] }
    }

    /// Changes the velocity of wall `index`.
    pub fn set_velocity(&mut self, index: usize, velocity: [f32; 2]) {
        self.all[index].velocity = velocity;
        // It may stay true when the last one stops, until the next step.
        self.any_moves |= self.all[index].moves();
    }

    /// Begins a part of a step, of `dt` seconds.
    pub fn begin_part(&mut self, settings: Settings, dt: f64) -> Result<()> {
        self.any_moves = self.any_moves && self.all.iter().any(Wall::moves);
        // Walls that stand still keep the tree of `Walls::new`.
        if self.any_moves || self.is_stale { self.build(settings, dt) } else { Ok(()) }
    }

    /// Moves the walls that have a velocity for `dt` seconds.
    pub fn advance(&mut self, dt: f64) {
        for (wall, &index) in self.all.iter_mut().zip(&self.indices) {
            if wall.moves() {
                wall.advance(dt);
                // Which of equal ends acts was decided with all walls together.
                let line = &mut self.lines[index as usize];
                *line = Line { has_end: line.has_end, ..Line::of(wall, line.torus_offset) };
            }
        }
    }

    /// Restores the walls before a step.
    pub fn restore(&mut self, all: Vec<Wall>) {
        // What follows from the walls is computed again; with no time they do not move.
        self.all = all;
        self.any_moves = self.all.iter().any(Wall::moves);
        self.are_elastic = are_elastic(&self.all);
        self.is_stale = true;
        self.advance(0.0);
    }

    /// Refuses a step of `dt` seconds in which a wall would move too far. `id` has the id of a wall.
    pub fn check_displacements(&self, dt: f64, id: impl Fn(u32) -> Id) -> Result<()> {
        if !self.any_moves {
            return Ok(());
        }
        let most = f64::from(FARTHEST);
        let is_far = |wall: &Wall| {
            let by = wall.displacement(dt);
            // The largest coordinates are at the end of the step, because the velocity is constant.
            let mut ends = wall.exact_ends().into_iter();
            ends.any(|end| (0..2).any(|k| (end[k] + by[k]).abs() > most || by[k].abs() > most))
        };
        if let Some(index) = self.all.iter().position(is_far) {
            let wall = id(index as u32);
            let rule = format!("wall {wall} would move out of the range ±{FARTHEST:e}");
            return Err(Error::of("dt", dt, &rule));
        }
        let period = self.period();
        let circles = |wall: &Wall| period.is_exceeded_by(wall.displacement(dt));
        match self.all.iter().position(circles) {
            None => Ok(()),
            Some(index) => {
                let wall = id(index as u32);
                let rule =
                    format!("wall {wall} would travel more than the period; take smaller steps");
                Err(Error::of("dt", dt, &rule))
            }
        }
    }
}

/// The time of a window, for the positions of walls.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    /// Seconds from the beginning of the step to that of the window.
    pub elapsed: f64,
    /// Seconds for each second of flight, which is shorter if there is damping.
    pub rate: f64,
}

impl Clock {
    /// How far a wall has moved in the step, `time` seconds of flight after the beginning of the
    /// window.
    #[inline(always)]
    pub(super) fn offset(&self, walls: &Walls, wall: u32, time: f64) -> Vector {
        if !walls.any_moves {
            return [0.0; 2];
        }
        // From the beginning of the step, and not from window to window: no error adds up, and
        // windows do not change the result.
        let seconds = self.elapsed + self.rate * time;
        walls.get(wall).map_or([0.0; 2], |of| of.displacement(seconds))
    }
}
