//! Rollback: restores the state before a step that is refused or interrupted.

use super::bodies::discs::Discs;
use super::bodies::ids::Ids;
use super::turns::count_turns;
use super::{Stats, World};
use crate::contacts::Contacts;
use crate::forces::Influences;
use crate::motion;
use crate::particles::Particles;
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_index::period::{Period, Turns};

/// The world before the current step. The first part of a step moves the old columns and contacts
/// here and writes new ones, so almost nothing is copied.
#[derive(Debug, Default)]
pub(crate) struct Before {
    /// Whether the old columns and contacts are here.
    pub(crate) is_reordered: bool,
    pub(crate) discs: Discs,
    pub(crate) contacts: Contacts,
    /// What [`wrap_positions`] changes, if some positions were outside of the first period.
    unwrapped: Option<Unwrapped>,
    influences: Influences,
    stats: Stats,
    /// Those before the first merger of the step.
    pub(crate) ids: Option<Ids>,
}

/// The columns that a wrap into the first period changes, as they were.
#[derive(Debug)]
struct Unwrapped {
    positions: Vec<[f32; 2]>,
    residuals: Vec<[f32; 2]>,
    turns: Vec<Turns>,
}

/// Begins an attempt at a step, which [`undo`] takes back. If there is no memory, nothing changes.
pub(crate) fn begin_attempt(world: &mut World) -> Result<()> {
    // Without `..`, so that the compiler asks for each new field. `reorder` writes new columns and contacts beside the
    // old ones, and a merger keeps the ids, so these need no copy. Only what a step changes in place is copied here.
    #[rustfmt::skip]
    let World {
        settings, influences, boundaries, external, bodies, contacts: _, stats, record, scratch,
        time: _, attachment: _, halo: _, islands: _,
    } = world;
    let before = &mut scratch.before;
    before.influences.copy_from(influences)?;
    external.begin_attempt()?;
    record.begin_attempt()?;
    boundaries.begin_attempt()?;
    before.is_reordered = false;
    before.stats = *stats;
    before.ids = None;
    before.unwrapped = wrap_positions(&mut bodies.awake, &settings.container.period())?;
    Ok(())
}

/// Wraps positions into the first period, and returns the columns as they were if any changes: callers may set
/// positions outside of it, and undo must restore their bits.
fn wrap_positions(discs: &mut Discs, period: &Period<f32>) -> Result<Option<Unwrapped>> {
    let Discs { particles: Particles { positions, residuals, .. }, persistent, .. } = discs;
    let turns = &mut persistent.turns;
    let outside = |position: &[f32; 2]| period.wrap(*position) != *position;
    if period.is_none() || !positions.iter().any(outside) {
        return Ok(None);
    }
    memory::resize_default(turns, positions.len())?;
    let before = Unwrapped {
        positions: memory::copy(positions)?,
        residuals: memory::copy(residuals)?,
        turns: memory::copy(turns)?,
    };
    let places = (|index: usize| positions[index], |index: usize| residuals[index]);
    count_turns(turns, places, period, Some(1));
    for (position, residual) in positions.iter_mut().zip(residuals) {
        (*position, *residual) = motion::wrapped(*position, *residual, period);
    }
    Ok(Some(before))
}

/// Restores the state before the attempt, and allocates nothing. It does not undo:
///
/// - what motors did to velocities and which islands woke: all attempts begin with that, and only a step that fails
///   takes it back;
/// - `time`, settings and text, which no attempt changes;
/// - what the attempt has exchanged with other processes, which [`Protocol::undo`] removes;
/// - the list of islands that the attempt would touch, which wake next, and all scratch.
///
/// [`Protocol::undo`]: super::distribution::Protocol::undo
pub(crate) fn undo(world: &mut World) {
    #[rustfmt::skip]
    let World {
        influences, boundaries, external, bodies, contacts, stats, record, scratch,
        settings: _, time: _, attachment: _, halo: _, islands: _,
    } = world;
    let before = &mut scratch.before;
    // An attempt that ended before it reordered has left the columns as they were.
    if before.is_reordered {
        let Discs { particles, rows, persistent } = &mut before.discs;
        std::mem::swap(&mut bodies.awake.particles, particles);
        std::mem::swap(&mut bodies.awake.rows, rows);
        std::mem::swap(&mut bodies.awake.persistent, persistent);
        contacts.exchange(&mut before.contacts);
        contacts.remember(bodies.awake.rows.len());
        bodies.forget_indices();
    }
    // After the exchange of columns, because these positions are in the old order.
    if let Some(Unwrapped { positions, residuals, turns }) = before.unwrapped.take() {
        let awake = &mut bodies.awake;
        (awake.particles.positions, awake.particles.residuals) = (positions, residuals);
        awake.persistent.turns = turns;
    }
    std::mem::swap(influences, &mut before.influences);
    external.undo();
    boundaries.undo();
    *stats = before.stats;
    record.undo();
    if let Some(ids) = before.ids.take() {
        bodies.ids = ids;
    }
}
