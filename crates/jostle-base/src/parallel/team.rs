//! The threads of a call: the caller, and workers that poll for work in a loop.
//!
//! Waking a sleeping thread takes between a few microseconds and a millisecond, longer than most
//! stages of a call. So the caller starts alone, workers that are awake join it, and after the
//! last task they poll for about a millisecond before they sleep. Only large calls wake workers;
//! small calls use those that are awake. A call with long stages for one thread keeps them awake
//! until its end.

use std::cell::Cell;
use std::ops::RangeInclusive;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread;

use super::barrier::Barrier;
use super::forks;
use super::idle::Idle;
use super::member::Member;
use super::shares::Shares;
use crate::interrupt::Stop;

/// Attempts of a worker to find work before it sleeps: about a millisecond, the time that waking it
/// can take. A waiting caller polls for interruption at the same interval.
const MAX_ATTEMPTS: usize = 1 << 14;

/// Attempts between two calls of `yield_now`, which gives the core to other processes.
const ATTEMPTS_BETWEEN_YIELDS: usize = 64;

/// Attempts of a thread that waits for others after which the machine counts as busy: about three
/// milliseconds, the time slice of another process that uses the core of one of them.
const LONG_WAIT: usize = 1 << 16;

/// Calls on one thread after a long wait: fewest after a single one, twice as many after each further
/// one (exponential backoff).
const CALLS_AFTER_LONG_WAIT: RangeInclusive<usize> = 64..=512;

/// The workers that may take part in a call.
pub(super) struct Team(Arc<Workers>);

/// A pool of threads.
struct Workers {
    pool: rayon::ThreadPool,
    idle: Idle,
    /// Whether they were woken and have not started their loop yet.
    called: AtomicBool,
    /// Calls that will use one thread, because the machine is busy.
    alone: AtomicUsize,
    /// Calls that used one thread after the latest long wait, less the calls since without one.
    backoff: AtomicUsize,
    /// Calls that keep them awake.
    calls: AtomicUsize,
    /// Whether the latest call is large, so that one of its tasks may take as long as a long wait.
    is_large: AtomicBool,
}

/// Keeps the workers awake while it exists.
pub(super) struct Awake(Arc<Workers>);

impl Drop for Awake {
    fn drop(&mut self) {
        // Relaxed, as all the counters of `Workers`: they decide who works and who sleeps, never
        // what is computed. A worker that reads an old value sleeps a moment too late, or too early
        // for one call.
        self.0.calls.fetch_sub(1, Ordering::Relaxed);
    }
}

thread_local! {
    static IS_WORKER: Cell<bool> = const { Cell::new(false) };
}

impl Team {
    /// `threads` threads, including the current one, at most one for each core. None if the current
    /// thread works alone: one was requested, it is a worker itself, or the system cannot start
    /// threads.
    pub(super) fn of(threads: Option<usize>) -> Option<Self> {
        // A worker that asks for a team is inside a task of another call. It works alone: if it
        // waited for workers, they could all be waiting for it.
        if threads == Some(1) || IS_WORKER.get() {
            return None;
        }
        Era::present().pools().workers(threads).map(Self)
    }

    /// Whether a worker is idle.
    pub(super) fn is_awake(&self) -> bool {
        self.0.idle.has(1)
    }

    /// Workers that are awake, or wake up, sleep only after the returned value is dropped.
    pub(super) fn keep_awake(self) -> Awake {
        self.0.calls.fetch_add(1, Ordering::Relaxed);
        Awake(self.0)
    }

    /// Whether a call should use one thread, because threads had to wait for each other for long in
    /// an earlier call.
    pub(super) fn is_held_up(&self) -> bool {
        // Each call on one thread uses up one of the calls to make alone. At 0 the update fails,
        // which means no.
        let next = |calls: usize| calls.checked_sub(1);
        self.0.alone.fetch_update(Ordering::Relaxed, Ordering::Relaxed, next).is_ok()
    }

    /// Says whether the work that follows is large.
    pub(super) fn expect_large(&self, is_large: bool) {
        self.0.is_large.store(is_large, Ordering::Relaxed);
    }

    /// Wakes the workers, so that they are ready for the work that follows.
    pub(super) fn wake(&self) {
        let Workers { pool, idle, called, .. } = &*self.0;
        // `called` is set until a worker has begun its loop, so a second call in that time does not
        // queue another broadcast. The swap makes one caller of several the one that wakes.
        if idle.has(pool.current_num_threads()) || called.swap(true, Ordering::Relaxed) {
            return;
        }
        let workers = self.0.clone();
        pool.spawn_broadcast(move |_| workers.poll_for_work());
    }

    /// Runs `task(0)`, …, `task(count - 1)`. The caller starts; workers join while tasks are left.
    pub(super) fn share(&self, count: usize, task: &(dyn Fn(usize) + Sync)) {
        let Workers { pool, idle, .. } = &*self.0;
        // The protocol of a call:
        //
        // 1. The caller takes the first task at once and waits for nobody.
        //
        // 2. Before it runs a task it reserves the workers that are idle by then, and spawns one
        // loop for each of them. A reserved worker is inside `poll_for_work` and stays there until
        // it has run its loop. So spawned work never waits for a thread that sleeps.
        //
        // 3. All take numbers from `shares` until none is left.
        //
        // 4. The caller spins until `working` is 0. Every worker counts itself idle before it
        // counts itself out of `working`: when the caller goes on, all are there for the next call.
        let mut absent = pool.current_num_threads();
        let shares = Shares::new(count, absent + 1);
        let working = AtomicUsize::new(0);
        let work = || {
            let _end = AtEnd { idle, working: &working };
            // The index of the thread in its pool, not the order of joining: so a worker has the
            // same share in each stage, and the data of its share in its cache.
            let thread = 1 + rayon::current_thread_index().expect("a worker");
            while let Some(index) = shares.take(thread) {
                task(index);
            }
        };
        pool.in_place_scope(|scope| {
            while let Some(index) = shares.take(0) {
                let joining = idle.reserve(absent);
                absent -= joining;
                // Before the spawn, so the counter is never 0 while a spawned loop has yet to
                // begin. Relaxed: the queue of rayon orders it before the loop, which subtracts.
                working.fetch_add(joining, Ordering::Relaxed);
                for _ in 0..joining {
                    scope.spawn(|_| work());
                }
                task(index);
            }
            // The scope would wait too, but it would put the caller to sleep, and it does not poll
            // for interruption.
            let attempts = self.0.wait_for(&working);
            // A task of a large call may last longer than a long wait, on a machine that is not
            // busy at all.
            if !self.0.is_large.load(Ordering::Relaxed) {
                self.0.ended(attempts);
            }
        });
    }

    /// Runs `work` on the caller and on workers that are awake, at the same time, on at most `most`
    /// threads; on the caller alone on a busy machine, where the threads would wait for the slowest.
    pub(super) fn together(&self, most: usize, work: &(dyn Fn(&Member<'_>) + Sync)) {
        let Workers { pool, idle, .. } = &*self.0;
        let most = if self.is_held_up() { 1 } else { most };
        // The number of threads is fixed before the barrier is made. A worker that wakes up later
        // cannot join: it would have to take part in every wait from the first on.
        let joining = idle.reserve(pool.current_num_threads().min(most.saturating_sub(1)));
        let group =
            Group { threads: joining + 1, barrier: Barrier::new(joining + 1), workers: &self.0 };
        // Every member needs an index below the number of threads, because it decides its share.
        // Those of the pool may have gaps, since not all of its threads take part.
        let (joined, working) = (AtomicUsize::new(1), AtomicUsize::new(joining));
        pool.in_place_scope(|scope| {
            for _ in 0..joining {
                scope.spawn(|_| {
                    let _end = AtEnd { idle, working: &working };
                    // Relaxed: an addition gives each index once, and no data depends on who gets
                    // which.
                    group.run(joined.fetch_add(1, Ordering::Relaxed), work);
                });
            }
            group.run(0, work);
            self.0.ended(self.0.wait_for(&working));
        });
    }
}

/// Threads that run the same work together.
struct Group<'a> {
    threads: usize,
    barrier: Barrier,
    workers: &'a Workers,
}

impl Group<'_> {
    fn run(&self, index: usize, work: &(dyn Fn(&Member<'_>) + Sync)) {
        /// Lets the others pass if the work of this thread panics.
        struct Open<'a>(&'a Barrier);
        impl Drop for Open<'_> {
            fn drop(&mut self) {
                // Without this the others would wait at the barrier for ever, and the panic would
                // never reach the caller. They go on with what this thread left behind, but the
                // result is thrown away by the panic.
                if thread::panicking() {
                    self.0.open();
                }
            }
        }
        let _open = Open(&self.barrier);
        let waits = Cell::new(0);
        let wait = || {
            waits.set(waits.get() + 1);
            let mut attempts = 0;
            // Spinning without sleeping: a sub-step of a pile has hundreds of waits of a few
            // microseconds. To sleep and be woken takes longer than the stage between two of them.
            self.barrier.wait(waits.get(), || pause(&mut attempts));
            self.workers.waited(attempts);
        };
        work(&Member { index, threads: self.threads, wait: &wait });
    }
}

/// Pauses for a moment; at intervals gives the core to other processes.
fn pause(attempts: &mut usize) {
    *attempts += 1;
    if attempts.is_multiple_of(ATTEMPTS_BETWEEN_YIELDS) {
        thread::yield_now()
    } else {
        // A hint to the processor: the other thread of the core gets its units, and the loop ends
        // without the penalty for a wrong guess of the order of memory.
        std::hint::spin_loop()
    }
}

/// Marks the end of a worker's tasks, also after a panic.
struct AtEnd<'a> {
    idle: &'a Idle,
    working: &'a AtomicUsize,
}

impl Drop for AtEnd<'_> {
    fn drop(&mut self) {
        // In this order: a caller that sees nobody working has to find the worker idle, or the next
        // stage would begin without it.
        //
        // Release, with the Acquire of `wait_for`: what the tasks wrote is seen by the caller.
        self.idle.enter();
        self.working.fetch_sub(1, Ordering::Release);
    }
}

impl Workers {
    /// Waits until all workers have finished, and polls for interruption. Returns the number of
    /// attempts. The wait is shorter than a task unless another process uses the core of a worker.
    fn wait_for(&self, working: &AtomicUsize) -> usize {
        let stop = Stop::current();
        let mut attempts = 0;
        // Only the polls, not the result: an interrupted call still waits, because tasks borrow its
        // data. They end early themselves, through their own `Stop`.
        while working.load(Ordering::Acquire) > 0 {
            pause(&mut attempts);
            if attempts.is_multiple_of(MAX_ATTEMPTS) {
                stop.is_set();
            }
        }
        attempts
    }

    /// Notes how long a thread has waited for others.
    fn waited(&self, attempts: usize) {
        if attempts >= LONG_WAIT {
            let (fewest, most) = CALLS_AFTER_LONG_WAIT.into_inner();
            // Two threads that note a wait at once may lose one doubling. That is harmless in a
            // guess.
            let calls = (2 * self.backoff.load(Ordering::Relaxed)).clamp(fewest, most);
            self.backoff.store(calls, Ordering::Relaxed);
            self.alone.store(calls, Ordering::Relaxed);
        }
    }

    /// Notes how long a thread has waited for others at the end of a call.
    fn ended(&self, attempts: usize) {
        let backoff = self.backoff.load(Ordering::Relaxed);
        // Each call that ends without a long wait takes one back, so the machine counts as quiet
        // again after as many good calls as there were calls on one thread.
        if attempts < LONG_WAIT && backoff > 0 {
            self.backoff.store(backoff - 1, Ordering::Relaxed);
        }
        self.waited(attempts);
    }

    /// Whether a call keeps them awake.
    fn is_kept_awake(&self) -> bool {
        self.calls.load(Ordering::Relaxed) > 0
    }

    /// Polls for work on the current thread until there has been none for [`MAX_ATTEMPTS`], or for
    /// longer if a call keeps the workers awake.
    fn poll_for_work(&self) {
        self.called.store(false, Ordering::Relaxed);
        // A worker that is awake may take a second broadcast from the queue within its own loop. A
        // loop inside the loop would count one thread twice.
        if IS_WORKER.replace(true) {
            return;
        }
        self.idle.enter();
        let mut attempts = 0;
        // `leave` comes last, since it changes the count: it is called only by a worker that wants
        // to sleep.
        while attempts < MAX_ATTEMPTS || self.is_kept_awake() || !self.idle.leave() {
            match rayon::yield_now() {
                // Each task starts the time again: after one stage of a call the next follows soon.
                Some(rayon::Yield::Executed) => attempts = 0,
                _ => pause(&mut attempts),
            }
        }
        IS_WORKER.set(false);
    }
}

/// Maximum number of pools that are kept, for different numbers of threads.
const MAX_POOLS: usize = 3;

/// Number of calls on one thread after the system failed to start threads.
const CALLS_ALONE: usize = 1000;

/// The most recently used pools, the latest first. They are kept because starting threads costs
/// more than a small call.
struct Pools {
    kept: Vec<Arc<Workers>>,
    /// Cores that this process may use; 0 if not known yet.
    cores: usize,
    /// Calls until the next attempt to start threads.
    refused: usize,
}

impl Pools {
    fn workers(&mut self, threads: Option<usize>) -> Option<Arc<Workers>> {
        if self.cores == 0 {
            self.cores = thread::available_parallelism().map_or(1, usize::from);
        }
        let count = threads.unwrap_or(self.cores).min(self.cores) - 1;
        if count == 0 {
            return None;
        }
        let known = self.kept.iter().position(|kept| kept.pool.current_num_threads() == count);
        if let Some(index) = known {
            self.kept[..=index].rotate_right(1);
            return Some(self.kept[0].clone());
        }
        // A system that refuses threads (a limit of the container) does so again. An attempt takes
        // about as long as many small calls, so the next one is a thousand calls later.
        if self.refused > 0 {
            self.refused -= 1;
            return None;
        }
        let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(count).build() else {
            self.refused = CALLS_ALONE;
            return None;
        };
        let workers = Workers {
            pool,
            idle: Idle::default(),
            called: AtomicBool::new(false),
            alone: AtomicUsize::new(0),
            backoff: AtomicUsize::new(0),
            calls: AtomicUsize::new(0),
            is_large: AtomicBool::new(false),
        };
        // The pool used longest ago is dropped; its threads end when the last call that uses them
        // does. A program uses one or two numbers of threads, and each idle pool costs only memory.
        self.kept.truncate(MAX_POOLS - 1);
        self.kept.insert(0, Arc::new(workers));
        Some(self.kept[0].clone())
    }
}

/// The pools of one process. A forked process starts with new pools: the threads of its parent do
/// not exist in it, and one of them may hold the lock.
pub(super) struct Era {
    pools: Mutex<Pools>,
    next: OnceLock<Box<Era>>,
}

impl Era {
    const fn new() -> Self {
        let pools = Mutex::new(Pools { kept: Vec::new(), cores: 0, refused: 0 });
        Self { pools, next: OnceLock::new() }
    }

    pub(super) fn present() -> &'static Self {
        static FIRST: Era = Era::new();
        let next = |era: &'static Self| era.next.get_or_init(|| Box::new(Self::new()));
        // Eras of parents are never dropped: to drop a pool means to wait for its threads, which do
        // not exist in this process. A list that only grows also needs no lock to be read.
        (0..forks()).fold(&FIRST, |era, _| next(era))
    }

    fn pools(&self) -> MutexGuard<'_, Pools> {
        self.pools.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a condition holds before the end of many pauses.
    fn becomes(condition: impl Fn() -> bool) -> bool {
        let mut attempts = 0;
        while attempts < 10_000 * MAX_ATTEMPTS && !condition() {
            pause(&mut attempts);
        }
        condition()
    }

    fn workers() -> Arc<Workers> {
        let mut pools = Pools { kept: Vec::new(), cores: 2, refused: 0 };
        pools.workers(Some(2)).expect("the system starts threads")
    }

    #[test]
    fn workers_sleep_after_the_calls_that_keep_them_awake() {
        let workers = workers();
        let awake = Team(workers.clone()).keep_awake();
        Team(workers.clone()).wake();
        assert!(becomes(|| workers.idle.has(1)));
        let mut attempts = 0;
        while attempts < 20 * MAX_ATTEMPTS {
            pause(&mut attempts);
        }
        assert!(workers.idle.has(1), "it is still awake");
        drop(awake);
        assert!(becomes(|| !workers.idle.has(1)), "it sleeps");
    }

    #[test]
    fn a_long_task_of_a_large_call_does_not_count_as_a_long_wait() {
        // On a busy machine the caller may be stopped while it waits, so its wait is short.
        let is_held_up = |is_large: bool| {
            let workers = workers();
            let team = Team(workers.clone());
            let _awake = Team(workers.clone()).keep_awake();
            team.wake();
            assert!(becomes(|| workers.idle.has(1)));
            team.expect_large(is_large);
            let begun = AtomicBool::new(false);
            team.share(2, &|index| {
                if index == 0 {
                    assert!(becomes(|| begun.load(Ordering::Relaxed)));
                    return;
                }
                begun.store(true, Ordering::Relaxed);
                let mut attempts = 0;
                while attempts < 8 * LONG_WAIT {
                    pause(&mut attempts);
                }
            });
            team.is_held_up()
        };
        assert!(!is_held_up(true));
        assert!((0..20).any(|_| is_held_up(false)));
    }

    /// The number of calls on one thread from now on.
    fn calls_alone(team: &Team) -> usize {
        (0..).take_while(|_| team.is_held_up()).count()
    }

    #[test]
    fn long_waits_make_calls_use_one_thread() {
        let workers = workers();
        let team = Team(workers.clone());
        workers.waited(LONG_WAIT - 1);
        assert_eq!(calls_alone(&team), 0, "the wait was short");
        let after = |waits: usize| {
            (0..waits).for_each(|_| workers.waited(LONG_WAIT));
            calls_alone(&team)
        };
        assert_eq!([1, 1, 1, 1, 1].map(after), [64, 128, 256, 512, 512]);
        (0..512).for_each(|_| workers.ended(0));
        assert_eq!(after(1), 64, "the machine was not busy for long");
    }
}
