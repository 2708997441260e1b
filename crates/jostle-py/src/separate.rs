//! `jostle.separate`.

use jostle_index::{Each, Scalar};
use jostle_separate::Separation;
use jostle_separate::{DEFAULT_MAX_ROUNDS, DEFAULT_TOLERANCE};
use numpy::Element;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Argument, Given, count, number, reals};
use crate::error::{refused, value_error};
use crate::interrupt::detached;
use crate::keywords::read_of_function;
use crate::queries::Maybe;
use crate::results;
use crate::settings;
use crate::shapes::{Rows, Shapes};

/// Move shapes apart until none overlap.
///
/// Overlapping pairs move apart along their contact normals, in repeated rounds over all near
/// pairs. Of each pair the shape with the larger weight moves less. A region with more shapes than
/// fit into it is enlarged first. A few shapes that still overlap move to the nearest free
/// positions. Shapes that overlap nothing do not move, unless others push them.
///
/// Parameters
/// ----------
/// positions : array_like, shape (n, 2)
///     Centres, in any unit of length.
/// radii : array_like, a number or shape (n,), default 0.0
///     Radii, in the same unit.
/// half_sizes : array_like, a number, shape (2,) or (n, 2), optional
///     Half widths and half heights. If omitted, every shape is a circle.
/// weights : array_like, a number or shape (n,), default 1.0
///     Weights above 0. Of two overlapping shapes, one with twice the weight of the other moves
///     half as far.
/// movable : array_like of bool, True or False or shape (n,), default True
///     Whether shapes may move; the others stay where they are. Pairs of two others may overlap.
/// axis : {0, 1}, optional
///     Move the shapes only along x (0) or only along y (1). If rounds do not succeed, the shapes
///     are placed one after another at the nearest free positions, as in a swarm plot.
/// gap : float, default 0.0
///     Least distance between the surfaces of two shapes.
/// bounds : array_like, shape (4,), optional
///     Region as min_x, min_y, max_x, max_y: all movable shapes are moved inside
///     entirely; with `axis`, along that axis alone.
/// max_rounds : int, default 1000
///     Maximum number of rounds. A small number, such as 8, spreads motion over several calls;
///     with fewer than 32, crowded regions are not enlarged.
/// tolerance : float, default 0.01
///     Overlapping shapes are moved apart by this share of their size more than needed. A smaller
///     number needs more rounds.
/// threads : int, optional
///     Number of threads, at most one for each core, which is the default. The answer is the
///     same for every number.
///
/// Returns
/// -------
/// Separated
///     The new positions, and the number of remaining overlaps.
///
///     positions : ndarray of float32 or float64, shape (n, 2)
///         The new centres.
///     rounds : int
///         Number of rounds, at most `max_rounds`; placing along an axis counts as one.
///     overlaps : int
///         Number of pairs that still overlap, or are closer than `gap`, without pairs of two
///         that may not move; 0 if the shapes are separated.
///
/// Raises
/// ------
/// TypeError
///     If an argument has the wrong type.
/// ValueError
///     If a shape is wrong, a value is out of range, or a shape is larger than `bounds`.
///
/// See Also
/// --------
/// find_pairs : The pairs that overlap.
///
/// Notes
/// -----
/// Arithmetic is float32 if every given array is float32, otherwise float64. The order of the
/// shapes has no effect, except that it distinguishes shapes with equal values at the same
/// place. If the bounds are too small for the shapes, some overlap at the end.
///
/// References
/// ----------
/// T. Dwyer, K. Marriott, P. Stuckey, *Fast Node Overlap Removal*, Graph Drawing (2005).
/// M. Müller et al., *Position Based Dynamics*, Journal of Visual Communication and Image
/// Representation 18 (2007).
///
/// Examples
/// --------
/// >>> import jostle
/// >>> apart = jostle.separate([(0, 0), (1, 0), (9, 0)], radii=1.0, tolerance=0)
/// >>> apart.positions.round(3)
/// array([[-0.5,  0. ],
///        [ 1.5,  0. ],
///        [ 9. ,  0. ]])
/// >>> apart.overlaps
/// 0
#[pyfunction]
#[pyo3(
    signature = (
        positions=Given::NOTHING, radii=Given::NOTHING, half_sizes=None, *, weights=Given::NOTHING, movable=None,
        axis=None, gap=Given::NOTHING, bounds=None, max_rounds=Given::NOTHING,
        tolerance=Given::NOTHING, threads=None, **unknown),
    text_signature = "(positions, radii=0.0, half_sizes=None, *, weights=1.0, movable=True, \
                      axis=None, gap=0.0, bounds=None, max_rounds=1000, tolerance=0.01, \
                      threads=None)"
)]
#[expect(clippy::too_many_arguments, reason = "they are Python's keywords")]
pub fn separate<'py>(
    py: Python<'py>,
    positions: Given<'py>,
    radii: Given<'py>,
    half_sizes: Maybe<'_, 'py>,
    weights: Given<'py>,
    movable: Maybe<'_, 'py>,
    axis: Maybe<'_, 'py>,
    gap: Given<'py>,
    bounds: Maybe<'_, 'py>,
    max_rounds: Given<'py>,
    tolerance: Given<'py>,
    threads: Maybe<'_, 'py>,
    unknown: Option<&Bound<'_, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    let [positions] = read_of_function("separate", unknown, [("positions", &positions)])?;
    let read = |name, given: &Given<'py>, default| {
        given.value().map_or(Ok(default), |value| number(name, value))
    };
    let rules = Rules {
        weights,
        movable: movable.map(|value| Argument::booleans("movable", value)).transpose()?,
        axis: axis.map(read_axis).transpose()?,
        gap: read("gap", &gap, 0.0)?,
        bounds: bounds.map(|bounds| Argument::reals("bounds", bounds)).transpose()?,
        max_rounds: match max_rounds.value() {
            None => DEFAULT_MAX_ROUNDS,
            Some(value) => count("max_rounds", value, 0)?,
        },
        tolerance: read("tolerance", &tolerance, DEFAULT_TOLERANCE)?,
        threads: settings::threads(threads)?,
    };
    match Shapes::read([Some(positions), half_sizes, None, None], &radii, [None, None])? {
        Shapes::Single(rows) => rules.run(py, rows),
        Shapes::Double(rows) => rules.run(py, rows),
    }
}

fn read_axis(value: &Bound<'_, PyAny>) -> PyResult<usize> {
    match count("axis", value, 0)? {
        axis @ (0 | 1) => Ok(axis),
        other => Err(value_error("axis", other, "0 or 1")),
    }
}

/// The arguments except the shapes.
struct Rules<'py> {
    weights: Given<'py>,
    movable: Option<Argument<'py>>,
    axis: Option<usize>,
    gap: f64,
    bounds: Option<Argument<'py>>,
    max_rounds: usize,
    tolerance: f64,
    threads: Option<usize>,
}

impl Rules<'_> {
    fn run<'py, T: Scalar + Element>(
        &self,
        py: Python<'py>,
        rows: Rows<T>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let bounds = match &self.bounds {
            None => None,
            Some(bounds) => match bounds.one_or_rows::<T, 4>()? {
                Each::One(one) => Some(one),
                Each::Rows(_) => return Err(bounds.wrong_shape("(4,)")),
            },
        };
        let rules = Separation {
            weights: reals("weights", self.weights.value(), rows.len())?
                .unwrap_or(Each::One(T::ONE)),
            movable: match &self.movable {
                None => Each::One(true),
                Some(movable) => movable.truth_each(rows.len())?,
            },
            axis: self.axis,
            gap: T::from_f64(self.gap),
            bounds,
            max_rounds: self.max_rounds,
            tolerance: T::from_f64(self.tolerance),
            threads: self.threads,
        };
        let apart = detached(py, || jostle_separate::separate(&rows.checked()?, &rules))?;
        results::separated(py, apart.map_err(refused)?)
    }
}
