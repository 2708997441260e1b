//! Passes over the near pairs.
//!
//! Within a chunk of places, each pair is moved as soon as it is tested (Gauss-Seidel). Of a pair
//! in two chunks, each moves its own part, and takes the other where it was before the pass
//! (Jacobi). Chunks depend on the order of the shapes alone, so results do not depend on threads.

use std::sync::Mutex;

use super::bodies::Bodies;
use super::near::{BLOCK, Near, places_of};
use super::push::Pusher;
use super::{Outcome, Separation};
use crate::error::Result;
use crate::geometry::Scalar;
use crate::interrupt;
use crate::memory;
use crate::parallel::{self, CHUNK, locked};

/// After so many passes the number of overlaps must have fallen by a tenth; otherwise passes end.
const PATIENCE: usize = 32;

/// A chunk of shapes during a pass.
struct Part<T> {
    /// Their centres.
    centers: Vec<[T; 2]>,
    /// Whether a shape of each block has moved in this pass.
    changed: Vec<bool>,
    /// Pairs that overlapped when they were tested.
    overlaps: usize,
    /// Whether a centre has changed.
    moved: bool,
    /// Whether a shape is beyond the reach of its list.
    left: bool,
}

/// The passes of a call.
pub struct Rounds<'a, T> {
    bodies: &'a mut Bodies<T>,
    pusher: Pusher<T>,
    rules: &'a Separation<T>,
    near: Near<T>,
    /// Whether a shape of each block has moved in the last pass, or may overlap since then.
    changed: Vec<bool>,
    parts: Vec<Mutex<Part<T>>>,
    /// Number of passes.
    count: usize,
}

impl<'a, T: Scalar> Rounds<'a, T> {
    /// Lists the near pairs.
    pub fn of(
        bodies: &'a mut Bodies<T>,
        pusher: &'a Pusher<T>,
        rules: &'a Separation<T>,
    ) -> Result<Self> {
        let len = bodies.len();
        let part = |index| {
            let len = places_of(index, len).len();
            let centers = memory::filled(len, [T::ZERO; 2])?;
            let changed = memory::filled(len.div_ceil(BLOCK), false)?;
            Ok(Mutex::new(Part { centers, changed, overlaps: 0, moved: false, left: false }))
        };
        let parts = (0..len.div_ceil(CHUNK)).map(part).collect::<Result<Vec<_>>>()?;
        let near = Near::of(bodies, rules.gap)?;
        let changed = memory::filled(len.div_ceil(BLOCK), true)?;
        let mut rounds = Self { bodies, pusher: *pusher, rules, near, changed, parts, count: 0 };
        if rules.max_rounds > 0 {
            rounds.enter_bounds();
        }
        rounds.find_near()?;
        Ok(rounds)
    }

    /// Moves shapes until none overlap or for `max_rounds` passes in all; returns false if it
    /// ends earlier, because passes are of little use. It does not if it is `patient`.
    pub fn run(&mut self, patient: bool) -> Result<bool> {
        let mut before = usize::MAX;
        while self.count < self.rules.max_rounds {
            interrupt::check()?;
            self.pusher = self.pusher.in_pass(self.count);
            self.count += 1;
            let (overlaps, moved) = self.pass()?;
            if overlaps == 0 && !moved {
                return Ok(true);
            }
            let is_due = !patient && self.count.is_multiple_of(PATIENCE);
            if !moved || (is_due && overlaps > before - before / 10) {
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
        self.find_near()
    }

    /// The number of passes, and of the pairs that overlap.
    pub fn outcome(&self) -> Outcome {
        Outcome { rounds: self.count, overlaps: self.overlaps() }
    }

    /// Number of shapes.
    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    fn find_near(&mut self) -> Result<()> {
        self.changed.fill(true);
        self.near.find(self.bodies, self.rules.threads)
    }

    /// One pass; returns the number of overlaps that it met, and whether a shape has moved.
    fn pass(&mut self) -> Result<(usize, bool)> {
        let this = &*self;
        parallel::for_tasks(self.rules.threads, self.parts.len(), |index| {
            this.pass_over(index, &mut locked(&this.parts[index]));
        });
        let (mut overlaps, mut moved, mut left) = (0, false, false);
        for (index, part) in self.parts.iter_mut().enumerate() {
            let part = part.get_mut().unwrap_or_else(std::sync::PoisonError::into_inner);
            overlaps += part.overlaps;
            moved |= part.moved;
            left |= part.left;
            let places = places_of(index, self.bodies.centers.len());
            let blocks = places.start / BLOCK..places.end.div_ceil(BLOCK);
            self.bodies.centers[places].copy_from_slice(&part.centers);
            self.changed[blocks].copy_from_slice(&part.changed);
        }
        if left {
            self.find_near()?;
        }
        Ok((overlaps, moved))
    }

    fn pass_over(&self, index: usize, part: &mut Part<T>) {
        let places = places_of(index, self.bodies.len());
        let first = places.start;
        part.centers.copy_from_slice(&self.bodies.centers[places]);
        part.changed.fill(false);
        part.overlaps = 0;
        for block in 0..part.changed.len() {
            let near = self.near.of_block(first / BLOCK + block);
            let is_changed = |&other: &u32| {
                let other = other as usize;
                let own = part.changed.get(other.wrapping_sub(first / BLOCK));
                self.changed[other] || own.is_some_and(|changed| *changed)
            };
            // Otherwise no pair of the block overlapped when it was tested, and none has moved.
            if near.iter().any(is_changed) {
                self.pass_over_block(first + block * BLOCK, first, part);
            }
        }
        self.end_pass(index, part);
    }

    /// Moves the pairs of a block of a chunk, whose first places are given.
    fn pass_over_block(&self, start: usize, first: usize, part: &mut Part<T>) {
        let Bodies { all, centers, .. } = &*self.bodies;
        let own = &mut part.centers[..];
        for i in start..(start + BLOCK).min(first + own.len()) {
            let a = &all[i];
            let mut center = own[i - first];
            for &other in self.near.of_place(i) {
                let j = other as usize;
                let b = &all[j];
                let here = j.wrapping_sub(first) < own.len();
                let at = if here { own[j - first] } else { centers[j] };
                let offset = [at[0] - center[0], at[1] - center[1]];
                if !self.pusher.overlaps(a, b, offset) {
                    continue;
                }
                part.overlaps += 1;
                part.changed[(i - first) / BLOCK] = true;
                let push = ordered_push(&self.pusher, (a, b), offset, (i, j));
                let share = share(a.weight, b.weight);
                center = [center[0] - push[0] * share, center[1] - push[1] * share];
                if here {
                    let rest = T::ONE - share;
                    own[j - first] = [at[0] + push[0] * rest, at[1] + push[1] * rest];
                    part.changed[(j - first) / BLOCK] = true;
                }
            }
            own[i - first] = center;
        }
    }

    /// Moves the shapes of a chunk into the bounds, and compares with the state before the pass.
    fn end_pass(&self, index: usize, part: &mut Part<T>) {
        let places = places_of(index, self.bodies.len());
        let reach = self.near.reach();
        (part.moved, part.left) = (false, false);
        for (place, center) in places.clone().zip(&mut part.centers) {
            let inside = self.inside(place, *center);
            part.changed[(place - places.start) / BLOCK] |= inside != *center;
            *center = inside;
            let origin = self.near.origins[place];
            let away = [center[0] - origin[0], center[1] - origin[1]].map(T::abs);
            part.moved |= *center != self.bodies.centers[place];
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

    fn enter_bounds(&mut self) {
        for place in 0..self.bodies.len() {
            self.bodies.centers[place] = self.inside(place, self.bodies.centers[place]);
        }
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
                if is_out[i] || is_out[j] || !self.pusher.overlaps(a, &all[j], offset) {
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
                twice += usize::from(self.pusher.overlaps(a, &all[j], offset)) * counted;
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
