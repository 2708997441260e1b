//! The geometry of an obstacle, for a shape that moves.

use jostle_index::geometry::{Scalar, Shape};

/// What the motion of a shape needs of the geometry of an obstacle. The shape is a rounded box
/// given by its centre.
///
/// Whatever implements this can be an obstacle: a new kind needs a variant of [`Solid`](super::Solid) in addition.
pub trait Outline<T: Scalar> {
    /// Whether a shape overlaps it; touching is not overlapping.
    fn overlaps(&self, body: &Shape<T>) -> bool;

    /// The unit normal from a shape towards it, and the depth of their overlap; the gap between
    /// them is the negative depth.
    fn contact(&self, body: &Shape<T>) -> ([T; 2], T);

    /// The share of a displacement after which a shape enters it by more than `slop`, and its unit
    /// normal there; None if the shape does not, or is inside at the start.
    ///
    /// A path that enters by less only grazes it: the path is along its surface, up to rounding.
    fn enters(&self, body: &Shape<T>, displacement: [T; 2], slop: T) -> Option<(T, [T; 2])>;

    /// A length that, with the position and the size of a shape, bounds the numbers from which
    /// overlaps and impacts are computed.
    fn span(&self, body: &Shape<T>) -> T;

    /// Whether a shape is above it, up to `slop`, where `up` is a unit vector.
    fn is_above(&self, body: &Shape<T>, up: [T; 2], slop: T) -> bool;

    /// Numbers that differ between different obstacles, which give an order to those that are met
    /// at the same time.
    fn numbers(&self) -> [T; 8];
}
