//! Placing shapes one after another at the nearest free positions along an axis.
//!
//! Each placed shape excludes an interval of positions for the shapes near it across the axis.
//! Shapes far from each other are placed first, at their own positions, then those between them,
//! and so on: a swarm becomes symmetric, with smooth edges.

use super::bodies::Bodies;
use super::push::Pusher;
use super::rules::Separation;
use super::taken::Taken;
use jostle_base::error::Result;
use jostle_base::interrupt::Pulse;
use jostle_base::memory;
use jostle_index::geometry::Scalar;

/// Places all movable shapes along the axis; one without a free position in the bounds is put into
/// them.
pub(crate) fn place<T: Scalar>(
    bodies: &mut Bodies<T>,
    axis: usize,
    pusher: &Pusher<T>,
    rules: &Separation<T>,
) -> Result<()> {
    let across = 1 - axis;
    let mut order: Vec<u32> = memory::collect(0..bodies.len() as u32)?;
    let at = |index: &u32| bodies.centers[*index as usize];
    order.sort_unstable_by(|a, b| {
        let [a_at, b_at] = [at(a), at(b)];
        // Sorted across the axis, so that all shapes that can be in the way of one are a range.
        let by_position = a_at[across].total_order(&b_at[across]);
        by_position.then(a_at[axis].total_order(&b_at[axis])).then(a.cmp(b))
    });
    let extents = bodies.all.iter().map(|body| body.extent(across));
    let widest = extents.fold(T::ZERO, T::max) + rules.gap;
    let mut taken = Taken::default();
    let mut placed = memory::filled(bodies.len(), false)?;
    let mut pulse = Pulse::current();
    for nth in far_apart(order.len()) {
        let own = order[nth] as usize;
        let (body, center) = (bodies.all[own], bodies.centers[own]);
        // The widest shape decides for all: a single one that is very wide makes each range long,
        // and the sweep quadratic at worst.
        let range = body.extent(across) + widest;
        let away = |other: u32| bodies.centers[other as usize][across] - center[across];
        // Positions across do not change, so the order stays valid while shapes are placed.
        let first = order.partition_point(|&other| away(other) <= -range);
        let last = order.partition_point(|&other| away(other) < range);
        pulse.check(last - first)?;
        taken.intervals.clear();
        for &other in &order[first..last] {
            let other = other as usize;
            let second = &bodies.all[other];
            // Shapes that are placed later will go round this one. Fixed ones are in the way from
            // the start.
            if other == own || !(placed[other] || second.is_fixed()) {
                continue;
            }
            let needed = pusher.needed_along(axis, &body, second, away(other as u32));
            if needed > T::ZERO {
                let needed = needed * pusher.size_factor();
                let at = bodies.centers[other][axis];
                memory::push(&mut taken.intervals, [at - needed, at + needed])?;
            }
        }
        if body.is_fixed() {
            continue;
        }
        let limits = rules.bounds.map(|bounds| {
            let extent = body.extent(axis);
            [bounds[axis] + extent, bounds[axis + 2] - extent]
        });
        let [low, high] = limits.unwrap_or([-T::INFINITY, T::INFINITY]);
        let free = taken.nearest_free(center[axis], limits);
        bodies.centers[own][axis] = free.unwrap_or(center[axis].min(high).max(low));
        placed[own] = true;
    }
    Ok(())
}

/// The numbers below `len`, successive ones far apart: with their bits reversed (the sequence of
/// van der Corput).
fn far_apart(len: usize) -> impl Iterator<Item = usize> {
    let bits = len.next_power_of_two().trailing_zeros();
    let reversed =
        // Reversed bits: each power of two of steps covers the whole range evenly, at half the
        // distance of the one before. In ascending order each shape would push all later ones in
        // one direction, and a swarm would lean.
        move |k: usize| if bits == 0 { k } else { k.reverse_bits() >> (usize::BITS - bits) };
    (0..1usize << bits).map(reversed).filter(move |&k| k < len)
}

#[cfg(test)]
mod tests {
    use super::far_apart;

    #[test]
    fn all_numbers_come_once_and_neighbours_late() {
        assert_eq!(far_apart(6).collect::<Vec<_>>(), [0, 4, 2, 1, 5, 3]);
        assert_eq!([far_apart(0).count(), far_apart(1).count()], [0, 1]);
    }
}
