//! Eight at a time: the signs of the comparison are bits, and a table has the permutation that
//! compresses them.

use std::arch::x86_64::*;
use std::ops::Range;

use super::{BOXES, Columns, EQUAL, Kind, Lanes, Output, Work};

const WIDTH: usize = 8;

/// For each mask of eight bits, the lanes of its set bits first.
static COMPRESSING: [[u32; WIDTH]; 256] = {
    let mut table = [[0; WIDTH]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut to) = (0, 0);
        while lane < WIDTH {
            if mask >> lane & 1 == 1 {
                table[mask][to] = lane as u32;
                to += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};

/// Exists only where the processor has AVX2 and BMI2.
#[derive(Clone, Copy)]
pub struct Avx2(());

/// # Safety
///
/// The processor must have the instructions named.
#[target_feature(enable = "avx2,bmi1,bmi2,popcnt,lzcnt")]
pub unsafe fn run<W: Work>(work: W) -> W::Outcome {
    work.run(Avx2(()))
}

impl Lanes for Avx2 {
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
                let left = _bzhi_u32(0xff, (strip.end - from).min(WIDTH) as u32);
                let hits = left & hits::<KIND>(columns, row, from, reach_squared);
                emit(columns, row, from, hits, output)
            };
            from += WIDTH;
        }
        output
    }
}

/// # Safety
///
/// The instructions must be there.
#[inline(always)]
unsafe fn nearer(dx: __m256, dy: __m256, reach_squared: __m256) -> __m256 {
    unsafe {
        let distance = _mm256_add_ps(_mm256_mul_ps(dx, dx), _mm256_mul_ps(dy, dy));
        _mm256_cmp_ps::<_CMP_LT_OQ>(distance, reach_squared)
    }
}

/// Which of the eight shapes from `from` on overlap the one in `row`.
///
/// # Safety
///
/// As for [`nearer`], and `row` and `from` must be rows.
#[inline(always)]
unsafe fn hits<const KIND: Kind>(all: &Columns, row: usize, from: usize, squared: f32) -> u32 {
    // SAFETY: eight rows can be read from any row.
    unsafe {
        let load = |column: &[f32]| _mm256_loadu_ps(column.as_ptr().add(from));
        let own = |column: &[f32]| _mm256_set1_ps(*column.get_unchecked(row));
        let bits = |lanes: __m256| _mm256_movemask_ps(lanes) as u32;
        let dx = _mm256_sub_ps(own(&all.x), load(&all.x));
        let dy = _mm256_sub_ps(own(&all.y), load(&all.y));
        if KIND == EQUAL {
            return bits(nearer(dx, dy, _mm256_set1_ps(squared)));
        }
        let (size, sizes) = (own(&all.size), load(&all.size));
        let smaller = bits(_mm256_cmp_ps::<_CMP_LT_OQ>(sizes, size));
        let equal = bits(_mm256_cmp_ps::<_CMP_EQ_OQ>(sizes, size));
        // Lanes of rows after `row`: all but the first `row + 1 - from`.
        let ahead = (row + 1).saturating_sub(from).min(WIDTH);
        let chosen = smaller | equal & 0xff << ahead;
        if KIND == BOXES {
            let [w, h] = &all.half;
            let positive = |lanes| _mm256_andnot_ps(_mm256_set1_ps(-0.0), lanes);
            let reach = [_mm256_add_ps(own(w), load(w)), _mm256_add_ps(own(h), load(h))];
            let in_x = _mm256_cmp_ps::<_CMP_LT_OQ>(positive(dx), reach[0]);
            let in_y = _mm256_cmp_ps::<_CMP_LT_OQ>(positive(dy), reach[1]);
            return chosen & bits(_mm256_and_ps(in_x, in_y));
        }
        let reach = _mm256_add_ps(size, sizes);
        chosen & bits(nearer(dx, dy, _mm256_mul_ps(reach, reach)))
    }
}

/// Writes the pairs of `row` with those of the eight rows from `from` that `hits` names.
///
/// # Safety
///
/// As for [`hits`], and there must be room for eight pairs.
#[inline(always)]
unsafe fn emit(all: &Columns, row: usize, from: usize, hits: u32, output: Output) -> Output {
    // SAFETY: `hits` has eight bits; eight rows can be read from any row.
    unsafe {
        let order = COMPRESSING.get_unchecked(hits as usize).as_ptr().cast();
        let others = _mm256_loadu_si256(all.id.as_ptr().add(from).cast());
        let others = _mm256_permutevar8x32_epi32(others, _mm256_loadu_si256(order));
        let own = _mm256_set1_epi32(*all.id.get_unchecked(row) as i32);
        let (first, second) = (_mm256_min_epu32(own, others), _mm256_max_epu32(own, others));
        // Pairs 0 1 and 4 5, then 2 3 and 6 7.
        let even = _mm256_unpacklo_epi32(first, second);
        let odd = _mm256_unpackhi_epi32(first, second);
        let next = output.next();
        _mm256_storeu_si256(next.cast(), _mm256_permute2x128_si256::<0x20>(even, odd));
        _mm256_storeu_si256(next.add(4).cast(), _mm256_permute2x128_si256::<0x31>(even, odd));
        output.advance(hits.count_ones() as usize)
    }
}
