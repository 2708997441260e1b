//! Sixteen at a time: the mask of the comparison compresses the register.
//!
//! Compressing into a register and storing it whole is several times as fast as compressing into
//! memory on some processors, and not slower on others.

use std::arch::x86_64::*;
use std::ops::Range;

use super::{BOXES, Columns, EQUAL, Kind, Lanes, Output, Work};
use crate::rivals::Pair;

const WIDTH: usize = 16;
const HALF: usize = WIDTH / 2;

/// Exists only where the processor has AVX-512 F, DQ, VL and BMI2.
#[derive(Clone, Copy)]
pub struct Avx512(());

/// # Safety
///
/// The processor must have the instructions named.
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,bmi1,bmi2,popcnt,lzcnt")]
pub unsafe fn run<W: Work>(work: W) -> W::Outcome {
    work.run(Avx512(()))
}

impl Lanes for Avx512 {
    #[inline(always)]
    fn strip<const KIND: Kind>(
        self,
        columns: &Columns,
        row: usize,
        strip: Range<usize>,
        reach_squared: f32,
        output: Output,
    ) -> Output {
        columns.check(row, &strip, KIND);
        let mut output = output.with_room(strip.len());
        let mut from = strip.start;
        while from < strip.end {
            // SAFETY: `row` and `from` are rows, spare rows follow the last one, the
            // instructions are there, and there is room for every pair of the strip.
            output = unsafe {
                // The instruction looks at eight bits of the number only.
                let left = _bzhi_u32(0xffff, (strip.end - from).min(WIDTH) as u32) as u16;
                let hits = left & hits::<KIND>(columns, row, from, reach_squared);
                let others = _mm512_loadu_si512(columns.id.as_ptr().add(from).cast());
                emit(columns.id[row], others, hits, output)
            };
            from += WIDTH;
        }
        output
    }

    #[inline(always)]
    fn two_strips(
        self,
        columns: &Columns,
        row: usize,
        strips: [Range<usize>; 2],
        reach_squared: f32,
        output: Output,
    ) -> Output {
        let [one, two] = strips;
        let lengths = [one.end.wrapping_sub(one.start), two.end.wrapping_sub(two.start)];
        let end = one.end.max(two.end);
        if (lengths[0] > HALF) | (lengths[1] > HALF) | (end > columns.len) | (row >= columns.len) {
            let output = self.strip::<EQUAL>(columns, row, one, reach_squared, output);
            return self.strip::<EQUAL>(columns, row, two, reach_squared, output);
        }
        let output = output.with_room(WIDTH);
        // SAFETY: both strips lie among the rows, as `row` does, spare rows follow the last
        // one, the instructions are there, and there is room for sixteen pairs.
        unsafe {
            let (x, y) = (columns.x.as_ptr(), columns.y.as_ptr());
            let both = |column: *const f32| {
                let first = _mm512_castps256_ps512(_mm256_loadu_ps(column.add(one.start)));
                _mm512_insertf32x8::<1>(first, _mm256_loadu_ps(column.add(two.start)))
            };
            let dx = _mm512_sub_ps(_mm512_set1_ps(*x.add(row)), both(x));
            let dy = _mm512_sub_ps(_mm512_set1_ps(*y.add(row)), both(y));
            let left = _bzhi_u32(0xff, lengths[0] as u32) | _bzhi_u32(0xff, lengths[1] as u32) << 8;
            let hits = left as u16 & nearer(dx, dy, _mm512_set1_ps(reach_squared));
            let others = _mm512_castps_si512(both(columns.id.as_ptr().cast()));
            emit(*columns.id.get_unchecked(row), others, hits, output)
        }
    }
}

/// # Safety
///
/// The instructions must be there.
#[inline(always)]
unsafe fn nearer(dx: __m512, dy: __m512, reach_squared: __m512) -> u16 {
    unsafe {
        let distance = _mm512_add_ps(_mm512_mul_ps(dx, dx), _mm512_mul_ps(dy, dy));
        _mm512_cmp_ps_mask::<_CMP_LT_OQ>(distance, reach_squared)
    }
}

/// Which of the sixteen shapes from `from` on overlap the one in `row`.
///
/// # Safety
///
/// As for [`nearer`], and `row` and `from` must be rows.
#[inline(always)]
unsafe fn hits<const KIND: Kind>(all: &Columns, row: usize, from: usize, squared: f32) -> u16 {
    // SAFETY: sixteen rows can be read from any row.
    unsafe {
        let load = |column: &[f32]| _mm512_loadu_ps(column.as_ptr().add(from));
        let own = |column: &[f32]| _mm512_set1_ps(*column.get_unchecked(row));
        let dx = _mm512_sub_ps(own(&all.x), load(&all.x));
        let dy = _mm512_sub_ps(own(&all.y), load(&all.y));
        if KIND == EQUAL {
            return nearer(dx, dy, _mm512_set1_ps(squared));
        }
        let (size, sizes) = (own(&all.size), load(&all.size));
        let smaller = _mm512_cmp_ps_mask::<_CMP_LT_OQ>(sizes, size);
        let equal = _mm512_cmp_ps_mask::<_CMP_EQ_OQ>(sizes, size);
        // Lanes of rows after `row`: all but the first `row + 1 - from`.
        let ahead = (row + 1).saturating_sub(from).min(WIDTH);
        let chosen = smaller | equal & (0xffff_u32 << ahead) as u16;
        if KIND == BOXES {
            let [w, h] = &all.half;
            let reach = [_mm512_add_ps(own(w), load(w)), _mm512_add_ps(own(h), load(h))];
            let in_x = _mm512_cmp_ps_mask::<_CMP_LT_OQ>(_mm512_abs_ps(dx), reach[0]);
            let in_y = _mm512_cmp_ps_mask::<_CMP_LT_OQ>(_mm512_abs_ps(dy), reach[1]);
            return chosen & in_x & in_y;
        }
        let reach = _mm512_add_ps(size, sizes);
        chosen & nearer(dx, dy, _mm512_mul_ps(reach, reach))
    }
}

/// Writes the pairs of `own` with those of `others` that `hits` names.
///
/// More than four at a time are rare, and a store of four crosses fewer cache lines.
///
/// # Safety
///
/// The instructions must be there, and room for sixteen pairs.
#[inline(always)]
unsafe fn emit(own: u32, others: __m512i, hits: u16, output: Output) -> Output {
    unsafe {
        let others = _mm512_maskz_compress_epi32(hits, others);
        let count = hits.count_ones() as usize;
        let next = output.next();
        if count > 4 {
            emit_all(own, others, next);
            return output.advance(count);
        }
        let (own, others) = (_mm_set1_epi32(own as i32), _mm512_castsi512_si128(others));
        let (first, second) = (_mm_min_epu32(own, others), _mm_max_epu32(own, others));
        _mm_storeu_si128(next.cast(), _mm_unpacklo_epi32(first, second));
        _mm_storeu_si128(next.add(2).cast(), _mm_unpackhi_epi32(first, second));
        output.advance(count)
    }
}

/// Writes the pairs of `own` with all sixteen of `others`.
///
/// # Safety
///
/// As for [`emit`].
#[inline(always)]
unsafe fn emit_all(own: u32, others: __m512i, to: *mut Pair) {
    unsafe {
        let low_half = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
        let high_half = _mm512_add_epi32(low_half, _mm512_set1_epi32(8));
        let own = _mm512_set1_epi32(own as i32);
        let (first, second) = (_mm512_min_epu32(own, others), _mm512_max_epu32(own, others));
        let pairs =
            [low_half, high_half].map(|half| _mm512_permutex2var_epi32(first, half, second));
        _mm512_storeu_si512(to.cast(), pairs[0]);
        _mm512_storeu_si512(to.add(HALF).cast(), pairs[1]);
    }
}
