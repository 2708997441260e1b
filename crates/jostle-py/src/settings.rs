//! Arguments that several calls have, and their defaults.

use jostle_base::settings::{DEFAULT_LEAF_CAPACITY, DEFAULT_MAX_DEPTH, DEFAULT_MAX_PAIRS};
use jostle_base::{Method, Settings};
use jostle_index::{Each, Period, Scalar};
use jostle_world::OnTouch;
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};

use crate::arrays::{Argument, Given, Maybe, count, number, truth, word};
use crate::error::{refused, value_error};
use crate::keywords::Keywords;

// These numbers are written in the signatures.
const _: () = assert!(DEFAULT_MAX_PAIRS == 134_217_728);
const _: () = assert!(DEFAULT_LEAF_CAPACITY == 96);
const _: () = assert!(DEFAULT_MAX_DEPTH == 4096);

/// Maximum number of pairs to return.
pub fn max_pairs(given: &Given<'_>) -> PyResult<usize> {
    given.value().map_or(Ok(DEFAULT_MAX_PAIRS), |value| count("max_pairs", value, 0))
}

/// Width and height of the period of a plane: a number for both, or a pair; 0 or None on an axis that
/// is not periodic.
pub fn period(value: Maybe<'_, '_>) -> PyResult<Period<f64>> {
    let Some(value) = value else { return Ok(Period::default()) };
    let plain = value.is_instance_of::<PyTuple>() || value.is_instance_of::<PyList>();
    let sides = if plain && value.try_iter()?.any(|side| side.is_ok_and(|side| side.is_none())) {
        let zero =
            |side: Bound<'_, PyAny>| if side.is_none() { Ok(0.0) } else { number("period", &side) };
        let sides = value.try_iter()?.map(|side| zero(side?)).collect::<PyResult<Vec<_>>>()?;
        Argument::reals("period", PyTuple::new(value.py(), sides)?.as_any())?
    } else {
        Argument::reals("period", value)?
    };
    match sides.half_sizes(1)? {
        Each::One(sides) => Period::new(sides).map_err(refused),
        Each::Rows(_) => Err(sides.wrong_shape("a number or (2,)")),
    }
}

/// A period in another precision.
pub fn period_in<T: Scalar>(period: Period<f64>) -> jostle_base::Result<Period<T>> {
    Period::new(period.sides().map(T::from_f64))
}

/// The distance of a search for pairs; 0 if omitted.
pub fn distance(given: &Given<'_>) -> PyResult<f64> {
    given.value().map_or(Ok(0.0), |value| number("distance", value))
}

/// Maximum number of shapes in a leaf.
pub fn leaf_capacity(given: &Given<'_>) -> PyResult<usize> {
    given.value().map_or(Ok(DEFAULT_LEAF_CAPACITY), |value| count("leaf_capacity", value, 1))
}

/// Maximum number of subdivisions.
pub fn max_depth(given: &Given<'_>) -> PyResult<usize> {
    given.value().map_or(Ok(DEFAULT_MAX_DEPTH), |value| count("max_depth", value, 0))
}

/// Number of threads; None is one for each core.
pub fn threads(value: Option<&Bound<'_, PyAny>>) -> PyResult<Option<usize>> {
    value.map(|value| count("threads", value, 1)).transpose()
}

/// Number of sub-steps; None is automatic.
pub fn substeps(value: Option<&Bound<'_, PyAny>>) -> PyResult<Option<usize>> {
    value.map(|value| count("substeps", value, 1)).transpose()
}

/// Whether particles may fall asleep; True if omitted.
pub fn sleeping(given: &Given<'_>) -> PyResult<bool> {
    if given.value().is_none() { Ok(true) } else { truth("sleeping", given) }
}

/// Whether pairs that touch are recorded; False if omitted.
pub fn track_events(given: &Given<'_>) -> PyResult<bool> {
    if given.value().is_none() { Ok(false) } else { truth("track_events", given) }
}

/// The method of `find_pairs`; None is the faster one.
pub fn method_or_auto(given: &Given<'_>) -> PyResult<Option<Method>> {
    let rule = "'auto', 'brute' or 'quadtree'";
    match word("method", given, rule)?.as_deref() {
        None | Some("auto") => Ok(None),
        Some("brute") => Ok(Some(Method::Brute)),
        Some("quadtree") => Ok(Some(Method::Quadtree)),
        Some(other) => Err(value_error("method", format!("'{other}'"), rule)),
    }
}

/// The method of a world.
pub fn method(given: &Given<'_>) -> PyResult<Method> {
    let rule = "'quadtree' or 'brute'";
    match word("method", given, rule)?.as_deref() {
        None | Some("quadtree") => Ok(Method::Quadtree),
        Some("brute") => Ok(Method::Brute),
        Some(other) => Err(value_error("method", format!("'{other}'"), rule)),
    }
}

/// The name of a method in Python.
pub fn method_name(method: Method) -> &'static str {
    match method {
        Method::Quadtree => "quadtree",
        Method::Brute => "brute",
    }
}

/// The reaction of particles that touch.
pub fn on_touch(given: &Given<'_>) -> PyResult<OnTouch> {
    let rule = "'bounce', 'merge' or 'ignore'";
    match word("on_touch", given, rule)?.as_deref() {
        None | Some("bounce") => Ok(OnTouch::Bounce),
        Some("merge") => Ok(OnTouch::Merge),
        Some("ignore") => Ok(OnTouch::Ignore),
        Some(other) => Err(value_error("on_touch", format!("'{other}'"), rule)),
    }
}

/// The name of a reaction in Python.
pub fn on_touch_name(on_touch: OnTouch) -> &'static str {
    match on_touch {
        OnTouch::Bounce => "bounce",
        OnTouch::Merge => "merge",
        OnTouch::Ignore => "ignore",
    }
}

/// The settings and the period of a class that holds shapes.
pub fn index(given: &mut Keywords<'_>) -> PyResult<(Settings, Period<f64>)> {
    Ok((tree(given)?, period(given.take_some("period").as_ref())?))
}

/// The settings of a tree.
pub fn tree(given: &mut Keywords<'_>) -> PyResult<Settings> {
    let (leaf_capacity, max_depth) = (given.given("leaf_capacity"), given.given("max_depth"));
    Ok(Settings {
        leaf_capacity: self::leaf_capacity(&leaf_capacity)?,
        max_depth: self::max_depth(&max_depth)?,
        threads: threads(given.take_some("threads").as_ref())?,
    })
}
