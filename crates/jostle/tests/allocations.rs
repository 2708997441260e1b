//! A step in a world that has made some steps allocates no memory.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use jostle::Particles;
use jostle::scenes::{self, STEP};

thread_local! {
    static COUNT: Cell<Option<usize>> = const { Cell::new(None) };
}

/// The system's allocator. It counts the allocations of a thread while they are counted.
struct Counting;

fn note() {
    COUNT.with(|count| count.set(count.get().map(|number| number + 1)));
}

#[allow(unsafe_code, reason = "an allocator is unsafe to implement")]
// SAFETY: every call is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        note();
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        note();
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Number of allocations of this thread during a call.
fn allocations(act: impl FnOnce()) -> usize {
    COUNT.set(Some(0));
    act();
    COUNT.take().expect("they are counted")
}

#[test]
fn a_step_allocates_nothing_after_some_steps() {
    // A list still grows when a step has more of something than all before it.
    const RARE: usize = 10;
    let smooth = [
        "gas",
        "pile",
        "mixed",
        "clusters",
        "shots",
        "orbit",
        "thermostat",
        "brownian",
        "sand",
        "galton",
    ];
    let rough = ["gas", "pile"];
    let all = smooth.map(|name| (name, 0.0)).into_iter().chain(rough.map(|name| (name, 0.5)));
    for (name, friction) in all {
        let mut world = scenes::find(name).unwrap().create(Some(1500), 1).unwrap();
        let roughen = |all: &mut Particles| {
            all.spins_mut().iter_mut().for_each(|spin| spin.friction = friction);
            Ok(())
        };
        world.edit(roughen).unwrap();
        let mut settings = *world.settings();
        settings.tree.threads = Some(1);
        world.configure(settings).unwrap();
        world.step(STEP, 150).unwrap();
        let found = allocations(|| world.step(STEP, 20).unwrap());
        assert!(found <= RARE, "{name}: {found} allocations in 20 steps");
    }
}
