//! jostle's core against the best Rust and C have to offer, in one process.
//!
//! ```sh
//! cargo run --release --manifest-path benchmarks/native/Cargo.toml -- pairs
//! cargo run --release --manifest-path benchmarks/native/Cargo.toml -- step
//! ```
//!
//! (with `CFLAGS="-O3 -DNDEBUG"` before `cargo`, see below; `test --release` in place of `run`
//! tests the grid). `make bench ARGS=native` does both. `pairs` finds all overlapping pairs, `step`
//! moves a world on by 1/60 s. Options of both:
//!
//! ```text
//! --counts 1000 100000      how many shapes or discs
//! --scenes uniform mixed    which scenes
//! --threads 1 2             how many threads
//! --rivals jostle grid      only rivals whose names begin so
//! --rounds 9                timings of each rival
//! --substeps 4              parts of a step; the scene's own where nothing is said
//! --keep no                 print only; leave benchmarks/results as it is
//! ```
//!
//! Rivals get the same arrays and are compared before anything is timed: the pairs
//! as sets, the worlds by what can be measured in them; engines that come to something
//! else than ours after a second are timed all the same, with a remark. Building and converting are
//! inside the clock, the rounds of the rivals are interleaved, tables give medians and
//! spread. Two threads say something only where two cores are free. The package stands outside
//! the library's workspace, and needs a C compiler for Box2D, whose wrapper leaves assertions on
//! unless told otherwise: build with `CFLAGS="-O3 -DNDEBUG"` in the environment, or the results
//! will say that it was slowed down.

mod grid;
mod machine;
mod measure;
mod memory;
mod observed;
mod options;
mod pairs;
mod rivals;
mod scenes;
mod simd;
mod step;
mod table;
mod worlds;

use options::Options;

fn main() {
    memory::keep();
    let mut arguments = std::env::args().skip(1);
    let command = arguments.next().unwrap_or_default();
    let options = Options::parse(arguments);
    println!("{}", machine::describe());
    match command.as_str() {
        "pairs" => pairs::run(&options),
        "step" => step::run(&options),
        _ => eprintln!("say what to measure: pairs or step"),
    }
}
