//! The formulas of overlaps, one shape after the other, independent of the library.

use jostle_base::Id;
use jostle_index::{Period, Scalar, Shape};

/// The gap between the cores of two shapes along an axis. On a periodic axis it is the smaller of two: as the shapes
/// are, and after the one with the higher centre was moved by minus a period.
fn gap<T: Scalar>(a: &Shape<T>, b: &Shape<T>, axis: usize, side: T) -> T {
    let halves = a.half_size[axis] + b.half_size[axis];
    let of = |a: [T; 2], b: [T; 2]| (b[0] - a[1]).max(a[0] - b[1]) - halves;
    let ends = |shape: &Shape<T>| [shape.min[axis], shape.max[axis]];
    let direct = of(ends(a), ends(b));
    if side == T::ZERO {
        return direct;
    }
    let is_higher = a.center()[axis] >= b.center()[axis];
    let (high, low) = if is_higher { (ends(a), ends(b)) } else { (ends(b), ends(a)) };
    direct.min(of([high[0] - side, high[1] - side], low))
}

/// Whether two shapes overlap; those that touch do not.
pub fn overlap<T: Scalar>(a: &Shape<T>, b: &Shape<T>, period: &Period<T>) -> bool {
    let [x, y] = [0, 1].map(|axis| gap(a, b, axis, period.sides()[axis]));
    let (e, f) = (x.max(T::ZERO), y.max(T::ZERO));
    let reach = a.radius + b.radius;
    e * e + f * f < reach * reach || (x < T::ZERO && y < T::ZERO)
}

/// Whether the filters of two shapes allow a pair.
pub fn may_pair<T>(a: &Shape<T>, b: &Shape<T>) -> bool {
    a.category & b.mask != 0 && b.category & a.mask != 0
}

/// The pairs of overlapping shapes, sorted. Shapes are extended by half of `distance`, and all have a category in
/// `mask`.
pub fn pairs<'a, T: Scalar>(
    shapes: impl Iterator<Item = (&'a Id, &'a Shape<T>)>,
    period: &Period<T>,
    (distance, mask): (T, Option<u32>),
) -> Vec<[Id; 2]> {
    let half = distance * T::from_f64(0.5);
    let grown = |shape: &Shape<T>| Shape { radius: shape.radius + half, ..*shape };
    let chosen = shapes.filter(|(_, shape)| mask.is_none_or(|mask| mask & shape.category != 0));
    let all: Vec<(Id, Shape<T>)> = chosen.map(|(id, shape)| (*id, grown(shape))).collect();
    let mut pairs = Vec::new();
    for (row, (i, a)) in all.iter().enumerate() {
        for (j, b) in &all[row + 1..] {
            if may_pair(a, b) && overlap(a, b, period) {
                pairs.push([*i.min(j), *i.max(j)]);
            }
        }
    }
    pairs.sort_unstable();
    pairs
}
