//! Serialization: numbers are little-endian, without padding, so the bytes are the same on every machine.
//!
//! [`plain!`](crate::plain!) and [`saved!`](crate::saved!) make writing and reading of a struct from one list of its
//! fields. The list must have all fields, so that none is forgotten.

use core::ops::Range;
use std::sync::Arc;

use crate::error::{Error, Result};
use crate::memory;

/// A value with a fixed number of bytes.
pub trait Plain: Copy {
    /// The number of bytes.
    const SIZE: usize;
    /// Writes the value into `to`, which has `SIZE` bytes.
    fn store(self, to: &mut [u8]);
    /// Reads a value from `SIZE` bytes.
    fn load(from: &[u8]) -> Self;
}

macro_rules! numbers {
    ($($t:ty),*) => {$(
        impl Plain for $t {
            const SIZE: usize = size_of::<$t>();
            #[inline(always)]
            fn store(self, to: &mut [u8]) {
                to.copy_from_slice(&self.to_le_bytes());
            }
            #[inline(always)]
            fn load(from: &[u8]) -> Self {
                Self::from_le_bytes(from.try_into().expect("as many bytes as it has"))
            }
        }
    )*};
}
numbers!(u8, u32, u64, i32, i64, f32, f64);

impl Plain for bool {
    const SIZE: usize = 1;
    #[inline(always)]
    fn store(self, to: &mut [u8]) {
        u8::from(self).store(to);
    }
    #[inline(always)]
    fn load(from: &[u8]) -> Self {
        u8::load(from) > 0
    }
}

impl<P: Plain + Default, const N: usize> Plain for [P; N] {
    const SIZE: usize = N * P::SIZE;
    #[inline(always)]
    fn store(self, to: &mut [u8]) {
        self.into_iter().zip(to.chunks_exact_mut(P::SIZE)).for_each(|(value, to)| value.store(to));
    }
    #[inline(always)]
    fn load(from: &[u8]) -> Self {
        let mut all = [P::default(); N];
        all.iter_mut().zip(from.chunks_exact(P::SIZE)).for_each(|(to, from)| *to = P::load(from));
        all
    }
}

/// Implements [`Plain`](crate::bytes::Plain) for a struct: its fields in this order. Those after the semicolon are
/// not written, and are read as default values.
#[macro_export]
macro_rules! plain {
    ($name:ident { $($field:ident),* $(; $($left_out:ident),*)? }) => {
        impl $crate::bytes::Plain for $name {
            const SIZE: usize = 0 $(+ $crate::bytes::size_of_field(|all: &$name| &all.$field))*;
            #[inline(always)]
            fn store(self, to: &mut [u8]) {
                let Self { $($field,)* $($($left_out: _,)*)? } = self;
                $(let to = $crate::bytes::store_first($field, to);)*
                debug_assert!(to.is_empty());
            }
            #[inline(always)]
            fn load(from: &[u8]) -> Self {
                $(let ($field, from) = $crate::bytes::load_first(from);)*
                debug_assert!(from.is_empty());
                Self { $($field,)* $($($left_out: Default::default(),)*)? }
            }
        }
    };
}

/// The bytes of a field.
pub const fn size_of_field<S, F: Plain>(_: fn(&S) -> &F) -> usize {
    F::SIZE
}

/// Writes a value into the first bytes; returns the others.
#[inline(always)]
pub fn store_first<P: Plain>(value: P, to: &mut [u8]) -> &mut [u8] {
    let (first, others) = to.split_at_mut(P::SIZE);
    value.store(first);
    others
}

/// Reads a value from the first bytes; returns the others, too.
#[inline(always)]
pub fn load_first<P: Plain>(from: &[u8]) -> (P, &[u8]) {
    let (first, others) = from.split_at(P::SIZE);
    (P::load(first), others)
}

/// Appends a value.
pub fn append<P: Plain>(to: &mut Vec<u8>, value: P) {
    let start = to.len();
    to.resize(start + P::SIZE, 0);
    value.store(&mut to[start..]);
}

/// The values that [`append`] has written one after the other.
pub fn read_all<P: Plain>(from: &[u8]) -> impl Iterator<Item = P> {
    from.chunks_exact(P::SIZE).map(P::load)
}

/// A value in files, of any number of bytes, which may be wrong.
pub trait Saved: Sized {
    /// Appends the value.
    fn put(&self, to: &mut Writer);
    /// Reads it.
    fn get(from: &mut Reader<'_>) -> Result<Self>;
    /// Appends several, without their count.
    fn put_each(all: &[Self], to: &mut Writer) {
        all.iter().for_each(|one| one.put(to));
    }
    /// Reads so many. Memory is not reserved: a damaged count may be very large.
    fn get_each(from: &mut Reader<'_>, count: usize) -> Result<Vec<Self>> {
        let mut all = Vec::new();
        for _ in 0..count {
            memory::push(&mut all, Self::get(from)?)?;
        }
        Ok(all)
    }
}

impl<P: Plain> Saved for P {
    fn put(&self, to: &mut Writer) {
        to.put(*self);
    }
    fn get(from: &mut Reader<'_>) -> Result<Self> {
        from.get()
    }
    fn put_each(all: &[Self], to: &mut Writer) {
        to.put_all(all);
    }
    fn get_each(from: &mut Reader<'_>, count: usize) -> Result<Vec<Self>> {
        from.get_all(count)
    }
}

impl Saved for usize {
    fn put(&self, to: &mut Writer) {
        to.put_count(*self);
    }
    fn get(from: &mut Reader<'_>) -> Result<Self> {
        from.get_count()
    }
}

impl<S: Saved> Saved for Vec<S> {
    fn put(&self, to: &mut Writer) {
        to.put_count(self.len());
        S::put_each(self, to);
    }
    fn get(from: &mut Reader<'_>) -> Result<Self> {
        let count = from.get_count()?;
        S::get_each(from, count)
    }
}

impl<S: Saved> Saved for Option<S> {
    fn put(&self, to: &mut Writer) {
        to.put(self.is_some());
        self.iter().for_each(|value| value.put(to));
    }
    fn get(from: &mut Reader<'_>) -> Result<Self> {
        let is_some: bool = from.get()?;
        is_some.then(|| S::get(from)).transpose()
    }
}

impl<S: Saved> Saved for Arc<S> {
    fn put(&self, to: &mut Writer) {
        (**self).put(to);
    }
    fn get(from: &mut Reader<'_>) -> Result<Self> {
        S::get(from).map(Self::new)
    }
}

impl Saved for Range<u32> {
    fn put(&self, to: &mut Writer) {
        to.put([self.start, self.end]);
    }
    fn get(from: &mut Reader<'_>) -> Result<Self> {
        let [start, end] = from.get()?;
        Ok(start..end)
    }
}

impl Saved for String {
    fn put(&self, to: &mut Writer) {
        to.put_count(self.len());
        to.put_all(self.as_bytes());
    }
    fn get(from: &mut Reader<'_>) -> Result<Self> {
        Self::from_utf8(Saved::get(from)?).map_err(|_| damaged("a text in it is not UTF-8"))
    }
}

/// Implements [`Saved`](crate::bytes::Saved) for a struct or an enum. The fields of a struct after the semicolon are
/// not written, and are read as default values. A variant of an enum has a number, which is never used for another.
#[macro_export]
macro_rules! saved {
    (struct $name:ident { $($field:ident),* $(; $($left_out:ident),*)? }) => {
        impl $crate::bytes::Saved for $name {
            fn put(&self, to: &mut $crate::bytes::Writer) {
                let Self { $($field,)* $($($left_out: _,)*)? } = self;
                $($crate::bytes::Saved::put($field, to);)*
            }
            fn get(from: &mut $crate::bytes::Reader<'_>) -> $crate::error::Result<Self> {
                Ok(Self {
                    $($field: $crate::bytes::Saved::get(from)?,)*
                    $($($left_out: Default::default(),)*)?
                })
            }
        }
    };
    (enum $name:ident($what:literal) {
        $($code:literal => $variant:ident $(($inner:ident))? $({ $($field:ident),* })?),*
    }) => {
        impl $crate::bytes::Saved for $name {
            fn put(&self, to: &mut $crate::bytes::Writer) {
                match self {
                    $(Self::$variant $(($inner))? $({ $($field),* })? => {
                        to.put::<u8>($code);
                        $($crate::bytes::Saved::put($inner, to);)?
                        $($($crate::bytes::Saved::put($field, to);)*)?
                    })*
                }
            }
            fn get(from: &mut $crate::bytes::Reader<'_>) -> $crate::error::Result<Self> {
                Ok(match from.get::<u8>()? {
                    $($code => {
                        $(let $inner = $crate::bytes::Saved::get(from)?;)?
                        $($(let $field = $crate::bytes::Saved::get(from)?;)*)?
                        Self::$variant $(($inner))? $({ $($field),* })?
                    })*
                    _ => return Err($crate::bytes::damaged(concat!("there is no such ", $what))),
                })
            }
        }
    };
}

/// The error for `all` bytes that are not what they should be.
pub fn foreign(all: u64) -> Error {
    let rule = "it does not begin as a snapshot does";
    Error::of("data", format!("{all} bytes of something else"), rule)
}

/// Bytes of the header: magic, version, length and checksum.
pub const HEAD: usize = 28;

/// Writes values, in files after a header with a magic number, the version, the length and a checksum. If there is no
/// memory, it writes nothing more, and the end returns the error.
#[derive(Debug, Default)]
pub struct Writer {
    bytes: Vec<u8>,
    failed: Option<Error>,
}

impl Writer {
    /// A writer of a file with capacity for `bytes` bytes after the header.
    pub fn with_capacity(bytes: usize) -> Self {
        let mut all = Self::default();
        all.reserve(HEAD + bytes);
        all.grow(HEAD);
        all
    }

    /// Writes nothing more: the end returns this error.
    pub fn fail(&mut self, error: Error) {
        self.failed = Some(error);
    }

    fn reserve(&mut self, more: usize) {
        if self.failed.is_none() {
            self.failed = memory::reserve(&mut self.bytes, more).err();
        }
    }

    /// Appends zeros; returns where they begin, unless there is no memory.
    #[inline(always)]
    fn grow(&mut self, more: usize) -> Option<usize> {
        let start = self.bytes.len();
        self.reserve(more);
        self.failed.is_none().then(|| {
            self.bytes.resize(start + more, 0);
            start
        })
    }

    /// Appends a value.
    pub fn put<P: Plain>(&mut self, value: P) {
        self.put_all(&[value]);
    }

    /// Appends a count, as a u64.
    pub fn put_count(&mut self, count: usize) {
        self.put(count as u64);
    }

    /// Appends values without their count.
    pub fn put_all<P: Plain>(&mut self, values: &[P]) {
        let Some(start) = self.grow(values.len() * P::SIZE) else { return };
        let to = self.bytes[start..].chunks_exact_mut(P::SIZE);
        values.iter().zip(to).for_each(|(value, to)| value.store(to));
    }

    /// Appends 1 and the first value if all have the same bytes, otherwise 0 and all values.
    pub fn put_uniform<P: Plain>(&mut self, values: &[P]) {
        self.put(0u8);
        let start = self.bytes.len();
        self.put_all(values);
        if self.failed.is_some() {
            return;
        }
        // Bytes are compared, not values: -0.0 equals 0.0 and NaN equals nothing, but a snapshot
        // gives back the same bits. The values are written first and cut off afterwards, so that
        // each is converted once.
        let all = &self.bytes[start..];
        if all.chunks_exact(P::SIZE).all(|bytes| bytes == &all[..P::SIZE]) {
            self.bytes[start - 1] = 1;
            self.bytes.truncate(start + P::SIZE);
        }
    }

    /// Appends the number of values, a bit for each that says whether it differs from the default value, and
    /// those that do; no values, if none does. Bits of numbers are compared: −0 is not 0.
    pub fn put_sparse<P: Plain + Default>(&mut self, values: &[P]) {
        let begin = self.bytes.len();
        self.put_count(values.len());
        let Some(bits) = self.grow(values.len().div_ceil(8)) else { return };
        let mut default = Vec::new();
        append(&mut default, P::default());
        for (row, value) in values.iter().enumerate() {
            let Some(start) = self.grow(P::SIZE) else { return };
            value.store(&mut self.bytes[start..]);
            if self.bytes[start..] == default {
                self.bytes.truncate(start);
            } else {
                self.bytes[bits + row / 8] |= 1 << (row % 8);
            }
        }
        if self.bytes[bits..].iter().all(|byte| *byte == 0) {
            self.bytes.truncate(begin);
            self.put_count(0);
        }
    }

    /// All bytes, without a header unless there is room for one.
    pub fn into_bytes(self) -> Result<Vec<u8>> {
        self.failed.map_or(Ok(self.bytes), Err)
    }

    /// Fills in the header and returns all bytes.
    pub fn finish(self, magic: [u8; 8], version: u32) -> Result<Vec<u8>> {
        let mut all = self.into_bytes()?;
        let (head, body) = all.split_at_mut(HEAD);
        magic.store(&mut head[..8]);
        version.store(&mut head[8..12]);
        [body.len() as u64, checksum(body)].store(&mut head[12..]);
        Ok(all)
    }
}

/// Reads values in the order in which they were written.
#[derive(Debug)]
pub struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    /// Reads bytes that have no header.
    pub fn without_head(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    /// Checks the header that [`Writer::finish`] has written.
    pub fn open(bytes: &'a [u8], magic: [u8; 8], version: u32) -> Result<Self> {
        let all = bytes.len();
        let mut reader = Self(bytes);
        if all == 0 {
            return Err(Error::of("data", "nothing", "a snapshot has at least its head"));
        }
        if all < HEAD && bytes.iter().zip(&magic).all(|(found, right)| found == right) {
            return Err(cut_off_after(all, HEAD as u64));
        }
        if reader.get::<[u8; 8]>().ok() != Some(magic) {
            return Err(foreign(all as u64));
        }
        let found: u32 = reader.get()?;
        if found != version {
            let rule = format!("this version of jostle reads format {version}");
            return Err(Error::of("data", format!("a snapshot in format {found}"), &rule));
        }
        // The length is checked before the checksum: a file that is cut off gets a message of its
        // own, because its user can copy it again.
        let (length, sum): (u64, u64) = (reader.get()?, reader.get()?);
        if length > reader.0.len() as u64 {
            return Err(cut_off_after(all, (HEAD as u64).saturating_add(length)));
        }
        if length < reader.0.len() as u64 || sum != checksum(reader.0) {
            return Err(damaged("its checksum is wrong"));
        }
        Ok(reader)
    }

    /// The next value.
    pub fn get<P: Plain>(&mut self) -> Result<P> {
        Ok(P::load(self.take(P::SIZE)?))
    }

    /// The next count.
    pub fn get_count(&mut self) -> Result<usize> {
        usize::try_from(self.get::<u64>()?).map_err(|_| damaged("a count is too large"))
    }

    /// The next `count` values.
    pub fn get_all<P: Plain>(&mut self, count: usize) -> Result<Vec<P>> {
        // The bytes are checked before memory is allocated for the values.
        let bytes = self.take(count.checked_mul(P::SIZE).ok_or_else(cut_off)?)?;
        memory::collect(bytes.chunks_exact(P::SIZE).map(P::load))
    }

    /// The next `count` values, which [`Writer::put_uniform`] has written.
    pub fn get_uniform<P: Plain>(&mut self, count: usize) -> Result<Vec<P>> {
        let is_same: bool = self.get()?;
        // `put_uniform` of no values writes 1 and nothing else: all of none are equal.
        if is_same && count > 0 { memory::filled(count, self.get()?) } else { self.get_all(count) }
    }

    /// The next values that [`Writer::put_sparse`] has written, of a column of `len` rows or of none.
    pub fn get_sparse<P: Plain + Default>(&mut self, len: usize) -> Result<Vec<P>> {
        let count = self.get_count()?;
        // A row costs a bit here and many bytes in memory, so a damaged number must not decide.
        if count != 0 && count != len {
            return Err(damaged("the number of values of a column is wrong"));
        }
        let bits = self.take(count.div_ceil(8))?;
        let differs = |row: usize| bits[row / 8] >> (row % 8) & 1 > 0;
        let value = |row| if differs(row) { self.get() } else { Ok(P::default()) };
        memory::try_collect((0..count).map(value))
    }

    /// Whether there are no values left.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Refuses bytes after the last value.
    pub fn close(self) -> Result<()> {
        if self.is_empty() { Ok(()) } else { Err(damaged("something is left over")) }
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or_else(cut_off)?;
        self.0 = rest;
        Ok(taken)
    }
}

/// The error for bytes that are not valid.
pub fn damaged(rule: &str) -> Error {
    Error::of("data", "a damaged snapshot", rule)
}

fn cut_off_after(found: usize, expected: u64) -> Error {
    damaged(&format!("it is cut off: {found} of at least {expected} bytes are there"))
}

fn cut_off() -> Error {
    damaged("it is cut off")
}

/// A 64-bit checksum that any change of a single word changes. Four independent chains of
/// multiplications are as fast as memory.
pub fn checksum(bytes: &[u8]) -> u64 {
    const FACTOR: u64 = 0x9e37_79b9_7f4a_7c15;
    // Each step is a bijection of the word for a given sum, and of the sum for a given word. So two
    // inputs that differ in one word have different sums: nothing after that word can make them
    // equal again. The rotation brings high bits to low places, where the next multiplication
    // spreads them.
    let mix = |sum: u64, word: u64| ((sum ^ word).wrapping_mul(FACTOR)).rotate_left(29);
    // A multiplication waits for the one before it in its chain. Four chains keep the multiplier
    // busy while each waits.
    let mut chains = [1u64, 2, 3, 4];
    let (blocks, rest) = bytes.as_chunks::<32>();
    for block in blocks {
        let (words, _) = block.as_chunks::<8>();
        for (chain, &word) in chains.iter_mut().zip(words) {
            *chain = mix(*chain, u64::from_le_bytes(word));
        }
    }
    let ends = chains.into_iter().chain(rest.iter().map(|&byte| u64::from(byte)));
    ends.fold(bytes.len() as u64, mix)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone, Copy, Debug, PartialEq)]
    struct Pair {
        first: u32,
        flag: bool,
        scratch: [f32; 3],
    }
    plain! { Pair { flag, first; scratch } }

    #[derive(Debug, PartialEq)]
    enum Shape {
        Point,
        Disc(f32),
        Box { low: [f32; 2], name: Option<String> },
    }
    saved! { enum Shape("shape") { 0 => Point, 1 => Disc(radius), 7 => Box { low, name } } }

    #[test]
    fn fields_are_read_as_they_were_written_and_others_are_defaults() {
        let pair = Pair { first: 3, flag: true, scratch: [1.0; 3] };
        let mut bytes = Vec::new();
        append(&mut bytes, pair);
        assert_eq!(bytes, [1, 3, 0, 0, 0]);
        let read: Vec<Pair> = read_all(&bytes).collect();
        assert_eq!(read, [Pair { scratch: [0.0; 3], ..pair }]);
    }

    #[test]
    fn variants_have_numbers_and_others_are_refused() {
        let name = Some("µ".to_owned());
        let all = vec![Shape::Point, Shape::Disc(2.0), Shape::Box { low: [1.0, -0.0], name }];
        let mut to = Writer::default();
        all.put(&mut to);
        let bytes = to.into_bytes().unwrap();
        let mut from = Reader::without_head(&bytes);
        assert_eq!(Vec::<Shape>::get(&mut from).unwrap(), all);
        from.close().unwrap();
        let error = Shape::get(&mut Reader::without_head(&[2])).unwrap_err();
        assert_eq!(error.to_string(), "data is a damaged snapshot; there is no such shape");
    }

    #[test]
    fn sparse_columns_keep_every_bit_and_cost_little() {
        let mut column = vec![0.0f32; 100];
        (column[3], column[99]) = (-0.0, f32::NAN);
        for (values, size) in [(&column[..], 8 + 13 + 8), (&column[4..99], 8), (&[], 8)] {
            let mut to = Writer::default();
            to.put_sparse(values);
            let bytes = to.into_bytes().unwrap();
            assert_eq!(bytes.len(), size);
            let read: Vec<f32> = Reader::without_head(&bytes).get_sparse(values.len()).unwrap();
            let bits = |all: &[f32]| all.iter().map(|v| v.to_bits()).collect::<Vec<u32>>();
            assert_eq!(bits(&read), bits(if size > 8 { values } else { &[] }));
        }
        let many = [vec![0, 0, 1, 0, 0, 0, 0, 0], vec![0; 8192]].concat();
        let read = |len| Reader::without_head(&many).get_sparse::<f32>(len);
        assert_eq!(read(1 << 16), Ok(vec![0.0; 1 << 16]));
        let error = read(100).unwrap_err().to_string();
        assert_eq!(error, "data is a damaged snapshot; the number of values of a column is wrong");
        let too_long = [255u8; 8];
        assert!(Reader::without_head(&too_long).get_sparse::<f32>(usize::MAX).is_err());
    }
}
