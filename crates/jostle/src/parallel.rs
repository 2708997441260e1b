//! Threads: how many work on a call, and nothing else.
//!
//! Work is cut into tasks by the data alone and results are put together in
//! the order of the tasks, so the number of threads never shows in an answer.

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
    let run = || (0..count).into_par_iter().with_max_len(1).map(&task).collect();
    match threads {
        None => run(),
        Some(threads) => pool(threads).install(run),
    }
}

/// Without the feature `parallel` every call runs on the caller's thread.
#[cfg(not(feature = "parallel"))]
pub fn map<R>(_threads: Option<usize>, count: usize, task: impl Fn(usize) -> R) -> Vec<R> {
    (0..count).map(task).collect()
}

/// Rows that one thread takes at a time in [`for_chunks`].
pub const CHUNK: usize = 1024;

/// Fewer items than this are not worth waking other threads for.
#[cfg(feature = "parallel")]
const WORTHWHILE: usize = 8 * CHUNK;

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
        let mut run = || {
            let chunks = items.par_chunks_mut(CHUNK).enumerate();
            chunks.for_each(|(index, chunk)| act(index * CHUNK, chunk));
        };
        return match threads {
            None => run(),
            Some(threads) => pool(threads).install(run),
        };
    }
    let _ = threads;
    act(0, items);
}

/// Whether more than one thread will work.
pub fn is_parallel(threads: Option<usize>) -> bool {
    cfg!(feature = "parallel") && threads != Some(1)
}

/// Pools are kept: starting threads costs more than a small call.
#[cfg(feature = "parallel")]
fn pool(threads: usize) -> std::sync::Arc<rayon::ThreadPool> {
    use std::collections::HashMap;
    use std::sync::{Arc, Mutex, OnceLock, PoisonError};
    type Pools = Mutex<HashMap<usize, Arc<rayon::ThreadPool>>>;
    static POOLS: OnceLock<Pools> = OnceLock::new();
    let pools = POOLS.get_or_init(Default::default);
    let mut pools = pools.lock().unwrap_or_else(PoisonError::into_inner);
    let start = || {
        let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
        Arc::new(builder.build().expect("the system can start threads"))
    };
    pools.entry(threads).or_insert_with(start).clone()
}
