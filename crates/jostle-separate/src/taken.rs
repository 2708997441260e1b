//! Free positions along a line.

use jostle_index::geometry::Scalar;

/// Open intervals of positions that are not free.
#[derive(Default)]
pub(crate) struct Taken<T> {
    /// `[from, to]` each, in any order.
    pub intervals: Vec<[T; 2]>,
}

impl<T: Scalar> Taken<T> {
    /// The free position nearest to `wanted`, if there is one within the limits. If two are as
    /// near, the lower one if the number of intervals is even: so swarms are symmetric.
    pub(crate) fn nearest_free(&mut self, wanted: T, limits: Option<[T; 2]>) -> Option<T> {
        let [low, high] = limits.unwrap_or([-T::INFINITY, T::INFINITY]);
        let start = wanted.max(low).min(high);
        self.intervals
            .sort_unstable_by(|a, b| a[0].total_order(&b[0]).then(a[1].total_order(&b[1])));
        // Intervals in ascending order: those that overlap are joined, until the union around
        // `start` is complete. Its two ends are the nearest free positions, so nothing before or
        // after it has to be kept.
        let mut union = [-T::INFINITY; 2];
        for &[from, to] in &self.intervals {
            if from < union[1] {
                union[1] = union[1].max(to);
            } else if union[0] < start && start < union[1] {
                break;
            } else {
                union = [from, to];
            }
        }
        if start <= union[0] || union[1] <= start {
            return Some(start);
        }
        let [below, above] = union;
        let lower = Some(below).filter(|&free| free >= low);
        let upper = Some(above).filter(|&free| free <= high);
        match (lower, upper) {
            (Some(lower), Some(upper)) => {
                let (down, up) = (start - lower, upper - start);
                let is_even = self.intervals.len().is_multiple_of(2);
                Some(if down < up || (down == up && is_even) { lower } else { upper })
            }
            (lower, upper) => lower.or(upper),
        }
    }
}
