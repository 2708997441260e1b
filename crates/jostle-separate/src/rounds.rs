//! Rounds over the near pairs.
//!
//! Within a chunk of indices, each pair is moved as soon as it is tested (Gauss-Seidel). Of a pair
//! in two chunks, each moves its own shape, and takes the other where it was before the round
//! (Jacobi). Chunks depend on the order of the shapes alone, so results do not depend on threads.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use super::bodies::Bodies;
use super::near::NeighborLists;
use super::push::Pusher;
use super::rules::Separation;
use jostle_base::error::Result;
use jostle_base::interrupt;
use jostle_base::memory;
use jostle_base::parallel::{self, CHUNK, locked};
use jostle_index::geometry::Scalar;
use jostle_index::quadtree::Quadtree;

/// The rounds end if the number of overlaps does not fall by a tenth within this number of rounds.
const PATIENCE: usize = 32;

/// A set of indices of a chunk, one bit each.
#[derive(Clone)]
struct IndexSet(Vec<u64>);

impl IndexSet {
    /// No index of a chunk of `len`.
    fn none(len: usize) -> Result<Self> {
        memory::filled(len.div_ceil(64), 0).map(Self)
    }

    /// All indices of a chunk of `len`.
    fn fill(&mut self, len: usize) {
        self.0.fill(u64::MAX);
        if let Some(last) = self.0.last_mut().filter(|_| !len.is_multiple_of(64)) {
            *last = (1 << (len % 64)) - 1;
        }
    }

    #[inline(always)]
    fn insert(&mut self, at: usize) {
        self.0[at / 64] |= 1 << (at % 64);
    }

    #[inline(always)]
    fn remove(&mut self, at: usize) {
        self.0[at / 64] &= !(1 << (at % 64));
    }

    fn has(&self, at: usize) -> bool {
        self.0[at / 64] >> (at % 64) & 1 == 1
    }

    /// The first index at `from` or after it.
    #[inline(always)]
    fn next(&self, from: usize) -> Option<usize> {
        let mut word = from / 64;
        let mut bits = *self.0.get(word)? & (u64::MAX << (from % 64));
        while bits == 0 {
            word += 1;
            bits = *self.0.get(word)?;
        }
        Some(64 * word + bits.trailing_zeros() as usize)
    }

    /// The indices, ascending.
    fn iter(&self) -> impl Iterator<Item = usize> {
        std::iter::successors(self.next(0), |&at| self.next(at + 1))
    }
}

/// A chunk of shapes.
struct Chunk<T> {
    /// Their centres; the same as those of the bodies between rounds.
    centers: Vec<[T; 2]>,
    /// The shapes that have moved since their pairs were tested, and the shapes in a pair with such
    /// a shape of another chunk. No other pair overlaps.
    stale: IndexSet,
    /// The shapes that have moved in this round.
    moved: IndexSet,
    /// Pairs that overlapped when they were tested.
    overlaps: usize,
    /// Whether a centre has changed in the round.
    changed: bool,
    /// Whether a shape has moved farther than its list allows.
    left: bool,
}

/// Number of rounds, and of the pairs that overlap after them.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Outcome {
    pub(crate) rounds: usize,
    pub(crate) overlaps: usize,
}

/// The rounds of a call.
pub(crate) struct Rounds<'a, T, K> {
    bodies: &'a mut Bodies<T>,
    pusher: Pusher<T>,
    rules: &'a Separation<T>,
    near: NeighborLists<T, K>,
    are_round: bool,
    chunks: Vec<Mutex<Chunk<T>>>,
    /// Number of rounds.
    count: usize,
}

impl<'a, T: Scalar, K: Scalar> Rounds<'a, T, K> {
    /// Lists the near pairs. `tree` is that of the shapes where they are.
    pub(crate) fn of(
        bodies: &'a mut Bodies<T>,
        pusher: &'a Pusher<T>,
        rules: &'a Separation<T>,
        tree: Option<&Quadtree<K>>,
    ) -> Result<Self> {
        let len = bodies.len();
        let chunk = |index| {
            let len = indices_of(index, len).len();
            let centers = memory::filled(len, [T::ZERO; 2])?;
            let (stale, moved) = (IndexSet::none(len)?, IndexSet::none(len)?);
            Ok(Mutex::new(Chunk {
                centers,
                stale,
                moved,
                overlaps: 0,
                changed: false,
                left: false,
            }))
        };
        let chunks = (0..len.div_ceil(CHUNK)).map(chunk).collect::<Result<Vec<_>>>()?;
        let (near, are_round) = (NeighborLists::of(bodies, rules.gap), bodies.are_round());
        let mut rounds = Self { bodies, pusher: *pusher, rules, near, are_round, chunks, count: 0 };
        // Without rounds only overlaps are counted, and nothing may move.
        let entered = rules.max_rounds > 0 && rounds.enter_bounds();
        rounds.restart();
        match tree.filter(|_| !entered) {
            Some(tree) => rounds.near.find_in(tree, None, rounds.bodies)?,
            None => rounds.near.find(rounds.bodies, rules.threads)?,
        }
        Ok(rounds)
    }

    /// Moves shapes until none overlap or for `max_rounds` rounds in all; returns false if it ends
    /// earlier because the number of overlaps falls too slowly. If it is `patient`, it does not end
    /// earlier.
    pub(crate) fn run(&mut self, patient: bool) -> Result<bool> {
        let mut before = usize::MAX;
        while self.count < self.rules.max_rounds {
            interrupt::check()?;
            // Over-relaxation begins after the first rounds, see `push`.
            self.pusher = self.pusher.in_round(self.count);
            self.count += 1;
            let (overlaps, changed) = self.round()?;
            // `overlaps` counts pairs when they were tested. Only if nothing has moved since is it
            // the present number.
            if overlaps == 0 && !changed {
                return Ok(true);
            }
            let is_due = !patient && self.count.is_multiple_of(PATIENCE);
            // Nothing moves although pairs overlap: between bounds or fixed shapes. Or progress is
            // too slow, by a comparison over many rounds: from one round to the next the number of
            // overlaps goes up and down.
            if !changed || (is_due && overlaps > before - before.div_ceil(10)) {
                return Ok(false);
            }
            if is_due {
                before = overlaps;
            }
        }
        Ok(true)
    }

    /// Moves the shapes by other means, and lists the near pairs again.
    pub(crate) fn change(&mut self, act: impl FnOnce(&mut Bodies<T>) -> Result<()>) -> Result<()> {
        act(self.bodies)?;
        self.enter_bounds();
        self.restart();
        self.near.find(self.bodies, self.rules.threads)
    }

    /// The number of rounds, and of the pairs that overlap.
    pub(crate) fn outcome(&self) -> Outcome {
        Outcome { rounds: self.count, overlaps: self.overlaps() }
    }

    /// Number of shapes.
    pub(crate) fn len(&self) -> usize {
        self.bodies.len()
    }

    /// Lets all chunks begin with the current centres.
    fn restart(&mut self) {
        let len = self.bodies.len();
        for (index, chunk) in self.chunks.iter_mut().enumerate() {
            let chunk = chunk.get_mut().unwrap_or_else(PoisonError::into_inner);
            let indices = indices_of(index, len);
            chunk.stale.fill(indices.len());
            chunk.centers.copy_from_slice(&self.bodies.centers[indices]);
        }
    }

    /// One round; returns the number of overlaps that it met, and whether a shape has moved.
    fn round(&mut self) -> Result<(usize, bool)> {
        let this = &*self;
        // A round has two halves, and a barrier between them.
        //
        // 1. Each chunk moves its own shapes. Pairs within the chunk are moved one after the other,
        // with the places that earlier pairs have given them (Gauss-Seidel, which converges fast).
        // For shapes of other chunks it reads their centres of before the round, which nobody
        // writes now. So a chunk has the same input however many threads there are.
        //
        // 2. One thread publishes the new centres and marks what has to be tested again.
        //
        // Invariant between rounds: two shapes that are not stale do not overlap. It holds at the
        // start, since all are stale, and each motion marks the shape that moved; a neighbour in
        // another chunk is marked, too, because that chunk cannot see the motion otherwise.
        parallel::for_tasks(self.rules.threads, self.chunks.len(), |number| {
            let chunk = &mut locked(&this.chunks[number]);
            let first = number * CHUNK;
            if this.are_round {
                this.round_over::<true>(first, chunk);
            } else {
                this.round_over::<false>(first, chunk);
            }
            this.end_round(first, chunk);
        });
        let (mut overlaps, mut changed, mut left) = (0, false, false);
        for number in 0..self.chunks.len() {
            let chunk = locked(&self.chunks[number]);
            overlaps += chunk.overlaps;
            changed |= chunk.changed;
            left |= chunk.left;
            for at in chunk.moved.iter() {
                let index = number * CHUNK + at;
                self.bodies.centers[index] = chunk.centers[at];
                let near = self.near.of_index(index);
                // Lists are sorted, so if the first and the last are in this chunk, all are. Most
                // shapes are far from the edge of their chunk, and the loop is not entered.
                let is_within = |other: Option<&u32>| other.is_none_or(|&o| chunk_of(o) == number);
                if is_within(near.first()) && is_within(near.last()) {
                    continue;
                }
                for &other in near.iter().filter(|&&other| chunk_of(other) != number) {
                    // The other, not the pair: its chunk tests it against its whole list in the
                    // next round.
                    locked(&self.chunks[chunk_of(other)]).stale.insert(other as usize % CHUNK);
                }
            }
        }
        // Half the margin for each of two shapes: a pair that is not listed cannot overlap before
        // one of them has moved by half of it. Beyond that the lists prove nothing.
        if left {
            // A shape may have moved so far that it overlaps one that was not listed.
            self.near.find(self.bodies, self.rules.threads)?;
            self.restart();
        }
        Ok((overlaps, changed))
    }

    /// Moves the pairs of the stale shapes of the chunk that starts at the index `first`.
    fn round_over<const ROUND: bool>(&self, first: usize, chunk: &mut Chunk<T>) {
        let Bodies { all, centers, .. } = &*self.bodies;
        let Chunk { centers: own, stale, moved, overlaps, .. } = chunk;
        moved.0.fill(0);
        *overlaps = 0;
        let mut next = stale.next(0);
        // A shape that is marked behind this place is tested in this round, one before it in the
        // next. To test all pairs of a shape after each of its motions took 3.05 instead of 2.08 ms
        // for 10,000 discs (docs/benchmarks-notes.md).
        while let Some(at) = next {
            // Before its pairs are tested, so that a push by one of them marks it again.
            stale.remove(at);
            let i = first + at;
            let (a, mut from, mut is_moved) = (&all[i], own[at], false);
            for &other in self.near.of_index(i) {
                let j = other as usize;
                let other_at = j.wrapping_sub(first);
                // `wrapping_sub` makes a huge number of an index before the chunk, so one
                // comparison tests both ends.
                let is_here = other_at < own.len();
                let (b, to) = (&all[j], if is_here { own[other_at] } else { centers[j] });
                let offset = [to[0] - from[0], to[1] - from[1]];
                if !self.pusher.overlaps::<ROUND>(a, b, offset) {
                    continue;
                }
                *overlaps += 1;
                // Both shapes of a pair in two chunks compute the push for themselves; from the
                // same places it must be the same.
                let push = ordered_push::<T, ROUND>(&self.pusher, (a, b), offset, (i, j));
                let share = share(a.weight, b.weight);
                if !a.is_fixed() {
                    from = [from[0] - push[0] * share, from[1] - push[1] * share];
                    is_moved = true;
                }
                // The share of a shape in another chunk is moved by that chunk, which meets the
                // same pair.
                if is_here && !b.is_fixed() {
                    let rest = T::ONE - share;
                    own[other_at] = [to[0] + push[0] * rest, to[1] + push[1] * rest];
                    moved.insert(other_at);
                    stale.insert(other_at);
                }
            }
            if is_moved {
                own[at] = from;
                moved.insert(at);
                stale.insert(at);
            }
            next = stale.next(at + 1);
        }
    }

    /// Moves the shapes of a chunk into the bounds, and compares with the state before the round.
    fn end_round(&self, first: usize, chunk: &mut Chunk<T>) {
        let most = self.near.max_displacement();
        let Chunk { centers, stale, moved, changed, left, .. } = chunk;
        (*changed, *left) = (false, false);
        for at in moved.iter() {
            let index = first + at;
            let center = self.inside(index, centers[at]);
            if center != centers[at] {
                centers[at] = center;
                stale.insert(at);
            }
            let origin = self.near.origins[index];
            // Only shapes that have moved are tested; the others are as far from their origins as
            // before.
            let away = [center[0] - origin[0], center[1] - origin[1]];
            *changed |= center != self.bodies.centers[index];
            *left |= away[0] * away[0] + away[1] * away[1] > most * most;
        }
    }

    /// The nearest centre at which a shape is in the bounds.
    fn inside(&self, index: usize, center: [T; 2]) -> [T; 2] {
        let body = &self.bodies.all[index];
        let Some(bounds) = self.rules.bounds else { return center };
        if body.is_fixed() {
            return center;
        }
        [0, 1].map(|axis| {
            if self.rules.axis.is_some_and(|only| only != axis) {
                return center[axis];
            }
            let extent = body.extent(axis);
            // `check` has made sure that the shape fits, so the order of the two limits does not
            // matter.
            center[axis].min(bounds[axis + 2] - extent).max(bounds[axis] + extent)
        })
    }

    /// Returns whether a shape was outside.
    fn enter_bounds(&mut self) -> bool {
        if self.rules.bounds.is_none() {
            return false;
        }
        let mut entered = false;
        for index in 0..self.bodies.len() {
            let center = self.inside(index, self.bodies.centers[index]);
            entered |= center != self.bodies.centers[index];
            self.bodies.centers[index] = center;
        }
        entered
    }

    /// Shapes without which no pair would overlap: of each pair the lighter one, of equal ones
    /// the later. The lists must be those of the current centres.
    pub(crate) fn to_take_out(&self) -> Result<Vec<u32>> {
        let mut is_out = memory::filled(self.len(), false)?;
        let all = &self.bodies.all;
        self.each_overlap(|i, j| {
            if !(is_out[i] || is_out[j]) {
                // A vertex cover, chosen greedily in one pass: not always the smallest. The lighter
                // one moves, as in rounds.
                is_out[if all[i].weight < all[j].weight { i } else { j }] = true;
            }
        });
        let mut indices: Vec<u32> =
            memory::with_capacity(is_out.iter().filter(|out| **out).count())?;
        indices.extend((0..is_out.len() as u32).filter(|&index| is_out[index as usize]));
        Ok(indices)
    }

    /// Number of pairs that overlap. The lists must be those of the current centres.
    fn overlaps(&self) -> usize {
        let mut count = 0;
        self.each_overlap(|_, _| count += 1);
        count
    }

    /// Calls `act` with each pair that overlaps, `i < j`.
    fn each_overlap(&self, mut act: impl FnMut(usize, usize)) {
        let Bodies { all, centers, .. } = &*self.bodies;
        let chunks: Vec<_> = self.chunks.iter().map(locked).collect();
        let is_stale = |index: usize| chunks[index / CHUNK].stale.has(index % CHUNK);
        for (number, chunk) in chunks.iter().enumerate() {
            for i in chunk.stale.iter().map(|at| number * CHUNK + at) {
                for j in self.near.of_index(i).iter().map(|&other| other as usize) {
                    let offset = [centers[j][0] - centers[i][0], centers[j][1] - centers[i][1]];
                    // A pair of two of them is met twice.
                    // By the invariant each pair that overlaps has a stale shape, so only their
                    // lists are read.
                    let is_new = j > i || !is_stale(j);
                    if is_new && self.pusher.overlaps::<false>(&all[i], &all[j], offset) {
                        act(i.min(j), i.max(j));
                    }
                }
            }
        }
    }
}

fn chunk_of(index: u32) -> usize {
    index as usize / CHUNK
}

/// The indices of a chunk of `len` shapes.
fn indices_of(chunk: usize, len: usize) -> Range<usize> {
    chunk * CHUNK..len.min((chunk + 1) * CHUNK)
}

/// The push of a pair, the same from both of its shapes.
#[inline(always)]
fn ordered_push<T: Scalar, const ROUND: bool>(
    pusher: &Pusher<T>,
    (a, b): (&super::bodies::Body<T>, &super::bodies::Body<T>),
    offset: [T; 2],
    (i, j): (usize, usize),
) -> [T; 2] {
    let push = if ROUND { Pusher::push_round } else { Pusher::push };
    if i < j {
        return push(pusher, a, b, offset, j - i);
    }
    // Adding 0 makes a 0 of −0, so that coincident centres have the same sign from both.
    let [x, y] = offset;
    let push = push(pusher, b, a, [T::ZERO - x, T::ZERO - y], i - j);
    [-push[0], -push[1]]
}

/// The share of a push that the first of two shapes moves.
#[inline(always)]
fn share<T: Scalar>(own: T, other: T) -> T {
    if own == T::INFINITY {
        T::ZERO
    } else if other == T::INFINITY {
        T::ONE
    } else {
        other / (own + other)
    }
}
