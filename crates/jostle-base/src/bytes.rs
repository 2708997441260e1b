//! Serialization of numbers: little-endian, without padding, so the bytes are the same on every
//! machine.

use crate::error::{Error, Result};

/// A value with a fixed number of bytes.
pub trait Plain: Copy {
    /// The number of bytes.
    const SIZE: usize;
    /// Writes the value into `to`, which has `SIZE` bytes.
    fn store(self, to: &mut [u8]);
    /// Reads a value from `SIZE` bytes.
    fn load(from: &[u8]) -> Self;
}

macro_rules! plain {
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
plain!(u8, u32, u64, f32, f64);

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

/// The error for `all` bytes that are not what they should be.
pub fn foreign(all: u64) -> Error {
    let rule = "it does not begin as a snapshot does";
    Error::of("data", format!("{all} bytes of something else"), rule)
}

/// Bytes of the header: magic, version, length and checksum.
pub const HEAD: usize = 28;

/// Writes values after a header with a magic number, the version, the length and a checksum.
#[derive(Debug)]
pub struct Writer(Vec<u8>);

impl Writer {
    /// A writer with capacity for `bytes` bytes after the header.
    pub fn with_capacity(bytes: usize) -> Self {
        let mut all = Vec::with_capacity(HEAD + bytes);
        all.resize(HEAD, 0);
        Self(all)
    }

    /// Appends a value.
    pub fn put(&mut self, value: impl Plain) {
        self.put_all(&[value]);
    }

    /// Appends a count, as a u64.
    pub fn put_count(&mut self, count: usize) {
        self.put(count as u64);
    }

    /// Appends values without their count.
    pub fn put_all<P: Plain>(&mut self, values: &[P]) {
        let start = self.0.len();
        self.0.resize(start + values.len() * P::SIZE, 0);
        let to = self.0[start..].chunks_exact_mut(P::SIZE);
        values.iter().zip(to).for_each(|(value, to)| value.store(to));
    }

    /// Appends 1 and the first value if all have the same bytes, otherwise 0 and all values.
    pub fn put_uniform<P: Plain>(&mut self, values: &[P]) {
        self.put(0u8);
        let start = self.0.len();
        self.put_all(values);
        // Bytes are compared, not values: -0.0 equals 0.0 and NaN equals nothing, but a snapshot
        // gives back the same bits. The values are written first and cut off afterwards, so that
        // each is converted once.
        let all = &self.0[start..];
        if all.chunks_exact(P::SIZE).all(|bytes| bytes == &all[..P::SIZE]) {
            self.0[start - 1] = 1;
            self.0.truncate(start + P::SIZE);
        }
    }

    /// Fills in the header and returns all bytes.
    pub fn finish(mut self, magic: [u8; 8], version: u32) -> Vec<u8> {
        let (head, body) = self.0.split_at_mut(HEAD);
        magic.store(&mut head[..8]);
        version.store(&mut head[8..12]);
        [body.len() as u64, checksum(body)].store(&mut head[12..]);
        self.0
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
        Ok(bytes.chunks_exact(P::SIZE).map(P::load).collect())
    }

    /// The next `count` values, which [`Writer::put_uniform`] has written.
    pub fn get_uniform<P: Plain>(&mut self, count: usize) -> Result<Vec<P>> {
        let is_same: bool = self.get()?;
        // `put_uniform` of no values writes 1 and nothing else: all of none are equal.
        if is_same && count > 0 { Ok(vec![self.get()?; count]) } else { self.get_all(count) }
    }

    /// Refuses bytes after the last value.
    pub fn close(self) -> Result<()> {
        if self.0.is_empty() { Ok(()) } else { Err(damaged("something is left over")) }
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
