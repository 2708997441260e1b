//! Time of `separate` for discs that have moved by up to a tenth of their radius from a state without
//! overlaps, on 60 % of the area: `cargo run --release --package jostle --example crowd`; arguments:
//! DISCS CALLS THREADS.
//!
//! Valgrind's callgrind counts instructions, which do not depend on the load of the machine:
//! `valgrind --tool=callgrind "--toggle-collect=*apart*" target/local/examples/crowd 10000 1 1`.

use std::hint::black_box;
use std::time::Instant;

use jostle_index::{Each, Shapes};
use jostle_scenes::random::Random;
use jostle_separate::{Separated, Separation, separate};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |index: usize| arguments.get(index).and_then(|text| text.parse().ok());
    let (discs, calls) = (number(0).unwrap_or(10_000), number(1).unwrap_or(31).max(1));
    let rules = Separation { threads: number(2), ..Separation::default() };
    let side = (discs as f64 * std::f64::consts::PI / 0.6).sqrt();
    let mut random = Random::new(1);
    let mut uniform = |low: f64, high: f64| f64::from(random.between(low as f32, high as f32));
    let spread = (0..discs).map(|_| [uniform(0.0, side), uniform(0.0, side)]).collect();
    let placed = separate(&circles(spread), &rules).expect("there is memory");
    let moved = placed.centers.iter().map(|c| c.map(|v| v + uniform(-0.1, 0.1))).collect();
    let shapes = circles(moved);
    let mut times = Vec::new();
    let mut last = Separated::default();
    for _ in 0..calls {
        let start = Instant::now();
        last = black_box(apart(black_box(&shapes), &rules));
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    times.sort_by(f64::total_cmp);
    let way = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).hypot(a[1] - b[1]);
    let moved = last.centers.iter().zip(shapes.centers()).map(way).sum::<f64>() / discs as f64;
    println!(
        "{discs} discs: {:.3} ms (least {:.3}), {} rounds, {} overlaps, mean displacement {moved:.5}",
        times[calls / 2],
        times[0],
        last.rounds,
        last.overlaps
    );
}

fn circles(centers: Vec<[f64; 2]>) -> Shapes<f64> {
    Shapes::circles(centers, Each::One(1.0)).expect("all are finite")
}

#[inline(never)]
fn apart(shapes: &Shapes<f64>, rules: &Separation<f64>) -> Separated<f64> {
    separate(shapes, rules).expect("there is memory")
}
