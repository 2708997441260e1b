//! Placing shapes one after another at the nearest free positions along an axis.
//!
//! Shapes are placed in the order of their positions across the axis, so only those placed last
//! can be in the way. Each leaves out an interval of positions. As in the swarm plots of
//! statistics, shapes that are placed first stay where they are.

use super::Separation;
use super::bodies::Bodies;
use super::push::Pusher;
use super::taken::Taken;
use crate::error::Result;
use crate::geometry::Scalar;
use crate::interrupt::Pulse;
use crate::memory;

/// Places all movable shapes; one without a free position in the bounds stays.
pub fn place<T: Scalar>(
    bodies: &mut Bodies<T>,
    axis: usize,
    pusher: &Pusher<T>,
    rules: &Separation<T>,
) -> Result<()> {
    let across = 1 - axis;
    let mut order: Vec<u32> = memory::collect(0..bodies.len() as u32)?;
    let at = |place: &u32| bodies.centers[*place as usize];
    order.sort_unstable_by(|a, b| {
        let [a_at, b_at] = [at(a), at(b)];
        let by_place = a_at[across].total_order(&b_at[across]);
        by_place.then(a_at[axis].total_order(&b_at[axis])).then(a.cmp(b))
    });
    let extents = bodies.all.iter().map(|body| body.extent(across));
    let widest = extents.fold(T::ZERO, T::max) + rules.gap;
    let mut taken = Taken::default();
    let mut placed = memory::filled(bodies.len(), false)?;
    let (mut first, mut last) = (0, 0);
    let mut pulse = Pulse::current();
    for (index, &own) in order.iter().enumerate() {
        let own = own as usize;
        let (body, center) = (bodies.all[own], bodies.centers[own]);
        let reach = body.extent(across) + widest;
        let away = |other: u32| bodies.centers[other as usize][across] - center[across];
        // A shape that is wider than another must see farther back.
        while first > 0 && T::ZERO - away(order[first - 1]) < reach {
            first -= 1;
        }
        while T::ZERO - away(order[first]) >= reach && first < index {
            first += 1;
        }
        last = last.max(index);
        while last < order.len() && away(order[last]) < reach {
            last += 1;
        }
        pulse.check(last - first)?;
        taken.intervals.clear();
        for &other in &order[first..last] {
            let other = other as usize;
            let second = &bodies.all[other];
            if other == own || !(placed[other] || second.is_fixed()) {
                continue;
            }
            let needed = pusher.needed_along(axis, &body, second, away(other as u32));
            if needed > T::ZERO {
                let needed = needed * pusher.room();
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
        if let Some(free) = taken.nearest_free(center[axis], limits) {
            bodies.centers[own][axis] = free;
        }
        placed[own] = true;
    }
    Ok(())
}
