//! How shapes are moved apart, and the checks of it.

use jostle_base::error::{Error, Result};
use jostle_base::settings::Settings;
use jostle_index::geometry::Scalar;
use jostle_index::shapes::{Each, Shapes, check_rects};

/// Default of [`Separation::max_rounds`].
pub const DEFAULT_MAX_ROUNDS: usize = 1000;

/// Default of [`Separation::tolerance`].
pub const DEFAULT_TOLERANCE: f64 = 0.01;

/// How shapes are moved apart.
#[derive(Clone, Debug)]
pub struct Separation<T> {
    /// Weights: of two overlapping shapes, each moves in proportion to the weight of the other.
    pub weights: Each<T>,
    /// Whether shapes may move; the others stay where they are.
    pub movable: Each<bool>,
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
            movable: Each::One(true),
            axis: None,
            gap: T::ZERO,
            bounds: None,
            max_rounds: DEFAULT_MAX_ROUNDS,
            tolerance: T::from_f64(DEFAULT_TOLERANCE),
            threads: None,
        }
    }
}

/// Refuses invalid rules, and shapes that do not fit into the bounds.
pub(crate) fn check<T: Scalar>(shapes: &Shapes<T>, rules: &Separation<T>) -> Result<()> {
    let len = shapes.len();
    Settings { threads: rules.threads, ..Settings::default() }.validate()?;
    rules.weights.check_len("weights", len)?;
    rules.movable.check_len("movable", len)?;
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
    let too_large = |row: &usize| rules.movable.at(*row) && !fits(shapes, *row, rules, bounds);
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
