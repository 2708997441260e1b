//! Threads.
//!
//! The division of work into tasks depends only on the data, and results are combined in the
//! order of the tasks. So results do not depend on the number of threads.

#[cfg(feature = "parallel")]
mod barrier;
#[cfg(feature = "parallel")]
mod idle;
mod member;
#[cfg(feature = "parallel")]
mod shares;
#[cfg(feature = "parallel")]
mod team;

use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::error::Result;
use crate::memory;
pub use member::Member;
use sync::{AtomicUsize, Ordering};
#[cfg(feature = "parallel")]
use team::Team;

/// The atomics of [`barrier`], [`idle`] and [`shares`], which the tests replace by those of a model checker.
mod sync {
    pub(super) use std::sync::atomic::{AtomicUsize, Ordering};
}

/// Runs `task(0)`, …, `task(count - 1)` on `threads` threads (`None`: one for each core).
pub fn for_tasks(threads: Option<usize>, count: usize, task: impl Fn(usize) + Sync + Send) {
    #[cfg(feature = "parallel")]
    if count > 1
        && let Some(team) = Team::of(threads)
    {
        // Threads share a list of numbers, never of data: which thread runs a task is left to
        // chance, what the task does is not. So the division of work has to depend on the data
        // alone, and it does in each caller.
        return team.share(count, &task);
    }
    let _ = threads;
    (0..count).for_each(task);
}

/// Runs `work` once on each of several threads at the same time: the caller, and those of the others
/// that are awake, at most `most` together. For work whose threads wait for each other very often.
pub fn together(threads: Option<usize>, most: usize, work: impl Fn(&Member<'_>) + Sync + Send) {
    #[cfg(feature = "parallel")]
    if let Some(team) = Team::of(threads) {
        return team.together(most, &work);
    }
    let _ = (threads, most);
    work(&Member { index: 0, threads: 1, wait: &|| () });
}

/// As [`for_tasks`], with a state for each thread, made by `make`; returns the states in any
/// order.
pub fn for_tasks_with<S: Send>(
    threads: Option<usize>,
    count: usize,
    make: impl Fn() -> S + Sync + Send,
    task: impl Fn(usize, &mut S) + Sync + Send,
) -> Vec<S> {
    // At most one state for each thread at work: a task takes one that lies idle, and makes one
    // only if all are in use. The lock is held for a push or a pop, a small part of any task.
    let idle = Mutex::new(Vec::new());
    for_tasks(threads, count, |index| {
        let known = locked(&idle).pop();
        let mut state = known.unwrap_or_else(&make);
        task(index, &mut state);
        locked(&idle).push(state);
    });
    idle.into_inner().unwrap_or_else(PoisonError::into_inner)
}

/// As [`for_tasks`]; returns the results in the order of the tasks.
pub fn map<R: Send>(
    threads: Option<usize>,
    count: usize,
    task: impl Fn(usize) -> R + Sync + Send,
) -> Vec<R> {
    if !is_parallel(threads) {
        return (0..count).map(task).collect();
    }
    // A lock for each result, so no two tasks ever wait for each other. It costs a few nanoseconds,
    // and it lets tasks write into one list without unsafe code.
    let results: Vec<Mutex<Option<R>>> = (0..count).map(|_| Mutex::default()).collect();
    for_tasks(threads, count, |index| *locked(&results[index]) = Some(task(index)));
    let result = |slot: Mutex<Option<R>>| slot.into_inner().ok().flatten();
    results.into_iter().map(|slot| result(slot).expect("every task has run")).collect()
}

/// Calls `act` with every item, on `threads` threads. With one thread nothing is allocated.
pub fn for_each<T: Send>(
    threads: Option<usize>,
    items: impl Iterator<Item = T>,
    act: impl Fn(T) + Sync + Send,
) {
    // A single item is run by the caller: nothing is allocated, and no thread is looked for.
    #[cfg(feature = "parallel")]
    if items.size_hint().1 != Some(1)
        && let Some(team) = Team::of(threads)
    {
        // Each task takes its item out of its own lock. So an item need not be `Sync`, and may be a
        // mutable slice.
        let (listed, rest) = listed(items);
        let each = |index: usize| locked(&listed[index]).take().into_iter().for_each(&act);
        team.share(listed.len(), &each);
        return rest.for_each(act);
    }
    let _ = threads;
    items.for_each(act);
}

/// The items in a lock each, and those for which there is no memory, which the caller takes itself.
fn listed<T, I: Iterator<Item = T>>(mut items: I) -> (Vec<Mutex<Option<T>>>, I) {
    let mut listed = Vec::new();
    while memory::reserve(&mut listed, 1).is_ok()
        && let Some(item) = items.next()
    {
        listed.push(Mutex::new(Some(item)));
    }
    (listed, items)
}

/// As [`for_each`]; returns an error of one of the items. The others are processed as well.
pub fn try_for_each<T: Send>(
    threads: Option<usize>,
    items: impl Iterator<Item = T>,
    act: impl Fn(T) -> Result<()> + Sync + Send,
) -> Result<()> {
    let failed = Mutex::new(Ok(()));
    for_each(threads, items, |item| {
        if let Err(error) = act(item) {
            *locked(&failed) = Err(error);
        }
    });
    failed.into_inner().unwrap_or_else(PoisonError::into_inner)
}

/// As [`for_each`], with a state for each thread, made by `make` and finally passed to `end`. With
/// one thread nothing is allocated.
pub fn for_each_with<T: Send, S: Send>(
    threads: Option<usize>,
    items: impl Iterator<Item = T>,
    make: impl Fn() -> S + Sync + Send,
    act: impl Fn(T, &mut S) + Sync + Send,
    end: impl FnMut(S),
) {
    if !is_parallel(threads) {
        let mut state = make();
        items.for_each(|item| act(item, &mut state));
        return Some(state).into_iter().for_each(end);
    }
    let (listed, rest) = listed(items);
    let each = |index: usize, state: &mut S| {
        locked(&listed[index]).take().into_iter().for_each(|item| act(item, state));
    };
    let mut states = for_tasks_with(threads, listed.len(), &make, each);
    let mut last = states.pop().unwrap_or_else(make);
    rest.for_each(|item| act(item, &mut last));
    states.into_iter().chain([last]).for_each(end);
}

/// Number of items of a task in [`for_chunks`].
pub const CHUNK: usize = 1024;

/// Lists of at most this length are processed by one thread, even if others are awake.
#[cfg(feature = "parallel")]
const MAX_SERIAL: usize = 4 * CHUNK;

/// Minimum number of shapes for which threads that are awake are used.
const WORTH_SHARING: usize = 4 * CHUNK;

/// Minimum number of shapes for which threads are woken.
pub const WORTH_WAKING: usize = 64 * CHUNK;

/// Whether small calls wake threads too. They do in builds with debug assertions, so that tests do
/// not need large calls.
static ALWAYS: AtomicBool = AtomicBool::new(cfg!(debug_assertions));

/// Sets whether small calls of the process wake threads too. For tests; results do not depend on
/// it.
pub fn wake_always(always: bool) {
    // Relaxed: results do not depend on it, so it does not matter when other threads see it.
    ALWAYS.store(always, Ordering::Relaxed);
}

/// The number of threads for `len` shapes: one if more would be slower.
pub fn worthwhile(threads: Option<usize>, len: usize) -> Option<usize> {
    threads_for(threads, len, WORTH_SHARING, WORTH_WAKING)
}

/// From this many times the work for which threads are woken on, threads are used on a busy machine,
/// too.
#[cfg(feature = "parallel")]
const LARGE: usize = 4;

/// The number of threads for some work: one if it is less than `sharing`; those that are awake if
/// it is less than `waking`; otherwise all, which are woken. One on a busy machine, unless the work is
/// large.
pub fn threads_for(
    threads: Option<usize>,
    work: usize,
    sharing: usize,
    waking: usize,
) -> Option<usize> {
    // The limits are those of the time that a second thread costs. A worker that is awake costs
    // about two microseconds a stage, one that sleeps needs up to a millisecond. A shape takes 4 to
    // 20 ns (docs/benchmarks-notes.md), so 4,096 shapes take 16 to 80 µs, and 65,536 take 0.3 to
    // 1.3 ms.
    if work < sharing || threads == Some(1) {
        return Some(1);
    }
    #[cfg(feature = "parallel")]
    if let Some(team) = Team::of(threads) {
        // In a large call a single task may take as long as a wait that means "the machine is
        // busy". Such a wait says nothing about the machine (docs/benchmarks-notes.md, "Piles on
        // two threads").
        team.expect_large(work >= LARGE * waking);
        // Relaxed: a test sets the flag before it calls, on the same thread, and the flag publishes
        // no data.
        if ALWAYS.load(Ordering::Relaxed) {
            team.wake();
        // `is_held_up` counts this call as one of those on one thread, so it is asked only if its
        // answer counts.
        } else if work < LARGE * waking && team.is_held_up() {
            return Some(1);
        } else if work >= waking {
            team.wake();
        } else if !team.is_awake() {
            return Some(1);
        }
    }
    let _ = waking;
    threads
}

/// Starts the threads that calls with some work will use, if they are not there. An object does so when it is made: a
/// later call then needs no memory for them.
pub fn start(threads: Option<usize>, work: usize, sharing: usize) {
    #[cfg(feature = "parallel")]
    if work >= sharing {
        Team::of(threads);
    }
    let _ = (threads, work, sharing);
}

/// Keeps threads awake until the returned value is dropped, if `work` is enough to wake them for. For
/// calls with long stages on one thread, in which the others would fall asleep.
#[must_use]
pub fn keep_awake(threads: Option<usize>, work: usize, waking: usize) -> impl Sized {
    // It does not wake anyone. Who is awake stays so, and `threads_for` of the first stage wakes
    // the rest.
    #[cfg(feature = "parallel")]
    let awake = if work < waking { None } else { Team::of(threads).map(Team::keep_awake) };
    #[cfg(not(feature = "parallel"))]
    let awake = (threads, work < waking);
    awake
}

/// Calls `act` with the index of the first item and the items of each chunk of [`CHUNK`] items, on
/// `threads` threads.
pub fn for_chunks<T: Send>(
    threads: Option<usize>,
    items: &mut [T],
    act: impl Fn(usize, &mut [T]) + Sync + Send,
) {
    // A slice of nothing takes no memory, so this is the same loop with a second slice.
    let nothing = &mut vec![(); items.len()];
    for_chunks_of_two(threads, items, nothing, |first, items, _| act(first, items));
}

/// As [`for_chunks`] with two slices of equal length.
pub fn for_chunks_of_two<A: Send, B: Send>(
    threads: Option<usize>,
    a: &mut [A],
    b: &mut [B],
    act: impl Fn(usize, &mut [A], &mut [B]) + Sync + Send,
) {
    debug_assert_eq!(a.len(), b.len());
    #[cfg(feature = "parallel")]
    if a.len() > MAX_SERIAL && is_parallel(threads) {
        // A lock for each chunk hands a mutable slice to the thread that takes its number, without
        // unsafe code. No lock is ever contended, because each number is taken once.
        let chunks = a.chunks_mut(CHUNK).zip(b.chunks_mut(CHUNK)).zip((0..).step_by(CHUNK));
        return for_each(threads, chunks, |((a, b), first)| act(first, a, b));
    }
    let _ = threads;
    act(0, a, b);
}

/// Replaces the contents of `to` by the items of `from` named by `order`, in that order. It allocates only if `to` has
/// no memory for them.
pub fn gather<V: Copy + Default + Send + Sync>(
    threads: Option<usize>,
    to: &mut Vec<V>,
    from: &[V],
    order: &[u32],
) {
    to.resize(order.len(), V::default());
    for_chunks(threads, to, |first, chunk| {
        for (value, &row) in chunk.iter_mut().zip(&order[first..]) {
            *value = from[row as usize];
        }
    });
}

/// Calls `act` with every number below `len`.
pub fn for_rows(threads: Option<usize>, len: usize, act: impl Fn(usize) + Sync + Send) {
    #[cfg(feature = "parallel")]
    if len > MAX_SERIAL
        && let Some(team) = Team::of(threads)
    {
        let chunk = |index: usize| index * CHUNK..len.min((index + 1) * CHUNK);
        let act = |index: usize| chunk(index).for_each(&act);
        return team.share(len.div_ceil(CHUNK), &act);
    }
    let _ = threads;
    (0..len).for_each(act);
}

/// Whether more than one thread will work.
pub fn is_parallel(threads: Option<usize>) -> bool {
    cfg!(feature = "parallel") && threads != Some(1)
}

/// The contents of a lock without contention.
pub fn locked<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Number of forks since this library was loaded.
static FORKS: AtomicUsize = AtomicUsize::new(0);

/// Number of forks between the process that loaded this library and the current one.
pub fn forks() -> usize {
    // Relaxed: the count changes only in a forked process, which has one thread at that time.
    FORKS.load(Ordering::Relaxed)
}

/// Abandons all threads. To be called in a forked process before it uses threads: those of its
/// parent do not exist in it.
pub fn abandon_threads() {
    // Relaxed: the process has one thread now, and those that it starts see all that came before.
    FORKS.fetch_add(1, Ordering::Relaxed);
    // The era is made here, while the process has one thread. A lock that a thread of the parent
    // held when the process was forked stays locked for ever; the new era has locks of its own.
    #[cfg(feature = "parallel")]
    team::Era::present();
}
