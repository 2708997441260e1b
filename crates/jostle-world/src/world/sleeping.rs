//! Falling asleep: islands that rest are taken out of the columns that a step works on.
//!
//! The unit of speed is √(g r), with the radius r. A particle is slow in a quarter of a second if
//! its mean velocity is at most [`SLOW`] and its speed never more than [`FAST`], and the same holds
//! for the velocity of its surface. So small vibrations count less than motion in one direction. At
//! the end of each quarter, an island falls asleep if each of its members rests on a particle or a
//! wall, at least one of them on a wall or a static particle, if each has been slow in this
//! quarter and in the previous one, if the largest mean speed, in this unit, has not grown from one
//! to the other, and if the mean velocity of the island has hardly changed. Discs that begin to
//! topple move slowly for longer, but faster and faster; a disc that reverses its direction on a slope is slow
//! for a while, but its velocity changes steadily.

use super::asleep::{Island, Sleepers, run};
use super::force_step::awake_springs;
use super::plan::Plan;
use super::{OnTouch, World};
use crate::forces::{Influence, Role};
use crate::particles::Particles;
use crate::world::bodies::Bodies;
use crate::world::bodies::discs::Discs;
use jostle_base::disjoint_sets::DisjointSets;
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::parallel;
use jostle_base::plain;
use jostle_base::table::{Table, dense};

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
const UNIT: f64 = 1.0 / (1u64 << 30) as f64;

/// Squares of mean speeds over their limit below this are due to rounding, and may grow.
const ROUNDING: f32 = 1e-10;

/// Seconds of which the mean speeds are compared.
const QUARTER: f64 = 0.25;

/// Seconds by which the first quarter is shorter, so that at usual lengths of a step the rounding
/// of the time does not decide in which step a quarter ends.
const SHORTER: f64 = 0.001_234_5;

/// How a particle moved in the previous quarter of a second and in this one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Drift {
    /// Displacement of the particle and of its surface in the previous quarter; infinite if it was
    /// too fast.
    pub(crate) before: [f32; 3],
    /// The same in this quarter so far.
    pub(crate) now: [f32; 3],
}

impl Drift {
    /// Of a particle that has not been observed for a whole quarter.
    pub(crate) const UNKNOWN: Self = Self { before: [f32::INFINITY; 3], now: [f32::INFINITY; 3] };
}

impl Default for Drift {
    fn default() -> Self {
        Self::UNKNOWN
    }
}

plain! { Drift { before, now } }

/// Stands for no island.
pub(crate) const NONE: u32 = u32::MAX;

/// What a particle rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Rest {
    /// Nothing.
    Free,
    /// Other movable particles.
    OnOther,
    /// A wall or a static particle.
    Supported,
}

/// What decides whether an island falls asleep. The order in which its members are added changes
/// nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct IslandMotion {
    /// The largest squares of the mean speeds of its members over their limits: in the previous
    /// quarter and in this one.
    pub(crate) squares: [f32; 2],
    /// Whether a member rests on a wall or on a static particle.
    pub(crate) is_supported: bool,
    /// Whether each member rests on something.
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

/// Scratch.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    groups: DisjointSets,
    /// The squares of the mean speeds of each particle over their limits: in the previous quarter
    /// and in this one.
    squares: Vec<[f32; 2]>,
    /// The change of the mean velocity of each particle over its limit, in units of [`UNIT`].
    changes: Vec<[i64; 3]>,
    /// The first member of the island of each particle.
    pub(crate) first: Vec<u32>,
    /// The motion of each island at the index of its first member.
    pub(crate) of_islands: Vec<IslandMotion>,
    /// In a distributed world, the name of each island at that index.
    pub(crate) names: Vec<Id>,
    /// What each particle rests on.
    rests: Vec<Rest>,
    /// The number of the sleeping island of the particle at each index.
    pub(crate) island_of: Vec<u32>,
    /// For each particle that falls asleep, the first member of its island and its own index.
    pub(crate) members: Vec<[u32; 2]>,
}

impl World {
    /// Whether anything may fall asleep with the present settings and forces.
    pub(crate) fn may_sleep(&self) -> bool {
        let settings = &self.settings;
        // A force that acts at a distance would have to wake what it moves. Springs connect
        // particles of one island, or an island and an immovable particle.
        let lets_rest = |influence: &Influence| match influence.role() {
            Role::Springs(_) | Role::Motor(_) | Role::Thermostat(_) => true,
            Role::Force(_) | Role::ThermalWalls(_) | Role::Andersen(_) => false,
        };
        settings.sleeping
            && settings.on_touch == OnTouch::Bounce
            && settings.gravity != [0.0; 2]
            && self.influences.list().iter().all(lets_rest)
            && !self.walls.move_any()
    }

    /// Puts the islands to sleep that rest at the end of a step of `dt` seconds. If there is an
    /// error, the step can be undone.
    pub(crate) fn fall_asleep(&mut self, plan: &Plan, dt: f64) -> Result<()> {
        if !self.may_sleep() || plan.is_lossless {
            self.bodies.awake.persistent.drifts.clear();
            return Ok(());
        }
        self.note_velocities(dt, plan.threads);
        // Quarters are counted from time 0, and not from the moment when an island came to rest. So
        // all processes, and a world that was restored, end them in the same step.
        let quarter = |time: f64| ((time + SHORTER) / QUARTER).floor();
        if quarter(self.time) == quarter(self.time + dt) {
            return Ok(());
        }
        self.end_quarter();
        if self.list_sleepers()? {
            let mut sleepers = self.take_sleepers();
            self.take_contacts(&mut sleepers);
            self.take_wall_impulses(&mut sleepers);
            self.put_to_sleep(sleepers)?;
        }
        Ok(())
    }

    /// Moves islands to the sleeping ones. If there is an error on any process, nothing changes.
    pub(crate) fn put_to_sleep(&mut self, sleepers: Sleepers) -> Result<()> {
        // The tree, the pairs and the messages may fail on any process. All wait until each knows
        // of the others. Only then particles leave the columns, so an error leaves all where they
        // are.
        let count = sleepers.islands.len();
        let done = if count > 0 {
            self.bodies.asleep.append(&sleepers, self.settings.tree)
        } else {
            Ok(())
        };
        let is_appended = done.is_ok();
        let done = done.and_then(|()| self.halo.protocol().keep_pairs(self));
        let done = done.and_then(|()| self.halo().wait());
        if done.is_err() {
            if is_appended {
                self.bodies.asleep.withdraw(count);
            }
            self.halo.protocol().drop_contacts(self);
            return done;
        }
        self.record.knows_sleepers = false;
        self.remove_sleepers(sleepers);
        Ok(())
    }

    /// Removes particles that sleep now from those that are awake.
    pub(crate) fn remove_sleepers(&mut self, sleepers: Sleepers) {
        let island_of = &self.scratch.sleeping.island_of;
        let keep: Vec<bool> = island_of.iter().map(|&island| island == NONE).collect();
        self.drop_wall_impulses(sleepers.discs.rows);
        self.keep(&keep);
    }

    /// The acceleration of gravity.
    fn gravity(&self) -> f64 {
        let [x, y] = self.settings.gravity.map(f64::from);
        (x * x + y * y).sqrt()
    }

    /// Adds the displacements of a step of `dt` seconds to the drifts of all particles.
    fn note_velocities(&mut self, dt: f64, threads: Option<usize>) {
        let gravity = self.gravity();
        let Self {
            bodies: Bodies { awake: Discs { particles, persistent, rows }, .. },
            settings,
            external,
            ..
        } = self;
        let drifts = &mut persistent.drifts;
        let Particles { velocities, radii, spins, restitutions, .. } = &*particles;
        drifts.resize(rows.len(), Drift::UNKNOWN);
        parallel::for_chunks(threads, drifts, |first, drifts| {
            for (drift, index) in drifts.iter_mut().zip(first..) {
                // A disc that turns in place is not at rest: friction would carry what lies on it.
                let surface = spins.get(index).map_or(0.0, |spin| spin.velocity * radii[index]);
                let [u, v] = velocities[index];
                let [x, y, turn] = [u, v, surface].map(f64::from);
                let square = (x * x + y * y).max(turn * turn);
                // A particle that keeps its energy may be slow at its highest point, and does not
                // come to rest.
                let is_elastic = settings.restitution * restitutions[index] == 1.0;
                // √(g r) is the unit of speed, so the rule is the same for discs of any size and
                // any gravity.
                if is_elastic || square > FAST * FAST * gravity * f64::from(radii[index]) {
                    // An infinite displacement stays infinite in the sum, so the whole quarter
                    // counts as fast.
                    drift.now = [f32::INFINITY; 3];
                } else {
                    // Displacements are added as vectors. Vibrations cancel, and motion in one
                    // direction does not.
                    let moved = [x, y, turn].map(|speed| (speed * dt) as f32);
                    drift.now = [0, 1, 2].map(|k| drift.now[k] + moved[k]);
                }
            }
        });
        // An exhausted particle stands still because its events were cut off, not because it rests.
        if !self.scratch.exhausted.is_empty() {
            for (drift, row) in drifts.iter_mut().zip(&*rows) {
                if self.scratch.exhausted.binary_search(row).is_ok() {
                    *drift = Drift::UNKNOWN;
                }
            }
        }
        // The force of a caller may hold a particle for the moment only.
        if let Some(external) = external {
            for (drift, &row) in drifts.iter_mut().zip(&*rows) {
                if external[row as usize] != [0.0; 2] {
                    *drift = Drift::UNKNOWN;
                }
            }
        }
    }

    /// Computes the mean speeds of the quarter that ends, and begins the next one.
    fn end_quarter(&mut self) {
        let gravity = self.gravity();
        let Self {
            bodies: Bodies { awake: Discs { particles, persistent, .. }, .. }, scratch, ..
        } = self;
        let Scratch { squares, changes, .. } = &mut scratch.sleeping;
        squares.clear();
        changes.clear();
        for (Drift { before, now }, &radius) in persistent.drifts.iter_mut().zip(&particles.radii) {
            let limit = QUARTER * SLOW * (gravity * f64::from(radius)).sqrt();
            // A point is slow only if it does not move.
            let relative = |v: f32| if v == 0.0 { 0.0 } else { f64::from(v) / limit };
            let both = [&*before, &*now].map(|drift| drift.map(relative));
            squares.push(both.map(|[x, y, turn]| (x * x + y * y).max(turn * turn) as f32));
            // A slow particle changes by 2 at most. Others keep their island awake in any case, so
            // the limit cuts nothing that counts. With it the sum over 2³¹ particles is at most
            // 2⁶², and fits into its type.
            let change = |k: usize| (both[1][k] - both[0][k]).clamp(-2.0, 2.0) / UNIT;
            changes.push([0, 1, 2].map(|k| change(k).round() as i64));
            (*before, *now) = (*now, [0.0; 3]);
        }
    }

    /// Lists the members of the islands that fall asleep; returns false if there are none
    /// on any process.
    fn list_sleepers(&mut self) -> Result<bool> {
        let is_slow = |[before, now]: [f32; 2]| before <= 1.0 && now <= 1.0;
        let Self {
            bodies: Bodies { awake: Discs { particles, rows, .. }, .. }, halo, scratch, ..
        } = self;
        let own = halo.own_rows();
        let sleeping = &mut scratch.sleeping;
        sleeping.members.clear();
        let mut all = sleeping.squares.iter().enumerate();
        // Most quarters end without a slow particle. Then this question is all that ranks exchange.
        let may_sleep = all.any(|(index, &squares)| {
            is_slow(squares) && particles.movable[index] && rows[index] < own
        });
        if !self.halo().any(may_sleep)? {
            return Ok(false);
        }
        self.find_islands();
        self.sum_islands();
        self.halo.protocol().join_islands(self)?;
        let Self { bodies: Bodies { awake: Discs { particles, rows, .. }, .. }, scratch, .. } =
            self;
        let Scratch { first, of_islands, members, .. } = &mut scratch.sleeping;
        for (index, &first) in (0..).zip(&*first) {
            let is_at_rest = of_islands[first as usize].is_at_rest();
            if is_at_rest && is_member(particles, index) && rows[index as usize] < own {
                members.push([first, index]);
            }
        }
        members.sort_unstable();
        // Other ranks wait for this one in what follows, also if it has no member.
        Ok(!self.halo.is_alone() || !self.scratch.sleeping.members.is_empty())
    }

    /// Sums up how the members of each island have moved. Ghosts count on their own processes; but
    /// kinematic ones keep the island awake on each process.
    fn sum_islands(&mut self) {
        let Self {
            bodies: Bodies { awake: Discs { particles, rows, .. }, .. }, halo, scratch, ..
        } = self;
        let own = halo.own_rows();
        let Scratch { groups, squares, changes, rests, of_islands, first, .. } =
            &mut scratch.sleeping;
        of_islands.clear();
        of_islands.resize(squares.len(), IslandMotion::default());
        first.clear();
        first.extend((0..squares.len() as u32).map(|index| groups.root(index)));
        for (index, &first) in first.iter().enumerate() {
            if !is_member(particles, index as u32) {
                continue;
            }
            let island = &mut of_islands[first as usize];
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
    }

    /// Finds which particles belong together, because they touched in the step, may come near each
    /// other by themselves or a spring connects them, and what each rests on. Candidate pairs do not
    /// count: which there are depends on the speeds of all particles. Static particles belong to no
    /// island; kinematic ones keep theirs awake.
    fn find_islands(&mut self) {
        let Self {
            bodies: Bodies { awake: Discs { particles, rows, .. }, .. },
            contacts,
            wall_impulses,
            scratch,
            halo,
            influences,
            ..
        } = self;
        let super::StepScratch { overlaps, events, sleeping, forces: scratch, .. } = scratch;
        let Scratch { groups, rests, .. } = sleeping;
        let (movable, own) = (&particles.movable, halo.own_rows());
        let indices = &scratch.indices;
        let tied = awake_springs(influences, indices)
            .map(|spring| spring.pair.map(|row| indices[row as usize]));
        groups.reset(movable.len());
        // Three reasons join two particles: they were near by themselves when the step began, they
        // touched in it, or a spring connects them.
        let touching = contacts.touching().map(|contact| contact.indices);
        let near = overlaps.iter().flat_map(|(_, pairs)| pairs).chain(&events.sensed);
        for pair in near.copied().chain(touching).chain(tied.clone()) {
            // Pairs of two ghosts are known to their own processes.
            let is_known = pair.iter().any(|&index| rows[index as usize] < own);
            if is_known && pair.iter().all(|&index| is_member(particles, index)) {
                groups.join(pair[0], pair[1]);
            }
        }
        rests.clear();
        // Pushes are those of the last sub-step. A bounce has none, so it is no support.
        let is_on_wall = |row: u32| {
            let first = wall_impulses.partition_point(|of| of.row < row);
            let of_row = wall_impulses[first..].iter().take_while(|of| of.row == row);
            of_row.map(|of| of.pushes[0]).any(|push| push > 0.0)
        };
        rests.extend(rows.iter().map(
            |&row| {
                if is_on_wall(row) { Rest::Supported } else { Rest::Free }
            },
        ));
        // Only contacts with an impulse carry anything. Surfaces that merely touch support nothing.
        let pressed = contacts.lasting().filter(|contact| contact.impulse > 0.0);
        for pair in pressed.map(|contact| contact.indices).chain(tied) {
            let [a, b] = pair.map(|index| index as usize);
            let rest = if movable[a] && movable[b] { Rest::OnOther } else { Rest::Supported };
            [a, b].into_iter().for_each(|index| rests[index] = rests[index].max(rest));
        }
        // A kinematic particle is a member of its island, and as a member without support it keeps
        // the island awake. Static particles are no members.
        for (rest, &movable) in rests.iter_mut().zip(movable) {
            if !movable {
                *rest = Rest::Free;
            }
        }
    }

    /// The islands that fall asleep, at rest, without their contacts. They are still among the others,
    /// too.
    pub(crate) fn take_sleepers(&mut self) -> Sleepers {
        let Self {
            bodies: Bodies { awake: Discs { particles, rows, persistent }, .. },
            scratch,
            ..
        } = &mut *self;
        let Scratch { members, island_of, names, .. } = &mut scratch.sleeping;
        let mut new = Sleepers::default();
        let order: Vec<u32> = members.iter().map(|&[_, index]| index).collect();
        let discs = &mut new.discs;
        discs.particles.gather(particles, &order, Some(1));
        discs.particles.velocities.fill([0.0; 2]);
        discs.particles.spins.iter_mut().for_each(|spin| spin.velocity = 0.0);
        discs.particles.simplify();
        dense::gather(&mut discs.rows, rows, &order, Some(1));
        discs.persistent.gather(persistent, &order, Some(1));
        // After waking, an island is observed for two whole quarters again.
        discs.persistent.drifts.clear();
        island_of.clear();
        island_of.resize(rows.len(), NONE);
        let mut start = 0;
        for (island, members) in (0..).zip(members.chunk_by(|a, b| a[0] == b[0])) {
            members.iter().for_each(|&[_, index]| island_of[index as usize] = island);
            let particles = start..start + members.len() as u32;
            start = particles.end;
            let name = names.get(members[0][0] as usize).copied().unwrap_or_default();
            new.islands.push(Island { particles, name, ..Island::default() });
        }
        new
    }

    /// Adds the contacts of islands that fall asleep. Those of a distributed world are kept with ids.
    fn take_contacts(&mut self, new: &mut Sleepers) {
        let Self {
            bodies: Bodies { awake: Discs { rows, .. }, .. }, contacts, scratch, halo, ..
        } = self;
        let island_of = &scratch.sleeping.island_of;
        let lasting = contacts.lasting().filter_map(|contact| {
            // An immovable particle has no island.
            let islands = contact.indices.map(|index| island_of[index as usize]);
            // `NONE` is the largest number, so the smaller one is an island if there is one.
            let island = islands.into_iter().min().filter(|&of| of != NONE);
            island.map(|island| (island, *contact))
        });
        let mut of_islands: Vec<_> = lasting.collect();
        // The sort is stable, so the contacts of an island keep the canonical order.
        of_islands.sort_by_key(|&(island, _)| island);
        if halo.keep_contacts(new, &of_islands, rows) {
            return;
        }
        for (_, contact) in &mut of_islands {
            contact.indices = contact.indices.map(|index| rows[index as usize]);
        }
        new.set_contacts(of_islands);
    }

    /// Adds the impulses of walls on islands that fall asleep.
    pub(crate) fn take_wall_impulses(&self, new: &mut Sleepers) {
        let mut of_rows: Vec<[u32; 2]> = Vec::with_capacity(new.discs.rows.len());
        for (island, of) in (0..).zip(&new.islands) {
            let range = of.particles.start as usize..of.particles.end as usize;
            of_rows.extend(new.discs.rows[range].iter().map(|&row| [row, island]));
        }
        of_rows.sort_unstable();
        let impulses = self.wall_impulses.iter().filter_map(|of| {
            let found = of_rows.binary_search_by_key(&of.row, |&[row, _]| row);
            found.ok().map(|at| (of_rows[at][1], *of))
        });
        let mut impulses: Vec<_> = impulses.collect();
        impulses.sort_by_key(|&(island, _)| island);
        let mut end = 0;
        for (number, island) in (0..).zip(&mut new.islands) {
            island.wall_impulses = run(&impulses, end, number);
            end = island.wall_impulses.end;
        }
        new.wall_impulses = impulses.into_iter().map(|(_, of)| of).collect();
    }
}

/// Whether a particle may be a member of an island. Static particles belong to none.
fn is_member(particles: &Particles, index: u32) -> bool {
    !particles.is_static(index as usize)
}
