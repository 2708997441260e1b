//! From velocities to positions, and how far a step may carry a particle.

use crate::container::Container;
use crate::motion::Motion;

/// Where the centre of a particle may be during one step. Pairs are looked for
/// within sweeps, so nothing may leave its own before the next look.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sweep {
    /// Lower corner.
    pub low: [f32; 2],
    /// Upper corner.
    pub high: [f32; 2],
}

/// Room beside the straight way, in radii: a bounce turns a particle aside.
const MARGIN: [f32; 2] = [0.05, 0.5];

impl Sweep {
    /// The sweep of a step of `dt` seconds: the straight way under `gravity`,
    /// and about as much again to every side for what a bounce may do.
    pub fn new(
        position: [f32; 2],
        velocity: [f32; 2],
        radius: f32,
        gravity: [f32; 2],
        dt: f32,
    ) -> Self {
        let way = [0, 1].map(|k| velocity[k] * dt);
        let bent = [0, 1].map(|k| way[k] + gravity[k] * dt * dt);
        let longest = way.iter().chain(&bent).fold(0.0f32, |most, v| most.max(v.abs()));
        let margin = longest.clamp(MARGIN[0] * radius, MARGIN[1] * radius);
        let low = [0, 1].map(|k| position[k] + way[k].min(bent[k]).min(0.0) - margin);
        let high = [0, 1].map(|k| position[k] + way[k].max(bent[k]).max(0.0) + margin);
        Self { low, high }
    }

    /// The same with `more` room to every side.
    pub fn widened(self, more: f32) -> Self {
        Self { low: self.low.map(|v| v - more), high: self.high.map(|v| v + more) }
    }

    /// The sweep of what nothing can move.
    pub fn still(position: [f32; 2]) -> Self {
        Self { low: position, high: position }
    }

    /// Centre and half size, as a rounded box of the tree.
    pub fn as_box(&self) -> ([f32; 2], [f32; 2]) {
        let center = [0, 1].map(|k| self.low[k] * 0.5 + self.high[k] * 0.5);
        let half = [0, 1].map(|k| (self.high[k] - center[k]).max(center[k] - self.low[k]));
        (center, half)
    }

    /// The nearest position inside.
    #[inline]
    pub fn clamp(&self, position: [f32; 2]) -> [f32; 2] {
        [0, 1].map(|k| position[k].max(self.low[k]).min(self.high[k]))
    }
}

/// Starts a sub-step of `h` seconds (semi-implicit Euler): gravity and drag
/// change the velocity first, the new velocity makes the way.
#[inline]
pub fn kick(motion: Motion, gravity: [f32; 2], drag: f32, h: f32) -> Motion {
    // dv/dt = −drag · v, implicitly: stable however strong.
    let keep = 1.0 / (1.0 + drag * h);
    let velocity = [0, 1].map(|k| (motion.velocity[k] + gravity[k] * h) * keep);
    Motion { velocity, travel: velocity.map(|v| v * h), since: 0.0, turn: 0, ..motion }
}

/// As [`kick`] with the `acceleration` that forces give halfway along the sub-step (see
/// [`halfway`]): for them this is a leapfrog, so that orbits close.
#[inline]
pub fn kick_and_pull(
    motion: Motion,
    gravity: [f32; 2],
    acceleration: [f32; 2],
    drag: f32,
    h: f32,
) -> Motion {
    let both = [0, 1].map(|k| gravity[k] + acceleration[k]);
    let kicked = kick(motion, both, drag, h);
    let way = |k: usize| kicked.travel[k] - 0.5 * h * h * acceleration[k];
    Motion { travel: [way(0), way(1)], ..kicked }
}

/// Where a particle would be in the middle of a sub-step of `h` seconds.
#[inline]
pub fn halfway(position: [f32; 2], velocity: [f32; 2], h: f32) -> [f32; 2] {
    [0, 1].map(|k| position[k] + velocity[k] * (0.5 * h))
}

/// Ends the way where the sweep or a wall ends. Speeds are left alone: what was
/// cut off is lost time, not lost energy.
#[inline]
pub fn confine(motion: Motion, sweep: &Sweep, container: &Container, radius: f32) -> Motion {
    let goal = [0, 1].map(|k| motion.position[k] + motion.travel[k]);
    let allowed = container.clamp(sweep.clamp(goal), radius);
    if allowed == goal {
        return motion;
    }
    Motion { travel: [0, 1].map(|k| allowed[k] - motion.position[k]), ..motion }
}
