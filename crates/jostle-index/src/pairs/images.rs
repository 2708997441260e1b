//! The pairs that overlap across the boundaries of a periodic plane.
//!
//! A tree is joined with itself again for each image: for each combination of axes on which the
//! higher shape of a pair is moved by minus one period. Only nodes near the boundaries have
//! images that overlap, so these joins take little time.

use super::Found;
use super::output::{Budget, PairScratch};
use super::unchanged;
use crate::geometry::{Scalar, Shape};
use crate::period::{self, Period};
use crate::shapes::Shapes;
use jostle_base::error::Result;

/// Which shape of a pair is moved by minus one period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Moved {
    Neither,
    First,
    Second,
}

/// Which shape of a pair is moved along each axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Image([Moved; 2]);

impl Image {
    /// All images in which a shape is moved. If both shapes are from the same tree, each pair comes
    /// in both orders, so the first shape moved is always the first of the pair.
    pub(super) fn all<T: Scalar>(period: &Period<T>, is_same: bool) -> Vec<Self> {
        use Moved::{First, Neither, Second};
        let choices = |axis| {
            if period.is_along(axis) { &[Neither, First, Second][..] } else { &[Neither][..] }
        };
        let all = choices(1).iter().flat_map(|&y| choices(0).iter().map(move |&x| Self([x, y])));
        let is_wanted = |image: &Self| match image.0 {
            [Neither, Neither] => false,
            // Within one tree the pair (i, j) with j moved is the pair (j, i) with the first moved,
            // and both orders are visited. Without this each pair across a border would be found
            // twice.
            [Second, _] | [Neither, Second] => !is_same,
            _ => true,
        };
        all.filter(is_wanted).collect()
    }

    /// The shifts of the first and of the second shape.
    pub(super) fn shifts<T: Scalar>(&self, period: &Period<T>) -> [[T; 2]; 2] {
        let shift = |moved: Moved| {
            [0, 1].map(|axis| if self.0[axis] == moved { period.sides()[axis] } else { T::ZERO })
        };
        [shift(Moved::First), shift(Moved::Second)]
    }

    /// Whether a pair that overlaps in this image is found here: the shapes that are moved are
    /// the higher ones, and no image before this one overlaps.
    pub(super) fn is_first<T: Scalar>(&self, period: &Period<T>, [a, b]: [Shape<T>; 2]) -> bool {
        let (a_is_higher, b_is_higher) = (period::higher(&a, &b), period::higher(&b, &a));
        let is_higher = |axis: usize| match self.0[axis] {
            Moved::Neither => true,
            Moved::First => a_is_higher[axis],
            Moved::Second => b_is_higher[axis],
        };
        let wrapped = self.0.map(|moved| moved != Moved::Neither);
        // Only the higher shape of a pair is ever moved, as in `Period::gaps`: the formula has to
        // be the same, to the last bit, or the tree and brute force could disagree about a pair
        // that touches.
        is_higher(0) && is_higher(1) && period.is_first_overlap(&a, &b, wrapped)
    }
}

/// Number of shapes that are tested against one shape between two checks for interruption.
const ROW_TESTS: usize = 1 << 10;

/// All overlapping pairs of rows in a periodic plane, `i < j`, by brute force.
pub(super) fn brute<T: Scalar>(shapes: &Shapes<T>, max_pairs: usize) -> Result<Found> {
    let budget = Budget::new(max_pairs);
    budget.find(Some(1), 1, &unchanged, &mut PairScratch::default(), |_, output| {
        for row in 0..shapes.len() {
            let shape = shapes.shape(row);
            for others in (row + 1..shapes.len()).step_by(ROW_TESTS) {
                if output.is_over(ROW_TESTS) {
                    return;
                }
                for other in others..shapes.len().min(others + ROW_TESTS) {
                    let found = shapes.shape(other);
                    output.tests += 1;
                    if shape.may_pair(&found) && shapes.period.overlap(&shape, &found) {
                        let Some(spare) = output.spare(1) else { return };
                        spare[0] = [row as u32, other as u32];
                        output.accept(1);
                    }
                }
            }
        }
    })
}
