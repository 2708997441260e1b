//! Blocks as arrays, which the compiler vectorizes for the target.

use super::{HALF, LANES, Number, Packing, Simd, for_each_lane};

/// Instructions of every processor of the architecture.
#[derive(Clone, Copy)]
pub(crate) struct Portable;

/// [`Simd::pack`], one set bit after the other.
#[inline(always)]
pub(crate) fn pack<V: Copy>(from: &[V; LANES], bits: u32, to: &mut [V; LANES]) {
    let mut count = 0;
    for_each_lane(bits, |lane| {
        // The remainders change nothing, since there are only sixteen bits. They tell the compiler,
        // which then leaves out the checks.
        to[count % LANES] = from[lane % LANES];
        count += 1;
    });
}

/// [`Simd::pack_indices`], one set bit after the other.
#[inline(always)]
pub(crate) fn pack_indices(first: u32, bits: u32, to: &mut [u32; LANES]) {
    let mut count = 0;
    for_each_lane(bits, |lane| {
        to[count % LANES] = first + lane as u32;
        count += 1;
    });
}

/// [`Simd::pair_with`], one set bit after the other.
#[inline(always)]
pub(crate) fn pair_with(
    first: u32,
    other: impl Fn(usize) -> u32,
    bits: u32,
    to: &mut [[u32; 2]; LANES],
) {
    let mut count = 0;
    for_each_lane(bits, |lane| {
        to[count % LANES] = [first, other(lane)];
        count += 1;
    });
}

/// [`Simd::ordered_pairs`], one set bit after the other.
#[inline(always)]
pub(crate) fn ordered_pairs(
    first: u32,
    others: [&[u32; HALF]; 2],
    bits: u32,
    to: &mut [[u32; 2]; LANES],
) {
    let mut count = 0;
    for_each_lane(bits, |lane| {
        let other = others[lane / HALF % 2][lane % HALF];
        to[count % LANES] = [first.min(other), first.max(other)];
        count += 1;
    });
}

#[inline(always)]
fn both<T: Number>(a: [T; LANES], b: [T; LANES], f: impl Fn(T, T) -> T) -> [T; LANES] {
    let mut out = a;
    for (out, b) in out.iter_mut().zip(b) {
        *out = f(*out, b);
    }
    out
}

impl Packing for Portable {
    #[inline(always)]
    fn prefetch<V>(self, _column: &[V]) {}
    #[inline(always)]
    fn pair_with(self, first: u32, others: &[u32; LANES], bits: u32, to: &mut [[u32; 2]; LANES]) {
        pair_with(first, |lane| others[lane % LANES], bits, to);
    }
    #[inline(always)]
    fn pair_with_indices(self, first: u32, start: u32, bits: u32, to: &mut [[u32; 2]; LANES]) {
        pair_with(first, |lane| start + lane as u32, bits, to);
    }
    #[inline(always)]
    fn ordered_pairs(
        self,
        first: u32,
        others: [&[u32; HALF]; 2],
        bits: u32,
        to: &mut [[u32; 2]; LANES],
    ) {
        ordered_pairs(first, others, bits, to);
    }
    #[inline(always)]
    fn pack_indices(self, first: u32, bits: u32, to: &mut [u32; LANES]) {
        pack_indices(first, bits, to);
    }
}

impl<T: Number> Simd<T> for Portable {
    type Block = [T; LANES];

    #[inline(always)]
    fn splat(self, value: T) -> Self::Block {
        [value; LANES]
    }
    #[inline(always)]
    fn load(self, from: &[T; LANES]) -> Self::Block {
        *from
    }
    #[inline(always)]
    fn load_halves(self, low: &[T; HALF], high: &[T; HALF]) -> Self::Block {
        std::array::from_fn(|lane| if lane < HALF { low[lane] } else { high[lane - HALF] })
    }
    #[inline(always)]
    fn store(self, block: Self::Block, to: &mut [T; LANES]) {
        *to = block;
    }
    #[inline(always)]
    fn add(self, a: Self::Block, b: Self::Block) -> Self::Block {
        both(a, b, |a, b| a + b)
    }
    #[inline(always)]
    fn sub(self, a: Self::Block, b: Self::Block) -> Self::Block {
        both(a, b, |a, b| a - b)
    }
    #[inline(always)]
    fn mul(self, a: Self::Block, b: Self::Block) -> Self::Block {
        both(a, b, |a, b| a * b)
    }
    #[inline(always)]
    fn div(self, a: Self::Block, b: Self::Block) -> Self::Block {
        both(a, b, |a, b| a / b)
    }
    #[inline(always)]
    fn sqrt(self, a: Self::Block) -> Self::Block {
        a.map(T::root)
    }
    #[inline(always)]
    fn max(self, a: Self::Block, b: Self::Block) -> Self::Block {
        // Not `T::max`: of +0 and -0, and of NaN and a number, the vector instructions return the
        // second operand.
        both(a, b, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn min(self, a: Self::Block, b: Self::Block) -> Self::Block {
        both(a, b, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn distance(self, a: Self::Block, b: Self::Block) -> Self::Block {
        // It has the bits of the absolute value of a - b: rounding is symmetric, and for
        // equal numbers the difference is +0.
        both(a, b, |a, b| if a > b { a - b } else { b - a })
    }
    #[inline(always)]
    fn both_negative(self, a: Self::Block, b: Self::Block) -> u32 {
        let zero = T::default();
        let negative = |lane: usize| (a[lane] < zero) & (b[lane] < zero);
        (0..LANES).fold(0, |bits, lane| bits | u32::from(negative(lane)) << lane)
    }
    #[inline(always)]
    fn less(self, a: Self::Block, b: Self::Block) -> u32 {
        (0..LANES).fold(0, |bits, lane| bits | u32::from(a[lane] < b[lane]) << lane)
    }
    #[inline(always)]
    fn at_most(self, a: Self::Block, b: Self::Block) -> u32 {
        (0..LANES).fold(0, |bits, lane| bits | u32::from(a[lane] <= b[lane]) << lane)
    }
    #[inline(always)]
    fn choose(self, bits: u32, a: Self::Block, b: Self::Block) -> Self::Block {
        let chosen = |lane: usize| if bits >> lane & 1 == 1 { a[lane] } else { b[lane] };
        std::array::from_fn(chosen)
    }
    #[inline(always)]
    fn pack(self, from: Self::Block, bits: u32, to: &mut [T; LANES]) {
        pack(&from, bits, to);
    }
}
