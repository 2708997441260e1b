//! A call may be interrupted at any poll: all objects then keep their state.

use crate::common::SetShapes;
use std::cell::Cell;

use jostle_base::interrupt::watch;
use jostle_base::settings::DEFAULT_MAX_PAIRS;
use jostle_base::{Error, Method, Result, Settings};
use jostle_index::pairs::FindScratch;
use jostle_index::query::{Circle, Ray};
use jostle_index::{Each, Quadtree, Shapes, pairs, query};
use jostle_space::Space;
use jostle_world::forces::{Flocking, Gravitation, Influence};
use jostle_world::{OnTouch, Particles, WorldSettings};

use crate::common::worlds::world_of;

thread_local! {
    /// Polls that do not stop.
    static LEFT: Cell<u32> = const { Cell::new(0) };
}

fn poll() -> bool {
    let left = LEFT.get();
    LEFT.set(left.saturating_sub(1));
    left == 0
}

/// Calls `call` until it ends, stopped at its first poll, at its second, and at many later
/// ones; `look` is called after each stop. Returns what `call` does in the end.
fn at_every_poll<S, R>(
    state: &mut S,
    mut call: impl FnMut(&mut S) -> Result<R>,
    mut look: impl FnMut(&mut S),
) -> R {
    let mut allowed = 0;
    loop {
        LEFT.set(allowed);
        match watch(poll, || call(state)) {
            Err(Error::Interrupted) => look(state),
            answer => {
                assert!(allowed > 0, "nothing was polled");
                return answer.expect("nothing else can go wrong");
            }
        }
        allowed += 1 + allowed / 4;
    }
}

fn centers(len: u32) -> Vec<[f64; 2]> {
    let mixed = |v: u32| f64::from(v.wrapping_mul(0x9e37_79b9).rotate_left(9) >> 12);
    (0..len).map(|row| [mixed(row), mixed(row ^ 0x5555)]).collect()
}

/// Some thousand pairs, and a few hundred shapes at one place.
fn shapes(len: u32) -> Shapes<f64> {
    let mut centers = centers(len);
    centers[..300].fill([7.0, 7.0]);
    Shapes::circles(centers, Each::One(4000.0)).expect("valid")
}

fn alone() -> Settings {
    Settings { threads: Some(1), ..Settings::default() }
}

#[test]
fn a_rebuilt_tree_is_usable_after_every_stop() {
    let all = shapes(15_000);
    for method in [Method::Quadtree, Method::Brute] {
        let find = |tree: &mut FindScratch<f64>| {
            let mut found = pairs::find_with(tree, &all, Some(method), Some(1), DEFAULT_MAX_PAIRS)?;
            found.sort()?;
            Ok(found.pairs)
        };
        let few = shapes(500);
        let expected = pairs::find(&few, None, None, DEFAULT_MAX_PAIRS).unwrap();
        let found = at_every_poll(&mut FindScratch::default(), find, |tree| {
            let quadtree = Some(Method::Quadtree);
            let found = pairs::find_with(tree, &few, quadtree, Some(1), DEFAULT_MAX_PAIRS);
            assert_eq!(found.unwrap().pairs.len(), expected.pairs.len());
            assert_eq!(tree.tree.check(), Ok(()));
        });
        assert_eq!(found, find(&mut FindScratch::default()).unwrap());
    }
}

#[test]
fn a_search_by_a_grid_stops() {
    let mut all = shapes(200_000);
    *all.columns_mut().radii = Each::One(8000.0);
    let find = |scratch: &mut FindScratch<f64>| {
        let found = pairs::find_with(scratch, &all, None, Some(1), DEFAULT_MAX_PAIRS)?;
        assert!(scratch.tree.is_empty(), "the tree was used");
        Ok(found)
    };
    let found = at_every_poll(&mut FindScratch::default(), find, |_| ());
    assert_eq!(found, find(&mut FindScratch::default()).unwrap());
}

#[test]
fn queries_stop() {
    let all = shapes(40_000);
    let mut tree = Quadtree::new(&all, alone()).unwrap();
    let circles = Circle::all(&Each::Rows(all.centers().to_vec()), &Each::One(1.0)).unwrap();
    let ways = Each::One([1.0, 0.5]);
    let rays =
        Ray::all(&Each::Rows(all.centers()[..5000].to_vec()), &ways, &Each::One(0.0), 9000.0)
            .unwrap();
    let points = &all.centers()[..5000];
    let wanted = (3, f64::INFINITY);
    let found = at_every_poll(&mut tree, |tree| query::search(tree, &circles, None), |_| ());
    assert_eq!(found, query::search(&tree, &circles, None).unwrap());
    let found = at_every_poll(&mut tree, |tree| query::nearest(tree, points, wanted, None), |_| ());
    assert_eq!(found, query::nearest(&tree, points, wanted, None).unwrap());
    let found = at_every_poll(&mut tree, |tree| query::first_hits(tree, &rays, None), |_| ());
    assert_eq!(found, query::first_hits(&tree, &rays, None).unwrap());
}

#[test]
fn a_space_is_unchanged_after_every_stop() {
    let all = shapes(20_000);
    let mut space = Space::new(alone()).unwrap();
    let ids = space.add(&all).unwrap();
    let mut twin = space.clone();
    for round in 0..3 {
        let few = if round == 0 { &ids[..0] } else { &ids[1000 * round..8000 * round] };
        for space in [&mut space, &mut twin] {
            let moved: Vec<_> = few.iter().map(|&id| [1e3 * id as f64 % 1e6, 3.0]).collect();
            space.move_to(few, &moved).unwrap();
        }
        let check = |space: &mut Space<f64>| assert_eq!(space.check(), Ok(()));
        let mut found =
            at_every_poll(&mut space, |space| space.pairs(None, DEFAULT_MAX_PAIRS), check);
        found.sort_unstable();
        let events = at_every_poll(&mut space, |space| space.update(DEFAULT_MAX_PAIRS), check);
        let expected = twin.update(DEFAULT_MAX_PAIRS).unwrap();
        assert_eq!((&events.entered, &events.left), (&expected.entered, &expected.left));
        assert_eq!(space.stayed(&events), twin.stayed(&expected));
        let mut expected = twin.pairs(None, DEFAULT_MAX_PAIRS).unwrap();
        expected.sort_unstable();
        assert_eq!(found, expected);
    }
}

#[test]
fn a_swept_update_is_unchanged_after_every_stop() {
    let mut space = Space::new(alone()).unwrap();
    let ids = space.add(&shapes(20_000)).unwrap();
    space.update(DEFAULT_MAX_PAIRS).unwrap();
    let moved: Vec<_> = space.read(&ids[5000..5300], |shape| shape.center()).unwrap();
    let moved: Vec<_> = moved.iter().map(|[x, y]| [x + 5e4, y - 3e4]).collect();
    space.move_to(&ids[5000..5300], &moved).unwrap();
    let mut twin = space.clone();
    let check = |space: &mut Space<f64>| assert_eq!(space.check(), Ok(()));
    let events = at_every_poll(&mut space, |space| space.update_swept(DEFAULT_MAX_PAIRS), check);
    let expected = twin.update_swept(DEFAULT_MAX_PAIRS).unwrap();
    assert_eq!((&events.entered, &events.left), (&expected.entered, &expected.left));
    let both = events.entered.iter().filter(|pair| events.left.binary_search(pair).is_ok());
    assert!(both.count() > 100);
    assert_eq!(space.stayed(&events), twin.stayed(&expected));
    assert_eq!(space.update_swept(9).unwrap().entered.len(), 0);
}

/// The number of polls of a call.
fn polls<R>(call: impl FnOnce() -> R) -> u32 {
    LEFT.set(u32::MAX);
    watch(poll, call);
    u32::MAX - LEFT.get()
}

/// Each task of a query may have less work than there is between two polls of a task.
#[test]
fn queries_of_many_short_tasks_poll_often() {
    let all = shapes(40_000);
    let tree = Quadtree::new(&all, alone()).unwrap();
    let points = all.centers();
    let nearest = polls(|| query::nearest(&tree, points, (1, f64::INFINITY), None).unwrap());
    assert!(nearest > 40, "{nearest}");
    let circles = Circle::all(&Each::Rows(points.to_vec()), &Each::One(1.0)).unwrap();
    let circles = polls(|| query::search(&tree, &circles, None).unwrap());
    assert!(circles > 40, "{circles}");
}

#[test]
fn forces_between_all_particles_and_neighbours_poll_often() {
    let positions: Vec<[f32; 2]> =
        centers(20_000).iter().map(|at| at.map(|v| v as f32 * 1e-3)).collect();
    let count = positions.len();
    let all = Particles::new(positions, vec![[1.0, 0.0]; count], vec![1.0; count], 1.0);
    let gravitation = Influence::Gravitation(Gravitation { g: 1.0, softening: 1.0, theta: 0.5 });
    let flocking = Flocking {
        cutoff: 10.0,
        separation: 1.0,
        alignment: 1.0,
        cohesion: 1.0,
        max_speed: f32::INFINITY,
        min_speed: 0.0,
    };
    for force in [gravitation, Influence::Flocking(flocking)] {
        // One thread: only the caller's polls, and how many tasks it gets of several varies.
        let settings =
            WorldSettings { on_touch: OnTouch::Ignore, tree: alone(), ..Default::default() };
        let mut world = world_of(all.clone(), settings);
        let without = polls(|| world.step(0.01, 1).unwrap());
        world.set_forces(vec![force]).unwrap();
        let with = polls(|| world.step(0.01, 1).unwrap());
        assert!(with > without + 20, "{with} instead of {without}");
        let before = world.snapshot().unwrap();
        LEFT.set(with / 2);
        assert_eq!(watch(poll, || world.step(0.01, 1)), Err(Error::Interrupted));
        assert_eq!(world.snapshot().unwrap(), before);
    }
}
