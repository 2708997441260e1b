//! Conversion of arrays and numbers between Python and Rust.
//!
//! Arguments: anything that `numpy.asarray` accepts, with any layout and byte order, is checked and
//! copied, so that other threads cannot change it during the call. The shape is checked before the
//! copy; if its allocation fails, MemoryError is raised. `shapes` has the shapes that arguments may
//! have, `scalars` arguments that are one number, and `results` makes arrays of vectors.

mod results;
mod scalars;
mod shapes;

use jostle_index::Scalar;
use jostle_index::shapes::MAX_ROWS;
use numpy::{
    Element, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyUntypedArray,
    PyUntypedArrayMethods, dtype,
};
use pyo3::exceptions::{PyMemoryError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyFrozenSet, PyInt, PySet};

use crate::error::{type_error, value_error};
use crate::masked::refuse_masked;
pub use results::{Widen, column, decimal, long, matrix, read_only, segments, table};
use scalars::is_truth;
pub use scalars::{count, long_ids, number, point, single_mask, too_long_id, truth, word};
pub use shapes::{PointLists, bit_sets, reals};

/// An argument that may be omitted. None is a value, not an omission.
#[derive(Default)]
pub struct Given<'py>(Option<Bound<'py, PyAny>>);

impl<'py> Given<'py> {
    /// An argument with a value, or an omitted one.
    pub fn of(value: Option<Bound<'py, PyAny>>) -> Self {
        Self(value)
    }

    /// The default in signatures.
    pub const NOTHING: Self = Self(None);

    /// The value; None if the argument was omitted.
    pub fn value(&self) -> Option<&Bound<'py, PyAny>> {
        self.0.as_ref()
    }
}

impl<'py> FromPyObject<'_, 'py> for Given<'py> {
    type Error = std::convert::Infallible;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> Result<Self, Self::Error> {
        Ok(Self(Some(value.to_owned())))
    }
}

/// The rule for categories and masks.
const BIT_SET_RULE: &str = "a set of 32 bits: between 0 and 4294967295, or a negative integer from \
                            -4294967296 as ~bits gives it";

/// The kinds of numbers of array arguments.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Real,
    Integer,
    Boolean,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Real => "real numbers",
            Self::Integer => "integers",
            Self::Boolean => "booleans",
        }
    }

    fn allows(self, numpy_kind: u8) -> bool {
        match self {
            Self::Real => matches!(numpy_kind, b'f' | b'i' | b'u'),
            Self::Integer => matches!(numpy_kind, b'i' | b'u'),
            Self::Boolean => numpy_kind == b'b',
        }
    }
}

/// An array argument with a checked type.
pub struct Argument<'py> {
    name: &'static str,
    /// Not of a subclass, whose methods may be overridden.
    array: Bound<'py, PyUntypedArray>,
    was_array: bool,
}

impl<'py> Argument<'py> {
    /// Reads an argument of real numbers.
    pub fn reals(name: &'static str, value: &Bound<'py, PyAny>) -> PyResult<Self> {
        Self::new(name, value, Kind::Real)
    }

    /// Reads an argument of integers.
    pub fn integers(name: &'static str, value: &Bound<'py, PyAny>) -> PyResult<Self> {
        Self::new(name, value, Kind::Integer)
    }

    /// Reads an argument of booleans.
    pub fn booleans(name: &'static str, value: &Bound<'py, PyAny>) -> PyResult<Self> {
        Self::new(name, value, Kind::Boolean)
    }

    fn new(name: &'static str, value: &Bound<'py, PyAny>, kind: Kind) -> PyResult<Self> {
        let was_array = value.cast::<PyUntypedArray>().is_ok();
        if value.is_instance_of::<PySet>() || value.is_instance_of::<PyFrozenSet>() {
            return Err(type_error(name, "an ordered list or array", value));
        }
        refuse_masked(name, value)?;
        let array = as_array(name, value)?;
        let argument = Self { name, array, was_array };
        argument.check_type(kind, value)?;
        match argument.array.shape().first() {
            Some(&rows) if rows > MAX_ROWS => {
                let message = format!("{name} has {rows} rows; it may have at most {MAX_ROWS}");
                Err(PyValueError::new_err(message))
            }
            _ => Ok(argument),
        }
    }

    /// Refuses an array of another kind of numbers. An array without elements may have any
    /// dtype.
    fn check_type(&self, kind: Kind, value: &Bound<'py, PyAny>) -> PyResult<()> {
        let (name, found) = (self.name, self.array.dtype());
        if self.array.len() == 0 || kind.allows(found.kind()) {
            return Ok(());
        }
        if kind == Kind::Integer && value.is_instance_of::<PyInt>() && !is_truth(value) {
            // An int that exceeds 64 bits; NumPy stores it as an object.
            return Err(value_error(name, value, BIT_SET_RULE));
        }
        let wanted = kind.name();
        let found = match self.array.ndim() {
            0 if !self.was_array => value.get_type().name()?.to_string(),
            _ => found.to_string(),
        };
        Err(PyTypeError::new_err(format!("{name} must hold {wanted}, not {found}")))
    }

    /// Whether it is a pair of numbers that was not given as an array.
    pub fn is_plain_pair(&self) -> bool {
        !self.was_array && self.array.shape() == [2]
    }

    /// Whether its numbers are float32, in any byte order.
    fn is_single(&self) -> bool {
        let found = self.array.dtype();
        found.kind() == b'f' && found.itemsize() == 4
    }

    /// Whether it is a single number.
    pub fn is_scalar(&self) -> bool {
        self.array.ndim() == 0
    }

    /// All numbers as `T`, in row-major order.
    fn real<T: Scalar + Element>(&self) -> PyResult<Vec<T>> {
        if self.is_single() {
            self.read(|all: &[f32]| {
                self.collected(all.len(), all.iter().map(|&v| T::from_f64(v.into())))
            })
        } else {
            self.read(|all: &[f64]| self.collected(all.len(), all.iter().map(|&v| rounded(v))))
        }
    }

    /// All numbers as pairs of `T`.
    fn real_pairs<T: Scalar + Element>(&self) -> PyResult<Vec<[T; 2]>> {
        self.real_rows()
    }

    /// All numbers as rows of `W` of `T`.
    fn real_rows<T: Scalar + Element, const W: usize>(&self) -> PyResult<Vec<[T; W]>> {
        if self.is_single() {
            self.read(|all: &[f32]| {
                let rows: &[[f32; W]] = all.as_chunks().0;
                let typed = rows.iter().map(|row| row.map(|v| T::from_f64(v.into())));
                self.collected(rows.len(), typed)
            })
        } else {
            self.read(|all: &[f64]| {
                let rows: &[[f64; W]] = all.as_chunks().0;
                self.collected(rows.len(), rows.iter().map(|row| row.map(T::from_f64)))
            })
        }
    }

    fn integer_each<N>(&self, narrow: fn(i128) -> Option<N>, rule: &str) -> PyResult<Vec<N>> {
        // Every unsigned type fits into u64, every signed one into i64.
        if self.array.dtype().kind() == b'u' {
            self.read(|all: &[u64]| self.narrowed(all, narrow, rule))
        } else {
            self.read(|all: &[i64]| self.narrowed(all, narrow, rule))
        }
    }

    fn narrowed<V: Copy + Into<i128>, N>(
        &self,
        values: &[V],
        narrow: fn(i128) -> Option<N>,
        rule: &str,
    ) -> PyResult<Vec<N>> {
        let mut narrowed = self.room_for(values.len())?;
        for (index, &value) in values.iter().enumerate() {
            let refused = || value_error(&self.entry(index), value.into(), rule);
            narrowed.push(narrow(value.into()).ok_or_else(refused)?);
        }
        Ok(narrowed)
    }

    /// The name of one of its values, with the row if it has rows.
    fn entry(&self, index: usize) -> String {
        let name = self.name;
        match self.array.shape() {
            [] => name.to_string(),
            [_, width @ ..] => {
                let width = width.iter().product::<usize>().max(1);
                format!("{name}[{}]", index / width)
            }
        }
    }

    /// Its only value.
    fn only<V: Copy>(&self, values: Vec<V>) -> PyResult<V> {
        values.first().copied().ok_or_else(|| self.changed())
    }

    /// A copy of all values, in row-major order.
    fn copied<V: Element + Copy>(&self) -> PyResult<Vec<V>> {
        self.read(|values: &[V]| self.collected(values.len(), values.iter().copied()))
    }

    /// `len` values as a vector.
    fn collected<V>(&self, len: usize, values: impl Iterator<Item = V>) -> PyResult<Vec<V>> {
        let mut all = self.room_for(len)?;
        all.extend(values);
        Ok(all)
    }

    fn room_for<V>(&self, len: usize) -> PyResult<Vec<V>> {
        let mut room = Vec::new();
        room.try_reserve_exact(len).map_err(|_| no_memory(self.name, len, size_of::<V>()))?;
        Ok(room)
    }

    /// Calls `take` with all values in row-major order, for any layout and byte order.
    fn read<V: Element + Copy, R>(&self, take: impl FnOnce(&[V]) -> PyResult<R>) -> PyResult<R> {
        let len = self.array.len();
        if len == 0 {
            return take(&[]);
        }
        if let Ok(array) = self.array.cast::<PyArrayDyn<V>>()
            && array.is_c_contiguous()
            && let Ok(values) = array.try_readonly()?.as_slice()
        {
            return take(values);
        }
        let py = self.array.py();
        let arguments = (dtype::<V>(py), "C", "unsafe", false);
        let copy = self.array.call_method1("astype", arguments).map_err(|error| {
            let full = error.is_instance_of::<PyMemoryError>(py);
            if full { no_memory(self.name, len, size_of::<V>()) } else { error }
        })?;
        // A warning of NumPy can run Python code, which could change the array.
        match copy.cast::<PyArrayDyn<V>>()?.try_readonly()?.as_slice() {
            Ok(values) if values.len() == len => take(values),
            _ => Err(self.changed()),
        }
    }

    /// The error for an array that was changed during the copy.
    fn changed(&self) -> PyErr {
        PyValueError::new_err(format!("{} changed its shape while it was read", self.name))
    }

    /// The error for a wrong shape.
    pub fn wrong_shape(&self, expected: &str) -> PyErr {
        let found = match self.array.shape() {
            [] => "()".to_string(),
            [rows] => format!("({rows},)"),
            shape => {
                format!("({})", shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", "))
            }
        };
        let name = self.name;
        if expected == "(2,)" && self.is_scalar() {
            let (value, rule) = (&self.array, "it must be two numbers, such as");
            return PyValueError::new_err(format!("{name} is {value}; {rule} (0, {value})"));
        }
        PyValueError::new_err(format!("{name} has shape {found}; it must be {expected}"))
    }
}

/// The nearest number of a type. Only 0 is rounded to 0, so that a size that is too small is
/// refused.
fn rounded<T: Scalar>(value: f64) -> T {
    let near = T::from_f64(value);
    let smallest = f64::from(f32::from_bits(1));
    if near == T::ZERO && value != 0.0 { T::from_f64(smallest.copysign(value)) } else { near }
}

/// The error if there is no memory for a copy of an argument.
fn no_memory(name: &str, len: usize, size: usize) -> PyErr {
    let bytes = len.saturating_mul(size);
    PyMemoryError::new_err(format!("{name}: there is no memory for {bytes} bytes"))
}

/// `numpy.asarray(value)`, of no subclass; its errors name the argument.
fn as_array<'py>(name: &str, value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyUntypedArray>> {
    if let Ok(array) = value.cast_exact::<PyUntypedArray>() {
        return Ok(array.clone());
    }
    static AS_ARRAY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let py = value.py();
    let array = AS_ARRAY.import(py, "numpy", "asarray")?.call1((value,)).map_err(|cause| {
        let message = format!("{name} cannot be read as an array: {}", cause.value(py));
        let error = if cause.is_instance_of::<PyValueError>(py) {
            PyValueError::new_err(message)
        } else if cause.is_instance_of::<PyTypeError>(py) {
            PyTypeError::new_err(message)
        } else {
            return cause;
        };
        error.set_cause(py, Some(cause));
        error
    })?;
    Ok(array.cast_into::<PyUntypedArray>()?)
}

/// Whether a call computes in float32: there is an array, and all arrays are float32. Single
/// numbers do not count.
pub fn all_single(arguments: &[Option<&Argument<'_>>]) -> bool {
    let arrays = arguments.iter().flatten().filter(|argument| !argument.is_scalar());
    let mut arrays = arrays.peekable();
    arrays.peek().is_some() && arrays.all(|argument| argument.is_single())
}

/// An argument that may be omitted or None.
pub type Maybe<'a, 'py> = Option<&'a Bound<'py, PyAny>>;
