//! What the events of a window lead to: trajectories and bounces. What later windows need of them.

use std::cmp::Ordering;

use super::Outside;
use super::friction::Turning;
use super::queue::WALL;
use crate::trajectory::{Piece, Vector};
use jostle_base::error::Result;
use jostle_base::memory;

/// Stands for no trajectory and for no piece.
pub const NONE: u32 = u32::MAX;

/// The trajectory of a disc that has events.
#[derive(Clone, Copy, Debug)]
pub struct Trajectory {
    /// The disc.
    pub index: u32,
    /// The number of its events in the window.
    pub count: u32,
    /// Its recent events, see [`exhaustion`](super::exhaustion).
    pub recent: u32,
    /// How far it has moved in these, from event to event: the sum of the distances along both
    /// axes.
    pub travelled: f32,
    /// The piece that it is on, in the end its last one.
    pub piece: Piece,
    /// The piece before, in the history's list; [`NONE`] if there is none.
    pub before: u32,
    /// One over the mass.
    pub inverse_mass: f64,
    /// Its position in the group plus one, while discs collide.
    pub in_group: u32,
    /// The parent in the disjoint-set forest: a trajectory of the same island, or itself for the
    /// representative.
    pub island: u32,
    /// The next trajectory of the island; the last one is followed by the first.
    pub next: u32,
    /// Whether the disc was exhausted in the step.
    pub is_exhausted: bool,
    /// Whether its contacts were solved jointly at some moment of the window.
    pub is_joint: bool,
    /// The velocity after the flight, if the disc was exhausted in it and loses no energy.
    pub stopped: Option<Vector>,
    /// A hash of the discs that collided with it at the same moment, where these were at least two.
    pub groups: u64,
}

/// Two discs that bounced, or a disc and a wall.
#[derive(Clone, Copy, Debug)]
pub struct Bounce {
    /// Their indices, the smaller first; [`WALL`](super::WALL) for a wall.
    pub pair: [u32; 2],
    /// The number of the wall, or of the image of the second disc.
    pub code: u32,
    /// Unit vector from the first to the second at the impact.
    pub normal: [f32; 2],
    /// The impulses along the normal and of friction.
    pub impulses: [f32; 2],
    /// The trajectory of one of the discs.
    pub trajectory: u32,
}

impl Bounce {
    /// Whether it is that of a disc and a wall or a side of the container.
    pub fn is_with_wall(&self) -> bool {
        self.pair[1] == WALL
    }

    /// The order of two bounces: by their pairs, those of the same pair by the rest, because sums of
    /// impulses depend on the order.
    pub fn order(&self, other: &Self) -> Ordering {
        let pair = |of: &Self| u64::from(of.pair[0]) << 32 | u64::from(of.pair[1]);
        let rest =
            |of: &Self| (of.code, of.impulses.map(f32::to_bits), of.normal.map(f32::to_bits));
        pair(self).cmp(&pair(other)).then_with(|| rest(self).cmp(&rest(other)))
    }
}

/// Inserts sorted bounces into sorted ones.
pub fn insert(all: &mut Vec<Bounce>, more: &[Bounce]) -> Result<()> {
    // A merge from the end, in place: the tail moves to its final place first, so nothing is
    // overwritten before it is read. Only bounces after the first insertion move.
    let Some(&last) = more.last() else { return Ok(()) };
    let mut before = all.len();
    memory::resize(all, before + more.len(), last)?;
    let mut end = all.len();
    for bounce in more.iter().rev() {
        while before > 0 && all[before - 1].order(bounce).is_gt() {
            (before, end) = (before - 1, end - 1);
            all[end] = all[before];
        }
        end -= 1;
        all[end] = *bounce;
    }
    Ok(())
}

/// The trajectories of some discs.
#[derive(Debug, Default)]
pub struct History {
    /// One for each disc that had an event, and for those that were simulated again.
    pub trajectories: Vec<Trajectory>,
    /// The rotation of each of them; empty if no disc has friction.
    pub turnings: Vec<Turning>,
    /// Pieces that ended with an event, and the pieces before them.
    pub ended: Vec<(Piece, u32)>,
    /// The pairs that bounced.
    pub bounces: Vec<Bounce>,
    /// Discs that leave their bounds.
    pub outside: Vec<Outside>,
    /// The trajectories of discs that were exhausted.
    pub exhausted_trajectories: Vec<u32>,
    /// The trajectories of discs whose collisions became elastic, because they had many.
    pub collapsed: Vec<u32>,
    /// Whether trajectories were removed from `trajectory_of`, because their discs are simulated again.
    pub has_removed: bool,
    /// Discs that were exhausted; written by [`History::retain`].
    pub exhausted: Vec<u32>,
}

impl History {
    /// Forgets all trajectories.
    pub fn clear(&mut self) {
        self.trajectories.clear();
        self.turnings.clear();
        self.ended.clear();
        self.bounces.clear();
        self.outside.clear();
        self.exhausted_trajectories.clear();
        self.collapsed.clear();
        self.has_removed = false;
        self.exhausted.clear();
    }

    /// Reserves memory for events that give `discs` discs new velocities, in as many contacts at most.
    pub fn reserve(&mut self, discs: usize, has_friction: bool) -> Result<()> {
        memory::reserve(&mut self.trajectories, discs)?;
        memory::reserve(&mut self.turnings, if has_friction { discs } else { 0 })?;
        memory::reserve(&mut self.ended, discs)?;
        memory::reserve(&mut self.bounces, discs)?;
        memory::reserve(&mut self.outside, discs)?;
        memory::reserve(&mut self.exhausted_trajectories, discs)?;
        memory::reserve(&mut self.collapsed, discs)
    }

    /// Keeps what belongs to trajectories that are still valid, and lists the exhausted discs.
    /// `mark` is added to the numbers of these trajectories in `trajectory_of`.
    pub fn retain(&mut self, mark: u32, trajectory_of: &[u32]) -> Result<()> {
        let trajectories = &self.trajectories;
        let is_valid = |number: u32| {
            trajectory_of[trajectories[number as usize].index as usize] == mark | number
        };
        // Bounces of discarded trajectories must not count. Impulses are sums over the history that
        // holds, and not over guesses.
        if self.has_removed {
            // The disc of the trajectory is one of the two. Bounces are sorted by their discs, so this reads
            // `trajectory_of` in order, and no trajectory.
            self.bounces.retain(|&Bounce { pair, trajectory, .. }| {
                pair.iter()
                    .any(|&disc| trajectory_of.get(disc as usize) == Some(&(mark | trajectory)))
            });
        }
        self.collapsed.retain(|&number| is_valid(number));
        let exhausted = self.exhausted_trajectories.iter().filter(|&&number| is_valid(number));
        let exhausted = exhausted.map(|&number| trajectories[number as usize].index);
        memory::extend(&mut self.exhausted, exhausted)
    }

    /// The trajectory that stands for the island of a trajectory.
    fn island(&mut self, mut number: u32) -> u32 {
        while self.trajectories[number as usize].island != number {
            let next = self.trajectories[number as usize].island;
            // Path halving keeps the trees flat without a second pass (R. E. Tarjan, J. van
            // Leeuwen, 1984).
            self.trajectories[number as usize].island = self.trajectories[next as usize].island;
            number = next;
        }
        number
    }

    /// Makes one island of those of two trajectories.
    pub fn connect(&mut self, number: u32, other: u32) {
        let [island, other] = [number, other].map(|number| self.island(number));
        if island == other {
            return;
        }
        self.trajectories[other as usize].island = island;
        // The members of an island are a ring. To exchange the successors of two members of
        // different rings makes one ring of both. In the same ring it would make two, hence the
        // test above.
        let [next, others] = [island, other].map(|number| self.trajectories[number as usize].next);
        self.trajectories[island as usize].next = others;
        self.trajectories[other as usize].next = next;
    }

    /// Calls `act` with the number of each trajectory of an island.
    pub fn each_of_island(&self, number: u32, mut act: impl FnMut(u32)) {
        let mut at = number;
        loop {
            act(at);
            at = self.trajectories[at as usize].next;
            if at == number {
                return;
            }
        }
    }
}

/// The discs that had events in earlier windows of a flight, and how they continue.
#[derive(Debug, Default)]
pub struct Carried {
    /// The number of the trajectory of each disc, [`NONE`] if it had no events; empty if none had any.
    numbers: Vec<u32>,
    trajectories: Vec<Trajectory>,
    /// The rotation of each of them; empty if no disc has friction.
    turnings: Vec<Turning>,
}

impl Carried {
    /// Begins a flight.
    pub fn clear(&mut self) {
        self.numbers.clear();
        self.trajectories.clear();
        self.turnings.clear();
    }

    /// The trajectory of a disc that had events.
    #[inline(always)]
    pub fn get(&self, index: u32) -> Option<&Trajectory> {
        let &number = self.numbers.get(index as usize)?;
        self.trajectories.get(number as usize)
    }

    /// The rotation of a disc that had events, if any disc has friction.
    pub fn turning(&self, index: u32) -> Option<&Turning> {
        let &number = self.numbers.get(index as usize)?;
        self.turnings.get(number as usize)
    }

    /// Takes the trajectories with events of a window of `len` discs. `mark` is added to the numbers of
    /// valid trajectories in `trajectory_of`.
    pub fn take(&mut self, history: &History, mark: u32, trajectory_of: &[u32]) -> Result<()> {
        let Self { numbers, trajectories, turnings } = self;
        memory::resize(numbers, trajectory_of.len(), NONE)?;
        memory::reserve(trajectories, history.trajectories.len())?;
        memory::reserve(turnings, history.turnings.len())?;
        for (number, trajectory) in (0..).zip(&history.trajectories) {
            let index = trajectory.index as usize;
            // A trajectory without events says nothing that the first piece does not.
            if trajectory_of[index] != mark | number || trajectory.count == 0 {
                continue;
            }
            let known = numbers[index] as usize;
            let turning = history.turnings.get(number as usize);
            // `NONE` is larger than each number of a trajectory, so one comparison tests both.
            if known < trajectories.len() {
                trajectories[known] = *trajectory;
                turning.into_iter().for_each(|turning| turnings[known] = *turning);
            } else {
                numbers[index] = trajectories.len() as u32;
                trajectories.push(*trajectory);
                turnings.extend(turning);
            }
        }
        Ok(())
    }
}

/// The pieces of a disc, the last one first.
#[derive(Clone, Debug)]
pub struct Pieces<'a> {
    ended: &'a [(Piece, u32)],
    next: Option<(Piece, u32)>,
    end: f64,
    is_last: bool,
}

impl<'a> Pieces<'a> {
    /// The trajectory of a disc without events.
    pub fn free(piece: Piece, end: f64) -> Self {
        Self { ended: &[], next: Some((piece, NONE)), end, is_last: true }
    }

    /// Leaves out the pieces that begin after `time`.
    pub fn skip_after(&mut self, time: f64) {
        while self.next.is_some_and(|(piece, _)| piece.time > time) {
            self.next();
        }
    }

    /// The trajectory of a disc with events.
    pub fn of(history: &'a History, trajectory: &Trajectory, end: f64) -> Self {
        let next = Some((trajectory.piece, trajectory.before));
        Self { ended: &history.ended, next, end, is_last: true }
    }
}

/// A piece of a trajectory.
pub struct TimedPiece {
    /// The piece.
    pub piece: Piece,
    /// When it ends.
    pub end: f64,
    /// Whether it is the first.
    pub is_first: bool,
    /// Whether it ends with the window, and not with an event.
    pub is_last: bool,
}

impl Iterator for Pieces<'_> {
    type Item = TimedPiece;

    fn next(&mut self) -> Option<TimedPiece> {
        let (piece, before) = self.next?;
        // `NONE` is beyond the end of the list, so `get` ends the chain.
        self.next = self.ended.get(before as usize).copied();
        let is_last = std::mem::take(&mut self.is_last);
        let part = TimedPiece { piece, end: self.end, is_first: before == NONE, is_last };
        self.end = piece.time;
        Some(part)
    }
}
