//! One step of a world: a gas of elastic discs, and a pile at rest.

use crate::machine;
use crate::measure::{Call, interleaved};
use crate::observed::Observed;
use crate::options::Options;
use crate::table::{HEAD, Row};
use crate::worlds::{self, Contender, Start};

const COUNTS: [usize; 4] = [1_000, 10_000, 50_000, 200_000];

/// Steps per second.
const SECOND: usize = 60;

/// A scene of jostle, and the number of its steps after which all engines start from it.
const SCENES: [(&str, usize); 2] = [("gas", 0), ("pile", 5 * SECOND)];

/// Compares and times all engines in both scenes.
pub fn run(options: &Options) {
    let counts = options.counts.clone().unwrap_or(COUNTS.to_vec());
    let mut lines = vec![HEAD.to_owned()];
    for (scene, settling) in SCENES.into_iter().filter(|(name, _)| options.wants_scene(name)) {
        for &count in &counts {
            let start = Start::of(scene, count, settling, options.substeps);
            for &threads in &options.threads {
                let rows = time_scene(scene, &start, threads, options);
                lines.extend(rows.iter().map(Row::line));
            }
        }
    }
    if options.keep {
        machine::write("step", &lines);
    }
}

fn time_scene(scene: &str, start: &Start, threads: usize, options: &Options) -> Vec<Row> {
    let (count, substeps) = (start.len(), start.substeps);
    println!("\n{scene}, {count} discs, {threads} thread(s), {substeps} sub-step(s)");
    let mut contenders = worlds::all(start, threads, |name| options.wants_rival(name));
    compare(start, &mut contenders);
    let mut calls: Vec<Call> = contenders.iter_mut().map(step).collect();
    let timings = interleaved(&mut calls, options.rounds);
    drop(calls);
    let row = |(contender, &timing): (&Contender, _)| Row {
        scene: scene.to_owned(),
        threads,
        count,
        rival: contender.name.to_owned(),
        version: contender.version.clone(),
        rounds: options.rounds,
        timing,
        remark: format!("{substeps} sub-step(s){}", contender.remark),
    };
    let rows: Vec<Row> = contenders.iter().zip(&timings).map(row).collect();
    rows.iter().for_each(|row| row.print(&timings[0]));
    rows
}

/// Simulates a second in every engine, prints the results, and adds remarks to those that differ
/// from jostle's.
fn compare(start: &Start, contenders: &mut [Contender]) {
    let mut ours = None;
    for contender in contenders {
        (0..SECOND).for_each(|_| contender.engine.step());
        let observed = Observed::of(start, &contender.engine.state());
        println!("  {:24} {observed}", contender.name);
        if let Some(difference) = observed.differs_from(ours.get_or_insert(observed)) {
            contender.remark += &format!(", after a second {difference}");
        }
    }
}

fn step(contender: &mut Contender) -> Call<'_> {
    Box::new(|| contender.engine.step())
}
