//! Division of the Morton curve into the domains of the ranks, by samples of the keys (sample
//! sort).

use super::scale::Scale;
use jostle_base::morton;

/// Number of keys that each rank samples.
pub const SAMPLES: usize = 256;

/// Number of cells along each axis, as a power of two.
const BITS: u32 = 31;

/// The Morton key of a position on the scales of both axes.
#[inline(always)]
pub fn key(scales: &[Scale; 2], position: [f32; 2]) -> u64 {
    let cells = f64::from(1u32 << BITS);
    // A cast limits numbers that are out of range.
    let index = |k: usize| {
        let along = scales[k].share(f64::from(position[k])) * cells;
        along.min(cells - 1.0) as u32
    };
    morton::wide_key(index(0), index(1))
}

/// Evenly spaced samples of some keys, which are sorted first; none if there are no keys.
pub fn sample(keys: &mut [u64]) -> Vec<u64> {
    keys.sort_unstable();
    let count = if keys.is_empty() { 0 } else { SAMPLES };
    // In the middle of each of equal parts.
    (0..count).map(|k| keys[(2 * k + 1) * keys.len() / (2 * count)]).collect()
}

/// The keys at which the domains of all ranks but the first begin, so that all have about the same
/// work. Each rank gives its samples and its work.
pub fn cuts(ranks: &[(Vec<u64>, f64)]) -> Vec<u64> {
    let mut all: Vec<(u64, f64)> = Vec::new();
    for (samples, work) in ranks {
        let each = work / samples.len().max(1) as f64;
        all.extend(samples.iter().map(|&key| (key, each)));
    }
    all.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let total: f64 = all.iter().map(|(_, work)| work).sum();
    let (mut cuts, mut done) = (Vec::new(), 0.0);
    for &(key, work) in &all {
        // A sample belongs to the domain in which the middle of its work lies. So a cut is wrong by
        // half a sample at most, as far as samples tell where the work is.
        while cuts.len() + 1 < ranks.len()
            && done + 0.5 * work > total * (cuts.len() + 1) as f64 / ranks.len() as f64
        {
            cuts.push(key);
        }
        done += work;
    }
    // Ranks for which no key is left begin behind all keys, and have no particles.
    cuts.resize(ranks.len() - 1, u64::MAX);
    cuts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_in_morton_order_and_limited() {
        let scale = |to: f64| Scale::new(&[(0.0, 1.0), (to, 1.0)], None);
        let scales = [scale(8.0), scale(4.0)];
        let keys = [[0.0, 0.0], [5.0, 0.0], [1.0, 3.9], [99.0, 99.0]].map(|at| key(&scales, at));
        assert!(keys.is_sorted_by(|a, b| a < b), "{keys:?}");
        let point = || Scale::new(&[(1.0, 1.0)], None);
        let keys = [0.5, 1.0, 1.5].map(|x| key(&[point(), point()], [x; 2]));
        assert!(keys[0] < keys[1] && keys[1] <= keys[2], "{keys:?}");
        assert_eq!(keys[2], (1 << (2 * BITS)) - 1);
    }

    #[test]
    fn a_position_far_away_does_not_join_the_keys_of_the_others() {
        let mut samples: Vec<(f64, f64)> = (0..1000).map(|x| (f64::from(x), 1.0)).collect();
        samples.push((1e18, 1.0));
        let scales = [Scale::new(&samples, None), Scale::new(&samples, None)];
        let mut keys: Vec<u64> = (0..1000).map(|x| key(&scales, [x as f32; 2])).collect();
        keys.dedup();
        assert!(keys.len() > 990, "{}", keys.len());
    }

    #[test]
    fn ranks_get_equal_work() {
        let keys = |from: u64, to: u64| sample(&mut (from..to).collect::<Vec<u64>>());
        let cuts_of = |ranks: &[(Vec<u64>, f64)]| cuts(ranks);
        assert_eq!(cuts_of(&[(keys(0, 1000), 1.0)]), []);
        let halves = cuts_of(&[(keys(0, 4096), 1.0), (vec![], 0.0)]);
        assert!(halves[0].abs_diff(2048) < 20, "{halves:?}");
        // Twice the work in the first half.
        let uneven = cuts_of(&[(keys(0, 2048), 2.0), (keys(2048, 4096), 1.0), (vec![], 0.0)]);
        assert!(uneven[0].abs_diff(1024) < 20 && uneven[1].abs_diff(2048) < 20, "{uneven:?}");
        assert_eq!(cuts_of(&[(vec![], 0.0), (vec![], 0.0)]), [u64::MAX]);
    }

    /// The largest share of all keys that a rank gets, times the number of ranks.
    fn imbalance(parts: &[Vec<u64>]) -> f64 {
        let ranks: Vec<(Vec<u64>, f64)> =
            parts.iter().map(|keys| (sample(&mut keys.clone()), keys.len() as f64)).collect();
        let mut counts = vec![0.0; parts.len()];
        let cuts = cuts(&ranks);
        let all = parts.iter().flatten();
        all.for_each(|key| counts[cuts.partition_point(|cut| cut <= key)] += 1.0);
        let total: f64 = counts.iter().sum();
        counts.iter().fold(0.0, |most, &count| f64::max(most, count)) / total * parts.len() as f64
    }

    #[test]
    fn the_imbalance_is_bounded() {
        const RANKS: u64 = 32;
        let square = |k: u64| k * k;
        // All ranks have keys everywhere, at first.
        let mixed = |rank: u64| (0..2000).map(|k| square(k * RANKS + rank)).collect();
        assert!(imbalance(&(0..RANKS).map(mixed).collect::<Vec<_>>()) < 1.0 + 32.0 / 256.0);
        // Later each has a range of the curve.
        let range = |rank: u64| (rank * 2000..(rank + 1) * 2000).map(square).collect();
        assert!(imbalance(&(0..RANKS).map(range).collect::<Vec<_>>()) < 1.0 + 2.0 / 256.0);
        // All keys on one rank.
        let mut one: Vec<Vec<u64>> = vec![vec![]; 8];
        one[3] = (0..64_000).map(square).collect();
        assert!(imbalance(&one) < 1.0 + 8.0 / 256.0);
    }
}
