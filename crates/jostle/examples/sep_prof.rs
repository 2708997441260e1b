use std::time::Instant;
use jostle::{Each, Separation, Shapes, separate};
fn main() {
    let bytes = std::fs::read("/tmp/sl/moved.bin").unwrap();
    let all: Vec<f64> = bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
    let centers: Vec<[f64; 2]> = all.chunks_exact(2).map(|c| [c[0], c[1]]).collect();
    let rounds: usize = std::env::args().nth(1).map_or(1000, |v| v.parse().unwrap());
    let reps: usize = std::env::args().nth(2).map_or(100, |v| v.parse().unwrap());
    let shapes = Shapes::circles(centers, Each::One(1.0)).unwrap();
    let rules = Separation { threads: Some(1), max_rounds: rounds, ..Separation::default() };
    let mut times = Vec::new();
    for _ in 0..reps {
        let start = Instant::now();
        timed_step(&shapes, &rules);
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    times.sort_by(f64::total_cmp);
    let apart = separate(&shapes, &rules).unwrap();
    let moved: f64 = apart.centers.iter().zip(&shapes.centers).map(|(a, b)| (a[0]-b[0]).abs() + (a[1]-b[1]).abs()).sum();
    println!("min {:.3} median {:.3} ms; rounds {} overlaps {} moved {moved}", times[0], times[reps / 2], apart.rounds, apart.overlaps);
}
#[inline(never)]
fn timed_step(shapes: &Shapes<f64>, rules: &Separation<f64>) {
    std::hint::black_box(separate(shapes, rules).unwrap());
}
