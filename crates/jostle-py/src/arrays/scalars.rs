//! Arguments that are one number, one pair, one word, or ids.

use std::fmt::Display;

use jostle_index::Each;
use numpy::PyUntypedArrayMethods;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyInt};

use super::{Argument, Given};
use crate::error::{missing_id, type_error, value_error};

/// One bit set.
pub fn single_mask(name: &'static str, value: &Bound<'_, PyAny>) -> PyResult<u32> {
    let mask = Argument::integers(name, value)?;
    match mask.bits_each(1)? {
        Each::One(mask) => Ok(mask),
        Each::Rows(_) => Err(mask.wrong_shape("an integer")),
    }
}

/// One real number.
pub fn number(name: &str, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    match value.extract::<f64>() {
        Ok(number) if !is_truth(value) => Ok(number),
        _ => Err(type_error(name, "a number", value)),
    }
}

/// An id of 63 bits or an array of ids; `of` is what they identify, for error messages: "shape".
pub fn long_ids(name: &'static str, value: &Bound<'_, PyAny>, of: &str) -> PyResult<Each<i64>> {
    if value.is_instance_of::<PyInt>() && !is_truth(value) {
        return value.extract().map(Each::One).map_err(|_| too_long_id(name, value, of));
    }
    Argument::integers(name, value)?.long_ids(of)
}

/// The error for an integer that is too large for an id.
pub fn too_long_id(name: &str, id: impl Display, of: &str) -> PyErr {
    missing_id(format!("{name} is {id}; no {of} has this id"))
}

/// Two real numbers.
pub fn point(name: &'static str, value: &Bound<'_, PyAny>) -> PyResult<[f32; 2]> {
    let argument = Argument::reals(name, value)?;
    match argument.array.shape() {
        [2] => argument.only(argument.real_pairs()?),
        _ => Err(argument.wrong_shape("(2,)")),
    }
}

/// One integer of at least `min`.
pub fn count(name: &str, value: &Bound<'_, PyAny>, min: usize) -> PyResult<usize> {
    if is_truth(value) {
        return Err(type_error(name, "an integer", value));
    }
    match value.extract::<usize>() {
        Ok(count) if count >= min => Ok(count),
        Err(error) if error.is_instance_of::<PyTypeError>(value.py()) => {
            Err(type_error(name, "an integer", value))
        }
        Err(_) if value.gt(min)? => {
            Err(value_error(name, value, &format!("at most {}", usize::MAX)))
        }
        _ => Err(value_error(name, value, &format!("at least {min}"))),
    }
}

/// True or False; False if omitted.
pub fn truth(name: &str, given: &Given<'_>) -> PyResult<bool> {
    let Some(value) = given.value() else { return Ok(false) };
    value.extract::<bool>().map_err(|_| type_error(name, "True or False", value))
}

/// A string; None if omitted.
pub fn word(name: &str, given: &Given<'_>, rule: &str) -> PyResult<Option<String>> {
    let read = |value: &Bound<'_, PyAny>| {
        value.extract::<String>().map_err(|_| type_error(name, rule, value))
    };
    given.value().map(read).transpose()
}

/// Whether a value is a bool. Python accepts bools as 1 and 0; as arguments they are mistakes.
pub fn is_truth(value: &Bound<'_, PyAny>) -> bool {
    value.is_instance_of::<PyBool>()
}
