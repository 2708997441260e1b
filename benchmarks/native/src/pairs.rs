//! All overlapping pairs, building included.

use std::hint::black_box;

use jostle_scenes::random::Random;
use rayon::ThreadPoolBuilder;

use crate::machine;
use crate::measure::{Call, interleaved};
use crate::options::Options;
use crate::rivals::{self, Pair, Rival};
use crate::scenes::{SCENES, Scene, Shapes};
use crate::table::{HEAD, Row};

const COUNTS: [usize; 5] = [100, 1_000, 10_000, 100_000, 1_000_000];

/// Compares and times all rivals in all scenes.
pub fn run(options: &Options) {
    let counts = options.counts.clone().unwrap_or(COUNTS.to_vec());
    let mut lines = vec![HEAD.to_owned()];
    let most = options.threads.iter().copied().max().unwrap_or(1);
    // Libraries that use rayon run on this thread, whose memory is in the cache, and on its pool.
    let pool = ThreadPoolBuilder::new().num_threads(most).use_current_thread().build();
    let _pool = pool.expect("a thread pool");
    for &threads in &options.threads {
        assert!(threads == 1 || threads == most, "one number of threads above 1 at a time");
        for scene in SCENES.iter().filter(|scene| options.wants_scene(scene.name)) {
            for &count in &counts {
                let rows = time_scene(scene, count, threads, options);
                lines.extend(rows.iter().map(Row::line));
            }
        }
    }
    if options.keep {
        machine::write("pairs", &lines);
    }
}

fn time_scene(scene: &Scene, count: usize, threads: usize, options: &Options) -> Vec<Row> {
    let shapes = (scene.make)(count, &mut Random::new(1));
    let rivals = rivals::all(&shapes, threads, |name| options.wants_rival(name));
    let found = check(&rivals, &shapes);
    let each = found as f64 / count as f64;
    println!("\n{}, {count} shapes, {threads} thread(s), {each:.2} pairs a shape", scene.name);
    let mut calls: Vec<Call> = rivals.iter().map(call).collect();
    let timings = interleaved(&mut calls, options.rounds);
    let rows: Vec<Row> = rivals
        .iter()
        .zip(&timings)
        .map(|(rival, &timing)| Row {
            scene: scene.name.to_owned(),
            threads,
            count,
            rival: rival.name.to_owned(),
            version: rival.version.clone(),
            rounds: options.rounds,
            timing,
            remark: rival.remark.clone(),
        })
        .collect();
    rows.iter().for_each(|row| row.print(&timings[0]));
    rows
}

fn call<'a>(rival: &'a Rival) -> Call<'a> {
    Box::new(|| drop(black_box((rival.find)())))
}

/// Checks that all return the same set of pairs; returns their number.
fn check(rivals: &[Rival], shapes: &Shapes) -> usize {
    let mut expected: Option<Vec<Pair>> = None;
    for rival in rivals {
        let mut pairs = (rival.find)();
        pairs.sort_unstable();
        assert!(pairs.iter().all(|[i, j]| i < j), "{} gives i < j", rival.name);
        let expected = expected.get_or_insert_with(|| pairs.clone());
        let (found, first) = (pairs.len(), expected.len());
        let (name, of) = (rival.name, shapes.len());
        assert!(*expected == pairs, "{name}: {found} pairs of {of} shapes, not the {first}");
    }
    expected.map_or(0, |pairs| pairs.len())
}
