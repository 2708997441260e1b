//! Refusal of `numpy.ma` arrays with masked elements, because a copy would include these.

use numpy::PyUntypedArray;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};

/// Refuses masked elements of an array, or of the arrays in a list or a tuple.
pub fn refuse_masked(name: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
    if is_array(value) {
        return match first_masked(value)? {
            None => Ok(()),
            Some(index) => {
                let row = index.first().map_or_else(String::new, |row| format!("[{row}]"));
                Err(refusal(&format!("{name}{row}")))
            }
        };
    }
    if let Ok(list) = value.cast::<PyList>() {
        refuse_masked_rows(name, list.iter())
    } else if let Ok(tuple) = value.cast::<PyTuple>() {
        refuse_masked_rows(name, tuple.iter())
    } else {
        Ok(())
    }
}

/// Lists of numbers are not searched: only lists whose first item is an array.
fn refuse_masked_rows<'py>(
    name: &str,
    items: impl Iterator<Item = Bound<'py, PyAny>>,
) -> PyResult<()> {
    let mut items = items.enumerate().peekable();
    if items.peek().is_some_and(|(_, first)| is_array(first)) {
        for (row, item) in items {
            if is_array(&item) && first_masked(&item)?.is_some() {
                return Err(refusal(&format!("{name}[{row}]")));
            }
        }
    }
    Ok(())
}

fn is_array(value: &Bound<'_, PyAny>) -> bool {
    value.cast::<PyUntypedArray>().is_ok()
}

/// The index of the first masked element of an array; empty for a single number.
fn first_masked(array: &Bound<'_, PyAny>) -> PyResult<Option<Vec<usize>>> {
    if array.cast_exact::<PyUntypedArray>().is_ok() {
        return Ok(None);
    }
    let numpy = array.py().import("numpy")?;
    let ma = numpy.getattr("ma")?;
    if !array.is_instance(&ma.getattr("MaskedArray")?)? {
        return Ok(None);
    }
    let mask = ma.call_method1("getmaskarray", (array,))?;
    let indices = numpy.call_method1("argwhere", (mask,))?.call_method0("tolist")?;
    indices.try_iter()?.next().transpose()?.map(|first| first.extract()).transpose()
}

fn refusal(what: &str) -> PyErr {
    PyValueError::new_err(format!(
        "{what} is masked, and masks are not read; leave out the masked rows, or give the array \
         that its method filled returns"
    ))
}
