//! Results as arrays; vectors become arrays without a copy.

use jostle_base::interrupt::Pulse;
use jostle_base::memory;
use numpy::ndarray::{Array2, Dimension};
use numpy::{Element, IntoPyArray, PyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// A vector as an array, without a copy.
pub fn column<V: Element>(py: Python<'_>, values: Vec<V>) -> Bound<'_, PyArray1<V>> {
    values.into_pyarray(py)
}

/// Rows of `N` values as a two-dimensional array, without a copy.
pub fn table<V: Element, const N: usize>(
    py: Python<'_>,
    rows: Vec<[V; N]>,
) -> PyResult<Bound<'_, PyArray2<V>>> {
    let shape = (rows.len(), N);
    matrix(py, rows.into_flattened(), shape)
}

/// Line segments as an array of shape (m, 2, 2).
pub fn segments<'py, T: Element + Copy>(
    py: Python<'py>,
    all: &[[[T; 2]; 2]],
) -> PyResult<Bound<'py, PyArray3<T>>> {
    table(py, all.as_flattened().to_vec())?.reshape([all.len(), 2, 2])
}

/// Numbers as a two-dimensional array, without a copy.
pub fn matrix<V: Element>(
    py: Python<'_>,
    values: Vec<V>,
    shape: (usize, usize),
) -> PyResult<Bound<'_, PyArray2<V>>> {
    let matrix = Array2::from_shape_vec(shape, values);
    Ok(matrix.map_err(|error| PyValueError::new_err(error.to_string()))?.into_pyarray(py))
}

/// Ids or pairs of ids as signed 64-bit integers, so that differences do not overflow; without the
/// GIL.
pub fn long<I: Widen>(ids: &[I]) -> jostle_base::Result<Vec<I::Long>> {
    let mut long = memory::with_capacity(ids.len())?;
    let mut pulse = Pulse::current();
    for some in ids.chunks(AT_A_TIME) {
        pulse.check(some.len())?;
        long.extend(some.iter().map(|&id| id.widen()));
    }
    Ok(long)
}

/// Number of ids that are converted between two checks for interruption.
const AT_A_TIME: usize = 1 << 12;

/// An id or a pair of ids of the core.
pub trait Widen: Copy {
    /// The 64-bit type.
    type Long;
    /// Converts.
    fn widen(self) -> Self::Long;
}

impl Widen for u32 {
    type Long = i64;

    fn widen(self) -> i64 {
        self.into()
    }
}

impl Widen for [u32; 2] {
    type Long = [i64; 2];

    fn widen(self) -> [i64; 2] {
        self.map(i64::from)
    }
}

impl Widen for [i64; 2] {
    type Long = Self;

    fn widen(self) -> Self {
        self
    }
}

/// Makes an array read-only: it is a copy, so writing into it would not change the world.
pub fn read_only<V: Element, D: Dimension>(
    array: Bound<'_, PyArray<V, D>>,
) -> Bound<'_, PyArray<V, D>> {
    array.readwrite().make_nonwriteable();
    array
}

/// The float64 with the same shortest decimal representation as a float32: 0.1 stays 0.1.
pub fn decimal(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}
