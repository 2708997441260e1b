//! Benchmarks of jostle's core and of libraries in Rust and C, in one process.
//!
//! ```sh
//! cargo run --release --manifest-path benchmarks/native/Cargo.toml -- pairs
//! cargo run --release --manifest-path benchmarks/native/Cargo.toml -- step
//! ```
//!
//! Set `CFLAGS="-O3 -DNDEBUG"` before `cargo`, see below. `make bench ARGS=native` runs both.
//! `pairs` finds all overlapping pairs, `step` advances a world by 1/60 s. `test --release` in
//! place of `run` tests the grid. Options of both:
//!
//! ```text
//! --counts 1000 100000      numbers of shapes or discs
//! --scenes uniform mixed    names of scenes
//! --threads 1 2             numbers of threads
//! --rivals jostle grid      only libraries whose names begin with one of these
//! --rounds 9                timings of each rival
//! --substeps 4              sub-steps of a step; by default those of the scene
//! --keep no                 print only; do not change benchmarks/results
//! ```
//!
//! All libraries get the same arrays, and their results are compared before timing: pairs as sets,
//! worlds by their energy, speeds and contacts after a second. Engines with other results are
//! timed too, with a remark. The time includes building and converting. The rounds of all
//! libraries are interleaved; tables give medians and spread. Times of two threads need two idle
//! cores.
//!
//! The package is outside the library's workspace. It needs a C compiler for Box2D. Its wrapper
//! compiles assertions unless `CFLAGS="-O3 -DNDEBUG"` is set; the results say whether it did.

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
