//! The events that are expected, the earliest first.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use super::neighbors::opposite;
use crate::trajectory::{Impact, Kind};

/// Takes the place of the partner in an event with a wall.
pub const WALL: u32 = u32::MAX;

/// An impact that happens if the two have no event before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// In seconds since the beginning of the window.
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
}

impl Eq for Event {}

impl Ord for Event {
    fn cmp(&self, other: &Self) -> Ordering {
        // Independent of which of the two predicted the event.
        let rest = |event: &Self| {
            let [a, b] = event.pair;
            if a < b { ([a, b], event.code) } else { ([b, a], opposite(event.code)) }
        };
        self.time.total_cmp(&other.time).then_with(|| rest(self).cmp(&rest(other)))
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
    /// Events that were known at the beginning, the earliest last.
    first: Vec<Event>,
    later: BinaryHeap<Reverse<Event>>,
}

impl Queue {
    /// Replaces all events.
    pub fn fill<'a>(&mut self, first: impl Iterator<Item = &'a Event>) {
        self.later.clear();
        self.first.clear();
        self.first.extend(first);
        self.first.sort_unstable_by(|a, b| b.cmp(a));
    }

    /// Adds an event.
    pub fn push(&mut self, event: Event) {
        self.later.push(Reverse(event));
    }

    /// Removes the earliest event.
    pub fn pop(&mut self) -> Option<Event> {
        match (self.first.last(), self.later.peek()) {
            (Some(first), Some(Reverse(later))) if later < first => {}
            (Some(_), _) => return self.first.pop(),
            (None, _) => {}
        }
        self.later.pop().map(|Reverse(event)| event)
    }
}
