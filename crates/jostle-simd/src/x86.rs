//! SSE2, AVX2 and AVX-512, with [`gather`](super::gather) the only unsafe code of the core.
//!
//! It is sound for two reasons. A token ([`Avx2`], [`Avx512`]) is created only in [`with_avx2`]
//! and [`with_avx512`], after a check of the CPU features, so its instructions exist. Every
//! x86-64 processor has SSE2. Loads and stores use references to arrays of exactly the length
//! that they access.
#![allow(unsafe_code)]
// The macros use `unsafe` for all instructions; those of SSE2 do not need it.
#![allow(unused_unsafe)]

use std::arch::x86_64::*;
use std::sync::atomic::AtomicU64;

use super::gather;
use super::{HALF, Instructions, LANES, Number, Packing, PairIndices, Simd, Work, portable};

/// SSE2, which every x86-64 processor has. Auto-vectorized code would be slower, and would take
/// several times longer to compile.
#[derive(Clone, Copy)]
pub(crate) struct Sse2;

/// A token: the processor has AVX2, BMI1, BMI2 and POPCNT.
#[derive(Clone, Copy)]
pub(crate) struct Avx2(());

/// A token: the processor has AVX-512 (F, VL, BW, DQ) and the features of [`Avx2`].
#[derive(Clone, Copy)]
pub(crate) struct Avx512(());

/// The widest instructions of this processor.
pub(crate) fn widest() -> Instructions {
    let older = is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("bmi2")
        && is_x86_feature_detected!("popcnt");
    let newer = is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512dq");
    match (older, newer) {
        (true, true) => Instructions::Avx512,
        (true, false) => Instructions::Avx2,
        _ => Instructions::Portable,
    }
}

/// Runs `work` with AVX2.
#[inline]
pub(crate) fn with_avx2<T: Number, W: Work<T>>(work: W) -> W::Out
where
    Avx2: Simd<T>,
{
    #[target_feature(enable = "avx2,bmi1,bmi2,popcnt")]
    fn inner<T: Number, W: Work<T>>(work: W) -> W::Out
    where
        Avx2: Simd<T>,
    {
        work.run(Avx2(()))
    }
    // `is_x86_feature_detected` keeps its answer in an atomic word, so the check costs a few
    // instructions for each piece of work.
    assert!(widest() >= Instructions::Avx2);
    // SAFETY: the line above has made sure that the processor has the features.
    unsafe { inner(work) }
}

/// Runs `work` with AVX-512.
#[inline]
pub(crate) fn with_avx512<T: Number, W: Work<T>>(work: W) -> W::Out
where
    Avx512: Simd<T>,
{
    #[target_feature(enable = "avx512f,avx512vl,avx512bw,avx512dq,avx2,bmi1,bmi2,popcnt")]
    fn inner<T: Number, W: Work<T>>(work: W) -> W::Out
    where
        Avx512: Simd<T>,
    {
        work.run(Avx512(()))
    }
    assert!(widest() >= Instructions::Avx512);
    // SAFETY: the line above has made sure that the processor has the features.
    unsafe { inner(work) }
}

/// Runs `work` with SSE2.
#[inline(never)]
pub(crate) fn with_sse2<T: Number, W: Work<T>>(work: W) -> W::Out
where
    Sse2: Simd<T>,
{
    work.run(Sse2)
}

/// Bytes of a cache line.
const CACHE_LINE: usize = 64;

/// Prefetches a column, line by line.
#[inline(always)]
fn prefetch<V>(column: &[V]) {
    for line in column.chunks(CACHE_LINE / size_of::<V>()) {
        // SAFETY: every processor has the instruction, and any address is valid for it.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(line.as_ptr().cast()) }
    }
}

/// Implements [`Simd`] except for packing, with registers `$k` of `$each` numbers. Unrolled: loops
/// would take most of the compile time.
macro_rules! arithmetic {
    ($t:ty, [$($k:literal)*] of $each:literal in $register:ty, $splat:ident, $load:ident,
     $store:ident, $add:ident, $sub:ident, $mul:ident, $max:ident, $min:ident, $less:expr,
     $abs:expr, $negative:expr, $div:ident, $sqrt:ident, $at_most:expr, $choose:expr) => {
        type Block = [$register; LANES / $each];

        #[inline(always)]
        fn splat(self, value: $t) -> Self::Block {
            // SAFETY: the token proves that the processor has the instruction.
            [unsafe { $splat(value) }; LANES / $each]
        }
        #[inline(always)]
        fn load(self, from: &[$t; LANES]) -> Self::Block {
            let from = from.as_ptr();
            // SAFETY: as above; register k covers numbers k · each … of the LANES there are.
            unsafe { [$($load(from.add($k * $each))),*] }
        }
        #[inline(always)]
        fn store(self, block: Self::Block, to: &mut [$t; LANES]) {
            let to = to.as_mut_ptr();
            // SAFETY: as in `load`.
            unsafe { $($store(to.add($k * $each), block[$k]);)* }
        }
        #[inline(always)]
        fn add(self, a: Self::Block, b: Self::Block) -> Self::Block {
            // SAFETY: the token proves that the processor has the instruction.
            unsafe { [$($add(a[$k], b[$k])),*] }
        }
        #[inline(always)]
        fn sub(self, a: Self::Block, b: Self::Block) -> Self::Block {
            // SAFETY: as above.
            unsafe { [$($sub(a[$k], b[$k])),*] }
        }
        #[inline(always)]
        fn mul(self, a: Self::Block, b: Self::Block) -> Self::Block {
            // SAFETY: as above.
            unsafe { [$($mul(a[$k], b[$k])),*] }
        }
        #[inline(always)]
        fn div(self, a: Self::Block, b: Self::Block) -> Self::Block {
            // SAFETY: as above.
            unsafe { [$($div(a[$k], b[$k])),*] }
        }
        #[inline(always)]
        fn sqrt(self, a: Self::Block) -> Self::Block {
            // SAFETY: as above.
            unsafe { [$($sqrt(a[$k])),*] }
        }
        #[inline(always)]
        fn max(self, a: Self::Block, b: Self::Block) -> Self::Block {
            // SAFETY: as above.
            unsafe { [$($max(a[$k], b[$k])),*] }
        }
        #[inline(always)]
        fn min(self, a: Self::Block, b: Self::Block) -> Self::Block {
            // SAFETY: as above.
            unsafe { [$($min(a[$k], b[$k])),*] }
        }
        #[inline(always)]
        fn distance(self, a: Self::Block, b: Self::Block) -> Self::Block {
            let difference: Self::Block = Simd::<$t>::sub(self, a, b);
            [$($abs(self, difference[$k])),*]
        }
        #[inline(always)]
        fn both_negative(self, a: Self::Block, b: Self::Block) -> u32 {
            0 $(| $negative(self, a[$k], b[$k]) << ($k * $each))*
        }
        #[inline(always)]
        fn less(self, a: Self::Block, b: Self::Block) -> u32 {
            0 $(| $less(self, a[$k], b[$k]) << ($k * $each))*
        }
        #[inline(always)]
        fn at_most(self, a: Self::Block, b: Self::Block) -> u32 {
            0 $(| $at_most(self, a[$k], b[$k]) << ($k * $each))*
        }
        #[inline(always)]
        fn choose(self, bits: u32, a: Self::Block, b: Self::Block) -> Self::Block {
            [$($choose(self, bits >> ($k * $each), a[$k], b[$k])),*]
        }
    };
}

/// [`Simd::load_halves`] with registers `$k` of `$each` numbers, at most half a block.
macro_rules! load_halves {
    ($t:ty, [$($k:literal)*] of $each:literal, $load:ident) => {
        #[inline(always)]
        fn load_halves(self, low: &[$t; HALF], high: &[$t; HALF]) -> Self::Block {
            let [low, high] = [low.as_ptr(), high.as_ptr()];
            // SAFETY: as in `load`; register k covers numbers k · each … of the one half, or those
            // of the other, which follow it.
            unsafe {
                [$($load(if $k * $each < HALF {
                    low.add($k * $each)
                } else {
                    high.add($k * $each - HALF)
                })),*]
            }
        }
    };
}

/// Packs in memory, because there is no instruction for it.
macro_rules! pack_one_by_one {
    ($t:ty) => {
        #[inline(always)]
        fn pack(self, from: Self::Block, bits: u32, to: &mut [$t; LANES]) {
            // SSE2 cannot permute by a variable. A loop over the set bits is as short as there are
            // hits.
            let mut numbers = [0.0; LANES];
            self.store(from, &mut numbers);
            portable::pack(&numbers, bits, to);
        }
    };
}

/// Functions of one or two registers, for [`arithmetic`].
macro_rules! functions {
    ($($name:ident($token:ty, $($v:ident),+: $register:ty) -> $out:ty = $body:expr;)*) => {$(
        #[inline(always)]
        fn $name(_: $token, $($v: $register),+) -> $out {
            // SAFETY: the token proves the instruction.
            unsafe { $body }
        }
    )*};
}

functions! {
    abs_128(Sse2, v: __m128) -> __m128 = _mm_andnot_ps(_mm_set1_ps(-0.0), v);
    abs_128d(Sse2, v: __m128d) -> __m128d = _mm_andnot_pd(_mm_set1_pd(-0.0), v);
    negative_128(Sse2, a, b: __m128) -> u32 = _mm_movemask_ps(_mm_and_ps(a, b)) as u32;
    negative_128d(Sse2, a, b: __m128d) -> u32 = _mm_movemask_pd(_mm_and_pd(a, b)) as u32;
    less_128(Sse2, a, b: __m128) -> u32 = _mm_movemask_ps(_mm_cmplt_ps(a, b)) as u32;
    less_128d(Sse2, a, b: __m128d) -> u32 = _mm_movemask_pd(_mm_cmplt_pd(a, b)) as u32;
    abs_512(Avx512, v: __m512) -> __m512 = _mm512_abs_ps(v);
    abs_512d(Avx512, v: __m512d) -> __m512d = _mm512_abs_pd(v);
    abs_256(Avx2, v: __m256) -> __m256 = _mm256_andnot_ps(_mm256_set1_ps(-0.0), v);
    abs_256d(Avx2, v: __m256d) -> __m256d = _mm256_andnot_pd(_mm256_set1_pd(-0.0), v);
    negative_512(Avx512, a, b: __m512) -> u32 = u32::from(_mm512_movepi32_mask(_mm512_castps_si512(_mm512_and_ps(a, b))));
    negative_512d(Avx512, a, b: __m512d) -> u32 = u32::from(_mm512_movepi64_mask(_mm512_castpd_si512(_mm512_and_pd(a, b))));
    negative_256(Avx2, a, b: __m256) -> u32 = _mm256_movemask_ps(_mm256_and_ps(a, b)) as u32;
    negative_256d(Avx2, a, b: __m256d) -> u32 = _mm256_movemask_pd(_mm256_and_pd(a, b)) as u32;
    less_512(Avx512, a, b: __m512) -> u32 = u32::from(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b));
    less_512d(Avx512, a, b: __m512d) -> u32 = u32::from(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b));
    less_256(Avx2, a, b: __m256) -> u32 = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b)) as u32;
    less_256d(Avx2, a, b: __m256d) -> u32 = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(a, b)) as u32;
    at_most_128(Sse2, a, b: __m128) -> u32 = _mm_movemask_ps(_mm_cmple_ps(a, b)) as u32;
    at_most_128d(Sse2, a, b: __m128d) -> u32 = _mm_movemask_pd(_mm_cmple_pd(a, b)) as u32;
    at_most_256(Avx2, a, b: __m256) -> u32 = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b)) as u32;
    at_most_256d(Avx2, a, b: __m256d) -> u32 = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LE_OQ>(a, b)) as u32;
    at_most_512(Avx512, a, b: __m512) -> u32 = u32::from(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b));
    at_most_512d(Avx512, a, b: __m512d) -> u32 = u32::from(_mm512_cmp_pd_mask::<_CMP_LE_OQ>(a, b));
}

// SAFETY of these: the token proves the instruction.

#[inline(always)]
fn choose_128(_: Sse2, bits: u32, a: __m128, b: __m128) -> __m128 {
    unsafe {
        // The bits become a mask: each lane keeps its own bit of the word and compares it with what
        // it should be.
        let lanes = _mm_setr_epi32(1, 2, 4, 8);
        let chosen = _mm_and_si128(_mm_set1_epi32(bits as i32), lanes);
        let mask = _mm_castsi128_ps(_mm_cmpeq_epi32(chosen, lanes));
        _mm_or_ps(_mm_and_ps(mask, a), _mm_andnot_ps(mask, b))
    }
}

#[inline(always)]
fn choose_128d(_: Sse2, bits: u32, a: __m128d, b: __m128d) -> __m128d {
    unsafe {
        let lanes = _mm_setr_epi32(1, 1, 2, 2);
        let chosen = _mm_and_si128(_mm_set1_epi32(bits as i32), lanes);
        let mask = _mm_castsi128_pd(_mm_cmpeq_epi32(chosen, lanes));
        _mm_or_pd(_mm_and_pd(mask, a), _mm_andnot_pd(mask, b))
    }
}

#[inline(always)]
fn choose_256(_: Avx2, bits: u32, a: __m256, b: __m256) -> __m256 {
    unsafe {
        let lanes = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
        let chosen = _mm256_and_si256(_mm256_set1_epi32(bits as i32), lanes);
        _mm256_blendv_ps(b, a, _mm256_castsi256_ps(_mm256_cmpeq_epi32(chosen, lanes)))
    }
}

#[inline(always)]
fn choose_256d(_: Avx2, bits: u32, a: __m256d, b: __m256d) -> __m256d {
    unsafe {
        let lanes = _mm256_setr_epi64x(1, 2, 4, 8);
        let chosen = _mm256_and_si256(_mm256_set1_epi64x(i64::from(bits)), lanes);
        _mm256_blendv_pd(b, a, _mm256_castsi256_pd(_mm256_cmpeq_epi64(chosen, lanes)))
    }
}

#[inline(always)]
fn choose_512(_: Avx512, bits: u32, a: __m512, b: __m512) -> __m512 {
    unsafe { _mm512_mask_blend_ps(bits as u16, b, a) }
}

#[inline(always)]
fn choose_512d(_: Avx512, bits: u32, a: __m512d, b: __m512d) -> __m512d {
    unsafe { _mm512_mask_blend_pd(bits as u8, b, a) }
}

impl Packing for Avx512 {
    #[inline(always)]
    fn prefetch<V>(self, column: &[V]) {
        prefetch(column);
    }
    #[inline(always)]
    fn pair_with(self, first: u32, others: &[u32; LANES], bits: u32, to: &mut [[u32; 2]; LANES]) {
        // SAFETY: the token proves the instruction; the array is one register long.
        let others = unsafe { _mm512_loadu_epi32(others.as_ptr().cast()) };
        pairs_512(self, first, others, bits, to);
    }
    #[inline(always)]
    fn pair_with_indices(self, first: u32, start: u32, bits: u32, to: &mut [[u32; 2]; LANES]) {
        pairs_512(self, first, counted_512(self, start), bits, to);
    }
    #[inline(always)]
    fn ordered_pairs(
        self,
        first: u32,
        [low, high]: [&[u32; HALF]; 2],
        bits: u32,
        to: &mut [[u32; 2]; LANES],
    ) {
        ordered_pairs_512(self, first, [low, high], bits, to);
    }
    #[inline(always)]
    fn pack_indices(self, first: u32, bits: u32, to: &mut [u32; LANES]) {
        pack_indices_512(self, first, bits, to);
    }
}

impl Simd<f32> for Avx512 {
    arithmetic!(
        f32,
        [0] of 16 in __m512,
        _mm512_set1_ps,
        _mm512_loadu_ps,
        _mm512_storeu_ps,
        _mm512_add_ps,
        _mm512_sub_ps,
        _mm512_mul_ps,
        _mm512_max_ps,
        _mm512_min_ps,
        less_512,
        abs_512,
        negative_512,
        _mm512_div_ps,
        _mm512_sqrt_ps,
        at_most_512,
        choose_512
    );

    #[inline(always)]
    fn gather(self, from: &[AtomicU64], indices: &PairIndices, k: usize) -> [Self::Block; 2] {
        let indices = indices.below(from.len(), k);
        // SAFETY: the line above, and the token.
        let [x, y] = unsafe { gather::gather_512(from, indices) };
        [[x], [y]]
    }
    #[inline(always)]
    fn scatter(self, [x, y]: [Self::Block; 2], to: &[AtomicU64], indices: &PairIndices, k: usize) {
        let indices = indices.below(to.len(), k);
        // SAFETY: the line above, and the token.
        unsafe { gather::scatter_512([x[0], y[0]], to, indices) }
    }
    #[inline(always)]
    fn pack(self, [from]: Self::Block, bits: u32, to: &mut [f32; LANES]) {
        // SAFETY: the token proves the instruction; the array is one register long.
        unsafe {
            let packed = _mm512_maskz_compress_ps(bits as u16, from);
            _mm512_storeu_ps(to.as_mut_ptr(), packed);
        }
    }
    #[inline(always)]
    fn load_halves(self, low: &[f32; HALF], high: &[f32; HALF]) -> Self::Block {
        // SAFETY: the token proves the instructions; each array is half a register long.
        unsafe {
            let low = _mm512_castps256_ps512(_mm256_loadu_ps(low.as_ptr()));
            [_mm512_insertf32x8::<1>(low, _mm256_loadu_ps(high.as_ptr()))]
        }
    }
}

impl Simd<f64> for Avx512 {
    arithmetic!(
        f64,
        [0 1] of 8 in __m512d,
        _mm512_set1_pd,
        _mm512_loadu_pd,
        _mm512_storeu_pd,
        _mm512_add_pd,
        _mm512_sub_pd,
        _mm512_mul_pd,
        _mm512_max_pd,
        _mm512_min_pd,
        less_512d,
        abs_512d,
        negative_512d,
        _mm512_div_pd,
        _mm512_sqrt_pd,
        at_most_512d,
        choose_512d
    );

    #[inline(always)]
    fn pack(self, from: Self::Block, bits: u32, to: &mut [f64; LANES]) {
        let low = bits & 0xff;
        // SAFETY: the token proves the instruction; the first register's numbers are at
        // most eight, so that the second one's eight end within the sixteen there are.
        unsafe {
            let packed = _mm512_maskz_compress_pd(low as u8, from[0]);
            _mm512_storeu_pd(to.as_mut_ptr(), packed);
            let packed = _mm512_maskz_compress_pd((bits >> 8) as u8, from[1]);
            _mm512_storeu_pd(to.as_mut_ptr().add(low.count_ones() as usize), packed);
        }
    }
    load_halves!(f64, [0 1] of 8, _mm512_loadu_pd);
}

// Compressing into a register and storing that is many times faster on some
// processors than compressing into memory.

/// Sixteen numbers from `first` on.
#[inline(always)]
fn counted_512(_: Avx512, first: u32) -> __m512i {
    // SAFETY: the token proves the instructions.
    unsafe {
        let lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
        _mm512_add_epi32(_mm512_set1_epi32(first as i32), lanes)
    }
}

/// Pairs of `first` with the numbers whose bit is set. More than four at once are rare, and a
/// store of four crosses fewer cache lines.
#[inline(always)]
fn pairs_512(_: Avx512, first: u32, others: __m512i, bits: u32, to: &mut [[u32; 2]; LANES]) {
    // SAFETY: the token proves the instructions; all stores end within the sixteen pairs.
    unsafe {
        let to = to.as_mut_ptr();
        // Compressed first: the numbers that count are in front, so the pairs are the first ones of
        // each store.
        let others = _mm512_maskz_compress_epi32(bits as u16, others);
        let (own, low) = (_mm_set1_epi32(first as i32), _mm512_castsi512_si128(others));
        _mm_storeu_si128(to.cast(), _mm_unpacklo_epi32(own, low));
        _mm_storeu_si128(to.add(2).cast(), _mm_unpackhi_epi32(own, low));
        if bits.count_ones() > 4 {
            let low = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
            let high =
                _mm512_setr_epi32(8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
            let own = _mm512_set1_epi32(first as i32);
            _mm512_storeu_si512(to.cast(), _mm512_permutex2var_epi32(own, low, others));
            _mm512_storeu_si512(to.add(8).cast(), _mm512_permutex2var_epi32(own, high, others));
        }
    }
}

/// As [`pairs_512`], the smaller number of each pair first.
#[inline(always)]
fn ordered_pairs_512(
    _: Avx512,
    first: u32,
    [low, high]: [&[u32; HALF]; 2],
    bits: u32,
    to: &mut [[u32; 2]; LANES],
) {
    // SAFETY: the token proves the instructions; each array is half a register long, and all stores
    // end within the sixteen pairs.
    unsafe {
        let to = to.as_mut_ptr();
        let low = _mm512_castsi256_si512(_mm256_loadu_si256(low.as_ptr().cast()));
        let others = _mm512_inserti32x8::<1>(low, _mm256_loadu_si256(high.as_ptr().cast()));
        let others = _mm512_maskz_compress_epi32(bits as u16, others);
        let (own, four) = (_mm_set1_epi32(first as i32), _mm512_castsi512_si128(others));
        let (less, more) = (_mm_min_epu32(own, four), _mm_max_epu32(own, four));
        _mm_storeu_si128(to.cast(), _mm_unpacklo_epi32(less, more));
        _mm_storeu_si128(to.add(2).cast(), _mm_unpackhi_epi32(less, more));
        if bits.count_ones() > 4 {
            let low = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
            let high =
                _mm512_setr_epi32(8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
            let own = _mm512_set1_epi32(first as i32);
            let (less, more) = (_mm512_min_epu32(own, others), _mm512_max_epu32(own, others));
            _mm512_storeu_si512(to.cast(), _mm512_permutex2var_epi32(less, low, more));
            _mm512_storeu_si512(to.add(8).cast(), _mm512_permutex2var_epi32(less, high, more));
        }
    }
}

#[inline(always)]
fn pack_indices_512(token: Avx512, first: u32, bits: u32, to: &mut [u32; LANES]) {
    // SAFETY: the token proves the instructions; the array is one register long.
    unsafe {
        let packed = _mm512_maskz_compress_epi32(bits as u16, counted_512(token, first));
        _mm512_storeu_epi32(to.as_mut_ptr().cast(), packed);
    }
}

impl Packing for Avx2 {
    #[inline(always)]
    fn prefetch<V>(self, column: &[V]) {
        prefetch(column);
    }
    #[inline(always)]
    fn pair_with(self, first: u32, others: &[u32; LANES], bits: u32, to: &mut [[u32; 2]; LANES]) {
        // SAFETY: the token proves the instruction; the array is two registers long.
        let others = unsafe {
            let others = others.as_ptr();
            [_mm256_loadu_si256(others.cast()), _mm256_loadu_si256(others.add(8).cast())]
        };
        pairs_256(self, first, others, bits, to);
    }
    #[inline(always)]
    fn pair_with_indices(self, first: u32, start: u32, bits: u32, to: &mut [[u32; 2]; LANES]) {
        pairs_with_indices_256(self, first, start, bits, to);
    }
    #[inline(always)]
    fn ordered_pairs(
        self,
        first: u32,
        [low, high]: [&[u32; HALF]; 2],
        bits: u32,
        to: &mut [[u32; 2]; LANES],
    ) {
        ordered_pairs_256(self, first, [low, high], bits, to);
    }
    #[inline(always)]
    fn pack_indices(self, first: u32, bits: u32, to: &mut [u32; LANES]) {
        pack_indices_256(self, first, bits, to);
    }
}

impl Simd<f32> for Avx2 {
    arithmetic!(
        f32,
        [0 1] of 8 in __m256,
        _mm256_set1_ps,
        _mm256_loadu_ps,
        _mm256_storeu_ps,
        _mm256_add_ps,
        _mm256_sub_ps,
        _mm256_mul_ps,
        _mm256_max_ps,
        _mm256_min_ps,
        less_256,
        abs_256,
        negative_256,
        _mm256_div_ps,
        _mm256_sqrt_ps,
        at_most_256,
        choose_256
    );

    #[inline(always)]
    fn gather(self, from: &[AtomicU64], indices: &PairIndices, k: usize) -> [Self::Block; 2] {
        let indices = indices.below(from.len(), k);
        // SAFETY: the line above, and the token.
        let [[a, b], [c, d]] =
            unsafe { [gather::gather_256(from, indices, 0), gather::gather_256(from, indices, 8)] };
        [[a, c], [b, d]]
    }
    #[inline(always)]
    fn scatter(self, [x, y]: [Self::Block; 2], to: &[AtomicU64], indices: &PairIndices, k: usize) {
        let indices = indices.below(to.len(), k);
        // SAFETY: the line above, and the token.
        unsafe {
            gather::scatter_256([x[0], y[0]], to, indices, 0);
            gather::scatter_256([x[1], y[1]], to, indices, 8);
        }
    }
    #[inline(always)]
    fn pack(self, from: Self::Block, bits: u32, to: &mut [f32; LANES]) {
        let behind = (bits & 0xff).count_ones() as usize;
        // SAFETY: the token proves the instructions; the first register's numbers are at
        // most eight, so that the second one's eight end within the sixteen there are.
        unsafe {
            let [low, high] = [_mm256_castps_si256(from[0]), _mm256_castps_si256(from[1])];
            let low = _mm256_castsi256_ps(packed_256(self, low, bits));
            let high = _mm256_castsi256_ps(packed_256(self, high, bits >> 8));
            _mm256_storeu_ps(to.as_mut_ptr(), low);
            _mm256_storeu_ps(to.as_mut_ptr().add(behind), high);
        }
    }
    load_halves!(f32, [0 1] of 8, _mm256_loadu_ps);
}

impl Simd<f64> for Avx2 {
    arithmetic!(
        f64,
        [0 1 2 3] of 4 in __m256d,
        _mm256_set1_pd,
        _mm256_loadu_pd,
        _mm256_storeu_pd,
        _mm256_add_pd,
        _mm256_sub_pd,
        _mm256_mul_pd,
        _mm256_max_pd,
        _mm256_min_pd,
        less_256d,
        abs_256d,
        negative_256d,
        _mm256_div_pd,
        _mm256_sqrt_pd,
        at_most_256d,
        choose_256d
    );

    #[inline(always)]
    fn pack(self, from: Self::Block, bits: u32, to: &mut [f64; LANES]) {
        let to = to.as_mut_ptr();
        let behind = |lanes: u32| (bits & ((1 << lanes) - 1)).count_ones() as usize;
        // SAFETY: the token proves the instructions; before register k there are at most 4 · k
        // numbers, so that its four end within the sixteen there are.
        unsafe {
            _mm256_storeu_pd(to, packed_256d(self, from[0], bits));
            _mm256_storeu_pd(to.add(behind(4)), packed_256d(self, from[1], bits >> 4));
            _mm256_storeu_pd(to.add(behind(8)), packed_256d(self, from[2], bits >> 8));
            _mm256_storeu_pd(to.add(behind(12)), packed_256d(self, from[3], bits >> 12));
        }
    }
    load_halves!(f64, [0 1 2 3] of 4, _mm256_loadu_pd);
}

impl Packing for Sse2 {
    #[inline(always)]
    fn prefetch<V>(self, column: &[V]) {
        prefetch(column);
    }
    #[inline(always)]
    fn pair_with(self, first: u32, others: &[u32; LANES], bits: u32, to: &mut [[u32; 2]; LANES]) {
        portable::pair_with(first, |lane| others[lane % LANES], bits, to);
    }
    #[inline(always)]
    fn pair_with_indices(self, first: u32, start: u32, bits: u32, to: &mut [[u32; 2]; LANES]) {
        portable::pair_with(first, |lane| start + lane as u32, bits, to);
    }
    #[inline(always)]
    fn ordered_pairs(
        self,
        first: u32,
        others: [&[u32; HALF]; 2],
        bits: u32,
        to: &mut [[u32; 2]; LANES],
    ) {
        portable::ordered_pairs(first, others, bits, to);
    }
    #[inline(always)]
    fn pack_indices(self, first: u32, bits: u32, to: &mut [u32; LANES]) {
        portable::pack_indices(first, bits, to);
    }
}

impl Simd<f32> for Sse2 {
    arithmetic!(
        f32,
        [0 1 2 3] of 4 in __m128,
        _mm_set1_ps,
        _mm_loadu_ps,
        _mm_storeu_ps,
        _mm_add_ps,
        _mm_sub_ps,
        _mm_mul_ps,
        _mm_max_ps,
        _mm_min_ps,
        less_128,
        abs_128,
        negative_128,
        _mm_div_ps,
        _mm_sqrt_ps,
        at_most_128,
        choose_128
    );

    #[inline(always)]
    fn gather(self, from: &[AtomicU64], indices: &PairIndices, k: usize) -> [Self::Block; 2] {
        let indices = indices.below(from.len(), k);
        // SAFETY: the line above; every x86-64 processor has SSE2.
        unsafe {
            let [a, b] = gather::gather_128(from, indices, 0);
            let [c, d] = gather::gather_128(from, indices, 4);
            let [e, f] = gather::gather_128(from, indices, 8);
            let [g, h] = gather::gather_128(from, indices, 12);
            [[a, c, e, g], [b, d, f, h]]
        }
    }
    #[inline(always)]
    fn scatter(self, [x, y]: [Self::Block; 2], to: &[AtomicU64], indices: &PairIndices, k: usize) {
        let indices = indices.below(to.len(), k);
        // SAFETY: the line above; every x86-64 processor has SSE2.
        unsafe {
            gather::scatter_128([x[0], y[0]], to, indices, 0);
            gather::scatter_128([x[1], y[1]], to, indices, 4);
            gather::scatter_128([x[2], y[2]], to, indices, 8);
            gather::scatter_128([x[3], y[3]], to, indices, 12);
        }
    }
    pack_one_by_one!(f32);
    load_halves!(f32, [0 1 2 3] of 4, _mm_loadu_ps);
}

impl Simd<f64> for Sse2 {
    arithmetic!(
        f64,
        [0 1 2 3 4 5 6 7] of 2 in __m128d,
        _mm_set1_pd,
        _mm_loadu_pd,
        _mm_storeu_pd,
        _mm_add_pd,
        _mm_sub_pd,
        _mm_mul_pd,
        _mm_max_pd,
        _mm_min_pd,
        less_128d,
        abs_128d,
        negative_128d,
        _mm_div_pd,
        _mm_sqrt_pd,
        at_most_128d,
        choose_128d
    );
    pack_one_by_one!(f64);
    load_halves!(f64, [0 1 2 3 4 5 6 7] of 2, _mm_loadu_pd);
}

/// For each set of bits the lanes that it names, lowest first, a byte each.
static LANES_OF: [u64; 256] = {
    let mut table = [0; 256];
    let mut bits = 0;
    while bits < 256 {
        let (mut lane, mut count) = (0, 0);
        while lane < 8 {
            if bits >> lane & 1 == 1 {
                table[bits] |= lane << (8 * count);
                count += 1;
            }
            lane += 1;
        }
        bits += 1;
    }
    table
};

/// The words of a register whose bit is set, first.
#[inline(always)]
fn packed_256(_: Avx2, register: __m256i, bits: u32) -> __m256i {
    // AVX2 can permute by a register but not compress. The table of 2 KiB has the order for each
    // set of eight bits.
    let order = LANES_OF[(bits & 0xff) as usize] as i64;
    // SAFETY: the token proves the instructions.
    unsafe {
        let order = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(order));
        _mm256_permutevar8x32_epi32(register, order)
    }
}

/// The numbers of a register whose bit is set, first.
#[inline(always)]
fn packed_256d(token: Avx2, register: __m256d, bits: u32) -> __m256d {
    /// Each bit twice, because a number is two words.
    const TWICE: [u8; 16] = [
        0x00, 0x03, 0x0c, 0x0f, 0x30, 0x33, 0x3c, 0x3f, 0xc0, 0xc3, 0xcc, 0xcf, 0xf0, 0xf3, 0xfc,
        0xff,
    ];
    let words = u32::from(TWICE[(bits & 0xf) as usize]);
    // SAFETY: the token proves the instructions.
    unsafe { _mm256_castsi256_pd(packed_256(token, _mm256_castpd_si256(register), words)) }
}

/// Eight numbers from `first` on.
#[inline(always)]
fn counted_256(_: Avx2, first: u32) -> __m256i {
    // SAFETY: the token proves the instructions.
    unsafe {
        let lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
        _mm256_add_epi32(_mm256_set1_epi32(first as i32), lanes)
    }
}

/// As [`pairs_512`], with two registers.
#[inline(always)]
fn pairs_256(
    token: Avx2,
    first: u32,
    [low, high]: [__m256i; 2],
    bits: u32,
    to: &mut [[u32; 2]; LANES],
) {
    if bits.count_ones() > 4 {
        return many_pairs_256(token, first, [low, high], bits, to);
    }
    // SAFETY: the token proves the instructions.
    let others = unsafe {
        let lanes = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(lanes_of(bits) as i64));
        let low = _mm256_permutevar8x32_epi32(low, lanes);
        let high = _mm256_permutevar8x32_epi32(high, lanes);
        // The permutation uses the low three bits of a lane, so both halves are permuted alike, and
        // the fourth bit chooses between them.
        let is_high = _mm256_cmpgt_epi32(lanes, _mm256_set1_epi32(7));
        _mm256_castsi256_si128(_mm256_blendv_epi8(low, high, is_high))
    };
    four_pairs(token, first, others, to);
}

/// As [`pairs_256`], the smaller number of each pair first.
#[inline(always)]
fn ordered_pairs_256(
    token: Avx2,
    first: u32,
    [low, high]: [&[u32; HALF]; 2],
    bits: u32,
    to: &mut [[u32; 2]; LANES],
) {
    // SAFETY: the token proves the instruction; each array is one register long.
    let others = unsafe { [low, high].map(|half| _mm256_loadu_si256(half.as_ptr().cast())) };
    pairs_256(token, first, others, bits, to);
    // Few pairs, which are still in the first-level cache.
    for pair in &mut to[..bits.count_ones() as usize] {
        *pair = [pair[0].min(pair[1]), pair[0].max(pair[1])];
    }
}

/// Pairs of `first` with `start` + lane for every set bit.
#[inline(always)]
fn pairs_with_indices_256(
    token: Avx2,
    first: u32,
    start: u32,
    bits: u32,
    to: &mut [[u32; 2]; LANES],
) {
    if bits.count_ones() > 4 {
        let others = [counted_256(token, start), counted_256(token, start.wrapping_add(8))];
        return many_pairs_256(token, first, others, bits, to);
    }
    // SAFETY: the token proves the instructions.
    let others = unsafe {
        let lanes = _mm_cvtepu8_epi32(_mm_cvtsi64_si128(lanes_of(bits) as i64));
        _mm_add_epi32(_mm_set1_epi32(start as i32), lanes)
    };
    four_pairs(token, first, others, to);
}

/// The lanes of at most four set bits, lowest first, a byte each.
#[inline(always)]
fn lanes_of(bits: u32) -> u64 {
    let (low, high) = (LANES_OF[(bits & 0xff) as usize], LANES_OF[(bits >> 8 & 0xff) as usize]);
    // The lanes of the upper half are eight higher; they follow those of the lower half. The zeros
    // behind the last lane become eights, which name lanes that do not count.
    low | (high + 0x0808_0808_0808_0808).wrapping_shl(8 * (bits & 0xff).count_ones())
}

/// Pairs of `first` with four others.
#[inline(always)]
fn four_pairs(_: Avx2, first: u32, others: __m128i, to: &mut [[u32; 2]; LANES]) {
    // SAFETY: the token proves the instructions; both stores end within the sixteen pairs.
    unsafe {
        let (own, to) = (_mm_set1_epi32(first as i32), to.as_mut_ptr());
        _mm_storeu_si128(to.cast(), _mm_unpacklo_epi32(own, others));
        _mm_storeu_si128(to.add(2).cast(), _mm_unpackhi_epi32(own, others));
    }
}

/// Pairs of `first` with those of sixteen others whose bit is set.
#[inline(always)]
fn many_pairs_256(
    token: Avx2,
    first: u32,
    [low, high]: [__m256i; 2],
    bits: u32,
    to: &mut [[u32; 2]; LANES],
) {
    let behind = (bits & 0xff).count_ones() as usize;
    eight_pairs(token, first, packed_256(token, low, bits), to, 0);
    eight_pairs(token, first, packed_256(token, high, bits >> 8), to, behind);
}

/// Pairs of `first` with eight others, from `start` on, at most the eighth.
#[inline(always)]
fn eight_pairs(_: Avx2, first: u32, others: __m256i, to: &mut [[u32; 2]; LANES], start: usize) {
    // SAFETY: the token proves the instructions; both stores end within the sixteen pairs.
    unsafe {
        let own = _mm256_set1_epi32(first as i32);
        // These instructions work within halves of the register, so the halves have to be put in
        // order afterwards.
        let (even, odd) = (_mm256_unpacklo_epi32(own, others), _mm256_unpackhi_epi32(own, others));
        let to = to.as_mut_ptr().add(start);
        _mm256_storeu_si256(to.cast(), _mm256_permute2x128_si256::<0x20>(even, odd));
        _mm256_storeu_si256(to.add(4).cast(), _mm256_permute2x128_si256::<0x31>(even, odd));
    }
}

#[inline(always)]
fn pack_indices_256(token: Avx2, first: u32, bits: u32, to: &mut [u32; LANES]) {
    let low = packed_256(token, counted_256(token, first), bits);
    let high = packed_256(token, counted_256(token, first.wrapping_add(8)), bits >> 8);
    let behind = (bits & 0xff).count_ones() as usize;
    // SAFETY: the token proves the instruction; the first register's words are at most
    // eight, so that the second one's eight end within the sixteen there are.
    unsafe {
        _mm256_storeu_si256(to.as_mut_ptr().cast(), low);
        _mm256_storeu_si256(to.as_mut_ptr().add(behind).cast(), high);
    }
}
