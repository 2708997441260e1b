//! Calls that fail for lack of memory return an error and leave the world as it was.
//!
//! An allocator refuses the k-th large allocation of a call, or all from the k-th on, for many k. The call returns
//! [`Error::NoMemory`](jostle_base::Error), the world keeps its state, and the same call with memory has the same
//! result as in a world that was never refused. If the process aborts, the last line names the call; with the
//! environment variable `JOSTLE_TRACE` each refusal prints its place. `--ignored` tries all k; arguments choose a world
//! and a call.

mod allocator;
mod worlds;

use allocator::{Refused, Refusing, large_allocations, refusing};
use jostle_world::World;
use worlds::{CALLS, Call, WORLDS, is_no_memory};

#[global_allocator]
static ALLOCATOR: Refusing = Refusing;

/// How many large allocations of a step, and of another call, are refused. `--ignored` refuses each.
const TRIES: [usize; 2] = [5, 2];

/// A world of its snapshot, with a number of threads.
fn restored(bytes: &[u8], threads: usize) -> World {
    let mut world = World::restore(bytes).unwrap();
    let mut settings = *world.settings();
    settings.tree.threads = Some(threads);
    world.configure(settings).unwrap();
    world
}

/// What is left of a world after a call.
fn outcome(world: &World) -> (u64, Vec<u8>) {
    (world.state_hash().unwrap(), world.snapshot().unwrap())
}

/// Threads of this process, where the system lists them.
fn threads_of_process() -> Option<usize> {
    std::fs::read_dir("/proc/self/task").ok().map(Iterator::count)
}

/// Refuses about `tries` large allocations of a call, each in a new world. Returns how many.
fn check(name: &str, bytes: &[u8], (call_name, call): Call, threads: usize, tries: usize) -> usize {
    let mut expected = restored(bytes, threads);
    let before = outcome(&expected);
    let large = large_allocations(|| call(&mut expected).unwrap());
    let after = outcome(&expected);
    let stride = large.div_ceil(tries).max(1);
    let (mut k, mut count) = (1, 0);
    loop {
        let which = if count % 4 == 3 { Refused::From(k) } else { Refused::One(k) };
        let about = format!("{name}, {call_name}, {threads} threads, {which:?}");
        eprintln!("{about}");
        let mut world = restored(bytes, threads);
        let (result, refused) = refusing(which, || call(&mut world));
        if refused == 0 {
            assert!(result.is_ok(), "{about}: {result:?}");
            return count;
        }
        count += 1;
        // A list of work for threads is not needed: without it the caller works alone.
        if let Err(error) = result {
            assert!(is_no_memory(&error), "{about}: {error}");
            assert!(outcome(&world) == before, "{about}: the world has changed");
            call(&mut world).unwrap_or_else(|error| panic!("{about}: {error}"));
        }
        assert!(outcome(&world) == after, "{about}: another result");
        k += stride;
    }
}

fn main() {
    let (flags, names): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|argument| argument.starts_with("--"));
    let is_long = flags.iter().any(|flag| flag == "--ignored");
    let is_chosen = |at: usize, name: &str| names.get(at).is_none_or(|chosen| chosen == name);
    for (number, (name, make, steps)) in WORLDS.into_iter().enumerate() {
        if !is_chosen(0, name) {
            continue;
        }
        let mut world = make();
        let started = threads_of_process();
        world.step(jostle_scenes::STEP, steps).unwrap();
        assert_eq!(threads_of_process(), started, "{name}: a step has started threads");
        let bytes = world.snapshot().unwrap();
        let mut total = 0;
        for (at, call) in CALLS.into_iter().enumerate().filter(|(_, call)| is_chosen(1, call.0)) {
            let tries = if is_long { usize::MAX } else { TRIES[usize::from(call.0 != "step")] };
            for threads in [1, 2] {
                // Both numbers of threads for steps, and one for other calls.
                if is_long || call.0 == "step" || threads == 1 + (at + number) % 2 {
                    total += check(name, &bytes, call, threads, tries);
                }
            }
        }
        println!("{name}: {total} refused");
    }
}
