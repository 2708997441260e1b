//! How long a window is: short enough for few events, and on a torus for short trajectories.

use super::Events;
use super::flight::{Flight, Start, Window};
use crate::container::MAX_TOURS;
use jostle_base::error::{Error, Result};

/// Discs for each first impact in a window, at least.
const DISCS_PER_IMPACT: usize = 3;

/// Fewer discs count as so many.
const FEW: usize = 64;

/// The number of first impacts that a window of so many discs may have.
pub(super) fn most_impacts(discs: usize) -> usize {
    discs.max(FEW) / DISCS_PER_IMPACT
}

impl Events {
    /// The end of the window, halved until few first impacts happen in it, but not shorter than
    /// `shortest`. Impacts at the start are in every window, so they do not count.
    pub(super) fn end_of_window(&self, window: &Window<'_>, shortest: f64) -> Result<f64> {
        if !window.flight.pairs {
            return Ok(window.end);
        }
        if !window.flight.halo.is_alone() {
            return self.end_of_window_of_all(window, shortest);
        }
        let most = most_impacts(window.starts.len());
        Ok(window.shortened(window.end, shortest, |end| {
            let until = [window.begin, end];
            self.blocks.iter().map(|block| block.impacts_until(until)).sum::<usize>() > most
        }))
    }
}

impl Window<'_> {
    /// The end of the window, which is halved while it is too long, but not shorter than
    /// `shortest`.
    fn shortened(&self, end: f64, shortest: f64, is_too_long: impl Fn(f64) -> bool) -> f64 {
        let (mut length, mut end) = (end - self.begin, end);
        while 0.5 * length >= shortest && is_too_long(end) {
            length *= 0.5;
            end = self.begin + length;
        }
        end
    }
}

/// The end of the window, halved until no disc travels further than around a torus in it, but not
/// shorter than `shortest`. Refuses a sub-step in which forces make one too fast.
pub(super) fn end_for_the_fast(window: &Window<'_>, shortest: f64) -> Result<f64> {
    let period = window.flight.walls.container.period();
    if period.is_none() {
        return Ok(window.end);
    }
    let speed = |start: &Start| start.velocity.map(f32::abs).into_iter().sum::<f32>();
    let halo = window.flight.halo;
    let own = (0..).zip(window.now).filter(|(index, _)| halo.owns(*index));
    let fastest = own.map(|(_, start)| speed(start)).fold(0.0, f32::max);
    let fastest = halo.largest([f64::from(fastest)])?[0] as f32;
    let tours = |seconds: f64| fastest * seconds as f32 / period.shortest();
    let left = window.end - window.begin;
    if tours(left) > 2.0 * MAX_TOURS {
        let rule = "forces would make a particle circle the torus too often; take smaller steps";
        return Err(Error::of("dt", format!("{left} s in a sub-step"), rule));
    }
    Ok(window.shortened(window.end, shortest, |end| tours(end - window.begin) > 1.0))
}

/// The shortest time for which processes have made bounds.
pub(super) fn shortest_of_all(flight: &Flight<'_>, seconds: f64) -> Result<f64> {
    Ok(-flight.halo.largest([-seconds])?[0])
}
