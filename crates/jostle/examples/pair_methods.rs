//! Nanoseconds a shape of `find_pairs` by the tree and by the method that is chosen automatically:
//! `cargo run --release --package jostle --example pair_methods -- 1 9 all 10000 100000`.
//!
//! The arguments are threads, rounds, the name of a scene or `all`, and numbers of shapes. The methods
//! take turns. A line has the scene, the type of its numbers, shapes, threads, the medians of the tree and of
//! the automatic choice, their quotient, how the automatic choice searched, and pairs for each shape.

use std::time::Instant;

use jostle_base::Method;
use jostle_base::settings::DEFAULT_MAX_PAIRS;
use jostle_index::pairs::{self, FindScratch};
use jostle_index::{Each, Scalar, Shapes};
use jostle_scenes::random::Random;

/// Share of the area that the shapes cover, if nothing else is said.
const COVERED: f64 = 0.4;

/// A scene of some number of shapes, with numbers that are exact in float32.
type Make = fn(usize, &mut Random) -> Scene;

/// The first five are those of `benchmarks/shapes.py`.
const SCENES: &[(&str, Make)] = &[
    ("discs", |n, random| square(vec![[0.5; 3]; n], COVERED, random, Kind::Equal)),
    ("mixed", |n, random| {
        let radii = (0..n).map(|_| octaves(100.0, random)).map(|r| [r; 3]).collect();
        square(radii, COVERED, random, Kind::Circles)
    }),
    ("clusters", |n, random| clusters(vec![[0.5; 3]; n], random, Kind::Equal)),
    ("rectangles", |n, random| square(sides(n, 50.0, random), COVERED, random, Kind::Rectangles)),
    ("rounded", |n, random| square(sides(n, 50.0, random), COVERED, random, Kind::Rounded)),
    ("similar", |n, random| {
        let radii = (0..n).map(|_| [0.5 + 0.5 * unit(random); 3]).collect();
        square(radii, COVERED, random, Kind::Circles)
    }),
    ("crowded", |n, random| {
        let radii = (0..n).map(|_| [0.5 + 0.5 * unit(random); 3]).collect();
        square(radii, 3.0, random, Kind::Circles)
    }),
    ("sparse", |n, random| {
        let radii = (0..n).map(|_| [0.5 + 0.5 * unit(random); 3]).collect();
        square(radii, 0.01, random, Kind::Circles)
    }),
    ("wide", |n, random| {
        let radii = (0..n).map(|_| octaves(1e4, random)).map(|r| [r; 3]).collect();
        square(radii, COVERED, random, Kind::Circles)
    }),
    ("clusters-similar", |n, random| {
        let radii = (0..n).map(|_| [0.25 + 0.5 * unit(random); 3]).collect();
        clusters(radii, random, Kind::Circles)
    }),
    ("clusters-mixed", |n, random| {
        let radii = (0..n).map(|_| 0.2 * octaves(30.0, random)).map(|r| [r; 3]).collect();
        clusters(radii, random, Kind::Circles)
    }),
    ("clusters-boxes", |n, random| {
        let halves = sides(n, 8.0, random).iter().map(|s| s.map(|v| v * 0.4)).collect();
        clusters(halves, random, Kind::Rectangles)
    }),
    ("sprites", |n, random| square(vec![[16.0, 24.0, 0.0]; n], COVERED, random, Kind::Rectangles)),
    ("horizontal", |n, random| {
        let halves = (0..n).map(|_| [10.0 + 40.0 * unit(random), 0.5, 0.0]).collect();
        square(halves, COVERED, random, Kind::Rectangles)
    }),
    ("crossed", |n, random| {
        let halves = (0..n)
            .map(|row| if row.is_multiple_of(2) { [25.0, 0.5, 0.0] } else { [0.5, 25.0, 0.0] });
        square(halves.collect(), COVERED, random, Kind::Rectangles)
    }),
    ("giant", |n, random| {
        let mut radii: Vec<[f64; 3]> = (0..n).map(|_| [0.5 + 0.5 * unit(random); 3]).collect();
        radii[n / 2] = [(n as f64).sqrt() * 0.6; 3];
        let mut scene = square(radii, COVERED, random, Kind::Circles);
        scene.centers[n / 2] = [(n as f64).sqrt(); 2];
        scene
    }),
    ("giants", |n, random| {
        let size = |row| if row % 1000 == 7 { 50.0 } else { 0.5 };
        let radii = (0..n).map(|row| [size(row) + 0.5 * unit(random); 3]).collect();
        square(radii, COVERED, random, Kind::Circles)
    }),
    ("coincident", |n, _| {
        let radii =
            (0..n).map(|row| [0.0, 0.0, if row.is_multiple_of(64) { 1e-3 } else { 0.0 }]).collect();
        let centers = (0..n).map(|row| [(row / 64 % 100) as f64, (row / 6400) as f64]).collect();
        Scene { centers, sizes: radii, kind: Kind::Circles }
    }),
    ("one-place", |n, random| {
        let sizes = (0..n).map(|_| [1e-6 * unit(random); 3]).collect();
        let mut scene = square(sizes, COVERED, random, Kind::Rectangles);
        for row in (0..n).step_by(2) {
            scene.centers[row] = [0.0; 2];
            scene.sizes[row] = [0.0; 3];
        }
        scene
    }),
    ("clumps", |n, random| clumps(n, 24, random)),
    ("two-sizes", |n, random| {
        let size = |row: usize| if row % 33 == 3 { 15.0 } else { 0.5 };
        let radii = (0..n).map(|row| [size(row) * (1.0 + 0.5 * unit(random)); 3]).collect();
        square(radii, COVERED, random, Kind::Circles)
    }),
    ("line", |n, random| {
        let radii = (0..n).map(|_| [0.5 + 0.5 * unit(random); 3]).collect();
        let centers = (0..n).map(|row| [row as f64, 7.0]).collect();
        Scene { centers, sizes: radii, kind: Kind::Circles }
    }),
];

/// Which of the sizes of a scene its shapes have.
enum Kind {
    Equal,
    Circles,
    Rectangles,
    Rounded,
}

/// Centres, and half width, half height and radius of each shape.
struct Scene {
    centers: Vec<[f64; 2]>,
    sizes: Vec<[f64; 3]>,
    kind: Kind,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [threads, rounds, name, counts @ ..] = arguments.as_slice() else {
        return println!("arguments: THREADS ROUNDS SCENE SHAPES...");
    };
    let number = |text: &str| text.parse().expect("a number");
    let (threads, rounds) = (number(threads), number(rounds));
    for (scene, make) in SCENES.iter().filter(|(scene, _)| name == "all" || name == scene) {
        for count in counts.iter().map(|count| number(count)) {
            let made = make(count, &mut Random::new(7));
            let before = [*scene, &count.to_string(), &threads.to_string()].join(" ");
            println!("{before} f32 {}", compare::<f32>(&made, threads, rounds));
            println!("{before} f64 {}", compare::<f64>(&made, threads, rounds));
        }
    }
}

/// The medians of both methods, after a comparison of their pairs.
fn compare<T: Scalar>(scene: &Scene, threads: usize, rounds: usize) -> String {
    let shapes = &shapes_of::<T>(scene);
    let mut scratch = [(); 2].map(|()| FindScratch::default());
    let mut times = [const { Vec::new() }; 2];
    let mut found = [const { Vec::new() }; 2];
    // The first rounds allocate the memory.
    for round in 0..rounds + 2 {
        for (k, method) in [Some(Method::Quadtree), None].into_iter().enumerate() {
            let start = Instant::now();
            let result =
                pairs::find_with(&mut scratch[k], shapes, method, Some(threads), DEFAULT_MAX_PAIRS);
            let time = start.elapsed().as_secs_f64();
            let mut result = result.expect("few pairs overlap");
            if round == 0 {
                result.sort().expect("there is memory");
                found[k].clone_from(&result.pairs);
            }
            scratch[k].keep(result.pairs);
            if round > 1 {
                times[k].push(time);
            }
        }
    }
    assert!(found[0] == found[1], "the pairs differ");
    let each = 1e9 / shapes.len() as f64;
    let [tree, chosen] = times.map(|times| median(times) * each);
    let by_tree = if scratch[1].tree.is_empty() { "other" } else { "tree" };
    let pairs = found[0].len() as f64 / shapes.len() as f64;
    format!("{tree:.1} {chosen:.1} {:.3} {by_tree} {pairs:.2}", chosen / tree)
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn shapes_of<T: Scalar>(scene: &Scene) -> Shapes<T> {
    let number = |value: f64| T::from_f64(f64::from(value as f32));
    let centers = scene.centers.iter().map(|center| center.map(number)).collect();
    let radius = |size: &[f64; 3]| number(size[2]);
    let half = |size: &[f64; 3]| [number(size[0]), number(size[1])];
    let radii = match scene.kind {
        Kind::Equal => Each::One(radius(&scene.sizes[0])),
        Kind::Rectangles => Each::One(T::ZERO),
        Kind::Circles | Kind::Rounded => Each::Rows(scene.sizes.iter().map(radius).collect()),
    };
    let halves = match scene.kind {
        Kind::Equal | Kind::Circles => None,
        Kind::Rectangles | Kind::Rounded => {
            Some(Each::Rows(scene.sizes.iter().map(half).collect()))
        }
    };
    Shapes::new(centers, radii, halves, None).expect("the shapes are valid")
}

/// Shapes uniform over a square, of which they cover a share.
fn square(sizes: Vec<[f64; 3]>, covered: f64, random: &mut Random, kind: Kind) -> Scene {
    let area = |size: &[f64; 3]| match kind {
        Kind::Equal | Kind::Circles => std::f64::consts::PI * size[2] * size[2],
        Kind::Rectangles | Kind::Rounded => 4.0 * size[0] * size[1],
    };
    let side = (sizes.iter().map(area).sum::<f64>() / covered).sqrt();
    let centers = sizes.iter().map(|_| [unit(random) * side, unit(random) * side]).collect();
    Scene { centers, sizes, kind }
}

/// Twelve Gaussian clusters with densities from 1 to 1/1000, in a square of twenty times the width of the
/// widest.
fn clusters(sizes: Vec<[f64; 3]>, random: &mut Random, kind: Kind) -> Scene {
    let width = |k: usize| {
        let covered = 2.0 * 1e-3f64.powf(k as f64 / 11.0);
        (0.25 * sizes.len() as f64 / 12.0 / (4.0 * covered)).sqrt()
    };
    let middles = [(); 12].map(|()| [unit(random), unit(random)].map(|v| v * 20.0 * width(11)));
    let centers = (0..sizes.len()).map(|row| {
        let offset = [normal(random), normal(random)];
        [0, 1].map(|k| middles[row % 12][k] + offset[k] * width(row % 12))
    });
    Scene { centers: centers.collect(), sizes, kind }
}

/// Groups of `k` circles in squares of width 0.5; most circles are small.
fn clumps(n: usize, k: usize, random: &mut Random) -> Scene {
    let count = n.div_ceil(k);
    let side = (count as f64 * 4.0).sqrt();
    let at: Vec<[f64; 2]> =
        (0..count).map(|_| [unit(random) * side, unit(random) * side]).collect();
    let centers = (0..n).map(|row| at[row % count].map(|v| v + 0.5 * unit(random))).collect();
    let sizes = (0..n).map(|_| [1e-3 + 0.5 * unit(random).powi(8); 3]).collect();
    Scene { centers, sizes, kind: Kind::Circles }
}

/// Half sizes whose sides are between 1 and `largest`, uniform in the logarithm; radii of a tenth.
fn sides(count: usize, largest: f64, random: &mut Random) -> Vec<[f64; 3]> {
    let mut half = || 0.5 * largest.powf(unit(random));
    (0..count).map(|_| [half(), half(), 0.1]).collect()
}

/// A radius between 1 and `largest`; every octave covers the same area.
fn octaves(largest: f64, random: &mut Random) -> f64 {
    1.0 / (1.0 - unit(random) * (1.0 - largest.powi(-2))).sqrt()
}

/// A number from the normal distribution, as the sum of twelve others.
fn normal(random: &mut Random) -> f64 {
    (0..12).map(|_| unit(random)).sum::<f64>() - 6.0
}

fn unit(random: &mut Random) -> f64 {
    f64::from(random.unit())
}
