//! Threads: how many work on a call, and nothing else.
//!
//! Work is cut into tasks by the data alone and results are put together in
//! the order of the tasks, so the number of threads never shows in an answer.

#[cfg(feature = "parallel")]
use std::collections::BTreeMap;
#[cfg(feature = "parallel")]
use std::sync::{Arc, Mutex, PoisonError};

/// Runs `task(0)`, …, `task(count - 1)` on `threads` threads (`None`: one for
/// each core) and returns the results in that order.
#[cfg(feature = "parallel")]
pub fn map<R: Send>(
    threads: Option<usize>,
    count: usize,
    task: impl Fn(usize) -> R + Sync + Send,
) -> Vec<R> {
    use rayon::prelude::*;
    if threads == Some(1) || count < 2 {
        return (0..count).map(task).collect();
    }
    run(threads, || (0..count).into_par_iter().with_max_len(1).map(&task).collect())
}

/// Without the feature `parallel` every call runs on the caller's thread.
#[cfg(not(feature = "parallel"))]
pub fn map<R>(_threads: Option<usize>, count: usize, task: impl Fn(usize) -> R) -> Vec<R> {
    (0..count).map(task).collect()
}

/// Calls `act` on every item, on `threads` threads.
pub fn for_each<T: Send>(
    threads: Option<usize>,
    items: &mut [T],
    act: impl Fn(&mut T) + Sync + Send,
) {
    #[cfg(feature = "parallel")]
    if threads != Some(1) && items.len() > 1 {
        use rayon::prelude::*;
        return run(threads, || items.par_iter_mut().with_max_len(1).for_each(act));
    }
    let _ = threads;
    items.iter_mut().for_each(act);
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
    if threads != Some(1) {
        return run(threads, work);
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
    if threads != Some(1) && items.len() > WORTHWHILE {
        use rayon::prelude::*;
        return run(threads, || {
            let chunks = items.par_chunks_mut(CHUNK).enumerate();
            chunks.for_each(|(index, chunk)| act(index * CHUNK, chunk));
        });
    }
    let _ = threads;
    act(0, items);
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
    if threads != Some(1) && a.len() > WORTHWHILE {
        use rayon::prelude::*;
        return run(threads, || {
            let chunks = a.par_chunks_mut(CHUNK).zip(b.par_chunks_mut(CHUNK)).enumerate();
            chunks.for_each(|(index, (a, b))| act(index * CHUNK, a, b));
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
    if threads != Some(1) && len > WORTHWHILE {
        use rayon::prelude::*;
        let chunks = len.div_ceil(CHUNK);
        let chunk = |index: usize| index * CHUNK..len.min((index + 1) * CHUNK);
        return run(threads, || {
            (0..chunks).into_par_iter().for_each(|index| chunk(index).for_each(&act));
        });
    }
    let _ = threads;
    (0..len).for_each(act);
}

/// Whether more than one thread will work.
pub fn is_parallel(threads: Option<usize>) -> bool {
    cfg!(feature = "parallel") && threads != Some(1)
}

/// The pools started so far, by number of threads; 0 is one for each core. They are
/// kept: starting threads costs more than a small call.
#[cfg(feature = "parallel")]
static POOLS: Mutex<BTreeMap<usize, Arc<rayon::ThreadPool>>> = Mutex::new(BTreeMap::new());

/// Runs `work` with `threads` threads at hand; on the caller's own where the system
/// starts no more.
#[cfg(feature = "parallel")]
fn run<R: Send>(threads: Option<usize>, work: impl FnOnce() -> R + Send) -> R {
    // Inside a pool there is nothing to look for, and no lock to take.
    if rayon::current_thread_index().is_some() {
        return work();
    }
    let count = threads.unwrap_or(0);
    let pool = {
        let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
        let kept = pools.get(&count).cloned();
        kept.or_else(|| {
            let pool = Arc::new(rayon::ThreadPoolBuilder::new().num_threads(count).build().ok()?);
            pools.insert(count, pool.clone());
            Some(pool)
        })
    };
    match pool {
        Some(pool) => pool.install(work),
        None => work(),
    }
}

/// Forgets all threads. To be called in a process that was forked from one in which
/// they ran: they did not come along.
pub fn abandon_threads() {
    #[cfg(feature = "parallel")]
    {
        let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
        // Not dropped: that would talk to threads which are not there.
        std::mem::forget(std::mem::take(&mut *pools));
    }
}
