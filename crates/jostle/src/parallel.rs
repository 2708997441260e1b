//! Threads: how many work on a call, and nothing else.
//!
//! Work is cut into tasks by the data alone and results are put together in
//! the order of the tasks, so the number of threads never shows in an answer.

use std::sync::atomic::{AtomicUsize, Ordering};
#[cfg(feature = "parallel")]
use std::sync::{Arc, Condvar, OnceLock};
use std::sync::{Mutex, MutexGuard, PoisonError};

#[cfg(feature = "parallel")]
use core::time::Duration;

#[cfg(feature = "parallel")]
use crate::interrupt::{self, Stop};

/// Runs `task(0)`, …, `task(count - 1)` on `threads` threads (`None`: one for
/// each core) and returns the results in that order.
pub fn map<R: Send>(
    threads: Option<usize>,
    count: usize,
    task: impl Fn(usize) -> R + Sync + Send,
) -> Vec<R> {
    #[cfg(feature = "parallel")]
    if count > 1
        && let Some(team) = Team::of(threads)
    {
        let results: Vec<Mutex<Option<R>>> = (0..count).map(|_| Mutex::default()).collect();
        team.share(count, 1, &|index| *locked(&results[index]) = Some(task(index)));
        let result = |slot: Mutex<Option<R>>| slot.into_inner().ok().flatten();
        return results.into_iter().map(|slot| result(slot).expect("every task has run")).collect();
    }
    let _ = threads;
    (0..count).map(task).collect()
}

/// Calls `act` with every item, on `threads` threads. One thread needs no memory for it.
pub fn for_each<T: Send>(
    threads: Option<usize>,
    items: impl Iterator<Item = T>,
    act: impl Fn(T) + Sync + Send,
) {
    #[cfg(feature = "parallel")]
    if items.size_hint().1 != Some(1)
        && let Some(team) = Team::of(threads)
    {
        let items: Vec<_> = items.map(|item| Mutex::new(Some(item))).collect();
        let act = |index: usize| locked(&items[index]).take().into_iter().for_each(&act);
        return team.share(items.len(), 1, &act);
    }
    let _ = threads;
    items.for_each(act);
}

/// Rows that one thread takes at a time in [`for_chunks`].
pub const CHUNK: usize = 1024;

/// Fewer items than this are not worth a word to other threads, even if they are awake.
#[cfg(feature = "parallel")]
const WORTHWHILE: usize = 4 * CHUNK;

/// Fewer shapes than this are not worth waking other threads for.
const WORTH_WAKING: usize = 16 * CHUNK;

/// The threads to use on `len` shapes: one where another would cost more than it saves.
pub fn worthwhile(threads: Option<usize>, len: usize) -> Option<usize> {
    if len < WORTH_WAKING { Some(1) } else { threads }
}

/// Runs `work` where the threads are, so that each of its parallel parts starts at once.
pub fn among<R: Send>(threads: Option<usize>, work: impl FnOnce() -> R + Send) -> R {
    #[cfg(feature = "parallel")]
    if let Some(team) = Team::of(threads) {
        return team.run(work);
    }
    let _ = threads;
    work()
}

/// Calls `act` with the index of the first item and the items of each chunk of
/// [`CHUNK`] items, on `threads` threads. What one call writes no other may read.
pub fn for_chunks<T: Send>(
    threads: Option<usize>,
    items: &mut [T],
    act: impl Fn(usize, &mut [T]) + Sync + Send,
) {
    #[cfg(feature = "parallel")]
    if items.len() > WORTHWHILE
        && let Some(team) = Team::of(threads)
    {
        let chunks: Vec<_> = items.chunks_mut(CHUNK).map(Mutex::new).collect();
        let act = |index: usize| act(index * CHUNK, &mut locked(&chunks[index]));
        return team.share(chunks.len(), usize::MAX, &act);
    }
    let _ = threads;
    act(0, items);
}

/// As [`for_chunks`] with items that are only read.
pub fn for_slices<T: Sync>(threads: Option<usize>, items: &[T], act: impl Fn(&[T]) + Sync + Send) {
    #[cfg(feature = "parallel")]
    if items.len() > WORTHWHILE
        && let Some(team) = Team::of(threads)
    {
        let chunk = |index: usize| index * CHUNK..items.len().min((index + 1) * CHUNK);
        let act = |index: usize| act(&items[chunk(index)]);
        return team.share(items.len().div_ceil(CHUNK), usize::MAX, &act);
    }
    let _ = threads;
    act(items);
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
    if a.len() > WORTHWHILE
        && let Some(team) = Team::of(threads)
    {
        let chunks = a.chunks_mut(CHUNK).zip(b.chunks_mut(CHUNK));
        let chunks: Vec<_> = chunks.map(Mutex::new).collect();
        return team.share(chunks.len(), usize::MAX, &|index| {
            let (a, b) = &mut *locked(&chunks[index]);
            act(index * CHUNK, a, b);
        });
    }
    let _ = threads;
    act(0, a, b);
}

/// Replaces the contents of `to` by the items of `from` named by `order`, in that order.
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
    if len > WORTHWHILE
        && let Some(team) = Team::of(threads)
    {
        let chunk = |index: usize| index * CHUNK..len.min((index + 1) * CHUNK);
        let act = |index: usize| chunk(index).for_each(&act);
        return team.share(len.div_ceil(CHUNK), usize::MAX, &act);
    }
    let _ = threads;
    (0..len).for_each(act);
}

/// Whether more than one thread will work.
pub fn is_parallel(threads: Option<usize>) -> bool {
    cfg!(feature = "parallel") && threads != Some(1)
}

/// The threads that work on a call.
#[cfg(feature = "parallel")]
enum Team {
    /// The pool of which the current thread is a member.
    Present,
    /// Another pool; the current thread waits for it.
    Others(Arc<rayon::ThreadPool>),
}

/// The contents of a lock without contention.
pub fn locked<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(feature = "parallel")]
impl Team {
    /// Runs `task(0)`, …, `task(count - 1)`, at most `longest` of them in a row on one thread if
    /// others are idle. Rayon sees one type of task, so its machinery is compiled once.
    fn share(self, count: usize, longest: usize, task: &(dyn Fn(usize) + Sync)) {
        use rayon::prelude::*;
        self.run(|| (0..count).into_par_iter().with_max_len(longest).for_each(task));
    }

    /// `threads` threads, at most one for each core. None if the current thread works alone:
    /// because one thread is enough, or because the system cannot start others.
    fn of(threads: Option<usize>) -> Option<Self> {
        if threads == Some(1) {
            return None;
        }
        if rayon::current_thread_index().is_some() {
            return Some(Self::Present);
        }
        Era::present().pools().pool(threads).map(Self::Others)
    }

    fn run<R: Send>(self, work: impl FnOnce() -> R + Send) -> R {
        let Self::Others(pool) = self else { return work() };
        let stop = Stop::current();
        if !stop.is_watched() {
            return pool.install(work);
        }
        let answer = Answer::default();
        pool.in_place_scope(|scope| {
            scope.spawn(|_| {
                let _done = Done(&answer);
                let value = interrupt::under(stop.clone(), work);
                answer.lock().0 = Some(value);
            });
            answer.wait(&stop);
        });
        let value = answer.lock().0.take();
        value.expect("a panic of the work goes on where its scope ends")
    }
}

/// Time for which a caller waits between two polls.
#[cfg(feature = "parallel")]
const POLL_EVERY: Duration = Duration::from_millis(20);

/// The result of other threads for a waiting one, and whether it is ready.
#[cfg(feature = "parallel")]
struct Answer<R> {
    value: Mutex<(Option<R>, bool)>,
    changed: Condvar,
}

#[cfg(feature = "parallel")]
impl<R> Default for Answer<R> {
    fn default() -> Self {
        Self { value: Mutex::new((None, false)), changed: Condvar::new() }
    }
}

#[cfg(feature = "parallel")]
impl<R> Answer<R> {
    fn lock(&self) -> MutexGuard<'_, (Option<R>, bool)> {
        self.value.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for the result and polls at the same time.
    fn wait(&self, stop: &Stop) {
        loop {
            let waited = self.changed.wait_timeout_while(self.lock(), POLL_EVERY, |now| !now.1);
            if waited.unwrap_or_else(PoisonError::into_inner).0.1 {
                return;
            }
            stop.is_set();
        }
    }
}

/// Marks the result as ready, also after a panic.
#[cfg(feature = "parallel")]
struct Done<'a, R>(&'a Answer<R>);

#[cfg(feature = "parallel")]
impl<R> Drop for Done<'_, R> {
    fn drop(&mut self) {
        self.0.lock().1 = true;
        self.0.changed.notify_one();
    }
}

/// Maximum number of pools that are kept, for different numbers of threads.
#[cfg(feature = "parallel")]
const MOST_POOLS: usize = 3;

/// Number of calls on one thread after the system failed to start others.
#[cfg(feature = "parallel")]
const PATIENCE: usize = 1000;

/// The most recently used pools, the latest first. They are kept because starting threads costs
/// more than a small call.
#[cfg(feature = "parallel")]
struct Pools {
    kept: Vec<Arc<rayon::ThreadPool>>,
    /// Cores that this process may use; 0 if not known yet.
    cores: usize,
    /// Calls until the next attempt to start threads.
    refused: usize,
}

#[cfg(feature = "parallel")]
impl Pools {
    fn pool(&mut self, threads: Option<usize>) -> Option<Arc<rayon::ThreadPool>> {
        if self.cores == 0 {
            self.cores = std::thread::available_parallelism().map_or(1, usize::from);
        }
        let count = threads.unwrap_or(self.cores).min(self.cores);
        if count < 2 {
            return None;
        }
        let known = self.kept.iter().position(|pool| pool.current_num_threads() == count);
        if let Some(place) = known {
            self.kept[..=place].rotate_right(1);
            return Some(self.kept[0].clone());
        }
        if self.refused > 0 {
            self.refused -= 1;
            return None;
        }
        let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(count).build() else {
            self.refused = PATIENCE;
            return None;
        };
        self.kept.truncate(MOST_POOLS - 1);
        self.kept.insert(0, Arc::new(pool));
        Some(self.kept[0].clone())
    }
}

/// Number of forks since this library was loaded.
static FORKS: AtomicUsize = AtomicUsize::new(0);

/// Number of forks between the process that loaded this library and the current one.
pub fn forks() -> usize {
    FORKS.load(Ordering::Relaxed)
}

/// The pools of one process. A forked process begins with new pools: the threads of its parent
/// do not exist in it, and one of them may have held the lock.
#[cfg(feature = "parallel")]
struct Era {
    pools: Mutex<Pools>,
    next: OnceLock<Box<Era>>,
}

#[cfg(feature = "parallel")]
impl Era {
    const fn new() -> Self {
        let pools = Mutex::new(Pools { kept: Vec::new(), cores: 0, refused: 0 });
        Self { pools, next: OnceLock::new() }
    }

    fn present() -> &'static Self {
        static FIRST: Era = Era::new();
        let next = |era: &'static Self| era.next.get_or_init(|| Box::new(Self::new()));
        (0..forks()).fold(&FIRST, |era, _| next(era))
    }

    fn pools(&self) -> MutexGuard<'_, Pools> {
        self.pools.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Forgets all threads. To be called in a process that was forked from one in which
/// they ran, before it starts any: they do not exist in it.
pub fn abandon_threads() {
    FORKS.fetch_add(1, Ordering::Relaxed);
    #[cfg(feature = "parallel")]
    Era::present();
}
