//! Gather and scatter: pairs of float32 are read from scattered indices into vectors, and written.
//!
//! Each pair is one word, which is read and written atomically, so that threads may share the
//! column. Single reads and writes are faster than the gather and scatter instructions of the
//! processor.
#![allow(unsafe_code)]
// The functions use `unsafe` for all instructions; those of SSE2 do not need it.
#![allow(unused_unsafe)]

use std::arch::asm;
use std::arch::x86_64::*;
use std::sync::atomic::{AtomicU64, Ordering};

use super::LANES;

/// The pair at the index of a lane.
///
/// # Safety
///
/// The index of each lane that is used is below the length of the column.
#[inline(always)]
unsafe fn one(from: &[AtomicU64], indices: &[u32; LANES], lane: usize) -> f64 {
    // SAFETY: the caller promises what the function requires.
    unsafe {
        let word = from.get_unchecked(indices[lane % LANES] as usize);
        f64::from_bits(word.load(Ordering::Relaxed))
    }
}

/// Writes the pair at the index of a lane.
///
/// # Safety
///
/// The index of each lane that is used is below the length of the column.
#[inline(always)]
unsafe fn set_one(pair: f64, to: &[AtomicU64], indices: &[u32; LANES], lane: usize) {
    // SAFETY: the caller promises what the function requires.
    unsafe {
        let word = to.get_unchecked(indices[lane % LANES] as usize);
        word.store(pair.to_bits(), Ordering::Relaxed);
    }
}

/// The pairs of two consecutive lanes.
///
/// # Safety
///
/// The index of each lane that is used is below the length of the column.
#[inline(always)]
unsafe fn two(from: &[AtomicU64], indices: &[u32; LANES], lane: usize) -> __m128d {
    // SAFETY: the caller promises what the function requires.
    unsafe { _mm_set_pd(one(from, indices, lane + 1), one(from, indices, lane)) }
}

/// Writes the pairs of two consecutive lanes.
///
/// # Safety
///
/// The index of each lane that is used is below the length of the column.
#[inline(always)]
unsafe fn set_two(pairs: __m128d, to: &[AtomicU64], indices: &[u32; LANES], lane: usize) {
    // SAFETY: the caller promises what the function requires.
    unsafe {
        set_one(_mm_cvtsd_f64(pairs), to, indices, lane);
        set_one(_mm_cvtsd_f64(_mm_unpackhi_pd(pairs, pairs)), to, indices, lane + 1);
    }
}

/// The first and the second numbers of the pairs of four lanes.
///
/// # Safety
///
/// The index of each lane that is used is below the length of the column.
#[inline(always)]
pub(crate) unsafe fn gather_128(
    from: &[AtomicU64],
    indices: &[u32; LANES],
    lane: usize,
) -> [__m128; 2] {
    // SAFETY: the caller promises what the function requires.
    unsafe {
        // Two words side by side are x0 y0 x1 y1. Of two such registers one shuffle takes all x,
        // another all y.
        let low = _mm_castpd_ps(two(from, indices, lane));
        let high = _mm_castpd_ps(two(from, indices, lane + 2));
        [_mm_shuffle_ps::<0x88>(low, high), _mm_shuffle_ps::<0xdd>(low, high)]
    }
}

/// Writes the pairs of four lanes.
///
/// # Safety
///
/// The index of each lane that is used is below the length of the column.
#[inline(always)]
pub(crate) unsafe fn scatter_128(
    [x, y]: [__m128; 2],
    to: &[AtomicU64],
    indices: &[u32; LANES],
    lane: usize,
) {
    // SAFETY: the caller promises what the function requires.
    unsafe {
        set_two(_mm_castps_pd(_mm_unpacklo_ps(x, y)), to, indices, lane);
        set_two(_mm_castps_pd(_mm_unpackhi_ps(x, y)), to, indices, lane + 2);
    }
}

/// As [`two`], with AVX, without integer registers, which the compiler uses for atomic words. On
/// x86 each of these reads is a relaxed atomic load.
///
/// # Safety
///
/// The index of each lane that is used is below the length of the column, and the processor has
/// AVX.
#[inline(always)]
unsafe fn two_avx(from: &[AtomicU64], indices: &[u32; LANES], lane: usize) -> __m128d {
    let [first, second] = [indices[lane % LANES], indices[(lane + 1) % LANES]];
    let pairs: __m128d;
    // SAFETY: the caller promises what the function requires.
    unsafe {
        asm!(
            // An aligned read of eight bytes is atomic on x86, and the compiler may not divide it.
            // `pure, readonly` lets the compiler move and drop reads, as relaxed loads allow.
            "vmovsd {pairs}, qword ptr [{from} + 8 * {first}]",
            "vmovhpd {pairs}, {pairs}, qword ptr [{from} + 8 * {second}]",
            pairs = out(xmm_reg) pairs,
            from = in(reg) from.as_ptr(),
            first = in(reg) first as usize,
            second = in(reg) second as usize,
            options(pure, readonly, nostack, preserves_flags),
        );
    }
    pairs
}

/// As [`set_two`], with AVX: two relaxed atomic stores.
///
/// # Safety
///
/// The index of each lane that is used is below the length of the column, and the processor has
/// AVX.
#[inline(always)]
unsafe fn set_two_avx(pairs: __m128d, to: &[AtomicU64], indices: &[u32; LANES], lane: usize) {
    let [first, second] = [indices[lane % LANES], indices[(lane + 1) % LANES]];
    // SAFETY: the caller promises what the function requires.
    unsafe {
        asm!(
            "vmovlpd qword ptr [{to} + 8 * {first}], {pairs}",
            "vmovhpd qword ptr [{to} + 8 * {second}], {pairs}",
            pairs = in(xmm_reg) pairs,
            to = in(reg) to.as_ptr(),
            first = in(reg) first as usize,
            second = in(reg) second as usize,
            options(nostack, preserves_flags),
        );
    }
}

/// The pairs of the lanes `lane`, `lane + 1`, `lane + 4` and `lane + 5`.
///
/// # Safety
///
/// The index of each lane that is used is below the length of the column, and the processor has
/// AVX.
#[inline(always)]
unsafe fn four(from: &[AtomicU64], indices: &[u32; LANES], lane: usize) -> __m256d {
    // SAFETY: the caller promises what the function requires.
    unsafe { _mm256_set_m128d(two_avx(from, indices, lane + 4), two_avx(from, indices, lane)) }
}

/// Writes the pairs of the lanes `lane`, `lane + 1`, `lane + 4` and `lane + 5`.
///
/// # Safety
///
/// The index of each lane that is used is below the length of the column, and the processor has
/// AVX.
#[inline(always)]
unsafe fn set_four(pairs: __m256d, to: &[AtomicU64], indices: &[u32; LANES], lane: usize) {
    // SAFETY: the caller promises what the function requires.
    unsafe {
        set_two_avx(_mm256_castpd256_pd128(pairs), to, indices, lane);
        set_two_avx(_mm256_extractf128_pd::<1>(pairs), to, indices, lane + 4);
    }
}

/// The first and the second numbers of the pairs of eight lanes.
///
/// # Safety
///
/// The index of each lane that is used is below the length of the column, and the processor has
/// AVX.
#[inline(always)]
pub(crate) unsafe fn gather_256(
    from: &[AtomicU64],
    indices: &[u32; LANES],
    lane: usize,
) -> [__m256; 2] {
    // SAFETY: the caller promises what the function requires.
    unsafe {
        let low = _mm256_castpd_ps(four(from, indices, lane));
        let high = _mm256_castpd_ps(four(from, indices, lane + 2));
        [_mm256_shuffle_ps::<0x88>(low, high), _mm256_shuffle_ps::<0xdd>(low, high)]
    }
}

/// Writes the pairs of eight lanes.
///
/// # Safety
///
/// The index of each lane that is used is below the length of the column, and the processor has
/// AVX.
#[inline(always)]
pub(crate) unsafe fn scatter_256(
    [x, y]: [__m256; 2],
    to: &[AtomicU64],
    indices: &[u32; LANES],
    lane: usize,
) {
    // SAFETY: the caller promises what the function requires.
    unsafe {
        set_four(_mm256_castps_pd(_mm256_unpacklo_ps(x, y)), to, indices, lane);
        set_four(_mm256_castps_pd(_mm256_unpackhi_ps(x, y)), to, indices, lane + 2);
    }
}

/// The pairs of the lanes `lane + k` and `lane + k + 1` for k = 0, 4, 8 and 12.
///
/// # Safety
///
/// The index of each lane that is used is below the length of the column, and the processor has
/// AVX-512F.
#[inline(always)]
unsafe fn eight(from: &[AtomicU64], indices: &[u32; LANES], lane: usize) -> __m512 {
    // SAFETY: the caller promises what the function requires.
    unsafe {
        let low = _mm512_castpd256_pd512(four(from, indices, lane));
        _mm512_castpd_ps(_mm512_insertf64x4::<1>(low, four(from, indices, lane + 8)))
    }
}

/// Writes the pairs of the lanes `lane + k` and `lane + k + 1` for k = 0, 4, 8 and 12.
///
/// # Safety
///
/// The index of each lane that is used is below the length of the column, and the processor has
/// AVX-512F.
#[inline(always)]
unsafe fn set_eight(pairs: __m512, to: &[AtomicU64], indices: &[u32; LANES], lane: usize) {
    // SAFETY: the caller promises what the function requires.
    unsafe {
        let pairs = _mm512_castps_pd(pairs);
        set_four(_mm512_castpd512_pd256(pairs), to, indices, lane);
        set_four(_mm512_extractf64x4_pd::<1>(pairs), to, indices, lane + 8);
    }
}

/// The first and the second numbers of the pairs of all lanes.
///
/// # Safety
///
/// The index of each lane that is used is below the length of the column, and the processor has
/// AVX-512F.
#[inline(always)]
pub(crate) unsafe fn gather_512(from: &[AtomicU64], indices: &[u32; LANES]) -> [__m512; 2] {
    // SAFETY: the caller promises what the function requires.
    unsafe {
        let (low, high) = (eight(from, indices, 0), eight(from, indices, 2));
        [_mm512_shuffle_ps::<0x88>(low, high), _mm512_shuffle_ps::<0xdd>(low, high)]
    }
}

/// Writes the pairs of all lanes.
///
/// # Safety
///
/// The index of each lane that is used is below the length of the column, and the processor has
/// AVX-512F.
#[inline(always)]
pub(crate) unsafe fn scatter_512([x, y]: [__m512; 2], to: &[AtomicU64], indices: &[u32; LANES]) {
    // SAFETY: the caller promises what the function requires.
    unsafe {
        set_eight(_mm512_unpacklo_ps(x, y), to, indices, 0);
        set_eight(_mm512_unpackhi_ps(x, y), to, indices, 2);
    }
}
