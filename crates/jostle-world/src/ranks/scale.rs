//! Scales of coordinates by quantiles: all cells of a scale have about the same number of
//! particles, so a particle far away from all others does not make the cells of these larger.

use jostle_base::sorting;

/// Cells of a scale.
pub const CELLS: usize = 256;

/// Equal parts of a scale, each with the range of its cells.
const BUCKETS: usize = 1024;

/// Approximate number of samples of all ranks together; minimum and maximum number of samples of
/// one rank.
const SAMPLES: usize = 8192;
const MIN_SAMPLES: usize = 64;
const MAX_SAMPLES: usize = 1024;

/// Maximum number of particles of a rank from which the samples are taken.
const SORTED: usize = 1 << 15;

/// A monotone map of a coordinate to 0..=1, linear in each cell.
#[derive(Clone, Debug, Default)]
pub struct Scale {
    /// The beginnings of the cells, and the end of the last one.
    edges: Vec<f64>,
    /// The number of cells that end before each bucket.
    hints: Vec<u16>,
    origin: f64,
    /// Buckets in a unit of length.
    per_length: f64,
}

impl Scale {
    /// The scale of weighted samples. That of an axis with a period covers one period.
    pub fn new(samples: &[(f64, f64)], period: Option<f64>) -> Self {
        let mut sorted = samples.to_vec();
        sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let mut edges = quantiles(&sorted);
        // On a torus coordinates outside of the samples are possible, and the scale must cover the
        // period.
        if let Some(side) = period {
            (edges[0], edges[CELLS]) = (0.0, side);
        }
        // The first and the last cell may be very long, because of a particle far away. Buckets
        // divide only what is between them.
        let (origin, end) = (edges[1], edges[CELLS - 1]);
        let per_length = BUCKETS as f64 / (end - origin);
        let per_length = if per_length.is_finite() { per_length } else { 0.0 };
        let mut scale = Self { edges, hints: vec![0; BUCKETS + 1], origin, per_length };
        for edge in 1..CELLS {
            let bucket = scale.bucket(scale.edges[edge]);
            scale.hints[bucket] += 1;
        }
        sorting::prefix_sum(&mut scale.hints);
        scale
    }

    #[inline(always)]
    fn bucket(&self, x: f64) -> usize {
        // A cast limits numbers that are out of range.
        (((x - self.origin) * self.per_length) as usize).min(BUCKETS - 1)
    }

    /// The cell of a coordinate: the number of cells that end before it. Coordinates outside are in
    /// the first or in the last one.
    #[inline(always)]
    pub fn cell(&self, x: f64) -> usize {
        let bucket = self.bucket(x);
        // Most buckets contain one edge at most, so one comparison replaces a search.
        let [first, last] = [bucket, bucket + 1].map(|bucket| usize::from(self.hints[bucket]));
        if last <= first + 1 {
            // Without a branch that depends on the coordinate.
            return first + usize::from((last > first) & (self.edges[first + 1] <= x));
        }
        first + self.edges[first + 1..=last].partition_point(|&edge| edge <= x)
    }

    /// The share of the scale before a coordinate, from 0 to 1.
    pub fn share(&self, x: f64) -> f64 {
        let cell = self.cell(x);
        let [start, end] = [self.edges[cell], self.edges[cell + 1]];
        let inside = (x - start) / (end - start);
        // At an edge between cells without a width it is not a number.
        let inside = if inside.is_nan() { f64::from(x > start) } else { inside.clamp(0.0, 1.0) };
        (cell as f64 + inside) / CELLS as f64
    }
}

/// The indices of the cells' edges in sorted samples.
fn quantiles(sorted: &[(f64, f64)]) -> Vec<f64> {
    let (Some(&(first, _)), Some(&(last, _))) = (sorted.first(), sorted.last()) else {
        return (0..=CELLS).map(|edge| edge as f64 / CELLS as f64).collect();
    };
    let total: f64 = sorted.iter().map(|(_, weight)| weight).sum();
    let (mut edges, mut before) = (vec![first], 0.0);
    for two in sorted.windows(2) {
        let [(x, weight), (next, after)] = [two[0], two[1]];
        // A sample stands for as much weight before as after it.
        let (at, step) = (before + 0.5 * weight, 0.5 * (weight + after));
        while edges.len() < CELLS {
            let wanted = total * edges.len() as f64 / CELLS as f64;
            if wanted > at + step {
                break;
            }
            let share = ((wanted - at) / step).clamp(0.0, 1.0);
            edges.push(x + share * (next - x));
        }
        before += weight;
    }
    edges.resize(CELLS + 1, last);
    edges
}

/// Coordinates of evenly spaced particles as bytes: those of one axis, then those of the other.
pub fn sample_positions(positions: &[[f32; 2]], ranks: usize) -> Vec<u8> {
    // A sample of a sample: to sort all coordinates of a rank would take longer than it gains.
    let stride = positions.len().div_ceil(SORTED).max(1);
    // All ranks together have about as many samples whatever their number, because each reads all.
    let count = (SAMPLES / ranks.max(1)).clamp(MIN_SAMPLES, MAX_SAMPLES);
    let mut bytes = Vec::new();
    for k in [0, 1] {
        let mut all: Vec<f32> = positions.iter().step_by(stride).map(|at| at[k]).collect();
        all.sort_unstable_by(f32::total_cmp);
        let count = count.min(all.len());
        let sample = |number: usize| {
            // From the first to the last one.
            all[number * (all.len() - 1) / (count - 1).max(1)]
        };
        bytes.extend((0..count).flat_map(|number| sample(number).to_le_bytes()));
    }
    bytes
}

/// The samples of ranks with so many particles, with their weights, for each axis.
pub fn read_samples<'a>(ranks: impl Iterator<Item = (&'a [u8], f64)>) -> [Vec<(f64, f64)>; 2] {
    let mut samples = [Vec::new(), Vec::new()];
    for (bytes, count) in ranks {
        let (numbers, _) = bytes.as_chunks::<4>();
        let half = numbers.len() / 2;
        let weight = count / half.max(1) as f64;
        for (samples, numbers) in samples.iter_mut().zip([&numbers[..half], &numbers[half..]]) {
            let number = |bytes: &[u8; 4]| (f64::from(f32::from_le_bytes(*bytes)), weight);
            samples.extend(numbers.iter().map(number));
        }
    }
    samples
}

#[cfg(test)]
mod tests {
    use super::*;

    fn brute_cell(scale: &Scale, x: f64) -> usize {
        scale.edges[1..CELLS].iter().filter(|&&edge| edge <= x).count()
    }

    #[test]
    fn cells_have_as_many_samples() {
        let even: Vec<(f64, f64)> = (0..2560).map(|x| (f64::from(x), 1.0)).collect();
        let scale = Scale::new(&even, None);
        let mut counts = [0; CELLS];
        even.iter().for_each(|&(x, _)| counts[scale.cell(x)] += 1);
        assert!(counts.iter().all(|&count| (8..=12).contains(&count)), "{counts:?}");
        // Twice the weight counts as two samples.
        let heavy = even.iter().map(|&(x, _)| (x, if x < 1280.0 { 3.0 } else { 1.0 }));
        let scale = Scale::new(&heavy.collect::<Vec<_>>(), None);
        assert!(scale.share(1280.0) > 0.74 && scale.share(1280.0) < 0.76);
    }

    #[test]
    fn cells_and_shares_are_monotone_at_any_coordinates() {
        let lists: [Vec<f64>; 6] = [
            vec![],
            vec![3.0],
            vec![-1.0, 1.0, 1.0, 1.0, 7.0],
            (0..500).map(f64::from).chain([1e18, -1e18]).collect(),
            (0..300).map(|x| f64::from(x) * 1e-12).chain((0..300).map(f64::from)).collect(),
            vec![1e18; 40],
        ];
        for list in lists {
            let samples: Vec<(f64, f64)> = list.iter().map(|&x| (x, 0.5)).collect();
            let scale = Scale::new(&samples, None);
            let mut probes =
                vec![f64::NEG_INFINITY, -1e30, 0.0, 1e-13, 0.5, 2.0, 1e30, f64::INFINITY];
            probes.extend(list.iter().flat_map(|x| [x - 0.25, *x, x + 0.25]));
            probes.extend(&scale.edges);
            probes.sort_unstable_by(f64::total_cmp);
            for two in probes.windows(2) {
                assert!(scale.cell(two[0]) <= scale.cell(two[1]), "{two:?}");
                assert!(scale.share(two[0]) <= scale.share(two[1]), "{two:?}");
            }
            for x in probes {
                assert_eq!(scale.cell(x), brute_cell(&scale, x), "{x}");
                assert!((0.0..=1.0).contains(&scale.share(x)), "{x}");
            }
        }
    }

    #[test]
    fn samples_are_read_with_their_weights() {
        let positions: Vec<[f32; 2]> = (0..3000).map(|k| [k as f32, -2.0 * k as f32]).collect();
        let bytes =
            [sample_positions(&positions, 16), sample_positions(&positions[..2], 16), vec![]];
        let counts = [3000.0, 2.0, 0.0];
        let [x, y] = read_samples(bytes.iter().map(Vec::as_slice).zip(counts));
        assert_eq!((x.len(), y.len()), (514, 514));
        assert_eq!((x[0].0, x[511].0, y[0].0, y[511].0), (0.0, 2999.0, -5998.0, 0.0));
        let total: f64 = x.iter().map(|(_, weight)| weight).sum();
        assert!((total - 3002.0).abs() < 1e-9);
    }
}
