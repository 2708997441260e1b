//! The impacts along the first segments of a window.
//!
//! Pairs are tested in the order of the candidate pairs, which are near each other in memory. A test
//! in float32 leaves out most of them.

use super::flight::Window;
use super::neighbors::{Neighbors, opposite};
use super::queue::Event;
use super::{Block, Events};
use crate::interrupt::Stop;
use crate::parallel;

/// Candidate pairs that one thread tests at a time.
const PAIRS: usize = 4096;

/// Some candidate pairs.
#[derive(Debug, Default)]
pub struct Batch {
    /// Those that may meet.
    near: Vec<[u32; 2]>,
    /// Their impacts.
    impacts: Vec<Event>,
}

impl Events {
    /// Finds the impacts of pairs along the first segments, and gives them to the blocks of their
    /// first discs.
    pub(super) fn find_first_impacts(&mut self, window: &Window<'_>) {
        let Self { neighbors, batches, blocks, size, .. } = self;
        if !window.flight.pairs {
            return;
        }
        let parts = || {
            let lists = window.flight.candidates.iter().zip(neighbors.codes());
            lists.flat_map(|((_, pairs), &code)| pairs.chunks(PAIRS).map(move |part| (part, code)))
        };
        let count = parts().count();
        batches.resize_with(batches.len().max(count), Batch::default);
        let (batches, stop) = (&mut batches[..count], Stop::current());
        let tasks = batches.iter_mut().zip(parts());
        parallel::for_each(window.flight.threads, tasks, |(batch, (pairs, code))| {
            batch.impacts.clear();
            if !stop.is_set() {
                batch.test(window, neighbors, pairs, code);
            }
        });
        let mut give = |event: Event| {
            let block: &mut Block = &mut blocks[event.pair[0] as usize / *size];
            let partner = event.pair[1];
            let is_inside =
                block.range.contains(&partner) || !window.starts[partner as usize].is_movable;
            if is_inside { block.first.push(event) } else { block.crossing.push(event) }
        };
        batches.iter().flat_map(|batch| &batch.impacts).for_each(|event| give(*event));
        for &(a, neighbor) in neighbors.later() {
            // Both of a pair have it in their lists.
            let pair = [a, neighbor.index];
            if is_reversed(window, pair) == Some(false) {
                first_impact(window, neighbors, pair, neighbor.image)
                    .into_iter()
                    .for_each(&mut give);
            }
        }
    }
}

impl Batch {
    fn test(&mut self, window: &Window<'_>, neighbors: &Neighbors, pairs: &[[u32; 2]], code: u32) {
        let Self { near, impacts } = self;
        near.resize(pairs.len().max(near.len()), Default::default());
        let image = neighbors.image_of(code).map(|v| v as f32);
        let mut count = 0;
        for pair in pairs {
            let [own, other] = pair.map(|index| &window.starts[index as usize]);
            // Without branches, because they would often be predicted wrongly.
            near[count] = *pair;
            let moves = own.is_movable | other.is_movable;
            count += usize::from(moves & window.may_meet(own, other, image));
        }
        for &[a, b] in &near[..count] {
            let (pair, code) = match is_reversed(window, [a, b]) {
                Some(true) => ([b, a], opposite(code)),
                _ => ([a, b], code),
            };
            impacts.extend(first_impact(window, neighbors, pair, code));
        }
    }
}

/// Whether the impacts of two discs are those of the second with the first: a movable disc comes
/// first, of two of them that with the smaller index. None if neither is movable.
fn is_reversed(window: &Window<'_>, [a, b]: [u32; 2]) -> Option<bool> {
    match [a, b].map(|index| window.starts[index as usize].is_movable) {
        [true, true] => Some(b < a),
        [true, false] => Some(false),
        [false, true] => Some(true),
        [false, false] => None,
    }
}

fn first_impact(
    window: &Window<'_>,
    neighbors: &Neighbors,
    pair: [u32; 2],
    code: u32,
) -> Option<Event> {
    let [p, q] = pair.map(|disc| window.segment(disc));
    let image = neighbors.image_of(code);
    let impact = window.impact((pair[0], &p), (pair[1], &q), image, window.end);
    impact.map(|impact| Event::of_discs(impact, pair, code, [0; 2]))
}
