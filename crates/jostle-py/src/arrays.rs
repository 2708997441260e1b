//! Conversion of arrays and numbers between Python and Rust.
//!
//! Arguments: anything that `numpy.asarray` accepts, with any layout and byte order, is checked and
//! copied, so that other threads cannot change it during the call. The shape is checked before the
//! copy; if its allocation fails, MemoryError is raised. Results: vectors become arrays without a
//! copy.

use std::fmt::Display;

use jostle::interrupt::Pulse;
use jostle::shapes::MOST_ROWS;
use jostle::{Each, Id, Scalar, memory};
use numpy::ndarray::Array2;
use numpy::{
    Element, IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayDescrMethods, PyArrayDyn,
    PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods, dtype,
};
use pyo3::exceptions::{PyMemoryError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBool, PyFrozenSet, PyInt, PySet};

use crate::error::{type_error, value_error};
use crate::masked::refuse_masked;

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

/// The rule for ids of particles.
const ID_RULE: &str = "the id of a particle, between 0 and 9223372036854775807";

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
            Some(&rows) if rows > MOST_ROWS => {
                let message = format!("{name} has {rows} rows; it may have at most {MOST_ROWS}");
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

    /// One pair for all of `len` rows or one for each.
    pub fn one_or_pairs<T: Scalar + Element>(&self, len: usize) -> PyResult<Each<[T; 2]>> {
        match self.array.shape() {
            [2] => Ok(Each::One(self.only(self.real_pairs()?)?)),
            [rows, 2] if *rows == len => Ok(Each::Rows(self.real_pairs()?)),
            [0] if len == 0 => Ok(Each::Rows(Vec::new())),
            _ => Err(self.wrong_shape(&format!("(2,) or ({len}, 2)"))),
        }
    }

    /// A single pair; `of` names the object that it belongs to, for error messages.
    pub fn only_pair<T: Scalar + Element>(&self, of: &str) -> PyResult<[T; 2]> {
        match self.array.shape() {
            [2] => self.only(self.real_pairs()?),
            _ => Err(self.wrong_shape(&format!("(2,), as there is one {of}"))),
        }
    }

    /// Number of rows, where each is a box.
    pub fn boxes_len(&self) -> PyResult<usize> {
        match self.array.shape() {
            [rows, 4] => Ok(*rows),
            [0] => Ok(0),
            _ => Err(self.wrong_shape("(n, 4)")),
        }
    }

    /// `len` boxes.
    pub fn boxes<T: Scalar + Element>(&self, len: usize) -> PyResult<Vec<[T; 4]>> {
        match self.array.shape() {
            [rows, 4] if *rows == len => self.real_rows(),
            [0] if len == 0 => Ok(Vec::new()),
            _ => Err(self.wrong_shape(&format!("({len}, 4)"))),
        }
    }

    /// Whether it has the shape of a box, or of many.
    pub fn is_like_boxes(&self) -> bool {
        matches!(self.array.shape(), [4] | [_, 4])
    }

    /// One row of `W` numbers, or many.
    pub fn one_or_rows<T: Scalar + Element, const W: usize>(&self) -> PyResult<Each<[T; W]>> {
        match self.array.shape() {
            [width] if *width == W => Ok(Each::One(self.only(self.real_rows()?)?)),
            [_, width] if *width == W => Ok(Each::Rows(self.real_rows()?)),
            [0] => Ok(Each::Rows(Vec::new())),
            _ => Err(self.wrong_shape(&format!("({W},) or (k, {W})"))),
        }
    }

    /// One list of points, or many of equal length.
    pub fn one_or_more_lists<T: Scalar + Element>(&self) -> PyResult<PointLists<T>> {
        match *self.array.shape() {
            [_, 2] => Ok(PointLists { points: self.real_pairs()?, many: None }),
            [0] => Ok(PointLists { points: Vec::new(), many: Some((0, 0)) }),
            [lists, len, 2] => {
                Ok(PointLists { points: self.real_pairs()?, many: Some((lists, len)) })
            }
            _ => Err(self.wrong_shape("(v, 2) or (k, v, 2)")),
        }
    }

    /// Number of rows, unless it is a single number.
    pub fn rows_if_any(&self) -> PyResult<Option<usize>> {
        if self.is_scalar() { Ok(None) } else { self.len().map(Some) }
    }

    /// Line segments: two points each.
    pub fn segments<T: Scalar + Element>(&self) -> PyResult<Vec<[[T; 2]; 2]>> {
        match self.array.shape() {
            [_, 2, 2] => {
                let points = self.real_pairs()?;
                Ok(points.chunks_exact(2).map(|two| [two[0], two[1]]).collect())
            }
            [0] => Ok(Vec::new()),
            _ => Err(self.wrong_shape("(m, 2, 2)")),
        }
    }

    /// A number for all or one for each of `len` rows.
    pub fn real_each<T: Scalar + Element>(&self, len: usize) -> PyResult<Each<T>> {
        self.each(len, "a number", Self::real)
    }

    /// Half sizes: a number, a pair for all, or a pair for each of `len` rows.
    pub fn half_sizes<T: Scalar + Element>(&self, len: usize) -> PyResult<Each<[T; 2]>> {
        match self.array.shape() {
            [] => Ok(Each::One([self.only(self.real()?)?; 2])),
            [2] => Ok(Each::One(self.only(self.real_pairs()?)?)),
            [rows, 2] if *rows == len => Ok(Each::Rows(self.real_pairs()?)),
            [0] if len == 0 => Ok(Each::Rows(Vec::new())),
            _ => Err(self.wrong_shape(&format!("a number, (2,) or ({len}, 2)"))),
        }
    }

    /// Bit sets: a number for all or one for each of `len` rows.
    pub fn bits_each(&self, len: usize) -> PyResult<Each<u32>> {
        self.each(len, "an integer", |argument| argument.unsigned(low_bits, BIT_SET_RULE))
    }

    /// Integers from 0 to `count` - 1, one or many; `rule` describes them.
    pub fn small_integers(&self, count: usize, rule: &str) -> PyResult<Vec<u8>> {
        if self.array.ndim() > 1 {
            return Err(self.wrong_shape("(n,)"));
        }
        let all = self.integer_each(|number| u8::try_from(number).ok(), rule)?;
        match all.iter().position(|&number| usize::from(number) >= count) {
            None => Ok(all),
            Some(index) => Err(value_error(&self.entry(index), all[index], rule)),
        }
    }

    /// The length of a side, if it is a square matrix.
    pub fn side(&self) -> Option<usize> {
        match self.array.shape() {
            [rows, columns] if rows == columns => Some(*rows),
            _ => None,
        }
    }

    /// A square matrix in row-major order and its number of rows. If this is given, one number may
    /// stand for all.
    pub fn square(&self, rows: Option<usize>) -> PyResult<(usize, Vec<f32>)> {
        match (self.array.shape(), self.side(), rows) {
            ([], _, Some(rows)) => Ok((rows, vec![self.only(self.real()?)?; rows * rows])),
            (_, Some(side), None) => Ok((side, self.real()?)),
            (_, Some(side), Some(rows)) if side == rows => Ok((rows, self.real()?)),
            (_, _, None) => Err(self.wrong_shape("(K, K)")),
            (_, _, Some(rows)) => Err(self.wrong_shape(&format!("a number or ({rows}, {rows})"))),
        }
    }

    /// A table of shape (K, K, m) in row-major order, and K.
    pub fn cube(&self) -> PyResult<(usize, Vec<f32>)> {
        match self.array.shape() {
            [rows, columns, points] if rows == columns && *points > 0 => Ok((*rows, self.real()?)),
            _ => Err(self.wrong_shape("(K, K, m)")),
        }
    }

    /// Pairs of ids of particles.
    pub fn id_pairs(&self) -> PyResult<Vec<[Id; 2]>> {
        match self.array.shape() {
            [_, 2] | [0] => {
                let id = |number: i128| Id::try_from(number).ok().filter(|&id| id >= 0);
                let ids = self.integer_each(id, ID_RULE)?;
                let pairs = ids.as_chunks::<2>().0;
                self.collected(pairs.len(), pairs.iter().copied())
            }
            _ => Err(self.wrong_shape("(m, 2)")),
        }
    }

    /// Ids of 63 bits: one or many; `of` is what they identify, for error messages.
    fn long_ids(&self, of: &str) -> PyResult<Each<i64>> {
        if self.array.ndim() > 1 {
            return Err(self.wrong_shape("an integer or (k,)"));
        }
        let ids = if self.array.dtype().kind() == b'u' {
            self.read(|ids: &[u64]| {
                if let Some(row) = ids.iter().position(|&id| i64::try_from(id).is_err()) {
                    return Err(too_long_id(&self.entry(row), ids[row], of));
                }
                self.collected(ids.len(), ids.iter().map(|&id| id as i64))
            })
        } else {
            self.copied::<i64>()
        }?;
        if self.is_scalar() { Ok(Each::One(self.only(ids)?)) } else { Ok(Each::Rows(ids)) }
    }

    /// A bool for all or one for each of `len` rows.
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
            [] => Ok(Each::One(self.only(read(self)?)?)),
            [rows] if *rows == len => Ok(Each::Rows(read(self)?)),
            _ => Err(self.wrong_shape(&format!("{one} or ({len},)"))),
        }
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

    /// The result of `narrow` for each integer; `rule` describes the integers that it accepts.
    fn unsigned(&self, narrow: fn(i128) -> Option<u32>, rule: &str) -> PyResult<Vec<u32>> {
        if self.array.dtype().is_equiv_to(&dtype::<u32>(self.array.py())) {
            return self.copied();
        }
        self.integer_each(narrow, rule)
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
        PyValueError::new_err(format!("{name} has shape {found}; it must be {expected}"))
    }
}

/// Lists of points of equal length, concatenated.
pub struct PointLists<T> {
    pub points: Vec<[T; 2]>,
    /// Number of lists and number of points in each; None for a single list.
    pub many: Option<(usize, usize)>,
}

/// The nearest number of a type. Only 0 is rounded to 0, so that a size that is too small is
/// refused.
fn rounded<T: Scalar>(value: f64) -> T {
    let near = T::from_f64(value);
    let smallest = f64::from(f32::from_bits(1));
    if near == T::ZERO && value != 0.0 { T::from_f64(smallest.copysign(value)) } else { near }
}

/// The low 32 bits of a valid set of bits; `~bits` is negative for an int or a signed array.
fn low_bits(bits: i128) -> Option<u32> {
    (-(1 << 32)..1 << 32).contains(&bits).then_some(bits as u32)
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

/// A number for all or one for each of `len` rows, if the argument is given.
pub fn reals<T: Scalar + Element>(
    name: &'static str,
    value: Maybe<'_, '_>,
    len: usize,
) -> PyResult<Option<Each<T>>> {
    value.map(|value| Argument::reals(name, value)?.real_each(len)).transpose()
}

/// A bit set for all or one for each of `len` rows, if the argument is given.
pub fn bit_sets(
    name: &'static str,
    value: Maybe<'_, '_>,
    len: usize,
) -> PyResult<Option<Each<u32>>> {
    value.map(|value| Argument::integers(name, value)?.bits_each(len)).transpose()
}

/// One bit set.
pub fn single_mask(name: &'static str, value: &Bound<'_, PyAny>) -> PyResult<u32> {
    let mask = Argument::integers(name, value)?;
    match mask.bits_each(1)? {
        Each::One(mask) => Ok(mask),
        Each::Rows(_) => Err(mask.wrong_shape("an integer")),
    }
}

/// One real number.
pub fn number(name: &str, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    match value.extract::<f64>() {
        Ok(number) if !is_truth(value) => Ok(number),
        _ => Err(type_error(name, "a number", value)),
    }
}

/// An id of 63 bits or an array of ids; `of` is what they identify, for error messages: "shape".
pub fn long_ids(name: &'static str, value: &Bound<'_, PyAny>, of: &str) -> PyResult<Each<i64>> {
    if value.is_instance_of::<PyInt>() && !is_truth(value) {
        return value.extract().map(Each::One).map_err(|_| too_long_id(name, value, of));
    }
    Argument::integers(name, value)?.long_ids(of)
}

/// The error for an integer that is too large for an id.
fn too_long_id(name: &str, id: impl Display, of: &str) -> PyErr {
    PyValueError::new_err(format!("{name} is {id}; no {of} has this id"))
}

/// Two real numbers.
pub fn point(name: &'static str, value: &Bound<'_, PyAny>) -> PyResult<[f32; 2]> {
    let argument = Argument::reals(name, value)?;
    match argument.array.shape() {
        [2] => argument.only(argument.real_pairs()?),
        _ => Err(argument.wrong_shape("(2,)")),
    }
}

/// One integer of at least `min`.
pub fn count(name: &str, value: &Bound<'_, PyAny>, min: usize) -> PyResult<usize> {
    if is_truth(value) {
        return Err(type_error(name, "an integer", value));
    }
    match value.extract::<usize>() {
        Ok(count) if count >= min => Ok(count),
        Err(error) if error.is_instance_of::<PyTypeError>(value.py()) => {
            Err(type_error(name, "an integer", value))
        }
        Err(_) if value.gt(min)? => {
            Err(value_error(name, value, &format!("at most {}", usize::MAX)))
        }
        _ => Err(value_error(name, value, &format!("at least {min}"))),
    }
}

/// True or False; False if omitted.
pub fn truth(name: &str, given: &Given<'_>) -> PyResult<bool> {
    let Some(value) = given.value() else { return Ok(false) };
    value.extract::<bool>().map_err(|_| type_error(name, "True or False", value))
}

/// A string; None if omitted.
pub fn word(name: &str, given: &Given<'_>, rule: &str) -> PyResult<Option<String>> {
    let read = |value: &Bound<'_, PyAny>| {
        value.extract::<String>().map_err(|_| type_error(name, rule, value))
    };
    given.value().map(read).transpose()
}

/// Whether a value is a bool. Python accepts bools as 1 and 0; as arguments they are mistakes.
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
pub fn long<I: Widen>(ids: &[I]) -> jostle::Result<Vec<I::Long>> {
    let mut long = memory::with_room(ids.len())?;
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
pub fn read_only<V: Element, D: numpy::ndarray::Dimension>(
    array: Bound<'_, numpy::PyArray<V, D>>,
) -> Bound<'_, numpy::PyArray<V, D>> {
    array.readwrite().make_nonwriteable();
    array
}

/// The float64 with the same shortest decimal representation as a float32: 0.1 stays 0.1.
pub fn decimal(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}
