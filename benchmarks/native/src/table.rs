//! A table to print, and its rows for the results file.

use crate::machine;
use crate::measure::Timing;

/// The header of a results file: what was measured, then the columns of a timing.
pub const HEAD: &str =
    "scene,threads,count,rival,version,rounds,median_s,low_s,high_s,machine,remark";

/// The time of one library in one scene.
#[derive(Debug)]
pub struct Row {
    /// The scene.
    pub scene: String,
    /// Number of threads.
    pub threads: usize,
    /// Number of shapes or discs.
    pub count: usize,
    /// The library.
    pub rival: String,
    /// Its version.
    pub version: String,
    /// Number of timings.
    pub rounds: usize,
    /// The timing.
    pub timing: Timing,
    /// Remarks, such as the settings that a sweep chose.
    pub remark: String,
}

impl Row {
    /// The row of a results file.
    pub fn line(&self) -> String {
        let Self { scene, threads, count, rival, version, rounds, timing, remark } = self;
        let Timing { median, low, high } = timing;
        let machine = machine::describe();
        format!(
            "{scene},{threads},{count},\"{rival}\",{version},{rounds},\
             {median:.6e},{low:.6e},{high:.6e},\"{machine}\",\"{remark}\""
        )
    }

    /// Prints milliseconds, nanoseconds for each of `count`, ratios to `first` of the medians
    /// and, less disturbed by a busy machine, of the fastest rounds, and the spread.
    pub fn print(&self, first: &Timing) {
        let Self { rival, timing, remark, .. } = self;
        let each = |seconds: f64| 1e9 * seconds / self.count as f64;
        let (call, median) = (1e3 * timing.median, each(timing.median));
        let ratios = [timing.median / first.median, timing.low / first.low];
        let ratios = format!("×{:.2}, fastest ×{:.2}", ratios[0], ratios[1]);
        let spread = format!("({:.1} to {:.1})", each(timing.low), each(timing.high));
        println!(
            "  {rival:20} {call:9.3} ms {median:8.1} ns each {spread:20} {ratios:24} {remark}"
        );
    }
}
