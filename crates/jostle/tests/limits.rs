//! Limits of a step: it never writes infinite numbers, takes unbounded time, or leaves a world
//! in the middle of a step.

use std::cell::Cell;
use std::time::{Duration, Instant};

use jostle_base::interrupt::watch;
use jostle_base::{Error, Id, Method, Settings};
use jostle_world::forces::{Attractor, Gravitation, Influence, Law, Pole, Spring, Springs};
use jostle_world::{Container, OnTouch, Particles, Stage, Wall, World, WorldSettings};

use crate::common::worlds::{bouncing, boxed, inside, still, world_of};

/// Much more than any of these steps takes; an unbounded step took hundreds of times as long.
const SOON: Duration = Duration::from_secs(20);

fn within_bounds(act: impl FnOnce()) {
    let start = Instant::now();
    act();
    assert!(start.elapsed() < SOON, "it took {:?}", start.elapsed());
}

/// Everything that another step depends on.
fn state(world: &World) -> (Vec<u8>, Option<Vec<Option<Id>>>) {
    (world.snapshot().unwrap(), world.renumbered().unwrap())
}

/// Three heavy discs that press against each other with more than float32 can hold.
fn overflowing() -> World {
    let positions = vec![[0.0, 0.0], [3.0, 0.0], [6.0, 0.0]];
    let mut all = bouncing(still(&positions, 1.0), 0.5);
    all.masses = vec![1e26; 3];
    let settings = WorldSettings {
        gravity: [0.0, 10.0],
        drag: 1e3,
        container: boxed([-20.0; 2], [20.0; 2]),
        substeps: Some(1),
        ..Default::default()
    };
    let mut world = world_of(all, settings);
    let gravitation = Gravitation { g: 1.0, softening: 0.1, theta: 0.5 };
    let forces = vec![Influence::Gravitation(gravitation)];
    world.set_forces(forces).unwrap();
    world
}

#[test]
fn a_step_that_overflows_is_refused_and_undone() {
    let mut world = overflowing();
    let (steps, before, error) = (0..1000)
        .find_map(|step| {
            let before = state(&world);
            let error = world.step(0.01, 1).err()?;
            Some((step, before, error.to_string()))
        })
        .expect("it overflows at some time");
    assert!(error.starts_with("the step would make "), "{error}");
    assert!(error.contains("[0] (inf") && error.contains(", which is not finite"), "{error}");
    assert_eq!(state(&world), before);
    assert_eq!(world.time(), (0..steps).fold(0.0, |time, _| time + 0.01));
    // All steps in one call: the steps before the one that is refused stay.
    let mut other = overflowing();
    assert_eq!(other.step(0.01, 1000).unwrap_err().to_string(), error);
    assert_eq!(state(&other), before);
    assert_eq!(state(&World::restore(&before.0).unwrap()).0, before.0);
    // The world can be corrected and continues.
    let lighter = |all: &mut Particles| {
        all.masses.fill(1.0);
        Ok(())
    };
    world.edit(lighter).unwrap();
    world.set_forces(Vec::new()).unwrap();
    world.step(0.01, 10).unwrap();
    assert!(world.bodies().velocities().unwrap().iter().flatten().all(|v| v.is_finite()));
}

fn crowd(len: usize, side: f32) -> Particles {
    let columns = (len as f32).sqrt().ceil() as usize;
    let gap = side / columns as f32;
    let at = |k: usize| [(k % columns) as f32 + 0.5, (k / columns) as f32 + 0.5].map(|v| v * gap);
    let speed = |k: usize| [(k * 7 % 11) as f32 - 5.0, (k * 5 % 13) as f32 - 6.0];
    let radii = (0..len).map(|k| gap * (0.3 + 0.05 * (k % 5) as f32)).collect();
    Particles::new((0..len).map(at).collect(), (0..len).map(speed).collect(), radii, 1.0)
}

/// Worlds of all kinds, with how they are called.
fn worlds() -> Vec<(&'static str, World)> {
    let pile = WorldSettings {
        gravity: [0.0, 40.0],
        container: boxed([-1.0; 2], [31.0; 2]),
        ..Default::default()
    };
    let torus = Container::Torus { size: [30.0; 2] };
    let merging =
        WorldSettings { on_touch: OnTouch::Merge, container: torus, ..Default::default() };
    let spring = |k| Spring {
        pair: [k, k + 1],
        length: 1.0,
        stiffness: 50.0,
        damping: 0.1,
        max_stretch: 0.5,
    };
    let mut outside = crowd(60, 30.0);
    outside.positions[3] = [-95.0, 64.0];
    let mut one_fast = crowd(200, 30.0);
    one_fast.velocities[7] = [9000.0, 4000.0];
    let make = |all, settings| world_of(all, settings);
    let lossy = || bouncing(crowd(60, 30.0), 0.3);
    let mut sprung = make(lossy(), pile);
    sprung.set_forces(vec![Influence::Springs(Springs((0..50).map(spring).collect()))]).unwrap();
    let many_parts = {
        let mut all = crowd(60, 30.0);
        all.velocities.iter_mut().for_each(|v| *v = v.map(|v| v * 100.0));
        make(all, WorldSettings { container: torus, ..Default::default() })
    };
    // Particles merge before the last part of a step.
    let merging_fast = {
        let mut all = crowd(120, 30.0);
        all.velocities.iter_mut().for_each(|v| *v = v.map(|v| v * 100.0));
        all.radii.iter_mut().for_each(|radius| *radius *= 0.1);
        let mut world = make(all, merging);
        world.remove(&[7]).unwrap();
        world
    };
    let mut walled = make(lossy(), pile);
    let wall = |k: i32| {
        let x = (k * 17 % 30) as f32;
        Wall::new([[x, (k * 7 % 30) as f32], [x + 5.0, (k * 11 % 30) as f32 + 0.5]])
    };
    walled.set_walls((0..12).map(wall).collect()).unwrap();
    vec![
        ("merging fast", merging_fast),
        ("walls", walled),
        ("pile", make(lossy(), pile)),
        ("springs", sprung),
        ("merging", make(crowd(60, 30.0), merging)),
        ("outside", make(outside, WorldSettings { container: torus, ..Default::default() })),
        ("one fast", make(one_fast, WorldSettings { container: torus, ..Default::default() })),
        ("many parts", many_parts),
    ]
}

thread_local! {
    /// Checks that do not stop.
    static LEFT: Cell<u32> = const { Cell::new(0) };
}

fn poll() -> bool {
    let left = LEFT.get();
    LEFT.set(left.saturating_sub(1));
    left == 0
}

#[test]
fn an_interrupted_step_is_undone_wherever_it_stops() {
    for (name, mut world) in worlds() {
        world.step(1.0 / 60.0, 5).unwrap();
        let mut other = World::restore(&world.snapshot().unwrap()).unwrap();
        // Stop at the first check, at the second, and so on, until the step gets through.
        for checks in 0.. {
            let before = state(&world);
            LEFT.set(checks);
            let stepped = watch(poll, || world.step(1.0 / 60.0, 1));
            let Err(error) = stepped else { break };
            assert_eq!(error, jostle_base::Error::Interrupted);
            assert_eq!(state(&world), before, "{name} stopped at check {checks}");
            assert!(checks < 10_000);
        }
        other.step(1.0 / 60.0, 1).unwrap();
        let steps = &mut |world: &mut World| world.step(1.0 / 60.0, 5).unwrap();
        steps(&mut world);
        steps(&mut other);
        assert_eq!(
            world.snapshot().unwrap(),
            other.snapshot().unwrap(),
            "{name} goes on as if nothing had been"
        );
    }
}

#[test]
fn positions_that_a_caller_gave_are_back_after_a_step_that_is_undone() {
    let torus = Container::Torus { size: [10.0; 2] };
    let all = Particles::new(vec![[-3.0, 25.0], [5.0, 5.0]], vec![[1.0; 2]; 2], vec![1.0; 2], 1.0);
    let settings = WorldSettings { container: torus, ..Default::default() };
    let mut world = world_of(all, settings);
    watch(|| true, || world.step(0.1, 1)).unwrap_err();
    assert_eq!(world.bodies().positions().unwrap()[0], [-3.0, 25.0]);
}

#[test]
fn a_round_wall_far_from_the_origin_takes_no_longer() {
    let center = [1e7 + 1.0; 2];
    let container = Container::Circle { center, radius: 2.1 };
    let positions = (0..1000).map(|k| [center[0] + (k % 7) as f32, center[1] - (k % 5) as f32]);
    let all = Particles::new(positions.collect(), vec![[1.0, 0.5]; 1000], vec![0.5; 1000], 1.0);
    let settings = WorldSettings { container, on_touch: OnTouch::Ignore, ..Default::default() };
    let mut world = world_of(all, settings);
    within_bounds(|| world.step(0.1, 3).unwrap());
    for [x, y] in world.bodies().positions().unwrap() {
        let [x, y] = [x - center[0], y - center[1]].map(f64::from);
        assert!((x * x + y * y).sqrt() <= 1.6 + 1e-6);
    }
}

fn torus_with_one_fast(speed: f32, len: usize, on_touch: OnTouch) -> World {
    let side = 1000.0;
    let mut all = crowd(len, side);
    all.radii.iter_mut().for_each(|radius| *radius *= 0.3);
    all.velocities[0] = [speed, 0.618 * speed];
    let container = Container::Torus { size: [side; 2] };
    world_of(all, WorldSettings { container, on_touch, ..Default::default() })
}

#[test]
fn a_fast_particle_on_a_torus_collides_again_and_again_in_a_step() {
    let mut stages = 0;
    let mut world = torus_with_one_fast(6e6, 400, OnTouch::Bounce);
    let (momentum, energy) = (world.momentum(), world.kinetic_energy());
    let mut count = |stage: Stage, _: &World| stages += i32::from(stage == Stage::Build);
    within_bounds(|| world.step_watched(0.01, 1, &mut count).unwrap());
    assert!(stages <= 300, "all particles made {stages} parts");
    let close = |a: f64, b: f64, size: f64| (a - b).abs() < 1e-5 * size;
    let size = 2.0 * energy / 6e6;
    assert!((0..2).all(|k| close(world.momentum()[k], momentum[k], size)));
    assert!(close(world.kinetic_energy(), energy, energy));
    let moved = world.bodies().velocities().unwrap().iter().filter(|v| v[0].abs() > 100.0).count();
    assert!(moved > 10, "only {moved} have been hit");
    assert_eq!(world.stats().unresolved, 0);
}

#[test]
fn the_number_of_steps_has_no_effect_on_a_fast_particle() {
    let torus = Container::Torus { size: [1000.0; 2] };
    let cases = (0..40).flat_map(|angle| [(torus, angle), (Container::None, angle)]);
    let mut stable = 0;
    for (container, angle) in cases {
        let mut all = torus_with_one_fast(0.0, 100, OnTouch::Bounce).bodies().particles().unwrap();
        all.velocities[0] = [(angle as f32).cos(), (angle as f32).sin()].map(|v| v * 3e4);
        let settings = inside(container);
        let [once, often, oftener] = [1, 40, 60].map(|steps| {
            let mut world = world_of(all.clone(), settings);
            world.step(0.02 / steps as f64, steps).unwrap();
            world.bodies().velocities().unwrap()
        });
        let error = |found: &[[f32; 2]]| {
            let both = found.iter().flatten().zip(oftener.iter().flatten());
            both.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max) / 3e4
        };
        // Each collision multiplies errors of rounding.
        if error(&often) < 2e-4 && oftener[0] != all.velocities[0] {
            stable += 1;
            let error = error(&once);
            assert!(error < 2e-3, "{container:?}, {angle}: {error}");
        }
    }
    assert!(stable > 20, "{stable} cases");
}

#[test]
fn a_fast_disc_meets_what_is_beyond_its_renewed_bounds() {
    // Rows of discs move together, so fast that the bounds are renewed three times in the step. Beside them the first
    // disc flies along a lane to the only other disc in it. In each part it flies farther than bounds on a torus reach.
    let (side, speed, dt) = (1000.0, 5000.0, 0.32);
    let container = Container::Torus { size: [side; 2] };
    for target in (640..=940).step_by(20).map(|x| x as f32) {
        let rows = (0..400).map(|k| [k % 20, k / 20].map(|at| at as f32));
        let rows = rows.map(|[x, y]| [50.0 * x, 200.0 + 35.0 * y]);
        let positions: Vec<_> = [[0.0, 50.0], [target, 50.0]].into_iter().chain(rows).collect();
        let mut velocities = vec![[130.0, 0.0]; positions.len()];
        velocities[..2].copy_from_slice(&[[speed, 0.0], [0.0; 2]]);
        let len = positions.len();
        let all = Particles::new(positions, velocities, vec![5.0; len], 1.0);
        let mut world = world_of(all, inside(container));
        world.step(f64::from(dt), 1).unwrap();
        let (positions, velocities) =
            (world.bodies().positions().unwrap(), world.bodies().velocities().unwrap());
        assert_eq!(velocities[..2], [[0.0, 0.0], [speed, 0.0]], "target at {target}");
        // They touch at a distance of 10, and exchange their velocities.
        let places = [target - 10.0, (10.0 + speed * dt) % side];
        for (found, expected) in positions.iter().zip(places) {
            assert!((found[0] - expected).abs() < 1e-2, "{found:?} {expected}");
        }
    }
}

#[test]
fn discs_that_meet_in_another_image_of_the_torus_collide() {
    // The first moves by nearly the side of the torus. The second is hit by the third, and is then
    // along its path, in another image.
    let side = 100.0;
    let positions = vec![[1.0, 50.0], [70.0, 50.2], [60.0, 50.1]];
    let velocities = vec![[-98.0, 0.0], [0.0; 2], [40.0, 0.0]];
    let all = Particles::new(positions, velocities, vec![1.0; 3], 1.0);
    let container = Container::Torus { size: [side; 2] };
    let settings = inside(container);
    let [once, often] = [1, 20].map(|steps| {
        let mut world = world_of(all.clone(), settings);
        world.step(1.0 / steps as f64, steps).unwrap();
        world.bodies().velocities().unwrap()
    });
    assert!(once.iter().all(|v| *v != [-98.0, 0.0]), "the first has collided");
    for (a, b) in once.iter().flatten().zip(often.iter().flatten()) {
        assert!((a - b).abs() < 1e-2, "{once:?} {often:?}");
    }
}

#[test]
fn few_discs_travel_often_around_a_torus() {
    let container = Container::Torus { size: [1000.0; 2] };
    let settings = inside(container);
    let angles = [0.3f32, 1.9, 3.1, 4.4, 5.2, 5.9];
    let velocities = angles.map(|angle| [angle.cos() * 4e4, angle.sin() * 4e4]);
    let positions = (0..6).map(|k| [150.0 * k as f32, 77.0 * (k * k) as f32]).collect();
    let all = Particles::new(positions, velocities.to_vec(), vec![4.0; 6], 1.0);
    let mut world = world_of(all, settings);
    let energy = world.kinetic_energy();
    within_bounds(|| world.step(1.0, 3).unwrap());
    assert!((world.kinetic_energy() / energy - 1.0).abs() < 1e-5);
    assert!(
        velocities.iter().zip(world.bodies().velocities().unwrap()).all(|(a, b)| *a != b),
        "all have collided"
    );
}

#[test]
fn strong_forces_on_a_torus_take_bounded_time() {
    let pole = Pole::Point([500.0; 2]);
    for strength in [1e6, 1e8, 1e12] {
        let mut world = torus_with_one_fast(100.0, 200, OnTouch::Bounce);
        let pull = Attractor { pole, strength, law: Law::Harmonic };
        world.set_forces(vec![Influence::Attractor(pull)]).unwrap();
        let before = state(&world);
        let mut result = Ok(());
        within_bounds(|| result = world.step(0.01, 1));
        assert_eq!(result.is_err(), strength > 1e7, "{result:?}");
        assert!(result.is_ok() || state(&world) == before);
    }
}

#[test]
fn a_fast_particle_in_a_wide_torus_with_many_others_takes_bounded_time() {
    let container = Container::Torus { size: [1000.0; 2] };
    let settings = inside(container);
    let mut all = crowd(10_000, 1000.0);
    all.radii.fill(0.05);
    all.velocities[0] = [1.2e5, 0.7e5];
    let mut world = world_of(all, settings);
    within_bounds(|| world.step(1.0, 1).unwrap());
}

#[test]
fn a_fast_particle_without_hits_moves_straight() {
    // Free flight: the place after a step is known.
    let mut world = torus_with_one_fast(5e5, 100, OnTouch::Ignore);
    let start = world.bodies().positions().unwrap();
    let velocities = world.bodies().velocities().unwrap();
    world.step(0.01, 1).unwrap();
    for (row, ([x, y], [u, v])) in start.into_iter().zip(velocities).enumerate() {
        let goal = [x + u * 0.01, y + v * 0.01].map(|v| f64::from(v).rem_euclid(1000.0));
        for (found, goal) in world.bodies().positions().unwrap()[row].into_iter().zip(goal) {
            let off = (f64::from(found) - goal).abs();
            assert!(off.min(1000.0 - off) < 0.05, "row {row}: {found} instead of {goal}");
        }
    }
}

#[test]
fn the_order_of_adding_has_no_effect_if_few_are_fast() {
    let mut worlds = [false, true].map(|reversed| {
        let world = torus_with_one_fast(2e6, 200, OnTouch::Bounce);
        let mut all = world.bodies().particles().unwrap();
        if reversed {
            let order: Vec<u32> = (0..200).rev().collect();
            all.gather(&world.bodies().particles().unwrap(), &order, Some(1));
        }
        world_of(all, *world.settings())
    });
    worlds.iter_mut().for_each(|world| world.step(0.01, 3).unwrap());
    let [first, second] = worlds.map(|world| world.bodies().positions().unwrap());
    assert!(first.iter().eq(second.iter().rev()));
}

#[test]
fn inelastic_collapse_of_a_long_row_takes_bounded_time() {
    let len = 1_000;
    let mut positions: Vec<[f32; 2]> = (0..len).map(|k| [-(k as f32), 0.0]).collect();
    positions.push([1.0, 0.0]);
    let mut velocities = vec![[60.0, 0.0]; len];
    velocities.push([0.0, 0.0]);
    let mut all = Particles::new(positions, velocities, vec![0.5; len + 1], 1.0);
    all.movable[len] = false;
    let settings = WorldSettings { substeps: Some(1), ..Default::default() };
    let mut world = world_of(bouncing(all, 0.0), settings);
    within_bounds(|| world.step(0.1, 1).unwrap());
    assert!(
        world.bodies().positions().unwrap().iter().all(|p| p[0] <= 1.0),
        "nothing has passed the obstacle"
    );
}

#[test]
fn an_overflow_at_a_round_wall_is_no_panic() {
    let positions = vec![[-4.971_573, -8.371_553], [-8.106_048_5e17, -1.249_123_6]];
    let velocities = vec![[1.0, 9.99e17], [0.0; 2]];
    let mut all = Particles::new(positions, velocities, vec![9.9e17, 6.617_464_5], 1.0);
    all.masses = vec![2.154_265_4e25, 6.257_104e-21];
    all.movable = vec![true, false];
    let settings = WorldSettings {
        gravity: [-6.6e17, 1e9],
        drag: 9.4,
        container: Container::Circle { center: [-9.99e17, 0.56], radius: 9.9e17 },
        ..Default::default()
    };
    let mut world = world_of(all, settings);
    let before = state(&world);
    if world.step(1.0 / 60.0, 1).is_err() {
        assert_eq!(state(&world), before);
    }
    assert_eq!(
        World::restore(&world.snapshot().unwrap()).unwrap().snapshot().unwrap(),
        world.snapshot().unwrap()
    );
}

#[test]
fn all_particles_of_a_world_with_gravitation_may_be_removed() {
    let mut world = overflowing();
    world.remove(&[0, 1, 2]).unwrap();
    world.step(0.01, 1).unwrap();
    assert_eq!((world.len(), world.potential_energy().unwrap()), (0, 0.0));
}

/// Elastic discs in a box, so many that fast ones divide a step into windows.
fn in_a_box(speed: f32, radius: f32, method: Method, threads: usize) -> World {
    let mut all = crowd(20, 10.0);
    all.radii.fill(radius);
    all.velocities.iter_mut().flatten().for_each(|v| *v *= speed);
    let container = boxed([0.0; 2], [10.0, 8.0]);
    let tree = Settings { threads: Some(threads), ..Default::default() };
    world_of(all, WorldSettings { container, method, tree, ..Default::default() })
}

#[test]
fn a_step_with_too_many_collisions_is_refused_and_undone() {
    let text = |method, threads| {
        let mut world = in_a_box(1e7, 0.6, method, threads);
        let before = state(&world);
        let mut refused = Ok(());
        within_bounds(|| refused = world.step(0.01, 1));
        let error = refused.unwrap_err();
        assert!(matches!(error, Error::TooManyCollisions { id: 0..20, limit: 100_000 }), "{error}");
        assert_eq!(state(&world), before);
        world.step(1e-8, 3).unwrap();
        (error.to_string(), world.state_hash().unwrap())
    };
    let expected = text(Method::Quadtree, 1);
    assert_eq!(text(Method::Brute, 2), expected);
    let rule =
        "has more than 100000 collisions in one step; the world is as it was before this step";
    assert!(expected.0.contains(rule), "{}", expected.0);
}

/// Immovable discs that move on a torus drive two others between them to ever larger speeds. Their
/// trajectories in a sub-step have hundreds of pieces, each many times around the torus.
#[test]
fn a_step_in_which_few_discs_become_very_fast_on_a_torus_is_refused_and_undone() {
    let rows = [
        ([3.432_708_7, 3.690_672_4], [-447.217_47, -352.585_72]),
        ([3.744_967_7, 9.874_45], [7.942_339, -12.139_879]),
        ([6.327_563, 6.743_239_4], [5045.36, 5_128.031_2]),
        ([3.299_634_5, 6.799_176_7], [47.201_557, -0.684_197_84]),
        ([1.229_723_7, 0.517_292_3], [288.415_28, -188.810_56]),
        ([8.501_913, 0.088_958_055], [-470.333_65, 46.844_143]),
    ];
    let radii =
        [0.058_338_977, 0.100_769_706, 1.344_976_8, 0.123_005_83, 0.196_876_14, 2.133_899_5];
    let (positions, velocities) = rows.into_iter().unzip();
    let mut all = Particles::new(positions, velocities, radii.to_vec(), 1.0);
    all.movable = vec![false, true, false, false, false, true];
    let settings = WorldSettings {
        container: Container::Torus { size: [10.0, 12.0] },
        gravity: [-22.499_771, -68.050_52],
        substeps: Some(6),
        ..Default::default()
    };
    let mut world = world_of(bouncing(all, 0.5), settings);
    let before = state(&world);
    let mut done = Ok(());
    within_bounds(|| done = world.step(0.1, 1));
    assert!(matches!(done, Err(Error::TooManyCandidates { .. })), "{done:?}");
    assert_eq!(state(&world), before);
    world.step(0.001, 3).unwrap();
}

#[test]
fn discs_of_a_crystal_travel_a_thousand_radii_in_a_step() {
    let mut world = in_a_box(1.0, 0.97, Method::Quadtree, 1);
    let energy = world.kinetic_energy();
    within_bounds(|| world.step(150.0, 1).unwrap());
    assert!((world.kinetic_energy() / energy - 1.0).abs() < 1e-5);
}
