//! How particles have moved in the last quarters of a second, from which follows whether an island is at rest.
//!
//! The unit of speed is √(g r), with the radius r. A particle is slow in a quarter of a second if
//! its mean velocity is at most [`SLOW`] and its speed never more than [`FAST`], and the same holds
//! for the velocity of its surface. So small vibrations count less than motion in one direction.

use super::Islands;
use super::groups::{Rest, is_member};
use crate::particles::Particles;
use crate::world::bodies::discs::{Discs, RecentMotion};
use crate::world::settings::WorldSettings;
use jostle_base::error::Result;
use jostle_base::plain;
use jostle_base::{memory, parallel, reserve};

/// Limit of the mean speed of a quarter of a second, in units of √(g r).
/// It trades how soon islands fall asleep against what stops: a disc of radius 1 m on the earth
/// that slides without friction at 0.03 m/s (docs/physics.md).
const SLOW: f64 = 0.01;

/// Limit of the speed at the end of a step, in the same units.
const FAST: f64 = 0.1;

/// Limit of the change of an island's mean velocity from one quarter to the next, as a share of
/// [`SLOW`].
const STEADY: f64 = 0.1;

/// Unit of sums of changes: 2⁻³⁰. Sums of whole numbers are exact, so they do not depend on the order
/// of the members and on the processes that have them. A slow particle changes by 2 at most.
pub(super) const UNIT: f64 = 1.0 / (1u64 << 30) as f64;

/// Squares of mean speeds over their limit below this are due to rounding, and may grow.
const ROUNDING: f32 = 1e-10;

/// Seconds of which the mean speeds are compared.
const QUARTER: f64 = 0.25;

/// Seconds by which the first quarter is shorter, so that at usual lengths of a step the rounding
/// of the time does not decide in which step a quarter ends.
const SHORTER: f64 = 0.001_234_5;

/// What decides whether an island falls asleep. The order in which its members are added changes
/// nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct IslandMotion {
    /// The largest squares of the mean speeds of its members over their limits: in the previous
    /// quarter and in this one.
    pub(crate) squares: [f32; 2],
    /// Whether a member rests on a wall or on a static particle, or has a spring to a static one.
    pub(crate) is_supported: bool,
    /// Whether each member rests on something or has a spring.
    pub(crate) all_rest: bool,
    /// Sum over its members of the change of the mean velocity over its limit, in units of
    /// [`UNIT`].
    pub(crate) change: [i64; 3],
    /// The number of its members.
    pub(crate) count: u32,
}

impl IslandMotion {
    /// Adds other members.
    pub(crate) fn join(&mut self, other: &Self) {
        self.squares = [0, 1].map(|k| self.squares[k].max(other.squares[k]));
        self.is_supported |= other.is_supported;
        self.all_rest &= other.all_rest;
        self.change = [0, 1, 2].map(|k| self.change[k].wrapping_add(other.change[k]));
        self.count += other.count;
    }

    /// Whether the island may fall asleep.
    pub(crate) fn is_at_rest(&self) -> bool {
        let [before, now] = self.squares;
        let is_slow = before <= 1.0 && now <= 1.0 && now <= before.max(ROUNDING);
        let most = STEADY * f64::from(self.count) / UNIT;
        let is_steady = self.change.iter().all(|&change| (change as f64).abs() <= most);
        self.is_supported && self.all_rest && is_slow && is_steady
    }
}

plain! { IslandMotion { squares, is_supported, all_rest, change, count } }

impl Default for IslandMotion {
    fn default() -> Self {
        Self { squares: [0.0; 2], is_supported: false, all_rest: true, change: [0; 3], count: 0 }
    }
}

/// The number of the quarter of a second in which a time lies. Quarters are counted from time 0, and not from the
/// moment when an island came to rest. So all processes, and a world that was restored, end them in the same step.
pub(super) fn quarter(time: f64) -> f64 {
    ((time + SHORTER) / QUARTER).floor()
}

/// Magnitude of the acceleration of gravity.
fn magnitude(gravity: [f32; 2]) -> f64 {
    let [x, y] = gravity.map(f64::from);
    (x * x + y * y).sqrt()
}

/// Adds the displacements of a step of `dt` seconds to the recent motions of all particles. Those of `exhausted` rows,
/// and of rows with an external acceleration, become unknown.
pub(super) fn note_motions(
    discs: &mut Discs,
    settings: &WorldSettings,
    exhausted: &[u32],
    external: Option<&[[f32; 3]]>,
    dt: f64,
    threads: Option<usize>,
) -> Result<()> {
    let gravity = magnitude(settings.gravity);
    let Discs { particles, persistent, rows } = discs;
    let recent = &mut persistent.recent_motions;
    let Particles { velocities, radii, spins, restitution, .. } = &*particles;
    memory::resize(recent, rows.len(), RecentMotion::UNKNOWN)?;
    parallel::for_chunks(threads, recent, |first, recent| {
        for (recent, index) in recent.iter_mut().zip(first..) {
            // A disc that turns in place is not at rest: friction would carry what lies on it.
            let surface = spins.get(index).map_or(0.0, |spin| spin.velocity * radii[index]);
            let [u, v] = velocities[index];
            let [x, y, turn] = [u, v, surface].map(f64::from);
            let square = (x * x + y * y).max(turn * turn);
            // A particle that keeps its energy may be slow at its highest point, and does not
            // come to rest.
            let is_elastic = restitution[index] == 1.0;
            // √(g r) is the unit of speed, so the rule is the same for discs of any size and
            // any gravity.
            if is_elastic || square > FAST * FAST * gravity * f64::from(radii[index]) {
                // An infinite displacement stays infinite in the sum, so the whole quarter
                // counts as fast.
                recent.now = [f32::INFINITY; 3];
            } else {
                // Displacements are added as vectors. Vibrations cancel, and motion in one
                // direction does not.
                let moved = [x, y, turn].map(|speed| (speed * dt) as f32);
                recent.now = [0, 1, 2].map(|k| recent.now[k] + moved[k]);
            }
        }
    });
    // An exhausted particle stands still because its events were cut off, not because it rests.
    if !exhausted.is_empty() {
        for (recent, row) in recent.iter_mut().zip(&*rows) {
            if exhausted.binary_search(row).is_ok() {
                *recent = RecentMotion::UNKNOWN;
            }
        }
    }
    // The force of a caller may hold a particle for the moment only.
    if let Some(external) = external {
        for (recent, &row) in recent.iter_mut().zip(&*rows) {
            if external[row as usize] != [0.0; 3] {
                *recent = RecentMotion::UNKNOWN;
            }
        }
    }
    Ok(())
}

impl Islands {
    /// Computes the mean speeds of the quarter that ends, and begins the next one.
    pub(super) fn end_quarter(&mut self, discs: &mut Discs, gravity: [f32; 2]) -> Result<()> {
        let gravity = magnitude(gravity);
        let Self { squares, changes, .. } = self;
        squares.clear();
        changes.clear();
        reserve!(discs.rows.len(); *squares, *changes);
        let recent = discs.persistent.recent_motions.iter_mut();
        for (RecentMotion { before, now }, &radius) in recent.zip(&discs.particles.radii) {
            let limit = QUARTER * SLOW * (gravity * f64::from(radius)).sqrt();
            // A point is slow only if it does not move.
            let relative = |v: f32| if v == 0.0 { 0.0 } else { f64::from(v) / limit };
            let both = [&*before, &*now].map(|displacement| displacement.map(relative));
            squares.push(both.map(|[x, y, turn]| (x * x + y * y).max(turn * turn) as f32));
            // A slow particle changes by 2 at most. Others keep their island awake in any case, so
            // the limit cuts nothing that counts. With it the sum over 2³¹ particles is at most
            // 2⁶², and fits into its type.
            let change = |k: usize| (both[1][k] - both[0][k]).clamp(-2.0, 2.0) / UNIT;
            changes.push([0, 1, 2].map(|k| change(k).round() as i64));
            (*before, *now) = (*now, [0.0; 3]);
        }
        Ok(())
    }

    /// Whether any particle that may fall asleep, of the rows below `own`, is slow.
    pub(super) fn any_is_slow(&self, discs: &Discs, own: u32) -> bool {
        let is_slow = |[before, now]: [f32; 2]| before <= 1.0 && now <= 1.0;
        self.squares.iter().enumerate().any(|(index, &squares)| {
            is_slow(squares) && discs.particles.movable[index] && discs.rows[index] < own
        })
    }

    /// Sums up how the members of each island have moved. Ghosts, which are in the rows from `own` on, count on their
    /// own processes; but kinematic ones keep the island awake on each process.
    pub(super) fn sum_motions(&mut self, discs: &Discs, own: u32) -> Result<()> {
        let Discs { particles, rows, .. } = discs;
        let Self { groups, squares, changes, rests, motions, first, .. } = self;
        motions.clear();
        memory::resize(motions, squares.len(), IslandMotion::default())?;
        first.clear();
        memory::extend(first, (0..squares.len() as u32).map(|index| groups.root(index)))?;
        for (index, &first) in first.iter().enumerate() {
            if !is_member(particles, index as u32) {
                continue;
            }
            let island = &mut motions[first as usize];
            if rows[index] < own {
                island.join(&IslandMotion {
                    squares: squares[index],
                    is_supported: rests[index] == Rest::Supported,
                    all_rest: rests[index] != Rest::Free,
                    change: changes[index],
                    count: 1,
                });
            } else {
                island.all_rest &= particles.movable[index];
            }
        }
        Ok(())
    }
}
