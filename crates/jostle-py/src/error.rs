//! Errors on their way to Python: a wrong type is a TypeError, a wrong value a
//! ValueError, each a sentence that begins with the argument; what does not fit into
//! memory is a MemoryError.

use std::fmt::Display;

use jostle::Error;
use pyo3::PyErr;
use pyo3::exceptions::{PyKeyboardInterrupt, PyMemoryError, PyTypeError, PyValueError};
use pyo3::prelude::*;

/// What the core refuses is the value, never the type.
#[expect(clippy::needless_pass_by_value, reason = "the shape that map_err wants")]
pub fn refused(error: Error) -> PyErr {
    match error {
        Error::NoMemory { .. } => PyMemoryError::new_err(error.to_string()),
        // An exception of a signal handler was raised before.
        Error::Interrupted => PyKeyboardInterrupt::new_err(()),
        _ => PyValueError::new_err(error.to_string()),
    }
}

/// A value of the right type that breaks a rule.
pub fn value_error(argument: &str, value: impl Display, rule: &str) -> PyErr {
    PyValueError::new_err(format!("{argument} is {value}; it must be {rule}"))
}

/// A value of the wrong type.
pub fn type_error(argument: &str, rule: &str, value: &Bound<'_, PyAny>) -> PyErr {
    let found = value.get_type().name().map_or_else(|_| "?".into(), |name| name.to_string());
    PyTypeError::new_err(format!("{argument} must be {rule}, not {found}"))
}
