//! Ids as arguments: one or many, of shapes or of particles.

use jostle_base::Id;
use jostle_index::Each;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyString};

use crate::arrays::long_ids;
use crate::error::type_error;
use crate::queries::result_of;

/// The left operand of `in`; None if it cannot be an id. `hint` says how to test many ids.
pub fn one_id(value: &Bound<'_, PyAny>, hint: &str) -> PyResult<Option<Id>> {
    if !value.is_instance_of::<PyString>() && value.len().is_ok() {
        return Err(type_error("the left side of `in`", &format!("one id; {hint}"), value));
    }
    Ok(if value.is_instance_of::<PyBool>() { None } else { value.extract().ok() })
}

/// The argument `ids` of a call.
pub struct Ids {
    pub all: Vec<Id>,
    /// Whether the argument was one id instead of an array.
    pub single: bool,
}

impl Ids {
    /// Reads the argument; `of` is what they identify, for error messages: "shape".
    pub fn read(value: &Bound<'_, PyAny>, of: &str) -> PyResult<Self> {
        let ids = long_ids("ids", value, of)?;
        let single = matches!(ids, Each::One(_));
        Ok(Self { all: ids.rows(1), single })
    }

    /// As [`result_of`](crate::queries::result_of).
    pub fn result_of<V>(&self, result: jostle_base::Result<V>) -> PyResult<V> {
        result_of(result, self.single)
    }
}
