//! A table to read and the same rows to keep.

use crate::machine;
use crate::measure::Timing;

/// The head of a results file: what was measured, then a timing's columns.
pub const HEAD: &str =
    "scene,threads,count,rival,version,rounds,median_s,low_s,high_s,machine,remark";

/// One rival's figure in one scene.
#[derive(Debug)]
pub struct Row {
    /// The scene.
    pub scene: String,
    /// Threads that it was given.
    pub threads: usize,
    /// Shapes or discs.
    pub count: usize,
    /// The rival.
    pub rival: String,
    /// Its version.
    pub version: String,
    /// Timings behind the median.
    pub rounds: usize,
    /// The timing.
    pub timing: Timing,
    /// What else is worth knowing, such as the settings that a sweep chose.
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

    /// Prints milliseconds, nanoseconds for each of `count`, the ratio to `first` and the spread.
    pub fn print(&self, first: &Timing) {
        let Self { rival, timing, remark, .. } = self;
        let each = |seconds: f64| 1e9 * seconds / self.count as f64;
        let (median, ratio) = (each(timing.median), timing.median / first.median);
        let spread = format!("({:.1} to {:.1})", each(timing.low), each(timing.high));
        let call = 1e3 * timing.median;
        println!(
            "  {rival:20} {call:9.3} ms {median:9.1} ns each  ×{ratio:<6.2} {spread:20} {remark}"
        );
    }
}
