//! A step in a world that has made some steps allocates no memory, nor a round that moves shapes apart,
//! and a change of one particle little.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use jostle_base::Settings;
use jostle_index::{Each, Shapes};
use jostle_scenes::{self as scenes, STEP};
use jostle_separate::{Separation, separate};
use jostle_world::{Changes, Particles, WorldSettings};

use crate::common::worlds::{bouncing, boxed, still, world_of};

thread_local! {
    static COUNT: Cell<Option<usize>> = const { Cell::new(None) };
    static BYTES: Cell<usize> = const { Cell::new(0) };
}

/// The system's allocator. It counts the allocations of a thread while they are counted.
struct Counting;

fn note(size: usize) {
    COUNT.with(|count| count.set(count.get().map(|number| number + 1)));
    BYTES.with(|bytes| bytes.set(bytes.get() + size));
}

#[allow(unsafe_code, reason = "an allocator is unsafe to implement")]
// SAFETY: every call is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        note(layout.size());
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        note(size);
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

/// Bytes that this thread allocates during a call.
fn allocated_bytes(act: impl FnOnce()) -> usize {
    BYTES.set(0);
    act();
    BYTES.get()
}

#[test]
fn rounds_that_move_shapes_apart_allocate_nothing() {
    // Few overlap, so that one list of pairs lasts, and it is far too little room for success.
    let at = |k: u32| [f64::from(k % 40) * 1.99, f64::from(k / 40) * 1.99];
    let shapes = Shapes::circles((0..1600).map(at).collect(), Each::One(1.0)).unwrap();
    let bounds = Some([-1.0, -1.0, 39.0 * 1.99 + 1.0, 39.0 * 1.99 + 1.0]);
    let count = |max_rounds| {
        let rules = Separation { max_rounds, bounds, threads: Some(1), ..Separation::default() };
        allocations(|| {
            let apart = separate(&shapes, &rules).unwrap();
            assert!(apart.rounds == max_rounds && apart.overlaps > 0);
        })
    };
    count(20);
    assert_eq!(count(4), count(20));
}

#[test]
fn to_read_or_change_one_particle_copies_no_columns() {
    for name in ["gas", "pile"] {
        let mut world = scenes::find(name).unwrap().create(Some(20_000), 1).unwrap();
        world.step(STEP, 1).unwrap();
        // The first call after a step finds the places of all rows.
        world.read(&[0]).unwrap();
        let velocities = Some(Each::One([0.5, 0.25]));
        let faster = Changes { velocities, ..Changes::default() };
        let own = || Some(Each::Rows(vec![0.125]));
        let heavier = Changes { masses: own(), friction: own(), ..Changes::default() };
        let bytes = allocated_bytes(|| {
            world.set(&[7], &faster).unwrap();
            world.read(&[7, 12_345]).unwrap();
        });
        assert!(bytes < 4096, "{name}: {bytes} bytes");
        assert_eq!(world.bodies().velocities().unwrap()[7], [0.5, 0.25]);
        // The column of friction is made when it is first needed.
        world.set(&[7], &heavier).unwrap();
        let bytes = allocated_bytes(|| world.set(&[12_345], &heavier).unwrap());
        assert!(bytes < 4096, "{name}: {bytes} bytes");
        assert_eq!(
            [7, 12_345, 8].map(|row: usize| world.bodies().friction().unwrap()[row]),
            [0.125, 0.125, 0.0]
        );
    }
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
        "flock",
        "life",
    ];
    let rough = ["gas", "pile"];
    // Trees of more than 4,096 discs are made in parts.
    let large = ["gas", "pile", "mixed"];
    let all = smooth.map(|name| (name, 800, 0.0)).into_iter();
    let all = all.chain(rough.map(|name| (name, 800, 0.5)));
    for (name, len, friction) in all.chain(large.map(|name| (name, 5_000, 0.0))) {
        let mut world = scenes::find(name).unwrap().create(Some(len), 1).unwrap();
        let roughen = |all: &mut Particles| {
            all.spins_mut().iter_mut().for_each(|spin| spin.friction = friction);
            Ok(())
        };
        world.edit(roughen).unwrap();
        let mut settings = *world.settings();
        settings.tree.threads = Some(1);
        // What falls asleep or wakes moves to other lists, which grow.
        settings.sleeping = false;
        world.configure(settings).unwrap();
        world.step(STEP, 150).unwrap();
        let found = allocations(|| world.step(STEP, 20).unwrap());
        assert!(found <= RARE, "{len} of {name}: {found} allocations in 20 steps");
    }
}

/// Discs that move near sleeping ones, and do not touch them.
#[test]
fn a_step_near_sleepers_allocates_nothing() {
    let at = |k: u16| [f32::from(k) * 2.5, 1.0];
    let discs = |positions: Vec<[f32; 2]>| bouncing(still(&positions, 1.0), 0.3);
    let settings = WorldSettings {
        gravity: [0.0, -9.8],
        container: boxed([-50.0, 0.0], [500.0, 100.0]),
        tree: Settings { threads: Some(1), ..Settings::default() },
        ..WorldSettings::default()
    };
    let mut world = world_of(discs((0..150).map(at).collect()), settings);
    world.step(STEP, 120).unwrap();
    assert_eq!(world.bodies().asleep().unwrap().iter().filter(|asleep| **asleep).count(), 150);
    // Kinematic discs move above them, more than those whose tree debug builds check.
    let mut more = discs((0..600).map(|k: u16| [f32::from(k) * 0.6, 4.0]).collect());
    more.velocities.fill([0.5, 0.0]);
    more.movable.fill(false);
    world.add(more).unwrap();
    world.step(STEP, 150).unwrap();
    assert_eq!(world.bodies().asleep().unwrap().iter().filter(|asleep| **asleep).count(), 150);
    assert_eq!(allocations(|| world.step(STEP, 60).unwrap()), 0);
}
