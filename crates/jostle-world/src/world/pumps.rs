//! Pumps move particles from their drains to their nozzles, before the first attempt at a step.

use super::bodies::Bodies;
use super::bodies::discs::Discs;
use crate::forces::Influences;
use crate::motion::{self, Motion, exact};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_index::period::Turns;

/// What pumps have moved before a step: index, and motion and turns before.
#[derive(Default)]
pub(crate) struct Pumped(Vec<(usize, Motion, Turns)>);

/// Moves what pumps take in a step of `dt` seconds that begins at `time`, and notes in `before` what it was. There are no
/// ghosts. Returns whether anything was moved.
pub(crate) fn pump(
    influences: &Influences,
    bodies: &mut Bodies,
    (time, dt): (f64, f64),
    before: &mut Pumped,
) -> Result<bool> {
    if influences.pumps().next().is_none() {
        return Ok(false);
    }
    let Discs { particles, persistent, .. } = &mut bodies.awake;
    for index in 0..particles.len() {
        let old = Motion::of(particles, index);
        let Motion { position: [x, y], residual: [a, b], velocity: [u, v] } = old;
        if !particles.movable[index] {
            continue;
        }
        let place = exact([x, y], [a, b]);
        let [p, q, r, s, t, w] = [x, y, a, b, u, v].map(f64::from);
        let state = [p, q, r, s, t, w, time];
        let Some([start, velocity]) = influences.pumps().find_map(|of| of.start(place, dt, &state))
        else {
            continue;
        };
        // The particle begins a new path, as one whose position a caller sets.
        let turns = persistent.turns.get_mut(index).map(std::mem::take).unwrap_or_default();
        memory::push(&mut before.0, (index, old, turns))?;
        let rounded = start.map(|v| v as f32);
        particles.positions[index] = rounded;
        particles.residuals[index] = motion::residual(start, rounded);
        particles.velocities[index] = velocity.map(|v| v as f32);
    }
    if before.0.is_empty() {
        return Ok(false);
    }
    bodies.forget_tree();
    Ok(true)
}

impl Pumped {
    /// Takes back what [`pump`] did before a step that failed.
    pub(crate) fn restore(self, bodies: &mut Bodies) {
        let Discs { particles, persistent, .. } = &mut bodies.awake;
        for (index, Motion { position, residual, velocity }, turns) in self.0 {
            particles.positions[index] = position;
            particles.residuals[index] = residual;
            particles.velocities[index] = velocity;
            if let Some(now) = persistent.turns.get_mut(index) {
                *now = turns;
            }
        }
        bodies.forget_tree();
    }
}
