//! The state that threads share, in every order in which they can run, by a model checker.

use loom::sync::Arc;
use loom::thread;

/// The atomics of the model checker instead of those of the standard library.
mod sync {
    pub use loom::sync::atomic::{AtomicUsize, Ordering};
}

#[path = "../../jostle-base/src/parallel/barrier.rs"]
mod barrier;
#[path = "../../jostle-base/src/parallel/idle.rs"]
mod idle;
#[path = "../../jostle-base/src/parallel/shares.rs"]
mod shares;

use barrier::Barrier;
use idle::Idle;
use shares::Shares;
use sync::{AtomicUsize, Ordering};

/// Checks a model with so many changes of thread at points where none has to be: two find most
/// errors, and more take minutes.
fn check(model: impl Fn() + Sync + Send + 'static) {
    let mut builder = loom::model::Builder::new();
    builder.preemption_bound = Some(2);
    builder.check(model);
}

/// Two callers and a worker that leaves as soon as it finds no work.
#[test]
fn a_worker_that_was_reserved_always_comes() {
    check(|| {
        let idle = Arc::new(Idle::default());
        let [given, done] = [(); 2].map(|()| Arc::new(AtomicUsize::new(0)));
        idle.enter();
        let worker = {
            let (idle, given, done) = (idle.clone(), given.clone(), done.clone());
            thread::spawn(move || {
                loop {
                    if given.load(Ordering::Acquire) > done.load(Ordering::Relaxed) {
                        idle.enter();
                        done.fetch_add(1, Ordering::Release);
                    } else if idle.leave() {
                        break;
                    } else {
                        thread::yield_now();
                    }
                }
            })
        };
        let call = |idle: &Idle, given: &AtomicUsize| {
            let reserved = idle.reserve(1);
            given.fetch_add(reserved, Ordering::Release);
            reserved
        };
        let other = {
            let (idle, given) = (idle.clone(), given.clone());
            thread::spawn(move || call(&idle, &given))
        };
        let reserved = call(&idle, &given) + other.join().unwrap();
        worker.join().unwrap();
        assert_eq!(done.load(Ordering::Acquire), reserved);
        assert!(!idle.has(1));
    });
}

#[test]
fn every_task_is_taken_once() {
    for count in 0..4 {
        check(move || {
            let shares = Arc::new(Shares::new(count, 2));
            let take_all =
                |shares: &Shares, thread| std::iter::from_fn(|| shares.take(thread)).collect();
            let other = {
                let shares = shares.clone();
                thread::spawn(move || -> Vec<usize> { take_all(&shares, 1) })
            };
            let mut taken: Vec<usize> = take_all(&shares, 0);
            taken.extend(other.join().unwrap());
            taken.sort_unstable();
            assert!(taken.into_iter().eq(0..count));
        });
    }
}

/// Without others a thread does its own share first, in order.
#[test]
fn a_thread_begins_with_its_own_share() {
    check(|| {
        let shares = Shares::new(4, 2);
        let taken: Vec<usize> = std::iter::from_fn(|| shares.take(1)).collect();
        assert_eq!(taken, [2, 3, 0, 1]);
    });
}

/// Each of two threads sees what the other wrote before the barrier, twice.
#[test]
fn nobody_passes_a_barrier_before_all_have_arrived() {
    check(|| {
        let barrier = Arc::new(Barrier::new(2));
        let written = Arc::new([(); 2].map(|()| AtomicUsize::new(0)));
        let run = |own: usize, barrier: &Barrier, written: &[AtomicUsize; 2]| {
            for time in 1..=2 {
                written[own].store(time, Ordering::Relaxed);
                barrier.wait(2 * time - 1, thread::yield_now);
                assert_eq!(written[1 - own].load(Ordering::Relaxed), time);
                barrier.wait(2 * time, thread::yield_now);
            }
        };
        let other = {
            let (barrier, written) = (barrier.clone(), written.clone());
            thread::spawn(move || run(1, &barrier, &written))
        };
        run(0, &barrier, &written);
        other.join().unwrap();
    });
}

/// A thread that waits passes when the barrier is opened.
#[test]
fn an_open_barrier_lets_all_pass() {
    check(|| {
        let barrier = Arc::new(Barrier::new(2));
        let other = {
            let barrier = barrier.clone();
            thread::spawn(move || barrier.open())
        };
        barrier.wait(1, thread::yield_now);
        other.join().unwrap();
    });
}
