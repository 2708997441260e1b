//! The bounds in which discs were searched for neighbours, and the discs that leave them.

use super::Events;
use super::flight::{Start, TimeWindow};
use super::history::NONE;
use super::neighbors::{NearPair, PairList};
use crate::trajectory::{Piece, Vector};
use jostle_base::error::Result;
use jostle_base::memory;

/// Where discs may be during a step, and how to find others that may be there too.
pub trait SweptBounds {
    /// How far discs may get from their positions at the beginning of the part, or when bounds were renewed, within
    /// the bounds in which their neighbours were searched.
    fn reaches(&self) -> &[f32];
    /// Until when they are made, in seconds since the beginning of the flight.
    fn horizon(&self) -> f64;
    /// Makes bounds around the present places of all discs for some of the `left` seconds, and
    /// replaces the pairs that may meet in them. Returns for how many seconds, and whether all discs stay in
    /// their bounds until then if they have no events.
    fn renew(&mut self, now: &[Start], left: f64, to: &mut Candidates) -> Result<(f64, bool)>;
    /// Forgets what was added for the window before.
    fn begin_window(&mut self);
    /// Lets the bounds of discs grow around trajectories in a window that ends at `end`, and appends
    /// the pairs that may meet in them.
    fn grow(
        &mut self,
        outside: &[Outside],
        gravity: Vector,
        end: f64,
        pairs: &mut Vec<NearPair>,
    ) -> Result<()>;
}

/// The pairs that may meet in renewed bounds.
#[derive(Debug, Default)]
pub struct Candidates {
    /// A list for each image, as of the candidate pairs of a step.
    pub pairs: Vec<PairList>,
    /// The offset of the second discs of each list, exactly.
    pub offsets: Vec<Vector>,
    /// The pairs that pass through each other.
    pub sensed: Vec<NearPair>,
    /// Lists that are not in use.
    spare: Vec<Vec<[u32; 2]>>,
}

impl Candidates {
    /// Removes all pairs.
    pub fn clear(&mut self) {
        let lists = self.pairs.drain(..).map(|(_, list)| list);
        self.spare.extend(lists);
        self.spare.iter_mut().for_each(Vec::clear);
        self.offsets.clear();
        self.sensed.clear();
    }

    /// Adds a list; returns its number.
    pub fn add(&mut self, offset: Vector) -> Result<usize> {
        memory::push(&mut self.offsets, offset)?;
        memory::reserve(&mut self.pairs, 1)?;
        self.pairs.push((offset.map(|v| v as f32), self.spare.pop().unwrap_or_default()));
        // So that `clear` finds memory for all lists.
        memory::reserve(&mut self.spare, self.pairs.len())?;
        Ok(self.pairs.len() - 1)
    }
}

/// A disc that leaves its bounds.
#[derive(Clone, Copy, Debug)]
pub struct Outside {
    /// The disc.
    pub index: u32,
    /// How far it gets from its position when the bounds were made, if it has no further events.
    pub distance: f64,
    /// The piece that it is on.
    pub piece: Piece,
}

impl Events {
    /// Adds the neighbours that the discs outside their bounds have in larger bounds.
    pub(super) fn grow(
        &mut self,
        window: &TimeWindow<'_>,
        bounds: &mut dyn SweptBounds,
    ) -> Result<()> {
        self.new.clear();
        if self.outside.is_empty() || !(window.flight.pairs || window.flight.senses_all) {
            return Ok(());
        }
        // Bounds may be larger than watched reaches, and they depend on guesses. So a disc that has left its
        // bounds is a candidate here, and the final trajectories decide.
        if !window.flight.watched_reaches.is_empty() {
            let outside = self.outside.iter().map(|outside| outside.index);
            memory::extend(&mut self.may_be_beyond_reach, outside)?;
        }
        self.near.clear();
        bounds.grow(&self.outside, window.gravity(), window.end, &mut self.near)?;
        // Pairs that pass through each other have no impacts, so they must not become neighbours.
        self.take_sensed(window)?;
        self.neighbors.add(&self.near, &mut self.new)
    }

    /// Lists the discs that get beyond their watched reaches in the window.
    pub(super) fn find_beyond_reach(&mut self, window: &TimeWindow<'_>) -> Result<()> {
        let mut listed = std::mem::take(&mut self.may_be_beyond_reach);
        if !window.flight.watched_reaches.is_empty() {
            // They may be smaller than bounds. Without events only renewed bounds let a disc get
            // further.
            let has_events = |&index: &u32| self.trajectory_of[index as usize] != NONE;
            let all = 0..window.starts.len() as u32;
            let all = all.filter(|index| window.anchors.is_some() || has_events(index));
            memory::extend(&mut listed, all)?;
        }
        // A disc may be listed by several repetitions, and by the rule above.
        listed.sort_unstable();
        listed.dedup();
        for &index in &listed {
            let squares = self.pieces(window, index);
            let anchor = window.flight.anchor(index);
            // `longest_square` follows each piece to the end of the window, also where an event
            // ends it earlier. So the distance is an upper bound, and it follows from the
            // trajectory alone.
            let squares = squares.map(|part| window.longest_square(anchor, &part.piece));
            let distance = squares.fold(0.0, f64::max).sqrt();
            if distance > f64::from(window.flight.watched_reaches[index as usize]) {
                memory::push(&mut self.beyond_reach, (index, distance))?;
            }
        }
        self.may_be_beyond_reach = listed;
        Ok(())
    }
}

/// Lists the discs whose first piece leaves their bounds.
pub(super) fn find_outside_at_start(
    window: &TimeWindow<'_>,
    reaches: &[f32],
    outside: &mut Vec<Outside>,
) -> Result<()> {
    let moves = |start: &Start| start.is_movable || start.velocity != [0.0; 2];
    // First in float32: nearly all discs stay in their bounds, and only for the others is the
    // distance computed in float64.
    let may_leave = |index: u32| window.may_leave(index, reaches[index as usize]);
    let moving = (0..).zip(window.now);
    let moving = moving.filter(|&(index, start)| moves(start) && may_leave(index));
    let all = moving.map(|(index, _)| {
        // Where it was before the window does not matter.
        let piece = window.piece(index);
        let piece = piece.moved(window.begin.max(piece.time), window.gravity());
        let distance = window.longest_square(window.anchor(index), &piece).sqrt();
        Outside { index, distance, piece }
    });
    outside.clear();
    let most = |disc: &Outside| f64::from(reaches[disc.index as usize]);
    memory::extend(outside, all.filter(|disc| disc.distance > most(disc)))
}
