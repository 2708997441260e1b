//! How long a window is: short enough for few events, and on a torus for short trajectories.

use super::Events;
use super::flight::{Start, Window};
use crate::container::MAX_TOURS;
use crate::error::{Error, Result};
use crate::parallel::locked;

/// Discs for each first impact in a window, at least.
const DISCS_PER_IMPACT: usize = 3;

/// Fewer discs count as so many.
const FEW: usize = 64;

/// The number of first impacts that a window of so many discs may have.
pub(super) fn most_impacts(discs: usize) -> usize {
    discs.max(FEW) / DISCS_PER_IMPACT
}

impl Events {
    /// The longest of `end`, `end`/2, `end`/4 … before which few first impacts happen, but not less than
    /// `shortest`. Impacts at the start are in every window, so they do not count. The result depends on
    /// the state alone.
    pub(super) fn end_of_window(&self, window: &Window<'_>, shortest: f64) -> Result<f64> {
        if !window.flight.pairs {
            return Ok(window.end);
        }
        if let Some(halo) = window.flight.halo {
            return self.end_of_window_of_all(window, shortest, &halo);
        }
        let most = most_impacts(window.starts.len());
        let mut end = window.end;
        while 0.5 * end >= shortest {
            let early = self.blocks.iter().map(|block| block.impacts_until(end)).sum::<usize>();
            if early <= most {
                break;
            }
            end *= 0.5;
        }
        Ok(end)
    }
}

/// The longest of `end`, `end`/2, `end`/4 … before which no disc travels further than around a torus,
/// but not less than `shortest`. Refuses a sub-step in which forces make one too fast.
pub(super) fn end_for_the_fast(window: &Window<'_>, shortest: f64) -> Result<f64> {
    let container = &window.flight.container;
    if container.period().is_none() {
        return Ok(window.end);
    }
    let speed = |start: &Start| start.velocity.map(f32::abs).into_iter().sum::<f32>();
    let fastest = match window.flight.halo {
        None => window.starts.iter().map(speed).fold(0.0, f32::max),
        Some(halo) => {
            let own = window.starts.iter().zip(halo.is_own).filter(|(_, is_own)| **is_own);
            let fastest = own.map(|(start, _)| speed(start)).fold(0.0, f32::max);
            locked(halo.group).largest([f64::from(fastest)])?[0] as f32
        }
    };
    let tours = |seconds: f64| container.tours(fastest * seconds as f32);
    if tours(window.end) > 2.0 * MAX_TOURS {
        let rule = "forces would make a particle circle the torus too often; take smaller steps";
        return Err(Error::of("dt", format!("{} s in a sub-step", window.end), rule));
    }
    let mut end = window.end;
    while 0.5 * end >= shortest && tours(end) > 1.0 {
        end *= 0.5;
    }
    Ok(end)
}
