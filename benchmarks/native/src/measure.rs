//! Interleaved rounds, so that noise of the machine affects all libraries equally.

use std::time::Instant;

/// Shorter calls are repeated, because the clock is too coarse for them.
const SHORTEST_S: f64 = 200e-6;

/// Median and spread of one rival's rounds, in seconds.
#[derive(Clone, Copy, Debug)]
pub struct Timing {
    /// Half of the rounds were faster.
    pub median: f64,
    /// The fastest round.
    pub low: f64,
    /// The slowest round.
    pub high: f64,
}

impl Timing {
    fn of(mut times: Vec<f64>) -> Self {
        times.sort_by(f64::total_cmp);
        let last = times.len() - 1;
        let median = (times[last / 2] + times[last.div_ceil(2)]) / 2.0;
        Self { median, low: times[0], high: times[last] }
    }
}

/// A call to be timed, with its arguments and results.
pub type Call<'a> = Box<dyn FnMut() + 'a>;

/// Seconds that one call takes.
pub fn seconds(call: &mut Call) -> f64 {
    let start = Instant::now();
    call();
    start.elapsed().as_secs_f64()
}

/// Times every call once a round, `rounds` times over, after one round to warm up.
/// A call too short for the clock is repeated within its round.
pub fn interleaved(calls: &mut [Call], rounds: usize) -> Vec<Timing> {
    let repeats: Vec<usize> = calls.iter_mut().map(repeats_of).collect();
    let mut times = vec![Vec::with_capacity(rounds); calls.len()];
    for _ in 0..rounds {
        for ((own, call), &repeats) in times.iter_mut().zip(&mut *calls).zip(&repeats) {
            let start = Instant::now();
            for _ in 0..repeats {
                call();
            }
            own.push(start.elapsed().as_secs_f64() / repeats as f64);
        }
    }
    times.into_iter().map(Timing::of).collect()
}

fn repeats_of(call: &mut Call) -> usize {
    let second = seconds(call).min(seconds(call));
    (SHORTEST_S / second.max(1e-9)).ceil().max(1.0) as usize
}
