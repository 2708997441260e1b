//! SIMD: blocks of sixteen numbers, with the widest vector instructions of the processor.
//!
//! A kernel is written once, as [`Work`] that is generic over [`Simd`]. The implementation is
//! chosen at run time (dynamic dispatch by CPU features), so one build is fast on every
//! processor. No operation is fused or reordered, so all implementations give the same bits.

#![warn(unreachable_pub)]
#![warn(clippy::disallowed_macros, clippy::disallowed_methods, clippy::disallowed_types)]

#[allow(dead_code, reason = "x86-64 uses its packing only; the tests compare with the rest")]
mod portable;
#[cfg(target_arch = "x86_64")]
mod gather;
#[cfg(target_arch = "x86_64")]
mod x86;

use std::ops::{Add, Div, Mul, Sub};
use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};

/// Numbers in a block.
pub const LANES: usize = 16;

/// Numbers in half a block.
pub const HALF: usize = LANES / 2;

/// Bits of the first `count` lanes.
#[inline(always)]
pub fn first_lanes(count: usize) -> u32 {
    // Counts above a block are usual: what is left of a range. A shift by 32 or more would
    // overflow.
    if count < LANES { (1 << count) - 1 } else { (1 << LANES) - 1 }
}

/// Calls `act` with the index of every set bit, lowest first.
#[inline(always)]
pub fn for_each_lane(mut bits: u32, mut act: impl FnMut(usize)) {
    while bits != 0 {
        act(bits.trailing_zeros() as usize);
        // Clears the lowest set bit, so there are as many iterations as bits, not as lanes.
        bits &= bits - 1;
    }
}

/// The [`LANES`] items of `column` from `start`. Panics if the column is shorter.
#[inline(always)]
pub fn block<V>(column: &[V], start: usize) -> &[V; LANES] {
    column[start..].first_chunk().expect("columns carry spare rows")
}

/// As [`block`], mutable.
#[inline(always)]
pub fn block_mut<V>(column: &mut [V], start: usize) -> &mut [V; LANES] {
    column[start..].first_chunk_mut().expect("columns carry spare rows")
}

/// The two float32 of the word at `index`.
#[inline(always)]
pub fn numbers_at(from: &[AtomicU64], index: u32) -> [f32; 2] {
    // Relaxed: a word is read and written whole, so the two numbers belong together. Which thread
    // may write it at what time is decided by the colours of the contacts and by barriers between
    // them.
    let word = from[index as usize].load(Ordering::Relaxed);
    [word as u32, (word >> 32) as u32].map(f32::from_bits)
}

/// Replaces the two float32 of the word at `index`.
#[inline(always)]
pub fn set_numbers_at(to: &[AtomicU64], index: u32, numbers: [f32; 2]) {
    let [a, b] = numbers.map(|number| u64::from(number.to_bits()));
    // Relaxed, as in `numbers_at`.
    to[index as usize].store(a | b << 32, Ordering::Relaxed);
}

/// The indices of [`LANES`] pairs in columns of words. The largest is stored, so that one test is
/// sufficient for all.
#[derive(Clone, Copy, Debug)]
pub struct PairIndices {
    indices: [[u32; LANES]; 2],
    largest: u32,
}

impl PairIndices {
    /// The indices of the first and of the second of each pair.
    pub fn new(indices: [[u32; LANES]; 2]) -> Self {
        // Once for each step: the sixteen indices of a block are then tested by one comparison in
        // each iteration of the solver. Steps of piles take 3 to 4 % less time than with sixteen
        // tests (docs/benchmarks-notes.md).
        let largest = indices.as_flattened().iter().copied().fold(0, u32::max);
        Self { indices, largest }
    }

    /// The indices of the first (k = 0) or of the second (k = 1) of each pair.
    #[inline(always)]
    pub fn of(&self, k: usize) -> &[u32; LANES] {
        &self.indices[k]
    }

    /// As [`of`](Self::of). Panics unless all indices are below `len`.
    #[inline(always)]
    fn below(&self, len: usize, k: usize) -> &[u32; LANES] {
        assert!((self.largest as usize) < len, "an index is too large");
        &self.indices[k]
    }
}

/// Operations on indices and pairs of them, which are the same for all types of numbers.
pub trait Packing: Copy {
    /// Prefetches `column` into the cache.
    fn prefetch<V>(self, column: &[V]);
    /// Writes the pairs of `first` with those of `others` whose bit is set, as [`Simd::pack`].
    fn pair_with(self, first: u32, others: &[u32; LANES], bits: u32, to: &mut [[u32; 2]; LANES]);
    /// Writes the pairs of `first` with `start` + lane for every set bit, as [`Simd::pack`].
    fn pair_with_indices(self, first: u32, start: u32, bits: u32, to: &mut [[u32; 2]; LANES]);
    /// As [`Packing::pair_with`], the smaller number of each pair first; the others are in two halves.
    fn ordered_pairs(
        self,
        first: u32,
        others: [&[u32; HALF]; 2],
        bits: u32,
        to: &mut [[u32; 2]; LANES],
    );
    /// Writes `first` + lane for every set bit, as [`Simd::pack`].
    fn pack_indices(self, first: u32, bits: u32, to: &mut [u32; LANES]);
}

/// Operations on blocks of [`LANES`] numbers by one set of vector instructions. A value of such a
/// type exists only if the processor has these instructions.
pub trait Simd<T: Number>: Packing {
    /// [`LANES`] numbers in registers.
    type Block: Copy;
    /// A block of equal numbers.
    fn splat(self, value: T) -> Self::Block;
    /// Loads a block.
    fn load(self, from: &[T; LANES]) -> Self::Block;
    /// Loads a block from two indices.
    fn load_halves(self, low: &[T; HALF], high: &[T; HALF]) -> Self::Block;
    /// Stores a block.
    fn store(self, block: Self::Block, to: &mut [T; LANES]);
    /// a + b.
    fn add(self, a: Self::Block, b: Self::Block) -> Self::Block;
    /// a − b.
    fn sub(self, a: Self::Block, b: Self::Block) -> Self::Block;
    /// a · b.
    fn mul(self, a: Self::Block, b: Self::Block) -> Self::Block;
    /// a / b.
    fn div(self, a: Self::Block, b: Self::Block) -> Self::Block;
    /// √a.
    fn sqrt(self, a: Self::Block) -> Self::Block;
    /// The larger number in each lane.
    fn max(self, a: Self::Block, b: Self::Block) -> Self::Block;
    /// The smaller number in each lane.
    fn min(self, a: Self::Block, b: Self::Block) -> Self::Block;
    /// |a − b|.
    fn distance(self, a: Self::Block, b: Self::Block) -> Self::Block;
    /// A bit for each lane in which both are below 0. No lane may be −0.
    fn both_negative(self, a: Self::Block, b: Self::Block) -> u32;
    /// A bit for each lane in which a < b.
    fn less(self, a: Self::Block, b: Self::Block) -> u32;
    /// A bit for each lane in which a ≤ b.
    fn at_most(self, a: Self::Block, b: Self::Block) -> u32;
    /// a in lanes whose bit is set, b in the others (blend).
    fn choose(self, bits: u32, a: Self::Block, b: Self::Block) -> Self::Block;
    /// The first and the second numbers of the words at the indices of the k-th of each pair.
    #[inline(always)]
    fn gather(self, from: &[AtomicU64], indices: &PairIndices, k: usize) -> [Self::Block; 2] {
        let mut columns = [[T::default(); LANES]; 2];
        for (lane, &index) in indices.below(from.len(), k).iter().enumerate() {
            let word = numbers_at(from, index);
            (columns[0][lane], columns[1][lane]) = (T::from(word[0]), T::from(word[1]));
        }
        columns.map(|column| self.load(&column))
    }
    /// Writes words to the indices of the k-th of each pair. Of several words with the same index
    /// one is written.
    #[inline(always)]
    fn scatter(self, blocks: [Self::Block; 2], to: &[AtomicU64], indices: &PairIndices, k: usize) {
        let mut columns = [[T::default(); LANES]; 2];
        blocks.into_iter().zip(&mut columns).for_each(|(block, to)| self.store(block, to));
        for (lane, &index) in indices.below(to.len(), k).iter().enumerate() {
            set_numbers_at(to, index, [columns[0][lane].single(), columns[1][lane].single()]);
        }
    }
    /// Writes the numbers whose bit is set, contiguously (stream compaction). Numbers after these
    /// are unspecified.
    fn pack(self, from: Self::Block, bits: u32, to: &mut [T; LANES]);
}

/// A computation that is generic over the vector instructions.
pub trait Work<T: Number> {
    /// Its result.
    type Out;
    /// Computes the result. Must be inlined, with every function that calls `simd`.
    fn run<S: Simd<T>>(self, simd: S) -> Self::Out;
}

/// A type of numbers with vector instructions.
pub trait Number:
    Copy
    + Default
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + From<f32>
    + Send
    + Sync
    + 'static
{
    /// Runs `work` with the widest instructions of the processor.
    fn with_widest<W: Work<Self>>(work: W) -> W::Out;
    /// The square root.
    fn root(self) -> Self;
    /// In float32.
    fn single(self) -> f32;
}

macro_rules! number {
    ($t:ty) => {
        impl Number for $t {
            #[inline(always)]
            fn root(self) -> Self {
                <$t>::sqrt(self)
            }
            #[inline(always)]
            fn single(self) -> f32 {
                self as f32
            }
            fn with_widest<W: Work<Self>>(work: W) -> W::Out {
                // One branch for each piece of work, not for each instruction. Everything below is
                // inlined into the function that has the instructions turned on; a call out of it
                // would run with SSE2 and pass blocks through memory.
                #[cfg(target_arch = "x86_64")]
                match widest() {
                    Instructions::Avx512 => x86::with_avx512(work),
                    Instructions::Avx2 => x86::with_avx2(work),
                    Instructions::Portable => x86::with_sse2(work),
                }
                #[cfg(not(target_arch = "x86_64"))]
                work.run(portable::Portable)
            }
        }
    };
}
number!(f32);
number!(f64);

/// Sets of vector instructions, narrowest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Instructions {
    /// Instructions of every processor of the architecture.
    Portable,
    /// x86-64 of about 2013 and later.
    Avx2,
    /// x86-64 servers, and desktops of about 2022 and later.
    Avx512,
}

const KINDS: [Instructions; 3] = [Instructions::Portable, Instructions::Avx2, Instructions::Avx512];

static LIMIT: AtomicU8 = AtomicU8::new(Instructions::Avx512 as u8);

/// Sets the widest instructions that the process uses from now on. For measurements and tests;
/// results do not depend on it.
pub fn limit(widest: Instructions) {
    // Relaxed: all sets of instructions give the same bits, so it does not matter when a thread
    // sees it.
    LIMIT.store(widest as u8, Ordering::Relaxed);
}

/// The instructions in use.
pub fn widest() -> Instructions {
    let limit = KINDS[usize::from(LIMIT.load(Ordering::Relaxed))];
    #[cfg(target_arch = "x86_64")]
    return limit.min(x86::widest());
    #[cfg(not(target_arch = "x86_64"))]
    return limit.min(Instructions::Portable);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The results of all operations on two blocks.
    struct All<T>([T; LANES], [T; LANES]);

    impl<T: Number> Work<T> for All<T> {
        type Out = (Vec<[T; LANES]>, [u32; 4], Vec<(Vec<T>, [Vec<[u32; 2]>; 3], Vec<u32>)>);

        #[inline(always)]
        fn run<S: Simd<T>>(self, simd: S) -> Self::Out {
            let (a, b) = (simd.load(&self.0), simd.load(&self.1));
            let words: [AtomicU64; LANES] = std::array::from_fn(|_| AtomicU64::default());
            let indices = |step: u32| std::array::from_fn(|lane| (lane as u32 * step + 3) % 16);
            let indices = PairIndices::new([indices(5), indices(7)]);
            simd.scatter([a, b], &words, &indices, 0);
            let shuffled = simd.gather(&words, &indices, 1);
            let halves: [[T; HALF]; 2] =
                [1, 5].map(|from| std::array::from_fn(|lane| self.0[from + lane]));
            let blocks = [
                simd.splat(self.0[3]),
                simd.add(a, b),
                simd.sub(a, b),
                simd.mul(a, b),
                simd.max(a, b),
                simd.min(a, b),
                simd.distance(a, b),
                simd.div(a, b),
                simd.sqrt(simd.mul(a, a)),
                simd.choose(0b0110_1010_0110_0101, a, b),
                shuffled[0],
                shuffled[1],
                simd.load_halves(&halves[0], &halves[1]),
            ];
            let stored = blocks.map(|block| {
                let mut to = [T::default(); LANES];
                simd.store(block, &mut to);
                to
            });
            let mut packed = Vec::new();
            for bits in SETS {
                let (mut numbers, mut indices) = ([T::default(); LANES], [0; LANES]);
                let mut pairs = [[[0; 2]; LANES]; 3];
                simd.pack(a, bits, &mut numbers);
                simd.pack_indices(70, bits, &mut indices);
                simd.pair_with(5, &OTHERS, bits, &mut pairs[0]);
                simd.pair_with_indices(6, 80, bits, &mut pairs[1]);
                let [low, high] = [&OTHERS[..HALF], &OTHERS[HALF..]].map(|half| half.try_into());
                simd.ordered_pairs(12, [low.unwrap(), high.unwrap()], bits, &mut pairs[2]);
                let count = bits.count_ones() as usize;
                let pairs = pairs.map(|pairs| pairs[..count].to_vec());
                packed.push((numbers[..count].to_vec(), pairs, indices[..count].to_vec()));
            }
            let bits =
                [simd.both_negative(a, b), simd.less(a, b), simd.at_most(a, b), simd.at_most(a, a)];
            (stored.to_vec(), bits, packed)
        }
    }

    /// Sets of lanes: none, few and many, in one half and in both.
    const SETS: [u32; 9] =
        [0, 0x1, 0x8000, 0x8181, 0x00f0, 0xf000, 0x801f, 0b1010_0110_0000_0001, 0xffff];

    const OTHERS: [u32; LANES] = [9, 31, 7, 2, 8, 40, 41, 3, 77, 60, 12, 13, 90, 4, 1, 55];

    /// The portable implementation and the instructions of this processor give the same results.
    #[test]
    fn all_sets_of_instructions_agree() {
        let number = |lane: usize| ((lane * 37 + 11) % 23) as f32 - 11.5;
        let a: [f32; LANES] = std::array::from_fn(number);
        let b: [f32; LANES] = std::array::from_fn(|lane| number(LANES - lane) * 0.3);
        let before = widest();
        for kind in KINDS {
            limit(kind);
            let plain = All(a, b).run(portable::Portable);
            assert_eq!(f32::with_widest(All(a, b)), plain, "{kind:?}");
            let (a, b) = (a.map(f64::from), b.map(f64::from));
            let plain = All(a, b).run(portable::Portable);
            assert_eq!(f64::with_widest(All(a, b)), plain, "{kind:?}");
        }
        limit(before);
    }
}
