//! How long a window is: short enough for few events, and on a torus for short trajectories.

use super::Events;
use super::flight::{Flight, Start, TimeWindow};
use crate::container::MAX_TOURS;
use jostle_base::error::{Error, Result};

/// Discs for each first impact in a window, at least.
const DISCS_PER_IMPACT: usize = 3;

/// Fewer discs count as so many.
const FEW: usize = 64;

/// The number of first impacts that a window of so many discs may have.
pub(super) fn most_impacts(discs: usize) -> usize {
    // The number trades two costs. A long window has long chains of events across blocks, which are
    // simulated again. A short one has a fixed cost for all discs. Shorter windows help a gas that
    // loses energy, and make an elastic one 25 % slower (`docs/benchmarks-notes.md`).
    // Few discs count as 64: with a handful of discs, windows of one impact each would only add
    // passes over the discs.
    discs.max(FEW) / DISCS_PER_IMPACT
}

impl Events {
    /// The end of the window, halved until few first impacts happen in it, but not shorter than
    /// `shortest`. Impacts at the start are in every window, so they do not count.
    pub(super) fn end_of_window(&self, window: &TimeWindow<'_>, shortest: f64) -> Result<f64> {
        // Without impacts of pairs, blocks cannot have conflicts.
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

impl TimeWindow<'_> {
    /// The end of the window, which is halved while it is too long, but not shorter than
    /// `shortest`.
    fn shortened(&self, end: f64, shortest: f64, is_too_long: impl Fn(f64) -> bool) -> f64 {
        let (mut length, mut end) = (end - self.begin, end);
        // The possible ends are few, and each length is exact: a product with a power of two is not
        // rounded. `end_of_window_of_all` finds the same ends in another way.
        while 0.5 * length >= shortest && is_too_long(end) {
            length *= 0.5;
            end = self.begin + length;
        }
        end
    }
}

/// The end of the window, halved until no disc travels further than around a torus in it, but not
/// shorter than `shortest`. Refuses a sub-step in which forces make one too fast.
pub(super) fn end_for_the_fast(window: &TimeWindow<'_>, shortest: f64) -> Result<f64> {
    let period = window.flight.walls.container.period();
    if period.is_none() {
        return Ok(window.end);
    }
    // The sum of the components is an upper bound of the speed, without a square root. The bound is
    // only for a limit, so it may be too large by the factor 1.42.
    let speed = |start: &Start| start.velocity.map(f32::abs).into_iter().sum::<f32>();
    let halo = window.flight.halo;
    // Each process looks at its own discs, and the largest of all decides. Ghosts are in the list
    // of their owner.
    let own = (0..).zip(window.now).filter(|(index, _)| halo.owns(*index));
    let fastest = own.map(|(_, start)| speed(start)).fold(0.0, f32::max);
    let fastest = halo.largest([f64::from(fastest)])?[0] as f32;
    let tours = |seconds: f64| fastest * seconds as f32 / period.shortest();
    let left = window.end - window.begin;
    // A step whose first velocities lead to more than `MAX_TOURS` was refused before it began. Only
    // forces within the step lead here, and they may make the tours up to twice as many.
    if tours(left) > 2.0 * MAX_TOURS {
        let rule = "forces would make a particle travel too many periods; take smaller steps";
        return Err(Error::of("dt", format!("{left} s in a sub-step"), rule));
    }
    // A disc that circles a torus several times in a window would meet several images of each other
    // disc. The lists of candidate pairs would grow without limit.
    Ok(window.shortened(window.end, shortest, |end| tours(end - window.begin) > 1.0))
}

/// The shortest time for which processes have made bounds.
pub(super) fn shortest_of_all(flight: &Flight<'_>, seconds: f64) -> Result<f64> {
    // The trait has only a maximum, and min(x) = −max(−x).
    Ok(-flight.halo.largest([-seconds])?[0])
}
