//! Ids as arguments: one or many, of shapes or of particles.

use jostle_base::Id;
use jostle_index::Each;
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyString};

use crate::arrays::{column, long_ids, too_long_id};
use crate::error::type_error;
use crate::queries::result_of;

/// The argument that is one id; `of` is what it identifies, for error messages: "particle".
pub fn one_id(name: &str, value: &Bound<'_, PyAny>, of: &str) -> PyResult<Id> {
    let refused = |error: PyErr| {
        let is_type = error.is_instance_of::<PyTypeError>(value.py());
        if is_type { type_error(name, "an integer", value) } else { too_long_id(name, value, of) }
    };
    if value.is_instance_of::<PyBool>() {
        return Err(type_error(name, "an integer", value));
    }
    match value.extract::<Id>().map_err(refused)? {
        id if id < 0 => Err(too_long_id(name, id, of)),
        id => Ok(id),
    }
}

/// The left operand of `in`; None if it cannot be an id. `hint` says how to test many ids.
pub fn left_operand(value: &Bound<'_, PyAny>, hint: &str) -> PyResult<Option<Id>> {
    if !value.is_instance_of::<PyString>() && value.len().is_ok() {
        return Err(type_error("the left side of `in`", &format!("one id; {hint}"), value));
    }
    Ok(if value.is_instance_of::<PyBool>() { None } else { value.extract().ok() })
}

/// The rows of ids in an array of any shape, in an array of this shape; of one id one row. `of` is what they
/// identify, `rows_of` finds the rows.
pub fn rows_of_any_shape<'py>(
    ids: &Bound<'py, PyAny>,
    of: &str,
    rows_of: impl FnOnce(&[Id]) -> PyResult<jostle_base::Result<Vec<i64>>>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = ids.py();
    let array = py.import("numpy")?.call_method1("asarray", (ids,))?;
    let shape = array.getattr("shape")?;
    // A list stays as it is, because its error names the first item that is no integer.
    let is_flat = shape.len()? < 2;
    let flat = if is_flat { ids.clone() } else { array.call_method1("reshape", (-1,))? };
    let ids = Ids::read(&flat, of)?;
    let rows = ids.result_of(rows_of(&ids.all)?)?;
    if ids.single {
        return rows[0].into_bound_py_any(py);
    }
    let rows = column(py, rows).into_any();
    if is_flat { Ok(rows) } else { rows.call_method1("reshape", (shape,)) }
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
