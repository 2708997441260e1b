//! Messages between ranks, by an object of `jostle.mpi`.

use jostle_base::{Error, Result};
use jostle_world::Communicator;
use pyo3::create_exception;
use pyo3::exceptions::PyRuntimeError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes, PyTuple};

use crate::interrupt;

create_exception!(
    jostle.mpi,
    RankError,
    PyRuntimeError,
    "Another rank could not do its part of a call, so no rank completes it.\n\n\
     The rank with the cause raises the cause itself. The others raise this error with the number\n\
     of that rank and its message."
);

/// An object with the methods `gather`, `gather_all`, `transpose` and `exchange`, of a rank.
pub struct PyCommunicator {
    object: Py<PyAny>,
    rank: usize,
    size: usize,
}

impl PyCommunicator {
    pub fn new(object: &Bound<'_, PyAny>) -> PyResult<Self> {
        let number = |name| object.getattr(name)?.extract();
        Ok(Self { object: object.clone().unbind(), rank: number("rank")?, size: number("size")? })
    }
}

/// The result of a call of Python; the current call raises its exception.
fn called<R>(work: impl FnOnce(Python<'_>) -> PyResult<R>) -> Result<R> {
    Python::attach(work).map_err(|error| {
        interrupt::raise(error);
        Error::Interrupted
    })
}

impl Communicator for PyCommunicator {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    fn gather(&mut self, own: &[u8]) -> Result<Vec<u8>> {
        called(|py| {
            let own = (PyBytes::new(py, own),);
            let all = self.object.bind(py).call_method1(intern!(py, "gather"), own)?;
            Ok(all.cast::<PyByteArray>()?.to_vec())
        })
    }

    fn gather_all(&mut self, own: &[u8], counts: &[usize]) -> Result<Vec<u8>> {
        called(|py| {
            let arguments = (PyBytes::new(py, own), PyTuple::new(py, counts)?);
            let all = self.object.bind(py).call_method1(intern!(py, "gather_all"), arguments)?;
            Ok(all.cast::<PyByteArray>()?.to_vec())
        })
    }

    fn transpose(&mut self, to: &[u64]) -> Result<Vec<u64>> {
        called(|py| {
            let object = self.object.bind(py);
            object.call_method1(intern!(py, "transpose"), (to.to_vec(),))?.extract()
        })
    }

    fn exchange(&mut self, to: &[u8], sent: &[usize], received: &[usize]) -> Result<Vec<u8>> {
        called(|py| {
            let to = PyBytes::new(py, to);
            let arguments = (to, PyTuple::new(py, sent)?, PyTuple::new(py, received)?);
            let all = self.object.bind(py).call_method1(intern!(py, "exchange"), arguments)?;
            Ok(all.cast::<PyByteArray>()?.to_vec())
        })
    }
}
