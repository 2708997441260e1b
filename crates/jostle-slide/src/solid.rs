//! Obstacles that a moving shape cannot enter.

use std::cmp::Ordering;

use super::outline::Outline;
use super::segment::Segment;
use jostle_index::geometry::{Bounds, Scalar, Shape};
use jostle_index::period::{Period, Turns};

/// An obstacle's geometry.
#[derive(Clone, Copy, Debug)]
pub enum Solid<T> {
    /// A rounded box.
    Shape(Shape<T>),
    /// A line segment with a length, or a capsule.
    Segment(Segment<T>),
}

/// A solid with its index for the caller.
#[derive(Clone, Copy, Debug)]
pub struct Obstacle<T> {
    /// Its geometry, in the first period.
    pub solid: Solid<T>,
    /// The periods by which this image of it is moved; 0 in a plane that is not periodic.
    pub turns: Turns,
    /// The displacement that has brought it here since the last motion of the shape that moves.
    pub motion: [T; 2],
    /// Its index for the caller.
    pub index: u32,
}

/// Lists the obstacles that may overlap a region.
pub type FindObstacles<'a, T> = dyn FnMut(&Bounds<T>, &mut Vec<Obstacle<T>>) + 'a;

impl<T: Scalar> Obstacle<T> {
    /// Calls `act` with a body and this image of the obstacle, when the share `left` of its motion
    /// is still to come, both where the formula of [`Period::overlap`] has them: the body in the
    /// first period, and the one with the higher centre moved by minus one period if the image is
    /// another one.
    #[inline(always)]
    pub fn facing<R>(
        &self,
        (period, left): (&Period<T>, T),
        body: &Shape<T>,
        act: impl FnOnce(&Shape<T>, &dyn Outline<T>) -> R,
    ) -> R {
        if left != T::ZERO && self.motion != [T::ZERO; 2] {
            let solid = self.solid.moved(self.motion.map(|v| v * left));
            // Obstacles are stored where they end. Their places at any time follow from the share
            // of their motion that is left, so that no second list is needed.
            let before = Self { solid, motion: [T::ZERO; 2], ..*self };
            return before.facing_now(period, body, act);
        }
        self.facing_now(period, body, act)
    }

    #[inline(always)]
    fn facing_now<R>(
        &self,
        period: &Period<T>,
        body: &Shape<T>,
        act: impl FnOnce(&Shape<T>, &dyn Outline<T>) -> R,
    ) -> R {
        if period.is_none() {
            return act(body, self.solid.outline());
        }
        // Both are brought to where `Period::overlap` compares them. Anywhere else the same two
        // shapes would round differently, and the walker would end in places that a query calls an
        // overlap.
        let (center, own) = (period.wrap(body.min), period.turns_of(body.min));
        let (mut of_body, mut of_solid) = ([T::ZERO; 2], [T::ZERO; 2]);
        for axis in 0..2 {
            let turns = self.turns[axis] - own[axis];
            if turns == 1 {
                of_body[axis] = period.sides()[axis];
            } else {
                of_solid[axis] = T::from_f64(-f64::from(turns)) * period.sides()[axis];
            }
        }
        let body = Shape { min: center, max: center, ..*body }.moved(of_body);
        act(&body, self.solid.moved(of_solid).outline())
    }

    /// Orders obstacles by their geometry, then by their numbers, so that ties do not depend on
    /// the order in which they were found.
    pub fn order(&self, other: &Self) -> Ordering {
        let (own, others) = (self.solid.outline().numbers(), other.solid.outline().numbers());
        let by_value = own.iter().zip(&others).map(|(a, b)| a.total_order(b));
        // By value first: the index of an obstacle depends on the order in which it was added, its
        // geometry does not.
        let by_value = by_value.fold(Ordering::Equal, Ordering::then);
        by_value.then((self.turns, self.index).cmp(&(other.turns, other.index)))
    }
}

impl<T: Scalar> Solid<T> {
    /// A shape. A segment without a length is a point, as a box without a size is.
    pub fn of(shape: Shape<T>) -> Self {
        Segment::of(shape).map_or(Self::Shape(shape), Self::Segment)
    }

    /// Its geometry.
    #[inline(always)]
    pub fn outline(&self) -> &dyn Outline<T> {
        match self {
            Self::Shape(shape) => shape,
            Self::Segment(segment) => segment,
        }
    }

    /// Its categories, a bit set.
    #[inline(always)]
    pub fn category(&self) -> u32 {
        match self {
            Self::Shape(shape) => shape.category,
            Self::Segment(segment) => segment.shape().category,
        }
    }

    /// The same moved by `-shift`.
    #[inline(always)]
    fn moved(&self, shift: [T; 2]) -> Self {
        match self {
            Self::Shape(shape) => Self::Shape(shape.moved(shift)),
            Self::Segment(segment) => Self::Segment(segment.moved(shift)),
        }
    }
}
