//! Moving overlapping shapes apart.
//!
//! The shapes are put into Morton order, ties by their values (`bodies`). If more shapes lie in a
//! region than fit there, `spread` first enlarges the region. `rounds` then moves overlapping pairs
//! apart in repeated rounds over lists of near pairs (`near`), each pair along its contact normal
//! (`push`). Along one axis, `sweep` places the shapes one after another where the rounds do not
//! succeed.
//!
//! T. Dwyer, K. Marriott, P. Stuckey, *Fast Node Overlap Removal*, Graph Drawing (2005), for the
//! task. M. Müller et al., *Position Based Dynamics*, J. Vis. Commun. Image Represent. (2007),
//! for the rounds.

#![warn(unreachable_pub)]
#![warn(clippy::disallowed_macros, clippy::disallowed_methods, clippy::disallowed_types)]

mod rules;
mod bodies;
mod push;
mod near;
mod rounds;
mod spread;
mod taken;
mod sweep;
mod insert;

use bodies::{Bodies, Input};
use jostle_base::error::Result;
use jostle_base::{memory, parallel};
use jostle_index::geometry::Scalar;
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::Shapes;
use push::Pusher;
use rounds::{Outcome, Rounds};
pub use rules::{DEFAULT_MAX_ROUNDS, DEFAULT_TOLERANCE, Separation};

/// Centres after [`separate`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Separated<T> {
    /// The new centres, one for each shape.
    pub centers: Vec<[T; 2]>,
    /// Number of rounds over all pairs, at most the maximum. Placing along an axis counts as one.
    pub rounds: usize,
    /// Number of pairs that still overlap, without those of two fixed shapes.
    pub overlaps: usize,
}

/// Moves shapes until none overlap, or until the maximum number of rounds is reached. Filters are
/// ignored, and shapes input as boxes are moved by their centres.
///
/// ```
/// # mod jostle {
/// #     pub use jostle_base::error::Error;
/// #     pub use jostle_index::{Each, Shapes};
/// #     pub use jostle_separate::{Separation, separate};
/// # }
/// use jostle::{Each, Separation, Shapes, separate};
/// let discs = Shapes::circles(vec![[0.0, 0.0], [1.0, 0.0]], Each::One(1.0))?;
/// let apart = separate(&discs, &Separation::default())?;
/// assert!(apart.overlaps == 0 && apart.centers[1][0] - apart.centers[0][0] >= 2.0);
/// # Ok::<(), jostle::Error>(())
/// ```
pub fn separate<T: Scalar>(shapes: &Shapes<T>, rules: &Separation<T>) -> Result<Separated<T>> {
    rules::check(shapes, rules)?;
    let threads = parallel::worthwhile(rules.threads, shapes.len());
    let rules = Separation { threads, ..rules.clone() };
    let input = Input::of(shapes, &rules)?;
    // Only the search for near pairs is in float32, with radii enlarged by its rounding errors: it
    // may list a pair too many, never one too few. What is moved, and how far, is computed in the
    // caller's type.
    if input.fits_single(rules.gap) {
        run::<T, f32>(&input, &rules)
    } else {
        run::<T, T>(&input, &rules)
    }
}

/// Moves the shapes; near pairs are found in the arithmetic of `K`.
fn run<T: Scalar, K: Scalar>(input: &Input<T>, rules: &Separation<T>) -> Result<Separated<T>> {
    // The tree that sorts the shapes also has the bounds of the first lists, so it is used twice.
    let (mut bodies, tree) = Bodies::sorted::<K>(input, rules)?;
    let crowded = spread::is_crowded(&tree, &bodies, rules.gap)?;
    let pusher = Pusher::of(rules);
    let outcome = match rules.axis {
        Some(axis) => along_axis(&mut bodies, axis, rules, (&pusher, crowded, &tree))?,
        None => in_plane(&mut bodies, rules, (&pusher, crowded, &tree))?,
    };
    let mut centers = memory::filled(bodies.len(), [T::ZERO; 2])?;
    for (&row, &center) in bodies.rows.iter().zip(&bodies.centers) {
        centers[row as usize] = center;
    }
    Ok(Separated { centers, rounds: outcome.rounds, overlaps: outcome.overlaps })
}

/// If the number of overlaps falls too slowly, regions are enlarged until shapes cover a small
/// share of them, and shapes that still overlap are moved to free positions.
fn in_plane<T: Scalar, K: Scalar>(
    bodies: &mut Bodies<T>,
    rules: &Separation<T>,
    (pusher, crowded, tree): (&Pusher<T>, bool, &Quadtree<K>),
) -> Result<Outcome> {
    let is_spread = crowded && rules.max_rounds >= FEW_ROUNDS;
    if is_spread {
        // Rounds push only neighbours. Where shapes lie many deep, the ones in the middle cannot
        // move until those at the edge have, so the number of rounds grows with the width of the
        // heap. Enlarging takes one pass.
        spread::spread(bodies, rules, spread::FULL)?;
    }
    let mut rounds = Rounds::of(bodies, pusher, rules, (!is_spread).then_some(tree))?;
    let mut done = rounds.run(false)?;
    // Many shapes still overlap: the region as a whole is too small, also if no part of it was
    // found crowded.
    if !done && rounds.to_take_out()?.len() > shapes_worth_spreading(&rounds) {
        rounds.change(|bodies| spread::spread(bodies, rules, spread::LOOSE))?;
        done = rounds.run(false)?;
    }
    if !done {
        // What is left are single shapes among others that fit. Each moves once, to a place of its
        // own; this always ends, and at most these shapes move far.
        let indices = rounds.to_take_out()?;
        rounds.change(|bodies| insert::insert(bodies, &indices, pusher, rules))?;
    }
    Ok(rounds.outcome())
}

/// With fewer rounds crowded regions are not enlarged: games spread motion over many calls, and it
/// has to be smooth.
const FEW_ROUNDS: usize = 32;

/// If more shapes than this overlap after the first rounds, the whole region is enlarged.
fn shapes_worth_spreading<T: Scalar, K: Scalar>(rounds: &Rounds<'_, T, K>) -> usize {
    64 + rounds.len() / 64
}

/// Crowded shapes up to this number are moved in rounds along an axis.
const FEW: usize = 1000;

/// Rounds keep the order along the axis; if they do not succeed, or if very many shapes are
/// `crowded`, `sweep` places them.
fn along_axis<T: Scalar, K: Scalar>(
    bodies: &mut Bodies<T>,
    axis: usize,
    rules: &Separation<T>,
    (pusher, crowded, tree): (&Pusher<T>, bool, &Quadtree<K>),
) -> Result<Outcome> {
    let before = memory::collect(bodies.centers.iter().copied())?;
    let mut done = 0;
    // Few, or not crowded: rounds keep shapes near their places. A long crowded row needs too many
    // of them, since each push has to be passed on from neighbour to neighbour.
    if rules.max_rounds == 0 || !crowded || bodies.len() <= FEW {
        let mut rounds = Rounds::of(bodies, pusher, rules, Some(tree))?;
        rounds.run(true)?;
        let outcome = rounds.outcome();
        if outcome.overlaps == 0 || rules.max_rounds == 0 {
            return Ok(outcome);
        }
        // The sweep begins with the places that the caller wanted, not with what the rounds have
        // made of them.
        bodies.centers = before;
        done = outcome.rounds;
    }
    let last = Separation { max_rounds: 0, ..rules.clone() };
    sweep::place(bodies, axis, pusher, rules)?;
    let outcome = Rounds::<T, K>::of(bodies, pusher, &last, None)?.outcome();
    Ok(Outcome { rounds: rules.max_rounds.min(done + 1), ..outcome })
}
