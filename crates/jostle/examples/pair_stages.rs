//! Nanoseconds a disc of the two stages of a search for all pairs, and the memory bandwidth:
//! `cargo run --release --package jostle --example pair_stages -- 31 10000 1000000`.
//!
//! The arguments are the number of rounds and the numbers of discs. `benchmarks/bandwidth.py` runs
//! this program and draws its results.

use std::time::Instant;

use jostle_base::Settings;
use jostle_base::settings::DEFAULT_MAX_PAIRS;
use jostle_index::pairs::{self, LEAF_CAPACITY};
use jostle_index::{Each, Quadtree, Shapes};

/// Numbers of an array that is copied: 512 MiB, more than a cache.
const COPIED: usize = 1 << 26;

/// Share of the area that the discs cover.
const COVERED: f64 = 0.4;

fn main() {
    let numbers: Vec<usize> =
        std::env::args().skip(1).filter_map(|text| text.parse().ok()).collect();
    let [rounds, counts @ ..] = numbers.as_slice() else {
        return println!("arguments: ROUNDS DISCS...");
    };
    println!("bytes_per_s {:.4e}", bandwidth(*rounds));
    for &count in counts {
        let (tree, search, found) = stages(&discs(count), *rounds);
        let each = 1e9 / count as f64;
        println!("{count} {:.4} {:.4} {found}", tree * each, search * each);
    }
}

/// Median seconds of the tree and of the search in it, and the number of pairs.
fn stages(discs: &Shapes<f32>, rounds: usize) -> (f64, f64, usize) {
    let settings =
        Settings { threads: Some(1), leaf_capacity: LEAF_CAPACITY, ..Settings::default() };
    let mut tree = Quadtree::default();
    let mut times = [const { Vec::new() }; 2];
    let mut found = 0;
    // The first round allocates the memory.
    for round in 0..=rounds {
        let start = Instant::now();
        tree.fill_unordered(discs, settings).expect("the settings are valid");
        let built = Instant::now();
        let pairs = pairs::within(&tree, None, DEFAULT_MAX_PAIRS).expect("few pairs overlap").pairs;
        let searched = Instant::now();
        found = pairs.len();
        if round > 0 {
            times[0].push((built - start).as_secs_f64());
            times[1].push((searched - built).as_secs_f64());
        }
    }
    let [tree, search] = times.map(median);
    (tree, search, found)
}

/// Bytes a second that one thread reads and writes while it copies an array.
fn bandwidth(rounds: usize) -> f64 {
    let source = vec![1u64; COPIED];
    let mut target = vec![0u64; COPIED];
    let mut times = Vec::new();
    for _ in 0..rounds {
        let start = Instant::now();
        target.copy_from_slice(&source);
        times.push(start.elapsed().as_secs_f64());
        std::hint::black_box(&mut target);
    }
    (2 * size_of_val(source.as_slice())) as f64 / median(times)
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Discs of radius 1 at random positions in a square.
fn discs(count: usize) -> Shapes<f32> {
    let side = (std::f64::consts::PI * count as f64 / COVERED).sqrt();
    let mut state = 1u64;
    let mut random = move || {
        // SplitMix64.
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (state ^ state >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        (mixed ^ mixed >> 31) as f64 / u64::MAX as f64
    };
    let centers = (0..count).map(|_| [random() * side, random() * side].map(|v| v as f32));
    Shapes::circles(centers.collect(), Each::One(1.0)).expect("the discs are valid")
}
