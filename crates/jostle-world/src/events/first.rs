//! The impacts along the first pieces of a window.
//!
//! Pairs are tested in the order of the candidate pairs, which are near each other in memory. A test
//! in float32 leaves out most of them.

use super::early::StartBlock;
use super::flight::TimeWindow;
use super::neighbors::{Neighbor, Neighbors, opposite};
use super::queue::Event;
use super::{Block, Events};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_simd::{Number, Simd, Work};

/// Candidate pairs that are tested at a time.
const PAIRS: usize = 4096;

/// If at most one of so many discs of a block is not settled, only the neighbours of these are tested.
const FEW: usize = 4;

impl Events {
    /// Finds the first impacts of the neighbours that were found after discs have left their bounds
    /// in an earlier window, and gives them to the blocks of their first discs.
    pub(super) fn find_first_impacts_of_later(&mut self, window: &TimeWindow<'_>) -> Result<()> {
        let Self { neighbors, blocks, size, .. } = self;
        if !window.flight.pairs {
            return Ok(());
        }
        for &(a, neighbor) in neighbors.later() {
            // Both of a pair have it in their lists.
            let pair = [a, neighbor.index];
            // The pair counts once, in the list of its first disc. Otherwise its event would be in
            // the queue twice.
            if is_reversed(window, pair) == Some(false) {
                let event = first_impact(window, neighbors, pair, neighbor.image);
                blocks[a as usize / *size].take(window, event)?;
            }
        }
        Ok(())
    }
}

impl Block {
    /// Finds the impacts along the first pieces of pairs of which a disc of this block is the first.
    /// `unsettled` are the discs of the block that are not settled. `near` is scratch.
    pub(super) fn find_first_impacts(
        &mut self,
        window: &TimeWindow<'_>,
        neighbors: &Neighbors,
        unsettled: &[u32],
        near: &mut Vec<[u32; 2]>,
    ) -> Result<()> {
        if !window.flight.pairs {
            return Ok(());
        }
        // In a pile at rest nearly all discs are settled, and a pass over all pairs would find
        // nothing. With many unsettled discs the pass is better, because it reads memory in order.
        if unsettled.len() <= self.range.len() / FEW {
            self.find_first_impacts_of(window, neighbors, unsettled)?;
        } else {
            self.find_first_impacts_inside(window, neighbors, near)?;
        }
        // A pair across blocks is in the lists of both. `test` gives the event to the block of the
        // first disc alone.
        for &(pair, code) in &neighbors.block(self.number).across {
            let image = neighbors.image_of(code).map(|v| v as f32);
            if may_meet(window, pair, image) {
                self.test(window, neighbors, pair, code)?;
            }
        }
        Ok(())
    }

    /// Finds the impacts of unsettled discs with others of this block. Settled discs have none with each other.
    fn find_first_impacts_of(
        &mut self,
        window: &TimeWindow<'_>,
        neighbors: &Neighbors,
        unsettled: &[u32],
    ) -> Result<()> {
        for &own in unsettled {
            for &Neighbor { index, image: code } in neighbors.at_start(own) {
                // Both of two have the pair in their lists.
                let is_tested = index < own && !window.now[index as usize].is_settled;
                let image = neighbors.image_of(code).map(|v| v as f32);
                if self.range.contains(&index)
                    && !is_tested
                    && may_meet(window, [own, index], image)
                {
                    self.test(window, neighbors, [own, index], code)?;
                }
            }
        }
        Ok(())
    }

    /// Finds the impacts of all pairs of discs of this block.
    fn find_first_impacts_inside(
        &mut self,
        window: &TimeWindow<'_>,
        neighbors: &Neighbors,
        near: &mut Vec<[u32; 2]>,
    ) -> Result<()> {
        // A chunk of pairs at most is near.
        memory::resize(near, PAIRS, [0; 2])?;
        let all = neighbors.block(self.number);
        for (list, range) in &all.inside {
            // The pairs are read where the search has written them. A list of their own for each
            // block would be another copy of all candidate pairs.
            let (image, pairs) = &window.candidates[*list as usize];
            let code = neighbors.code(*list);
            for pairs in pairs[range.start as usize..range.end as usize].chunks(PAIRS) {
                let count = find_near(window, pairs, *image, near);
                for &pair in &near[..count] {
                    self.test(window, neighbors, pair, code)?;
                }
            }
        }
        Ok(())
    }

    /// Takes the impact of two discs, if the first of them belongs to this block.
    fn test(
        &mut self,
        window: &TimeWindow<'_>,
        neighbors: &Neighbors,
        [a, b]: [u32; 2],
        code: u32,
    ) -> Result<()> {
        let (pair, code) = match is_reversed(window, [a, b]) {
            Some(true) => ([b, a], opposite(code)),
            _ => ([a, b], code),
        };
        if !self.range.contains(&pair[0]) {
            return Ok(());
        }
        self.take(window, first_impact(window, neighbors, pair, code))
    }

    /// Adds an event of a disc of this block.
    fn take(&mut self, window: &TimeWindow<'_>, event: Option<Event>) -> Result<()> {
        let Some(event) = event else { return Ok(()) };
        let partner = event.pair[1];
        let is_inside =
            self.range.contains(&partner) || !window.starts[partner as usize].is_movable;
        // Impacts across blocks are not executed. They are conflicts from the beginning, see
        // `find_crossing`.
        memory::push(if is_inside { &mut self.first } else { &mut self.crossing }, event)
    }
}

/// Writes the pairs that may meet to `near`, and returns their number.
fn find_near(
    window: &TimeWindow<'_>,
    pairs: &[[u32; 2]],
    image: [f32; 2],
    near: &mut [[u32; 2]],
) -> usize {
    let near = &mut near[..pairs.len()];
    f32::with_widest(FindNear { window, pairs, image, near })
}

struct FindNear<'a> {
    window: &'a TimeWindow<'a>,
    pairs: &'a [[u32; 2]],
    image: [f32; 2],
    near: &'a mut [[u32; 2]],
}

impl Work<f32> for FindNear<'_> {
    type Out = usize;

    #[inline(always)]
    fn run<S: Simd<f32>>(self, _: S) -> usize {
        let Self { window, pairs, image, near } = self;
        let mut count = 0;
        let mut add = |pair: &[u32; 2], may_meet: u32| {
            // Without branches, because they would often be predicted wrongly.
            near[count] = *pair;
            count += may_meet as usize;
        };
        let mut discs = [StartBlock::default(); 2];
        let (blocks, rest) = pairs.as_chunks();
        for block in blocks {
            let may_meet = window.may_meet_of(block, image, &mut discs);
            block.iter().zip(may_meet).for_each(|(pair, may_meet)| add(pair, may_meet));
        }
        rest.iter().for_each(|pair| add(pair, u32::from(may_meet(window, *pair, image))));
        count
    }
}

#[inline(always)]
fn may_meet(window: &TimeWindow<'_>, pair: [u32; 2], image: [f32; 2]) -> bool {
    window.may_meet(pair.map(|index| &window.now[index as usize]), image)
}

/// Whether the impacts of two discs are those of the second with the first: a movable disc comes
/// first, of two of them that with the smaller index. None if neither is movable.
fn is_reversed(window: &TimeWindow<'_>, [a, b]: [u32; 2]) -> Option<bool> {
    match [a, b].map(|index| window.starts[index as usize].is_movable) {
        [true, true] => Some(b < a),
        [true, false] => Some(false),
        [false, true] => Some(true),
        [false, false] => None,
    }
}

fn first_impact(
    window: &TimeWindow<'_>,
    neighbors: &Neighbors,
    pair: [u32; 2],
    code: u32,
) -> Option<Event> {
    // Discs that have ended count as immovable: one of a pair must move.
    if !pair.iter().any(|&disc| window.now[disc as usize].is_movable) {
        return None;
    }
    let [p, q] = pair.map(|disc| window.piece(disc));
    let image = neighbors.image_of(code);
    // Both have no event in the window yet, so the counts are 0.
    let impact = window.impact((pair[0], &p), (pair[1], &q), image, window.end);
    impact.map(|impact| Event::of_discs(impact, pair, code, [0; 2]))
}
