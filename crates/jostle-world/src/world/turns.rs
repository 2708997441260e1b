//! How many periods each particle has travelled since its position was set, so that callers can follow paths across
//! the sides of the period. Nothing in a step reads them.

use super::World;
use super::bodies::Bodies;
use super::bodies::discs::Discs;
use crate::motion::{exact, wrapped};
use crate::trajectory::Vector;
use jostle_base::error::Result;
use jostle_base::parallel;
use jostle_index::period::{Period, Turns};

impl World {
    /// Where each particle would be without a period, in the order of adding: its position with all digits, and the
    /// periods that it has travelled since its position was set.
    pub fn unwrapped_positions(&self) -> Result<Vec<[f64; 2]>> {
        self.bodies.unwrapped_positions(&self.settings.container.period())
    }
}

impl Bodies {
    fn unwrapped_positions(&self, period: &Period<f32>) -> Result<Vec<[f64; 2]>> {
        let period = period.exact();
        self.disc_column(|Discs { particles, persistent, .. }, at| {
            let inside = exact(particles.positions[at], particles.residuals[at]);
            let span = period.span(persistent.turns.get(at).copied().unwrap_or_default());
            [0, 1].map(|k| inside[k] + span[k])
        })
    }
}

/// Counts the periods by which positions are outside of the first one, before they are wrapped into it. Positions and
/// residuals are given by index.
pub(crate) fn count_turns(
    turns: &mut [Turns],
    (position, residual): (impl Fn(usize) -> [f32; 2] + Sync, impl Fn(usize) -> [f32; 2] + Sync),
    period: &Period<f32>,
    threads: Option<usize>,
) {
    let [width, height] =
        [0, 1].map(|k| if period.is_along(k) { period.sides()[k] } else { f32::INFINITY });
    let [left, low] = [0, 1].map(|k| if period.is_along(k) { 0.0 } else { f32::NEG_INFINITY });
    parallel::for_chunks(threads, turns, |first, turns| {
        for (turns, index) in turns.iter_mut().zip(first..) {
            let [x, y] = position(index);
            // True for nearly all, so this test is the cost. A residual is at most half a spacing of float32, so it
            // does not carry a position beyond the side.
            if (x >= left) & (x < width) & (y >= low) & (y < height) {
                continue;
            }
            let rest = residual(index);
            let (inside, rest_inside) = wrapped([x, y], rest, period);
            let more = turns_between(exact([x, y], rest), exact(inside, rest_inside), period);
            *turns = [0, 1].map(|k| turns[k].saturating_add(more[k]));
        }
    });
}

/// The number of periods from one image of a position to another, `from` minus `to`.
pub(crate) fn turns_between(from: Vector, to: Vector, period: &Period<f32>) -> Turns {
    let sides = period.exact().sides();
    [0, 1].map(|k| match period.is_along(k) {
        true => ((from[k] - to[k]) / sides[k]).round() as i32,
        false => 0,
    })
}
