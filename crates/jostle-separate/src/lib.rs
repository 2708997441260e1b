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

mod bodies;
mod spread;
mod push;
mod near;
mod rounds;
mod taken;
mod sweep;
mod insert;

use bodies::{Bodies, Input};
use jostle_base::error::{Error, Result};
use jostle_base::settings::Settings;
use jostle_base::{memory, parallel};
use jostle_index::geometry::Scalar;
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::{Each, Shapes, check_rects};
use push::Pusher;
use rounds::Rounds;

/// Default of [`Separation::max_rounds`].
pub const DEFAULT_MAX_ROUNDS: usize = 1000;

/// Default of [`Separation::tolerance`].
pub const DEFAULT_TOLERANCE: f64 = 0.01;

/// How shapes are moved apart.
#[derive(Clone, Debug)]
pub struct Separation<T> {
    /// Weights: of two overlapping shapes, each moves in proportion to the weight of the other.
    pub weights: Each<T>,
    /// Whether shapes stay where they are.
    pub fixed: Each<bool>,
    /// The only axis along which shapes move, 0 or 1; None for both.
    pub axis: Option<usize>,
    /// Least distance between the surfaces of two shapes.
    pub gap: T,
    /// Min x, min y, max x, max y of the region in which movable shapes stay; with an axis, along
    /// this axis alone.
    pub bounds: Option<[T; 4]>,
    /// Maximum number of rounds.
    pub max_rounds: usize,
    /// Distance beyond touching to which overlapping shapes are moved, as a share of their size.
    pub tolerance: T,
    /// Number of threads; None: one for each core.
    pub threads: Option<usize>,
}

impl<T: Scalar> Default for Separation<T> {
    fn default() -> Self {
        Self {
            weights: Each::One(T::ONE),
            fixed: Each::One(false),
            axis: None,
            gap: T::ZERO,
            bounds: None,
            max_rounds: DEFAULT_MAX_ROUNDS,
            tolerance: T::from_f64(DEFAULT_TOLERANCE),
            threads: None,
        }
    }
}

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
    check(shapes, rules)?;
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

/// Number of rounds, and of the pairs that overlap after them.
#[derive(Clone, Copy, Debug, Default)]
struct Outcome {
    rounds: usize,
    overlaps: usize,
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

fn check<T: Scalar>(shapes: &Shapes<T>, rules: &Separation<T>) -> Result<()> {
    let len = shapes.len();
    Settings { threads: rules.threads, ..Settings::default() }.validate()?;
    rules.weights.check_len("weights", len)?;
    rules.fixed.check_len("fixed", len)?;
    rules.weights.check(|weights| {
        let fits = |w: &T| *w > T::ZERO && *w <= T::MAX_SIZE;
        // NaN fails the comparisons and is refused like any other weight.
        let Some(index) = weights.iter().position(|w| !fits(w)) else { return Ok(()) };
        let rule = format!("a weight must be above 0 and at most {:e}", T::MAX_SIZE.to_f64());
        Err(Error::at("weights", index, weights[index], &rule))
    })?;
    if !(rules.gap >= T::ZERO && rules.gap <= T::MAX_SIZE) {
        let rule = format!("a gap must be at least 0 and at most {:e}", T::MAX_SIZE.to_f64());
        return Err(Error::of("gap", rules.gap, &rule));
    }
    if !(rules.tolerance >= T::ZERO && rules.tolerance <= T::ONE) {
        return Err(Error::of("tolerance", rules.tolerance, "it must be between 0 and 1"));
    }
    if rules.axis.is_some_and(|axis| axis > 1) {
        return Err(Error::of("axis", rules.axis.unwrap_or(0), "it must be 0 or 1"));
    }
    let Some(bounds) = rules.bounds else { return Ok(()) };
    check_rects("bounds", &[bounds]).map_err(Error::without_row)?;
    let too_large = |row: &usize| !rules.fixed.at(*row) && !fits(shapes, *row, rules, bounds);
    match (0..len).find(too_large) {
        None => Ok(()),
        Some(row) => {
            let text = jostle_index::shapes::tuple(&bounds);
            Err(Error::of("bounds", text, &format!("shape {row} is larger than they are")))
        }
    }
}

/// Whether a shape fits into the bounds along the axes along which it may move.
fn fits<T: Scalar>(shapes: &Shapes<T>, row: usize, rules: &Separation<T>, bounds: [T; 4]) -> bool {
    let shape = shapes.shape(row);
    let half = shape.core_half_size();
    (0..2).filter(|&axis| rules.axis.is_none_or(|only| only == axis)).all(|axis| {
        let extent = half[axis] + shape.radius;
        bounds[axis] + extent <= bounds[axis + 2] - extent
    })
}
