//! Array arguments by their shape: one row or many, pairs, boxes, segments, matrices.

use jostle_base::Id;
use jostle_index::{Each, Scalar};
use jostle_world::particles::MAX_KINDS;
use numpy::{Element, PyArrayDescrMethods, PyUntypedArrayMethods, dtype};
use pyo3::prelude::*;

use super::scalars::too_long_id;
use super::{Argument, BIT_SET_RULE, Maybe};

/// The rule for ids of particles.
const ID_RULE: &str = "the id of a particle, between 0 and 9223372036854775807";

impl Argument<'_> {
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

    /// Number of rows of pairs; None if it is a number or one pair.
    pub fn rows_of_pairs(&self) -> Option<usize> {
        match self.array.shape() {
            [rows, _] => Some(*rows),
            _ => None,
        }
    }

    /// Number of line segments.
    pub fn segments_len(&self) -> PyResult<usize> {
        match self.array.shape() {
            [rows, 2, 2] => Ok(*rows),
            [0] => Ok(0),
            _ => Err(self.wrong_shape("(n, 2, 2)")),
        }
    }

    /// `len` line segments.
    pub fn segments_of<T: Scalar + Element>(&self, len: usize) -> PyResult<Vec<[[T; 2]; 2]>> {
        if self.segments_len().ok() == Some(len) {
            return self.segments();
        }
        Err(self.wrong_shape(&format!("({len}, 2, 2)")))
    }

    /// One line segment, or many.
    pub fn one_or_segments<T: Scalar + Element>(&self) -> PyResult<Each<[[T; 2]; 2]>> {
        match self.array.shape() {
            [2, 2] => Ok(Each::One(self.only(self.real_pairs()?.as_chunks::<2>().0.to_vec())?)),
            [_, 2, 2] | [0] => Ok(Each::Rows(self.segments()?)),
            _ => Err(self.wrong_shape("(2, 2) or (k, 2, 2)")),
        }
    }

    /// Line segments: two points each.
    pub fn segments<T: Scalar + Element>(&self) -> PyResult<Vec<[[T; 2]; 2]>> {
        match self.array.shape() {
            [_, 2, 2] => {
                let points = self.real_pairs()?;
                Ok(points.chunks_exact(2).map(|two| [two[0], two[1]]).collect())
            }
            [0] => Ok(Vec::new()),
            _ => Err(self.wrong_shape("(m, 2, 2), each segment as ((x, y), (x, y))")),
        }
    }

    /// Whether it has the shape of one line segment.
    pub fn is_segment(&self) -> bool {
        self.array.shape() == [2, 2]
    }

    /// A single line segment.
    pub fn only_segment<T: Scalar + Element>(&self) -> PyResult<Vec<[[T; 2]; 2]>> {
        if !self.is_segment() {
            return Err(self.wrong_shape("(2, 2), as there is one wall"));
        }
        let points = self.real_pairs()?;
        Ok(points.as_chunks::<2>().0.to_vec())
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

    /// Kinds of particles: a number for all or one for each of `len` rows.
    pub fn kind_each(&self, len: usize) -> PyResult<Each<u8>> {
        let kind = |number| u8::try_from(number).ok().filter(|&kind| usize::from(kind) < MAX_KINDS);
        let rule = format!("a kind, between 0 and {}", MAX_KINDS - 1);
        self.each(len, "an integer", |argument| argument.integer_each(kind, &rule))
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
    pub fn long_ids(&self, of: &str) -> PyResult<Each<i64>> {
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

    /// The result of `narrow` for each integer; `rule` describes the integers that it accepts.
    fn unsigned(&self, narrow: fn(i128) -> Option<u32>, rule: &str) -> PyResult<Vec<u32>> {
        if self.array.dtype().is_equiv_to(&dtype::<u32>(self.array.py())) {
            return self.copied();
        }
        self.integer_each(narrow, rule)
    }
}

/// Lists of points of equal length, concatenated.
pub struct PointLists<T> {
    pub points: Vec<[T; 2]>,
    /// Number of lists and number of points in each; None for a single list.
    pub many: Option<(usize, usize)>,
}

/// The low 32 bits of a valid set of bits; `~bits` is negative for an int or a signed array.
fn low_bits(bits: i128) -> Option<u32> {
    (-(1 << 32)..1 << 32).contains(&bits).then_some(bits as u32)
}

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
