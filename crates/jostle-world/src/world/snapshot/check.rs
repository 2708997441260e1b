//! Checks of a world that was read: bytes with the right checksum may still be forged. A step relies on what is
//! checked here.

use std::mem;

use super::super::bodies::Bodies;
use super::super::bodies::asleep::{Island, Sleepers};
use super::super::bodies::discs::{Discs, RecentMotion};
use super::super::boundaries::Boundaries;
use super::super::external::check_external;
use super::super::islands::sleep::may_sleep;
use super::super::{Walls, World, WorldSettings};
use crate::contacts::Contact;
use crate::resting::WallImpulse;
use crate::walls::index_of;
use jostle_base::bytes::damaged;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::memory;
use jostle_base::table::check_lengths;
use jostle_index::shapes::MAX_ROWS;

/// The error for a value that another check has refused.
fn refused(error: Error) -> Error {
    if let Error::NoMemory { .. } = error { error } else { damaged(&error.to_string()) }
}

/// Refuses what is wrong, for this reason.
fn ensure(is_right: bool, rule: &str) -> Result<()> {
    if is_right { Ok(()) } else { Err(damaged(rule)) }
}

/// Refuses islands that do not have all particles, contacts and impulses of walls, one after the other.
fn check_islands(islands: &[Island], counts: [usize; 3]) -> Result<()> {
    let mut ends = [0; 3];
    for Island { particles, contacts, wall_impulses, .. } in islands {
        let ranges = [particles, contacts, wall_impulses];
        let follow =
            ranges.iter().zip(ends).all(|(range, end)| range.start == end && range.end >= end);
        ensure(follow && !particles.is_empty(), "an island is empty, or in no order")?;
        ends = ranges.map(|range| range.end);
    }
    ensure(ends.map(|end| end as usize) == counts, "the sizes of its islands are wrong")
}

/// Refuses rows that are not a permutation of those of all particles.
fn check_rows<'a>(rows: impl Iterator<Item = &'a u32>, len: usize) -> Result<()> {
    let mut is_known = memory::filled(len, false)?;
    let is_new =
        |row: &u32| is_known.get_mut(*row as usize).is_some_and(|known| !mem::replace(known, true));
    ensure({ rows }.all(is_new), "its rows are not those of its particles")
}

/// Refuses contacts that are not between two of `len` particles, and impulses that no contact can have.
fn check_contacts(all: &[Contact], len: usize) -> Result<()> {
    for &Contact { indices: [a, b], image, normal, gap, .. } in all {
        ensure(a.max(b) < len as u32 && a != b, "a contact is between no particles")?;
        let numbers = [image[0], image[1], normal[0], normal[1], gap];
        ensure(!numbers.iter().any(|number| number.is_nan()), "a number of a contact is NaN")?;
    }
    let is_right = |contact: &Contact| {
        let [normal, friction] = contact.totals;
        let numbers = [contact.friction_impulse, normal, friction];
        contact.impulse >= 0.0 && !numbers.iter().any(|number| number.is_nan())
    };
    ensure(all.iter().all(is_right), "an impulse of a contact is negative or NaN")
}

/// Refuses impulses of walls on none of `len` particles, and impulses that no wall can give.
fn check_impulses(all: &[WallImpulse], len: usize) -> Result<()> {
    for &WallImpulse { row, impulses, pushes, .. } in all {
        ensure((row as usize) < len, "a wall has an impulse on no particle")?;
        let is_push = pushes[0] >= 0.0 && pushes.iter().all(|push| push.is_finite());
        let is_right = is_push && !impulses.iter().any(|impulse| impulse.is_nan());
        ensure(is_right, "an impulse of a wall is not a number, or negative")?;
    }
    Ok(())
}

/// Refuses values that no world can have, and computes what follows from the others.
pub(super) fn finish(world: &mut World) -> Result<()> {
    // A checksum does not show that bytes are not forged. So nothing here may rely on what is
    // not yet checked: lengths come before rows, rows before contacts, and these before
    // islands.
    // Without `..`, so that the compiler asks for a check of each new field. Any text is allowed, and the last four are
    // not read.
    #[rustfmt::skip]
    let World {
        settings, time, bodies, contacts, boundaries, influences, external, record,
        attachment: _, stats: _, halo: _, islands: _, scratch: _,
    } = world;
    let WorldSettings { container, tree, .. } = *settings;
    settings.validate().map_err(refused)?;
    ensure(time.is_finite(), "its time is not finite")?;
    check_discs(&bodies.awake, settings)?;
    bodies.awake.particles.simplify();
    let Sleepers { discs, contacts: asleep, wall_impulses, islands } = bodies.asleep.sleepers();
    check_discs(discs, settings)?;
    check_islands(islands, [discs.rows.len(), asleep.len(), wall_impulses.len()])?;
    let awake = bodies.awake.rows.len();
    let len = awake.saturating_add(discs.rows.len());
    ensure(len <= MAX_ROWS, "it has too many particles")?;
    // Rows index lists everywhere, so they must be a permutation.
    check_rows(bodies.awake.rows.iter().chain(&discs.rows), len)?;
    check_contacts(contacts.all(), awake)?;
    check_contacts(asleep, len)?;
    check_impulses(&boundaries.impulses, len)?;
    check_impulses(wall_impulses, len)?;
    contacts.reserve_impulses(awake, 0)?;
    contacts.remember(awake);
    bodies.asleep = bodies.asleep.rebuilt(tree).map_err(refused)?;
    check_sleeping(bodies)?;
    influences
        .validate(|row| (0..len as Id).contains(&row))
        .and_then(|()| influences.check_kinds(&bodies.kinds()?))
        .and_then(|()| influences.check_fit(container))
        .and_then(|()| influences.check_sides(container))
        .map_err(refused)?;
    let walls = memory::copy(mem::take(&mut boundaries.walls).all())?;
    boundaries.walls = Walls::new(walls, container, tree).map_err(refused)?;
    boundaries.walls.set_sides(settings.present_sides());
    boundaries.ids.check(boundaries.walls.all().len()).map_err(refused)?;
    influences.check_walls(|id| boundaries.ids.row(id).is_some()).map_err(refused)?;
    check_wall_impulses(boundaries, bodies)?;
    bodies.ids.check(len).map_err(refused)?;
    if let Some(external) = &external.accelerations {
        ensure(external.len() == len, "it has accelerations of no particles")?;
        check_external(external).map_err(refused)?;
    }
    let next = [bodies.ids.parts().1, boundaries.ids.parts().1];
    record.check(next, settings.track_events, boundaries.walls.all().len())?;
    let may_sleep = may_sleep(settings, influences, &boundaries.walls);
    ensure(bodies.asleep.is_empty() || may_sleep, "nothing can sleep in it")
}

fn check_discs(discs: &Discs, settings: &WorldSettings) -> Result<()> {
    let Discs { particles, persistent, rows } = discs;
    particles.validate().map_err(refused)?;
    settings.container.check_fit(&particles.radii).map_err(refused)?;
    let len = rows.len();
    let lengths = check_lengths(persistent, len, |column| column);
    ensure(particles.len() == len && lengths.is_ok(), "its columns have different lengths")?;
    let is_nan =
        |motion: &RecentMotion| motion.before.iter().chain(&motion.now).any(|v| v.is_nan());
    ensure(!persistent.recent_motions.iter().any(is_nan), "a mean speed is not possible")
}

/// Refuses impulses of walls that do not exist.
pub(crate) fn check_wall_impulses(boundaries: &Boundaries, bodies: &Bodies) -> Result<()> {
    let count = boundaries.walls.all().len();
    let mut all = boundaries.impulses.iter().chain(&bodies.asleep.sleepers().wall_impulses);
    let is_known =
        |impulse: &WallImpulse| index_of(impulse.wall).is_none_or(|index| (index as usize) < count);
    ensure(all.all(is_known), "a particle has an impulse of no wall")
}

/// Refuses sleeping particles that move, and islands with contacts of others.
pub(crate) fn check_sleeping(bodies: &Bodies) -> Result<()> {
    let Sleepers { discs, contacts, wall_impulses, islands } = bodies.asleep.sleepers();
    let particles = &discs.particles;
    let indices = bodies.indices()?;
    let at_rest = particles.velocities.iter().all(|&velocity| velocity == [0.0; 2])
        && particles.spins.iter().all(|spin| spin.velocity == 0.0)
        && particles.movable.iter().all(|&movable| movable);
    let are_own = |island: &Island| {
        let first = bodies.awake.rows.len() as u32;
        let own = first + island.particles.start..first + island.particles.end;
        let is_own = |&row: &u32| own.contains(&indices[row as usize]);
        let is_fixed = |&row: &u32| bodies.is_immovable(indices[row as usize]);
        let range = |range: &std::ops::Range<u32>| range.start as usize..range.end as usize;
        contacts[range(&island.contacts)].iter().all(|contact| {
            contact.indices.iter().any(is_own)
                && contact.indices.iter().all(|row| is_own(row) || is_fixed(row))
        }) && wall_impulses[range(&island.wall_impulses)].iter().all(|impulse| is_own(&impulse.row))
    };
    let rule = "a sleeping particle moves, or touches one that is not in its island";
    ensure(at_rest && islands.iter().all(are_own), rule)
}
