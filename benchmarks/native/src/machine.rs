//! The machine and the versions of a measurement, and its results file.

use std::fs;
use std::path::Path;

/// The versions that were built, from `Cargo.lock`.
const LOCK: &str = include_str!("../Cargo.lock");

/// The name of the processor, if the system has it.
fn cpu() -> String {
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let named = info.lines().find(|line| line.starts_with("model name"));
    let name = named.and_then(|line| line.split_once(':')).map(|(_, name)| name.trim());
    name.unwrap_or(std::env::consts::ARCH).to_owned()
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, Into::into)
}

/// One line: processor, cores, vector instructions, system, compiler.
pub fn describe() -> String {
    let (system, compiler) = (std::env::consts::OS, env!("RUST_VERSION"));
    let vectors = crate::simd::Level::best().name();
    format!("{}, {} cores, {vectors}, {system}, Rust {compiler}", cpu(), cores())
}

/// The version of the package called `name` that this program was built with.
pub fn version_of(name: &str) -> &'static str {
    let start = format!("name = \"{name}\"\nversion = \"");
    let after = LOCK.split_once(&start).map(|(_, after)| after);
    after.and_then(|after| after.split('"').next()).unwrap_or("unknown")
}

/// A file name for the results of this kind of machine, as the Python benchmarks make it.
fn slug() -> String {
    let vectors = crate::simd::Level::best().name().replace('-', "");
    let words = format!("{} {vectors} {} cores", cpu(), cores());
    let words = words.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("-").to_lowercase()
}

/// Writes the lines of one benchmark, a header and a line for each figure. They replace this
/// machine's earlier ones for the same scene, threads, count and library.
pub fn write(kind: &str, lines: &[String]) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../results");
    let name = format!("native-{kind}-{}.csv", slug());
    let earlier = fs::read_to_string(folder.join(&name)).unwrap_or_default();
    let measured: Vec<&str> = lines.iter().map(|line| subject(line)).collect();
    let kept = earlier.lines().filter(|line| !measured.contains(&subject(line)));
    let all: Vec<&str> = lines.iter().map(String::as_str).chain(kept).collect();
    let written = fs::create_dir_all(&folder)
        .and_then(|()| fs::write(folder.join(&name), all.join("\n") + "\n"));
    match written {
        Ok(()) => println!("\nwritten to benchmarks/results/{name}"),
        Err(error) => eprintln!("\n{name} could not be written: {error}"),
    }
}

/// The key of a line: everything up to the end of the library's name, which is in quotes.
fn subject(line: &str) -> &str {
    let end = line.match_indices('"').nth(1);
    end.map_or(line, |(end, _)| &line[..end])
}
