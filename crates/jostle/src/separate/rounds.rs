//! Rounds over the near pairs.
//!
//! Within a chunk of places, each pair is moved as soon as it is tested (Gauss-Seidel). Of a pair
//! in two chunks, each moves its own part, and takes the other where it was before the round
//! (Jacobi). Chunks depend on the order of the shapes alone, so results do not depend on threads.

use std::sync::{Mutex, PoisonError};

use super::bodies::Bodies;
use super::near::{Near, places_of};
use super::push::Pusher;
use super::{Outcome, Separation};
use crate::error::Result;
use crate::geometry::Scalar;
use crate::interrupt;
use crate::memory;
use crate::parallel::{self, CHUNK, locked};
use crate::quadtree::Quadtree;

/// After so many rounds the number of overlaps must have fallen by a tenth; otherwise they end.
const PATIENCE: usize = 32;

/// A chunk of shapes during a round.
struct Part<T> {
    /// Their centres.
    centers: Vec<[T; 2]>,
    /// Whether each has moved in this round.
    moved: Vec<bool>,
    /// Pairs that overlapped when they were tested.
    overlaps: usize,
    /// Whether a centre is another one than before the round.
    changed: bool,
    /// Whether a shape is beyond the reach of its list.
    left: bool,
}

/// The rounds of a call.
pub struct Rounds<'a, T> {
    bodies: &'a mut Bodies<T>,
    pusher: Pusher<T>,
    rules: &'a Separation<T>,
    near: Near<T>,
    are_round: bool,
    /// Whether each shape has moved in the last round, or by other means since then.
    moved: Vec<bool>,
    parts: Vec<Mutex<Part<T>>>,
    /// Number of rounds.
    count: usize,
}

impl<'a, T: Scalar> Rounds<'a, T> {
    /// Lists the near pairs. `tree` is that of the shapes where they are.
    pub fn of(
        bodies: &'a mut Bodies<T>,
        pusher: &'a Pusher<T>,
        rules: &'a Separation<T>,
        tree: Option<&Quadtree<T>>,
    ) -> Result<Self> {
        let len = bodies.len();
        let part = |index| {
            let centers = memory::collect(bodies.centers[places_of(index, len)].iter().copied())?;
            let moved = memory::filled(centers.len(), false)?;
            Ok(Mutex::new(Part { centers, moved, overlaps: 0, changed: false, left: false }))
        };
        let parts = (0..len.div_ceil(CHUNK)).map(part).collect::<Result<Vec<_>>>()?;
        let (near, are_round) = (Near::of(bodies, rules.gap), bodies.are_round());
        let moved = memory::filled(len, true)?;
        let (pusher, count) = (*pusher, 0);
        let mut rounds = Self { bodies, pusher, rules, near, are_round, moved, parts, count };
        let entered = rules.max_rounds > 0 && rounds.enter_bounds();
        match tree.filter(|_| !entered) {
            Some(tree) => rounds.near.find_in(tree, None, rounds.bodies)?,
            None => rounds.near.find(rounds.bodies, rules.threads)?,
        }
        Ok(rounds)
    }

    /// Moves shapes until none overlap or for `max_rounds` rounds in all; returns false if it
    /// ends earlier, because rounds are of little use. It does not if it is `patient`.
    pub fn run(&mut self, patient: bool) -> Result<bool> {
        let mut before = usize::MAX;
        while self.count < self.rules.max_rounds {
            interrupt::check()?;
            self.pusher = self.pusher.in_round(self.count);
            self.count += 1;
            let (overlaps, changed) = self.round()?;
            if overlaps == 0 && !changed {
                return Ok(true);
            }
            let is_due = !patient && self.count.is_multiple_of(PATIENCE);
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
    pub fn change(&mut self, act: impl FnOnce(&mut Bodies<T>) -> Result<()>) -> Result<()> {
        act(self.bodies)?;
        self.enter_bounds();
        self.moved.fill(true);
        self.near.find(self.bodies, self.rules.threads)
    }

    /// The number of rounds, and of the pairs that overlap.
    pub fn outcome(&self) -> Outcome {
        Outcome { rounds: self.count, overlaps: self.overlaps() }
    }

    /// Number of shapes.
    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    /// One round; returns the number of overlaps that it met, and whether a shape has moved.
    fn round(&mut self) -> Result<(usize, bool)> {
        let this = &*self;
        parallel::for_tasks(self.rules.threads, self.parts.len(), |index| {
            let part = &mut locked(&this.parts[index]);
            if this.are_round {
                this.round_over::<true>(index, part);
            } else {
                this.round_over::<false>(index, part);
            }
            this.end_round(index, part);
        });
        let (mut overlaps, mut changed, mut left) = (0, false, false);
        for (index, part) in self.parts.iter_mut().enumerate() {
            let part = part.get_mut().unwrap_or_else(PoisonError::into_inner);
            overlaps += part.overlaps;
            changed |= part.changed;
            left |= part.left;
            let places = places_of(index, self.bodies.centers.len());
            self.bodies.centers[places.clone()].copy_from_slice(&part.centers);
            self.moved[places].copy_from_slice(&part.moved);
        }
        if left {
            self.near.find(self.bodies, self.rules.threads)?;
        }
        Ok((overlaps, changed))
    }

    /// Moves the pairs of a chunk. A pair is tested only if one of both has moved since its last
    /// test, in the last round or in this one: otherwise it did not overlap then and does not now.
    fn round_over<const ROUND: bool>(&self, index: usize, part: &mut Part<T>) {
        let Bodies { all, centers, .. } = &*self.bodies;
        let first = places_of(index, all.len()).start;
        let (own, moved) = (&mut part.centers[..], &mut part.moved[..]);
        own.copy_from_slice(&centers[first..first + own.len()]);
        moved.fill(false);
        part.overlaps = 0;
        for at in 0..own.len() {
            let i = first + at;
            let mut is_moved = self.moved[i] || moved[at];
            for &other in self.near.of_place(i) {
                let j = other as usize;
                let other_at = j.wrapping_sub(first);
                let is_here = other_at < own.len();
                if !(is_moved || self.moved[j] || (is_here && moved[other_at])) {
                    continue;
                }
                let (a, b) = (&all[i], &all[j]);
                let (from, to) = (own[at], if is_here { own[other_at] } else { centers[j] });
                let offset = [to[0] - from[0], to[1] - from[1]];
                if !self.pusher.overlaps::<ROUND>(a, b, offset) {
                    continue;
                }
                part.overlaps += 1;
                let push = ordered_push(&self.pusher, (a, b), offset, (i, j));
                let share = share(a.weight, b.weight);
                if !a.is_fixed() {
                    own[at] = [from[0] - push[0] * share, from[1] - push[1] * share];
                    (moved[at], is_moved) = (true, true);
                }
                if is_here && !b.is_fixed() {
                    let rest = T::ONE - share;
                    own[other_at] = [to[0] + push[0] * rest, to[1] + push[1] * rest];
                    moved[other_at] = true;
                }
            }
        }
    }

    /// Moves the shapes of a chunk into the bounds, and compares with the state before the round.
    fn end_round(&self, index: usize, part: &mut Part<T>) {
        let places = places_of(index, self.bodies.len());
        let reach = self.near.reach();
        (part.changed, part.left) = (false, false);
        for ((place, center), _) in
            places.zip(&mut part.centers).zip(&part.moved).filter(|(_, moved)| **moved)
        {
            *center = self.inside(place, *center);
            let origin = self.near.origins[place];
            let away = [center[0] - origin[0], center[1] - origin[1]].map(T::abs);
            part.changed |= *center != self.bodies.centers[place];
            part.left |= away[0] * away[0] + away[1] * away[1] > reach * reach;
        }
    }

    /// The nearest centre at which a shape is in the bounds.
    fn inside(&self, place: usize, center: [T; 2]) -> [T; 2] {
        let body = &self.bodies.all[place];
        let Some(bounds) = self.rules.bounds else { return center };
        if body.is_fixed() {
            return center;
        }
        [0, 1].map(|axis| {
            if self.rules.axis.is_some_and(|only| only != axis) {
                return center[axis];
            }
            let extent = body.extent(axis);
            center[axis].min(bounds[axis + 2] - extent).max(bounds[axis] + extent)
        })
    }

    /// Returns whether a shape was outside.
    fn enter_bounds(&mut self) -> bool {
        let mut entered = false;
        for place in 0..self.bodies.len() {
            let center = self.inside(place, self.bodies.centers[place]);
            entered |= center != self.bodies.centers[place];
            self.bodies.centers[place] = center;
        }
        entered
    }

    /// Shapes without which no pair would overlap: of each pair the lighter one, of equal ones
    /// the later. The lists must be those of the current centres.
    pub fn to_take_out(&self) -> Result<Vec<u32>> {
        let Bodies { all, centers, .. } = &*self.bodies;
        let mut is_out = memory::filled(all.len(), false)?;
        for (i, a) in all.iter().enumerate() {
            for &other in self.near.of_place(i) {
                let j = other as usize;
                let offset = [centers[j][0] - centers[i][0], centers[j][1] - centers[i][1]];
                if is_out[i] || is_out[j] || !self.pusher.overlaps::<false>(a, &all[j], offset) {
                    continue;
                }
                let (a, b) = (a.weight, all[j].weight);
                is_out[if b < a || (b == a && j > i) { j } else { i }] = true;
            }
        }
        let mut places: Vec<u32> = memory::with_room(is_out.iter().filter(|out| **out).count())?;
        places.extend((0..all.len() as u32).filter(|&place| is_out[place as usize]));
        Ok(places)
    }

    /// Number of pairs that overlap. The lists must be those of the current centres.
    fn overlaps(&self) -> usize {
        let Bodies { all, centers, .. } = &*self.bodies;
        let mut twice = 0;
        for (i, a) in all.iter().enumerate() {
            for &other in self.near.of_place(i) {
                let j = other as usize;
                let offset = [centers[j][0] - centers[i][0], centers[j][1] - centers[i][1]];
                let counted = if i / CHUNK == j / CHUNK { 2 } else { 1 };
                twice += usize::from(self.pusher.overlaps::<false>(a, &all[j], offset)) * counted;
            }
        }
        twice / 2
    }
}

/// The push of a pair, the same from both of its shapes.
#[inline(always)]
fn ordered_push<T: Scalar>(
    pusher: &Pusher<T>,
    (a, b): (&super::bodies::Body<T>, &super::bodies::Body<T>),
    offset: [T; 2],
    (i, j): (usize, usize),
) -> [T; 2] {
    if i < j {
        return pusher.push(a, b, offset, j - i);
    }
    // Adding 0 makes a 0 of −0, so that coincident centres have the same sign from both.
    let [x, y] = offset;
    let push = pusher.push(b, a, [T::ZERO - x, T::ZERO - y], i - j);
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
