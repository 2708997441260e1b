//! Where the Morton curve is cut into the domains of the ranks.

/// Keys that each rank samples.
pub const SAMPLES: usize = 256;

/// Cells along each axis, as bits: clusters that are smaller by this factor than the whole are cut too.
const BITS: u32 = 31;

/// The Morton key of a position between `low` and `high`.
#[inline(always)]
pub fn key([low, high]: [[f64; 2]; 2], position: [f32; 2]) -> u64 {
    let cells = f64::from(1u32 << BITS);
    let side = (high[0] - low[0]).max(high[1] - low[1]);
    let scale = if side > 0.0 { cells / side } else { 0.0 };
    // A cast limits numbers that are out of range.
    let index = |k: usize| {
        let along = (f64::from(position[k]) - low[k]) * scale;
        spread(along.clamp(0.0, cells - 1.0) as u64)
    };
    index(0) | index(1) << 1
}

/// Inserts a 0 after each bit.
#[inline(always)]
fn spread(mut bits: u64) -> u64 {
    for (shift, mask) in [
        (16, 0x0000_ffff_0000_ffff),
        (8, 0x00ff_00ff_00ff_00ff),
        (4, 0x0f0f_0f0f_0f0f_0f0f),
        (2, 0x3333_3333_3333_3333),
        (1, 0x5555_5555_5555_5555),
    ] {
        bits = (bits | bits << shift) & mask;
    }
    bits
}

/// Evenly spaced ones of some keys, which get sorted; none of no keys.
pub fn sample(keys: &mut [u64]) -> Vec<u64> {
    keys.sort_unstable();
    let count = if keys.is_empty() { 0 } else { SAMPLES };
    // In the middle of each of equal parts.
    (0..count).map(|k| keys[(2 * k + 1) * keys.len() / (2 * count)]).collect()
}

/// The keys at which the domains of all ranks but the first begin, so that all have about as much
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
        while cuts.len() + 1 < ranks.len()
            && done + 0.5 * work > total * (cuts.len() + 1) as f64 / ranks.len() as f64
        {
            cuts.push(key);
        }
        done += work;
    }
    cuts.resize(ranks.len() - 1, u64::MAX);
    cuts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_in_morton_order_and_limited() {
        let area = [[0.0; 2], [8.0, 4.0]];
        let keys = [[0.0, 0.0], [5.0, 0.0], [1.0, 3.9], [99.0, 99.0]].map(|at| key(area, at));
        assert_eq!(keys[0], 0);
        assert!(keys[2] < keys[1] && keys[1] < keys[3]);
        assert_eq!(key([[1.0; 2]; 2], [1.0, 1.0]), 0);
        assert_eq!(keys[3], (1 << (2 * BITS)) - 1);
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
}
