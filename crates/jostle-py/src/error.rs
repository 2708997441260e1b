//! Python exceptions: TypeError for a wrong type, ValueError for a wrong value and IdError for an id that nothing has,
//! with messages that begin with the argument, and MemoryError for a failed allocation.

use std::fmt::Display;

use jostle_base::Error;
use pyo3::PyErr;
use pyo3::exceptions::{PyKeyboardInterrupt, PyMemoryError, PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::communicator::RankError;

/// The exception for an error of the core.
#[expect(clippy::needless_pass_by_value, reason = "for map_err")]
pub fn refused(error: Error) -> PyErr {
    match error {
        Error::NoMemory { .. } => PyMemoryError::new_err(error.to_string()),
        // Usually the exception of a signal handler is raised instead, see `interrupt`.
        Error::Interrupted => PyKeyboardInterrupt::new_err(()),
        Error::OtherRank { .. } => RankError::new_err(error.to_string()),
        Error::MissingId { .. } => missing_id(error.to_string()),
        _ => PyValueError::new_err(error.to_string()),
    }
}

/// The exception for an id that nothing has. Its class is Python's: one made here can have only one base.
pub fn missing_id(message: String) -> PyErr {
    Python::attach(|py| {
        let raised = py.import("jostle.errors").and_then(|module| module.getattr("IdError"));
        raised
            .and_then(|class| class.call1((message,)))
            .map_or_else(|error| error, PyErr::from_value)
    })
}

/// The exception for a value of the right type that violates a rule.
pub fn value_error(argument: &str, value: impl Display, rule: &str) -> PyErr {
    PyValueError::new_err(format!("{argument} is {value}; it must be {rule}"))
}

/// The exception for a value of the wrong type.
pub fn type_error(argument: &str, rule: &str, value: &Bound<'_, PyAny>) -> PyErr {
    let found = value.get_type().name().map_or_else(|_| "?".into(), |name| name.to_string());
    PyTypeError::new_err(format!("{argument} must be {rule}, not {found}"))
}
