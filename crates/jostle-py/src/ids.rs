//! The ids in a call: of shapes or of particles, one or many.

use jostle::{Each, Id};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyString};

use crate::arrays::long_ids;
use crate::error::type_error;
use crate::queries::told;

/// The left side of `in`; None if it is nothing that may be an id. `hint` says what to do with many.
pub fn one_id(value: &Bound<'_, PyAny>, hint: &str) -> PyResult<Option<Id>> {
    if !value.is_instance_of::<PyString>() && value.len().is_ok() {
        return Err(type_error("the left side of `in`", &format!("one id; {hint}"), value));
    }
    Ok(if value.is_instance_of::<PyBool>() { None } else { value.extract().ok() })
}

/// What a call is about.
pub struct Ids {
    pub all: Vec<Id>,
    /// Whether it was one id and no array.
    pub single: bool,
}

impl Ids {
    /// Reads the argument `ids`; `of` says what they identify: "shape".
    pub fn read(value: &Bound<'_, PyAny>, of: &str) -> PyResult<Self> {
        let ids = long_ids("ids", value, of)?;
        let single = matches!(ids, Each::One(_));
        Ok(Self { all: ids.rows(1), single })
    }

    /// Where one id was given, an error names no row.
    pub fn told<V>(&self, done: jostle::Result<V>) -> PyResult<V> {
        told(done, self.single)
    }
}
