//! The overlap test of one shape, or of bounds, with the shapes of a block: the formulas of
//! [`geometry`](super) in every lane, with the same rounding.

use super::Scalar;
use jostle_simd::Simd;

/// [`gap`](super::gap) between an interval and those of a block.
#[inline(always)]
pub fn gap<T: Scalar, S: Simd<T>>(simd: S, own: [T; 2], [min, max]: [S::Block; 2]) -> S::Block {
    let below = simd.sub(simd.splat(own[0]), max);
    let above = simd.sub(min, simd.splat(own[1]));
    simd.max(below, above)
}

/// x² + y².
#[inline(always)]
pub fn square<T: Scalar, S: Simd<T>>(simd: S, [x, y]: [S::Block; 2]) -> S::Block {
    simd.add(simd.mul(x, x), simd.mul(y, y))
}

/// [`square_of_gaps`](super::square_of_gaps).
#[inline(always)]
pub fn square_of_gaps<T: Scalar, S: Simd<T>>(simd: S, [x, y]: [S::Block; 2]) -> S::Block {
    let zero = simd.splat(T::ZERO);
    square(simd, [simd.max(x, zero), simd.max(y, zero)])
}

/// A bit for each lane in which two shapes overlap: [`overlap`](super::overlap).
#[inline(always)]
pub fn overlap<T: Scalar, S: Simd<T>>(simd: S, gaps: [S::Block; 2], radius_sum: S::Block) -> u32 {
    let zero = simd.splat(T::ZERO);
    // A comparison, not the sign bit: a gap of -0 between two boxes means touching, which is no
    // overlap.
    let inside = simd.less(gaps[0], zero) & simd.less(gaps[1], zero);
    simd.less(square_of_gaps(simd, gaps), simd.mul(radius_sum, radius_sum)) | inside
}

/// As [`overlap`], faster, for shapes given by their centres. Their gaps are never −0: they are
/// distances of centres minus sums of half sizes.
#[inline(always)]
pub fn overlap_by_centers<T: Scalar, S: Simd<T>>(
    simd: S,
    gaps: [S::Block; 2],
    radius_sum: S::Block,
) -> u32 {
    let is_near = simd.less(square_of_gaps(simd, gaps), simd.mul(radius_sum, radius_sum));
    // The sign bits of both gaps, which takes fewer instructions than two comparisons. Right only
    // because no gap is -0.
    is_near | simd.both_negative(gaps[0], gaps[1])
}

/// As [`overlap`], faster, for discs: from the offsets of their centres, whose signs have no
/// effect.
#[inline(always)]
pub fn discs_overlap<T: Scalar, S: Simd<T>>(
    simd: S,
    offsets: [S::Block; 2],
    radius_sum: S::Block,
) -> u32 {
    // Same bits as `overlap`: the squares of ±x are equal, and the cores of discs have no inside.
    simd.less(square(simd, offsets), simd.mul(radius_sum, radius_sum))
}

/// A bit for each lane in which two shapes overlap or touch. Further bits may be set.
#[inline(always)]
pub fn may_touch<T: Scalar, S: Simd<T>>(simd: S, gaps: [S::Block; 2], radius_sum: S::Block) -> u32 {
    // Negated, so that NaN counts as touching: the answer may err in this direction only.
    !simd.less(simd.mul(radius_sum, radius_sum), square_of_gaps(simd, gaps))
}
