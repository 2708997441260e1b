//! What a moving shape cannot enter: a shape, or a line segment.

use std::cmp::Ordering;

use super::cast::enters;
use super::segment;
use crate::geometry::{self, Scalar, Shape, gap, overlap};

/// An obstacle's geometry.
#[derive(Clone, Copy, Debug)]
pub enum Solid<T> {
    /// A rounded box.
    Shape(Shape<T>),
    /// A line segment, solid from both sides.
    Segment([[T; 2]; 2]),
}

/// A solid with its index for the caller.
#[derive(Clone, Copy, Debug)]
pub struct Obstacle<T> {
    /// Its geometry.
    pub solid: Solid<T>,
    /// Its index for the caller.
    pub index: u32,
}

impl<T: Scalar> Obstacle<T> {
    /// Whether a shape overlaps it.
    #[inline(always)]
    pub fn overlaps(&self, body: &Shape<T>) -> bool {
        match &self.solid {
            Solid::Shape(shape) => overlap(gaps(body, shape), body.radius + shape.radius),
            Solid::Segment(ends) => segment::overlaps(body, ends),
        }
    }

    /// The unit normal from a shape that overlaps it towards it, and the depth of the overlap.
    pub fn contact(&self, body: &Shape<T>) -> ([T; 2], T) {
        match &self.solid {
            Solid::Shape(shape) => geometry::contact(body, shape),
            Solid::Segment(ends) => segment::contact(body, ends),
        }
    }

    /// A length that, with the position and the size of a shape, bounds the numbers from which
    /// overlaps and impacts are computed: the gaps to another shape, or the offset of the farther
    /// end of a segment.
    pub fn span(&self, body: &Shape<T>) -> T {
        match &self.solid {
            Solid::Shape(shape) => {
                let [x, y] = gaps(body, shape);
                x.max(T::ZERO) + y.max(T::ZERO)
            }
            Solid::Segment([a, b]) => {
                let away = |axis: usize| {
                    (a[axis] - body.min[axis]).abs().max((b[axis] - body.min[axis]).abs())
                };
                away(0) + away(1)
            }
        }
    }

    /// The share of a displacement after which a shape enters it by more than `slop`, and the
    /// normal there; None if it does not, or is inside at the start.
    pub fn enters(&self, body: &Shape<T>, displacement: [T; 2], slop: T) -> Option<(T, [T; 2])> {
        match &self.solid {
            Solid::Shape(shape) => enters(body, displacement, shape, slop),
            Solid::Segment(ends) => segment::enters(body, displacement, ends, slop),
        }
    }

    /// The shape, if it is of one of these categories.
    pub fn shape_of(&self, categories: u32) -> Option<&Shape<T>> {
        match &self.solid {
            Solid::Shape(shape) if shape.category & categories != 0 => Some(shape),
            _ => None,
        }
    }

    /// Orders obstacles by their geometry, then by their indices, so that ties do not depend on
    /// the order in which they were found.
    pub fn order(&self, other: &Self) -> Ordering {
        let (own, others) = (self.numbers(), other.numbers());
        let by_value = own.iter().zip(&others).map(|(a, b)| a.total_order(b));
        by_value.fold(Ordering::Equal, Ordering::then).then(self.index.cmp(&other.index))
    }

    fn numbers(&self) -> [T; 8] {
        match self.solid {
            Solid::Shape(Shape { min, max, half_size, radius, .. }) => {
                [T::ZERO, min[0], min[1], max[0], max[1], half_size[0], half_size[1], radius]
            }
            Solid::Segment([a, b]) => [T::ONE, a[0], a[1], b[0], b[1], T::ZERO, T::ZERO, T::ZERO],
        }
    }
}

/// The gaps between the cores of two shapes along each axis.
#[inline(always)]
fn gaps<T: Scalar>(body: &Shape<T>, obstacle: &Shape<T>) -> [T; 2] {
    let along = |axis: usize| {
        let own = [body.min[axis], body.max[axis]];
        gap(own, [obstacle.min[axis], obstacle.max[axis]])
            - (body.half_size[axis] + obstacle.half_size[axis])
    };
    [along(0), along(1)]
}
