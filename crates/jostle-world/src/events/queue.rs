//! The events that are expected, the earliest first.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use super::neighbors::opposite;
use crate::trajectory::{Impact, Kind};
use jostle_base::error::Result;
use jostle_base::memory;

/// Takes the place of the partner in an event with a wall.
pub const WALL: u32 = u32::MAX;

/// An impact that happens if the two have no event before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// In seconds since the beginning of the flight.
    pub time: f64,
    /// What happens.
    pub kind: Kind,
    /// The image of the partner, or the number of the wall.
    pub code: u32,
    /// The disc and its partner; [`WALL`] for walls.
    pub pair: [u32; 2],
    /// The number of events that each had when this one was predicted.
    pub counts: [u32; 2],
}

impl Event {
    /// The impact of two discs; `code` is the image of the second.
    pub fn of_discs(impact: Impact, pair: [u32; 2], code: u32, counts: [u32; 2]) -> Self {
        let Impact { time, kind } = impact;
        Self { time, kind, code, pair, counts }
    }

    /// The impact of a disc on a wall.
    pub fn with_wall(impact: Impact, index: u32, wall: u32, count: u32) -> Self {
        Self::of_discs(impact, [index, WALL], wall, [count, 0])
    }

    /// The order of two events at the same time, whichever of the two discs predicted each.
    fn cmp_at_once(&self, other: &Self) -> Ordering {
        // Either of the two discs may have predicted the event, so the pair is put in order first.
        // Equal events then compare as equal, and the order of time does not depend on who
        // predicted.
        let rest = |event: &Self| {
            let [a, b] = event.pair;
            if a < b { ([a, b], event.code) } else { ([b, a], opposite(event.code)) }
        };
        rest(self).cmp(&rest(other))
    }
}

impl Eq for Event {}

impl Ord for Event {
    fn cmp(&self, other: &Self) -> Ordering {
        // A total order without ties between different events: the heap may pop equal elements in
        // any order, which would depend on the sequence of pushes.
        self.time.total_cmp(&other.time).then_with(|| self.cmp_at_once(other))
    }
}

impl PartialOrd for Event {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// A queue of events.
#[derive(Debug, Default)]
pub struct Queue {
    /// Events that were known at the beginning.
    first: Vec<Event>,
    /// Their times, and their indices in `first`; the earliest last.
    order: Vec<(f64, u32)>,
    later: BinaryHeap<Reverse<Event>>,
}

impl Queue {
    /// Replaces all events.
    pub fn fill<'a>(&mut self, all: impl Iterator<Item = &'a Event>) -> Result<()> {
        // First events are known all at once. To sort them costs less than to push them one by one,
        // and to pop from the end of a sorted list costs nothing. Later events are few at a time,
        // so they use a heap.
        let Self { first, order, later } = self;
        later.clear();
        first.clear();
        memory::extend(first, all.copied())?;
        order.clear();
        // The sort moves 16 bytes instead of a whole event, and most comparisons need the time
        // alone.
        memory::extend(order, first.iter().map(|event| event.time).zip(0..))?;
        let event = |&(_, at): &(f64, u32)| &first[at as usize];
        order.sort_unstable_by(|a, b| {
            // In descending order, so that the earliest event is the last and is popped without a
            // shift.
            b.0.total_cmp(&a.0).then_with(|| event(b).cmp_at_once(event(a)))
        });
        Ok(())
    }

    /// Adds an event.
    pub fn push(&mut self, event: Event) -> Result<()> {
        if self.later.len() == self.later.capacity() {
            let more = self.later.try_reserve(1);
            let len = self.later.len() + 1;
            more.map_err(|error| memory::no_memory::<Event>(&error, len))?;
        }
        self.later.push(Reverse(event));
        Ok(())
    }

    /// Removes the earliest event.
    pub fn pop(&mut self) -> Option<Event> {
        let first = self.order.last().map(|&(_, at)| self.first[at as usize]);
        match (first, self.later.peek()) {
            // The two lists are merged as they are read. At equal events either may come first.
            (Some(first), Some(Reverse(later))) if *later < first => {}
            (Some(_), _) => {
                self.order.pop();
                return first;
            }
            (None, _) => {}
        }
        self.later.pop().map(|Reverse(event)| event)
    }
}
