//! Times of stages: `cargo bench --package jostle`.
//!
//! Building the tree and finding the pairs of discs that cover 40 % of a square, and a
//! step of the gas and of the pile, each on one thread. `examples/one_step.rs` measures the
//! stages inside a step; `benchmarks/stages.py` counts their instructions.

use divan::Bencher;
use divan::counter::ItemsCount;
use jostle::scenes::{self, STEP};
use jostle::settings::DEFAULT_MAX_PAIRS;
use jostle::{Each, Quadtree, Settings, Shapes, World, pairs};

const COUNTS: [usize; 3] = [10_000, 100_000, 1_000_000];

fn main() {
    divan::main();
}

/// Discs of radius ½ at random positions, over 40 % of a square.
fn discs(count: usize) -> Shapes<f32> {
    let side = (count as f64 * std::f64::consts::FRAC_PI_4 / 0.4).sqrt() as f32;
    let mut random = scenes::random::Random::new(1);
    let centers = (0..count).map(|_| [0, 1].map(|_| random.between(0.0, side))).collect();
    Shapes::circles(centers, Each::One(0.5)).expect("they are valid")
}

const ONE_THREAD: Option<usize> = Some(1);

fn settings() -> Settings {
    Settings { threads: ONE_THREAD, ..Settings::default() }
}

#[divan::bench(args = COUNTS)]
fn build(bencher: Bencher, count: usize) {
    let shapes = discs(count);
    let mut tree = Quadtree::default();
    bencher.counter(ItemsCount::new(count)).bench_local(|| tree.fill(&shapes, settings()));
}

#[divan::bench(args = COUNTS)]
fn join(bencher: Bencher, count: usize) {
    let tree = Quadtree::new(&discs(count), settings()).expect("the settings are valid");
    bencher.counter(ItemsCount::new(count)).bench_local(|| pairs::within(&tree, DEFAULT_MAX_PAIRS));
}

fn world(scene: &str, count: usize, warm_up: usize) -> World {
    let scene = scenes::find(scene).expect("the scene exists");
    let mut world = scene.create(Some(count), 0).expect("a scene is valid");
    let mut settings = *world.settings();
    settings.tree.threads = ONE_THREAD;
    world.configure(settings).expect("the settings are valid");
    world.step(STEP, warm_up, &mut |_| ()).expect("a scene can be stepped");
    world
}

#[divan::bench(args = [1_000, 10_000, 100_000])]
fn step_of_the_gas(bencher: Bencher, count: usize) {
    let mut world = world("gas", count, 10);
    bencher.counter(ItemsCount::new(count)).bench_local(|| world.step(STEP, 1, &mut |_| ()));
}

#[divan::bench(args = [1_000, 10_000])]
fn step_of_the_pile(bencher: Bencher, count: usize) {
    let mut world = world("pile", count, 600);
    bencher.counter(ItemsCount::new(count)).bench_local(|| world.step(STEP, 1, &mut |_| ()));
}
