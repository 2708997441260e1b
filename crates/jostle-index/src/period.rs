//! Periodic boundaries: positions in the first period, images of shapes, and minimum images.
//!
//! On a periodic axis of length p, positions are equal if they differ by a multiple of p. Centres
//! are stored in `[0, p)`. The gap between two shapes along the axis is the smaller of two: that of
//! the shapes as they are stored, and that after the shape with the higher centre was moved by -p.
//! Both shapes have the same role, so the gap does not depend on their order.

use crate::geometry::{Scalar, Shape, contact, cores_overlap, middle, overlap};
use jostle_base::error::{Error, Result};

/// A number of periods along each axis.
pub type Turns = [i32; 2];

/// A position and its eight nearest images.
pub const NINE_IMAGES: [Turns; 9] =
    [[-1, -1], [0, -1], [1, -1], [-1, 0], [0, 0], [1, 0], [-1, 1], [0, 1], [1, 1]];

/// One of each two opposite images in [`NINE_IMAGES`], without the position itself.
const HALF_OF_IMAGES: [Turns; 4] = [[-1, 0], [0, -1], [-1, -1], [-1, 1]];

/// Width and height of the period; 0 on an axis that is not periodic.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Period<T>([T; 2]);

impl<T: Scalar> Period<T> {
    /// Refuses sides that are not finite or out of range.
    pub fn new(sides: [T; 2]) -> Result<Self> {
        let [min, max] = T::RADII;
        let fits = |side: &T| *side == T::ZERO || (*side >= min && *side <= max);
        match sides.iter().position(|side| !fits(side)) {
            None => Ok(Self(sides)),
            Some(axis) => {
                let rule = format!("a period must be 0 (none), or between {min:e} and {max:e}");
                Err(Error::at("period", axis, sides[axis], &rule))
            }
        }
    }

    /// The period with sides that are known to be in range.
    #[inline(always)]
    pub fn unchecked(sides: [T; 2]) -> Self {
        Self(sides)
    }

    /// This period in float64.
    #[inline(always)]
    pub fn exact(&self) -> Period<f64> {
        Period(self.0.map(T::to_f64))
    }

    /// Width and height; 0 on an axis that is not periodic.
    #[inline(always)]
    pub fn sides(&self) -> [T; 2] {
        self.0
    }

    /// The shortest side; infinite if no axis is periodic.
    pub fn shortest(&self) -> T {
        let side = |axis: usize| if self.is_along(axis) { self.0[axis] } else { T::INFINITY };
        side(0).min(side(1))
    }

    /// Whether no axis is periodic.
    #[inline(always)]
    pub fn is_none(&self) -> bool {
        self.0 == [T::ZERO; 2]
    }

    /// Whether an axis is periodic.
    #[inline(always)]
    pub fn is_along(&self, axis: usize) -> bool {
        self.0[axis] > T::ZERO
    }

    /// The same position in the first period: in `[0, p)` on a periodic axis of length p.
    #[inline]
    pub fn wrap(&self, point: [T; 2]) -> [T; 2] {
        [0, 1].map(
            |axis| if self.is_along(axis) { wrap(point[axis], self.0[axis]) } else { point[axis] },
        )
    }

    /// The multiple of the period that moves this centre into the first period, up to rounding,
    /// when it is subtracted; 0 if the centre is in it.
    pub fn turns(&self, center: [T; 2]) -> [T; 2] {
        [0, 1].map(|axis| {
            let (side, along) = (self.0[axis], center[axis]);
            // Positions in the first period get exactly 0, so nothing is subtracted and nothing
            // rounded.
            if !self.is_along(axis) || (along >= T::ZERO && along < side) {
                return T::ZERO;
            }
            // In float64, also for float32: the quotient may be large, and the product is rounded
            // once at the end.
            T::from_f64((along.to_f64() / side.to_f64()).floor() * side.to_f64())
        })
    }

    /// The number of periods from the position in the first period to a position.
    #[inline]
    pub fn turns_of(&self, point: [T; 2]) -> Turns {
        if self.is_none() {
            return [0; 2];
        }
        let first = self.wrap(point);
        [0, 1].map(|axis| match point[axis] - first[axis] {
            away if away == T::ZERO => 0,
            away => (away / self.0[axis]).to_f64().round() as i32,
        })
    }

    /// The minimum image of a displacement: that between the nearest images of two positions. It is at
    /// most half a period long along each axis.
    #[inline(always)]
    pub fn minimum_image(&self, displacement: [T; 2]) -> [T; 2] {
        if self.is_none() {
            return displacement;
        }
        self.minimum_image_within([0, 1].map(|axis| {
            let (side, along) = (self.0[axis], displacement[axis]);
            // The remainder is exact, so that the result does not depend on the number of periods.
            if along.abs() > side && side > T::ZERO { along.remainder(side) } else { along }
        }))
    }

    /// The shortest image of a displacement of at most one period along each axis. Loops over it are
    /// vectorized, because it neither divides nor branches.
    #[inline(always)]
    pub fn minimum_image_within(&self, displacement: [T; 2]) -> [T; 2] {
        [0, 1].map(|axis| {
            let (side, along) = (self.0[axis], displacement[axis]);
            let half = T::from_f64(0.5) * side;
            if along > half {
                along - side
            } else if along < -half {
                along + side
            } else {
                along
            }
        })
    }

    /// The images, as numbers of periods, of the shapes with centres in the first period that a
    /// region may touch. Of shapes wider than a period, the images that are nearest to it.
    pub fn images_near(&self, min: [T; 2], max: [T; 2]) -> impl Iterator<Item = Turns> + use<T> {
        let [x, y] = [0, 1].map(|axis| {
            let turns = |at: T| (at / self.0[axis]).to_f64().floor() as i32;
            // A shape belongs to the period of its centre, but reaches beyond it, so the periods on
            // either side count.
            if self.is_along(axis) { turns(min[axis]) - 1..=turns(max[axis]) + 1 } else { 0..=0 }
        });
        y.flat_map(move |y| x.clone().map(move |x| [x, y]))
    }

    /// Whether a displacement is longer than the period along an axis.
    pub fn is_exceeded_by(&self, displacement: [T; 2]) -> bool {
        (0..2).any(|axis| self.is_along(axis) && displacement[axis].abs() > self.0[axis])
    }

    /// The displacement of a number of periods.
    #[inline]
    pub fn span(&self, turns: Turns) -> [T; 2] {
        [0, 1].map(|axis| T::from_f64(f64::from(turns[axis])) * self.0[axis])
    }

    /// The same shape with its centre in the first period. A box there is unchanged; one elsewhere
    /// is moved, which rounds its sides.
    pub fn wrap_shape(&self, shape: Shape<T>) -> Shape<T> {
        if self.is_none() {
            return shape;
        }
        let [min, max] = self.wrap_corners([shape.min, shape.max]);
        Shape { min, max, ..shape }
    }

    /// As [`Period::wrap_shape`], for the corners alone.
    pub fn wrap_corners(&self, [min, max]: [[T; 2]; 2]) -> [[T; 2]; 2] {
        let center = [0, 1].map(|axis| middle(min[axis], max[axis]));
        let (wrapped, turns) = (self.wrap(center), self.turns(center));
        let (mut low, mut high) = (min, max);
        for axis in 0..2 {
            if !self.is_along(axis) || wrapped[axis] == center[axis] {
                continue;
            }
            // Sides that touch are moved by the same number of periods, so they still touch.
            low[axis] = min[axis] - turns[axis];
            high[axis] = max[axis] - turns[axis];
            let error = (middle(low[axis], high[axis]) - wrapped[axis]).abs();
            // Far away the multiple of the period is rounded by more than the period.
            if min[axis] == max[axis] || error * T::from_f64(8.0) > self.0[axis] {
                let half = max[axis] * T::from_f64(0.5) - min[axis] * T::from_f64(0.5);
                (low[axis], high[axis]) = (wrapped[axis] - half, wrapped[axis] + half);
            }
        }
        [low, high]
    }

    /// The displacements to the nearest images of a position, one of each two opposite ones: a pair of
    /// shapes whose centres are in the first period is near with one of them, if not as it is.
    pub fn half_of_images(&self) -> impl Iterator<Item = [T; 2]> + use<T> {
        let period = *self;
        let exists = move |turns: &Turns| (0..2).all(|k| turns[k] == 0 || period.is_along(k));
        HALF_OF_IMAGES.into_iter().filter(exists).map(move |turns| period.span(turns))
    }

    /// The displacements to the images of a region that may overlap shapes whose centres are in the
    /// first period, itself first.
    pub fn images(&self) -> impl Iterator<Item = [T; 2]> {
        let along = |axis: usize| {
            let side = self.0[axis];
            let count = if self.is_along(axis) { 3 } else { 1 };
            // Itself first: most searches end there, and the order of the hits begins with the
            // unmoved ones.
            [T::ZERO, -side, side].into_iter().take(count)
        };
        along(1).flat_map(move |y| along(0).map(move |x| [x, y]))
    }

    /// The images of a coordinate along an axis; three equal ones if the axis is not periodic.
    #[inline(always)]
    pub fn images_along(&self, axis: usize, at: T) -> [T; 3] {
        [at, at - self.0[axis], at + self.0[axis]]
    }

    /// The gaps between the cores of two shapes along each axis: as they are, and after the
    /// shape with the higher centre was moved by one period.
    fn gaps(&self, a: &Shape<T>, b: &Shape<T>) -> [[T; 2]; 2] {
        let direct = a.gaps(b);
        // Always the shape with the higher centre is moved by -p, never the lower one by +p. The
        // two give the same gap in exact arithmetic and different roundings: then `overlap(a, b)`
        // and `overlap(b, a)` could differ.
        let (first, second) = (a.moved(self.0).gaps(b), a.gaps(&b.moved(self.0)));
        let (is_first, both) = (higher(a, b), [direct, first, second]);
        let wrapped = [0, 1].map(|axis| both[if is_first[axis] { 1 } else { 2 }][axis]);
        [direct, wrapped]
    }

    /// Whether two shapes overlap, with the smaller gap along each axis.
    pub fn overlap(&self, a: &Shape<T>, b: &Shape<T>) -> bool {
        if a.is_slanted() || b.is_slanted() {
            // The image with the smaller gap of boxes may have the larger distance of segments.
            return self.combinations(usize::MAX).any(|which| {
                let [a, b] = self.moved(a, b, which);
                a.overlaps(&b)
            });
        }
        let [direct, wrapped] = self.gaps(a, b);
        let smaller = |axis: usize| {
            if self.is_along(axis) { direct[axis].min(wrapped[axis]) } else { direct[axis] }
        };
        overlap([smaller(0), smaller(1)], a.radius + b.radius)
    }

    /// Whether no combination of gaps before `wrapped` overlaps. Combinations are ordered as
    /// numbers with a bit for each axis, which is set if the gap is the one after a move.
    pub fn is_first_overlap(&self, a: &Shape<T>, b: &Shape<T>, wrapped: [bool; 2]) -> bool {
        let gaps = self.gaps(a, b);
        let own = usize::from(wrapped[0]) + 2 * usize::from(wrapped[1]);
        // Wide shapes may overlap in several images at once. The first combination that overlaps
        // has the pair; in all later ones it is left out. So each pair is found once.
        self.combinations(own).all(|which| {
            let gaps = [gaps[which & 1][0], gaps[which >> 1][1]];
            !overlap(gaps, a.radius + b.radius) || {
                let [a, b] = self.moved(a, b, which);
                !cores_overlap(&a, &b)
            }
        })
    }

    /// The combinations of moves before `end`.
    fn combinations(&self, end: usize) -> impl Iterator<Item = usize> {
        // A bit of an axis that is not periodic would mean a move by 0, the same combination once
        // more.
        let exists = |which: &usize| {
            (which & 1 == 0 || self.is_along(0)) && (which & 2 == 0 || self.is_along(1))
        };
        (0..end.min(4)).filter(exists)
    }

    /// Two shapes after the higher one along each axis of a combination was moved by minus one
    /// period.
    fn moved(&self, a: &Shape<T>, b: &Shape<T>, which: usize) -> [Shape<T>; 2] {
        let is_first = higher(a, b);
        let by = |of_first: bool| {
            [0, 1].map(|axis| {
                let is_moved = which >> axis & 1 != 0 && is_first[axis] == of_first;
                if is_moved { self.0[axis] } else { T::ZERO }
            })
        };
        [a.moved(by(true)), b.moved(by(false))]
    }

    /// Two shapes as they are nearest to each other: the one with the higher centre is moved
    /// by minus one period along each axis on which this makes the gap smaller.
    pub fn nearest_images(&self, a: &Shape<T>, b: &Shape<T>) -> [Shape<T>; 2] {
        if a.is_slanted() || b.is_slanted() {
            let depth = |[a, b]: &[Shape<T>; 2]| contact(a, b).1;
            let all = self.combinations(usize::MAX).map(|which| self.moved(a, b, which));
            let deepest =
                all.reduce(|one, other| if depth(&other) > depth(&one) { other } else { one });
            return deepest.unwrap_or([*a, *b]);
        }
        let [direct, wrapped] = self.gaps(a, b);
        let is_first = higher(a, b);
        let (mut of_a, mut of_b) = ([T::ZERO; 2], [T::ZERO; 2]);
        for axis in 0..2 {
            // Not at equal gaps: what need not be moved keeps its bits.
            if self.is_along(axis) && wrapped[axis] < direct[axis] {
                let moved = if is_first[axis] { &mut of_a } else { &mut of_b };
                moved[axis] = self.0[axis];
            }
        }
        [a.moved(of_a), b.moved(of_b)]
    }
}

/// Whether the centre of `a` is the higher one along each axis.
pub fn higher<T: Scalar>(a: &Shape<T>, b: &Shape<T>) -> [bool; 2] {
    let (a, b) = (a.center(), b.center());
    [a[0] >= b[0], a[1] >= b[1]]
}

/// A coordinate modulo `side`, in `[0, side)`. The remainder is exact; only the addition to a
/// negative one rounds.
fn wrap<T: Scalar>(along: T, side: T) -> T {
    // −0 becomes 0.
    if along >= T::ZERO && along < side {
        return along + T::ZERO;
    }
    // `fmod` is exact. `along - floor(along / side) * side` rounds three times, and may even give a
    // number below 0.
    let rest = along.remainder(side);
    let wrapped = if rest < T::ZERO { rest + side } else { rest };
    // A tiny negative number is rounded up to the side.
    if wrapped < side { wrapped + T::ZERO } else { T::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapped_coordinates_are_in_the_first_period() {
        for (along, side, expected) in [
            (0.0, 3.0, 0.0),
            (3.0, 3.0, 0.0),
            (-0.0, 3.0, 0.0),
            (-1e-300, 3.0, 0.0),
            (-1.0, 3.0, 2.0),
            (7.5, 3.0, 1.5),
            (1e300, 0.1, 1e300 % 0.1),
        ] {
            let found: f64 = wrap(along, side);
            assert_eq!(found, expected, "{along} {side}");
            assert!(found.is_sign_positive() && found < side);
        }
    }

    #[test]
    fn turns_and_images_are_whole_periods() {
        let period = Period::new([3.0, 0.0]).unwrap();
        for (x, turns) in [(0.0, 0), (2.9, 0), (3.0, 1), (-1e-300, 0), (-0.5, -1), (31.0, 10)] {
            assert_eq!(period.turns_of([x, 7.0]), [turns, 0], "{x}");
        }
        assert_eq!(period.minimum_image([2.0, 2.0]), [-1.0, 2.0]);
        assert_eq!(period.minimum_image([-1.25, 1e9]), [-1.25, 1e9]);
        assert_eq!(period.minimum_image([1.5, 0.0]), [1.5, 0.0]);
        assert_eq!(period.minimum_image([-31.0, -1e9]), [-1.0, -1e9]);
        let near: Vec<Turns> = period.images_near([-1.0, -9.0], [4.0, 9.0]).collect();
        assert_eq!(near, [[-2, 0], [-1, 0], [0, 0], [1, 0], [2, 0]]);
    }

    #[test]
    fn sides_out_of_range_are_refused() {
        assert!(Period::new([0.0f64, 1.0]).is_ok());
        for side in [-1.0, f64::NAN, f64::INFINITY, 1e-300, 1e200] {
            let error = Period::new([1.0, side]).unwrap_err().to_string();
            assert!(error.starts_with("period[1] is "), "{error}");
        }
    }
}
