//! Arrays and numbers between Python and Rust; nothing else converts them.
//!
//! In: whatever `numpy.asarray` understands, of any layout and byte order, is
//! checked and copied, so that nobody can change it once other threads run.
//! Out: vectors become arrays without a copy.

use std::fmt::Display;

use jostle::{Each, Scalar};
use numpy::ndarray::Array2;
use numpy::{
    Element, IntoPyArray, PyArray1, PyArray2, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods,
    PyUntypedArray, PyUntypedArrayMethods, dtype,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBool, PyFrozenSet, PyInt, PySet};

use crate::error::{type_error, value_error};

/// An argument that may be left out, which is not the same as giving None.
#[derive(Default)]
pub struct Given<'py>(Option<Bound<'py, PyAny>>);

impl<'py> Given<'py> {
    /// For the defaults of signatures.
    pub const NOTHING: Self = Self(None);

    /// The argument, unless it was left out.
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

/// What categories, masks and ids hold.
const BIT_SET_RULE: &str = "between 0 and 4294967295";

/// What an array argument may hold.
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

/// An argument as NumPy sees it, its type checked.
pub struct Argument<'py> {
    name: &'static str,
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
            return Err(type_error(
                name,
                "a list or an array, in which things have a place",
                value,
            ));
        }
        let array = as_array(name, value)?;
        let found = array.dtype();
        // An empty list has no type of its own; NumPy makes it float64.
        let nothing = array.len() == 0 && !was_array;
        if nothing || kind.allows(found.kind()) {
            return Ok(Self { name, array, was_array });
        }
        if kind == Kind::Integer && value.is_instance_of::<PyInt>() && !is_truth(value) {
            // Too long even for NumPy, which makes it an object.
            return Err(value_error(name, value, BIT_SET_RULE));
        }
        let wanted = kind.name();
        let found = match array.ndim() {
            0 if !was_array => value.get_type().name()?.to_string(),
            _ => found.to_string(),
        };
        Err(PyTypeError::new_err(format!("{name} must hold {wanted}, not {found}")))
    }

    /// Whether it is two numbers that did not come in an array.
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

    /// Number of rows, where each is a pair.
    pub fn pairs_len(&self) -> PyResult<usize> {
        match self.array.shape() {
            [rows, 2] => Ok(*rows),
            [0] => Ok(0),
            _ => Err(self.wrong_shape("(n, 2)")),
        }
    }

    /// Number of rows, where each is a single value.
    pub fn len(&self) -> PyResult<usize> {
        match self.array.shape() {
            [rows] => Ok(*rows),
            _ => Err(self.wrong_shape("(n,)")),
        }
    }

    /// `len` pairs.
    pub fn pairs<T: Scalar + Element>(&self, len: usize) -> PyResult<Vec<[T; 2]>> {
        match self.array.shape() {
            [rows, 2] if *rows == len => self.real_pairs(),
            [0] if len == 0 => Ok(Vec::new()),
            _ => Err(self.wrong_shape(&format!("({len}, 2)"))),
        }
    }

    /// One row of `W` numbers, or many.
    pub fn one_or_rows<T: Scalar + Element, const W: usize>(&self) -> PyResult<Each<[T; W]>> {
        match self.array.shape() {
            [width] if *width == W => Ok(Each::One(self.real_rows()?[0])),
            [_, width] if *width == W => Ok(Each::Rows(self.real_rows()?)),
            [0] => Ok(Each::Rows(Vec::new())),
            _ => Err(self.wrong_shape(&format!("({W},) or (k, {W})"))),
        }
    }

    /// One list of points, or many of equal length.
    pub fn one_or_more_lists<T: Scalar + Element>(&self) -> PyResult<Each<Vec<[T; 2]>>> {
        match *self.array.shape() {
            [_, 2] => Ok(Each::One(self.real_pairs()?)),
            [0] => Ok(Each::Rows(Vec::new())),
            [lists, 0, 2] => Ok(Each::Rows(vec![Vec::new(); lists])),
            [_, len, 2] => {
                let points = self.real_pairs()?;
                Ok(Each::Rows(points.chunks(len).map(<[_]>::to_vec).collect()))
            }
            _ => Err(self.wrong_shape("(v, 2) or (k, v, 2)")),
        }
    }

    /// Number of rows, unless it is a single number.
    pub fn rows_if_any(&self) -> PyResult<Option<usize>> {
        if self.is_scalar() { Ok(None) } else { self.len().map(Some) }
    }

    /// A number for all or one for each of `len` rows.
    pub fn real_each<T: Scalar + Element>(&self, len: usize) -> PyResult<Each<T>> {
        self.each(len, "a number", Self::real)
    }

    /// Half sizes: a number, a pair for all, or a pair for each of `len` rows.
    pub fn half_sizes<T: Scalar + Element>(&self, len: usize) -> PyResult<Each<[T; 2]>> {
        match self.array.shape() {
            [] => Ok(Each::One([self.real()?[0]; 2])),
            [2] => Ok(Each::One(self.real_pairs()?[0])),
            [rows, 2] if *rows == len => Ok(Each::Rows(self.real_pairs()?)),
            [0] if len == 0 => Ok(Each::Rows(Vec::new())),
            _ => Err(self.wrong_shape(&format!("a number, (2,) or ({len}, 2)"))),
        }
    }

    /// Bit sets: a number for all or one for each of `len` rows.
    pub fn bits_each(&self, len: usize) -> PyResult<Each<u32>> {
        self.each(len, "an integer", Self::unsigned)
    }

    /// Row numbers.
    pub fn ids(&self) -> PyResult<Vec<u32>> {
        self.len()?;
        self.unsigned()
    }

    /// Pairs of row numbers.
    pub fn id_pairs(&self) -> PyResult<Vec<[u32; 2]>> {
        match self.array.shape() {
            [_, 2] | [0] => Ok(self.unsigned()?.as_chunks::<2>().0.to_vec()),
            _ => Err(self.wrong_shape("(m, 2)")),
        }
    }

    /// Ids of 63 bits: one, or a row of them.
    pub fn long_ids(&self) -> PyResult<Each<i64>> {
        let ids = if self.array.dtype().kind() == b'u' {
            let id = |(row, id): (usize, u64)| {
                let name = if self.is_scalar() { String::new() } else { format!("[{row}]") };
                id.try_into().map_err(|_| too_long_id(&format!("{}{name}", self.name), id))
            };
            self.copied::<u64>()?.into_iter().enumerate().map(id).collect::<PyResult<_>>()?
        } else {
            self.copied::<i64>()?
        };
        match self.array.shape() {
            [] => Ok(Each::One(ids[0])),
            [_] => Ok(Each::Rows(ids)),
            _ => Err(self.wrong_shape("an integer or (k,)")),
        }
    }

    /// A truth for all or one for each of `len` rows.
    pub fn truth_each(&self, len: usize) -> PyResult<Each<bool>> {
        self.each(len, "True or False", |argument| argument.copied())
    }

    fn each<V: Copy>(
        &self,
        len: usize,
        one: &str,
        read: impl FnOnce(&Self) -> PyResult<Vec<V>>,
    ) -> PyResult<Each<V>> {
        match self.array.shape() {
            [] => Ok(Each::One(read(self)?[0])),
            [rows] if *rows == len => Ok(Each::Rows(read(self)?)),
            _ => Err(self.wrong_shape(&format!("{one} or ({len},)"))),
        }
    }

    /// All numbers as `T`, row after row.
    fn real<T: Scalar + Element>(&self) -> PyResult<Vec<T>> {
        if self.is_single() {
            self.read(|values: &[f32]| values.iter().map(|&v| T::from_f64(v.into())).collect())
        } else {
            self.read(|values: &[f64]| values.iter().map(|&v| T::from_f64(v)).collect())
        }
    }

    /// All numbers as pairs of `T`.
    fn real_pairs<T: Scalar + Element>(&self) -> PyResult<Vec<[T; 2]>> {
        self.real_rows()
    }

    /// All numbers as rows of `W` of `T`.
    fn real_rows<T: Scalar + Element, const W: usize>(&self) -> PyResult<Vec<[T; W]>> {
        fn rows<V: Copy, T, const W: usize>(
            values: &[V],
            number: impl Fn(V) -> T + Copy,
        ) -> Vec<[T; W]> {
            values.as_chunks().0.iter().map(|row: &[V; W]| row.map(number)).collect()
        }
        if self.is_single() {
            self.read(|values: &[f32]| rows(values, |v| T::from_f64(v.into())))
        } else {
            self.read(|values: &[f64]| rows(values, T::from_f64))
        }
    }

    /// All numbers as unsigned 32-bit integers.
    fn unsigned(&self) -> PyResult<Vec<u32>> {
        if self.array.dtype().is_equiv_to(&dtype::<u32>(self.array.py())) {
            return self.copied();
        }
        // Every unsigned type fits into u64, every signed one into i64.
        if self.array.dtype().kind() == b'u' {
            self.narrow(&self.copied::<u64>()?)
        } else {
            self.narrow(&self.copied::<i64>()?)
        }
    }

    fn narrow<V: Copy + TryInto<u32> + ToString>(&self, values: &[V]) -> PyResult<Vec<u32>> {
        let narrowed = values.iter().enumerate().map(|(index, &value)| {
            value.try_into().map_err(|_| {
                let place = if self.is_scalar() { String::new() } else { format!("[{index}]") };
                value_error(&format!("{}{place}", self.name), value.to_string(), BIT_SET_RULE)
            })
        });
        narrowed.collect()
    }

    /// A copy of all values, row after row.
    fn copied<V: Element + Copy>(&self) -> PyResult<Vec<V>> {
        self.read(<[V]>::to_vec)
    }

    /// What `take` makes of all values, row after row, of whatever layout and byte order
    /// they are.
    fn read<V: Element + Copy, R>(&self, take: impl FnOnce(&[V]) -> R) -> PyResult<R> {
        if let Ok(array) = self.array.cast::<PyArrayDyn<V>>()
            && array.is_c_contiguous()
            && let Ok(values) = array.try_readonly()?.as_slice()
        {
            return Ok(take(values));
        }
        let wanted = dtype::<V>(self.array.py());
        let copy = self.array.call_method1("astype", (wanted, "C", "unsafe", false))?;
        Ok(take(&copy.cast::<PyArrayDyn<V>>()?.try_readonly()?.to_vec()?))
    }

    /// Refuses the shape.
    pub fn wrong_shape(&self, expected: &str) -> PyErr {
        let found = match self.array.shape() {
            [] => "()".to_string(),
            [rows] => format!("({rows},)"),
            shape => {
                format!("({})", shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", "))
            }
        };
        let name = self.name;
        PyValueError::new_err(format!("{name} has shape {found}; it must be {expected}"))
    }
}

/// `numpy.asarray(value)`; its errors name the argument.
fn as_array<'py>(name: &str, value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyUntypedArray>> {
    if let Ok(array) = value.cast::<PyUntypedArray>() {
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

/// Whether a call computes in float32: every array is float32, and there is one.
/// A single number follows the arrays beside it.
pub fn all_single(arguments: &[Option<&Argument<'_>>]) -> bool {
    let arrays = arguments.iter().flatten().filter(|argument| !argument.is_scalar());
    let mut arrays = arrays.peekable();
    arrays.peek().is_some() && arrays.all(|argument| argument.is_single())
}

/// One real number.
pub fn number(name: &str, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    match value.extract::<f64>() {
        Ok(number) if !is_truth(value) => Ok(number),
        _ => Err(type_error(name, "a number", value)),
    }
}

/// An id of 63 bits or an array of them.
pub fn long_ids(name: &'static str, value: &Bound<'_, PyAny>) -> PyResult<Each<i64>> {
    if value.is_instance_of::<PyInt>() && !is_truth(value) {
        return value.extract().map(Each::One).map_err(|_| too_long_id(name, value));
    }
    Argument::integers(name, value)?.long_ids()
}

/// What does not fit into an id is none.
fn too_long_id(name: &str, id: impl Display) -> PyErr {
    PyValueError::new_err(format!("{name} is {id}; no shape has this id"))
}

/// Two real numbers.
pub fn point(name: &'static str, value: &Bound<'_, PyAny>) -> PyResult<[f32; 2]> {
    let argument = Argument::reals(name, value)?;
    match argument.array.shape() {
        [2] => Ok(argument.real_pairs()?[0]),
        _ => Err(argument.wrong_shape("(2,)")),
    }
}

/// One integer of at least `least`.
pub fn count(name: &str, value: &Bound<'_, PyAny>, least: usize) -> PyResult<usize> {
    if is_truth(value) {
        return Err(type_error(name, "an integer", value));
    }
    match value.extract::<usize>() {
        Ok(count) if count >= least => Ok(count),
        Err(error) if error.is_instance_of::<PyTypeError>(value.py()) => {
            Err(type_error(name, "an integer", value))
        }
        Err(_) if value.gt(least)? => {
            Err(value_error(name, value, &format!("at most {}", usize::MAX)))
        }
        _ => Err(value_error(name, value, &format!("at least {least}"))),
    }
}

/// True or False; left out, it is False.
pub fn truth(name: &str, given: &Given<'_>) -> PyResult<bool> {
    let Some(value) = given.value() else { return Ok(false) };
    value.extract::<bool>().map_err(|_| type_error(name, "True or False", value))
}

/// A word; None where it was left out.
pub fn word(name: &str, given: &Given<'_>, rule: &str) -> PyResult<Option<String>> {
    let read = |value: &Bound<'_, PyAny>| {
        value.extract::<String>().map_err(|_| type_error(name, rule, value))
    };
    given.value().map(read).transpose()
}

/// True and False count as 1 and 0 in Python; as an argument that is a slip.
fn is_truth(value: &Bound<'_, PyAny>) -> bool {
    value.is_instance_of::<PyBool>()
}

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

/// Numbers as a two-dimensional array, without a copy.
pub fn matrix<V: Element>(
    py: Python<'_>,
    values: Vec<V>,
    shape: (usize, usize),
) -> PyResult<Bound<'_, PyArray2<V>>> {
    let matrix = Array2::from_shape_vec(shape, values);
    Ok(matrix.map_err(|error| PyValueError::new_err(error.to_string()))?.into_pyarray(py))
}

/// The same array, which NumPy now refuses to write: it is a copy, and nobody would see what
/// is written there.
pub fn read_only<V: Element, D: numpy::ndarray::Dimension>(
    array: Bound<'_, numpy::PyArray<V, D>>,
) -> Bound<'_, numpy::PyArray<V, D>> {
    array.readwrite().make_nonwriteable();
    array
}

/// A float32 as the float64 with the same shortest decimals: 0.1 stays 0.1.
pub fn decimal(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}
