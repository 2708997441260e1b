//! Keyword arguments of a call, with errors that name the call and suggest the right word.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

/// The keywords of a call that are not read yet.
pub struct Keywords<'py> {
    /// The call, for errors: `World()`.
    call: &'static str,
    left: Option<Bound<'py, PyDict>>,
    /// All that the call reads.
    known: Vec<&'static str>,
}

impl<'py> Keywords<'py> {
    /// Those of a call.
    pub fn of(call: &'static str, all: Option<&Bound<'py, PyDict>>) -> PyResult<Self> {
        let left = all.map(|all| all.copy()).transpose()?;
        Ok(Self { call, left, known: Vec::new() })
    }

    /// The value of a keyword, even if it is None.
    pub fn take(&mut self, name: &'static str) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.known.push(name);
        let Some(left) = &self.left else { return Ok(None) };
        let value = left.get_item(name)?;
        if value.is_some() {
            left.del_item(name)?;
        }
        Ok(value)
    }

    /// The value of a keyword, if there is one and it is not None.
    pub fn take_some(&mut self, name: &'static str) -> PyResult<Option<Bound<'py, PyAny>>> {
        Ok(self.take(name)?.filter(|value| !value.is_none()))
    }

    /// Refuses the first keyword that nothing has read.
    pub fn end(self) -> PyResult<()> {
        let Some((name, _)) = self.left.iter().flatten().next() else { return Ok(()) };
        let name = name.cast::<PyString>()?.to_cow()?.into_owned();
        let close = self.known.iter().map(|known| (distance(known, &name), known)).min();
        let hint = match close {
            Some((changes, known)) if changes <= 1 + name.chars().count() / 4 => {
                format!("; did you mean '{known}'?")
            }
            _ => String::new(),
        };
        let call = self.call;
        Err(PyTypeError::new_err(format!(
            "{call} got an unexpected keyword argument '{name}'{hint}"
        )))
    }
}

/// The number of letters that must be added, removed or replaced to turn one word into the other.
fn distance(from: &str, to: &str) -> usize {
    let to: Vec<char> = to.chars().collect();
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (index, a) in from.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = index + 1;
        for (k, &b) in to.iter().enumerate() {
            let replaced = diagonal + usize::from(a != b);
            diagonal = row[k + 1];
            row[k + 1] = replaced.min(row[k] + 1).min(diagonal + 1);
        }
    }
    row[to.len()]
}
