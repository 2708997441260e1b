//! Crowds of discs that walls and kinematic discs push: no disc ends on the other side.

use jostle_base::{Error, Method};
use jostle_scenes::random::Random;
use jostle_world::forces::{Influence, Motor, WallIds};
use jostle_world::{Container, Particles, Wall, World, WorldSettings};

use crate::common::worlds::{STEP, bouncing, discs, moving, run, still, walled, world_of};

const RESTITUTIONS: [f32; 5] = [0.0, 0.3, 0.5, 0.8, 1.0];

fn motor(walls: &[i64], ids: Vec<i64>, velocity: [f32; 2], cycle: f32) -> Influence {
    let (pivot, angular_velocity) = ([0.0; 2], 0.0);
    Influence::Motor(Motor {
        ids,
        walls: WallIds(walls.to_vec()),
        pivot,
        angular_velocity,
        velocity,
        cycle,
    })
}

/// Discs at random places in a rectangle, as many of them as fit without overlaps.
fn scattered(random: &mut Random, radii: &[f32], [width, height]: [f32; 2]) -> Particles {
    let mut rows: Vec<([f32; 2], f32)> = Vec::new();
    for &radius in radii {
        let places =
            (0..2000).map(|_| [width, height].map(|side| random.between(radius, side - radius)));
        let is_free = |place: &[f32; 2]| {
            rows.iter()
                .all(|(other, r)| (other[0] - place[0]).hypot(other[1] - place[1]) > r + radius)
        };
        let places: Vec<_> = places.collect();
        let Some(place) = places.into_iter().find(is_free) else { break };
        rows.push((place, radius));
    }
    let (positions, radii): (Vec<_>, Vec<_>) = rows.into_iter().unzip();
    Particles::new(positions.clone(), vec![[0.0; 2]; positions.len()], radii, 1.0)
}

fn with_kinematic(all: Particles, more: &[[f32; 2]], radius: f32, velocity: [f32; 2]) -> Particles {
    let (own, len) = (all.len(), all.len() + more.len());
    let positions = [&all.positions[..], more].concat();
    let velocities = [vec![[0.0; 2]; own], vec![velocity; more.len()]].concat();
    let radii = [all.radii.clone(), vec![radius; more.len()]].concat();
    let mut both = Particles::new(positions, velocities, radii, 1.0);
    both.movable[own..len].fill(false);
    both
}

fn settings(substeps: usize, gravity: f32) -> WorldSettings {
    let (gravity, substeps) = ([0.0, -gravity], Some(substeps));
    WorldSettings { substeps, gravity, ..WorldSettings::default() }
}

#[test]
fn two_discs_before_a_wall_do_not_get_behind_it() {
    let positions = vec![[1.15, 0.94], [0.66, 0.22]];
    let all = bouncing(still(&positions, 0.4), 0.0);
    let mut world =
        walled(all, vec![moving([[0.0, -9.0], [0.0, 9.0]], [30.0, 0.0])], settings(1, 0.0));
    for _ in 0..8 {
        run(&mut world, 1);
        let wall = world.walls()[0].ends[0][0];
        for [x, _] in world.bodies().positions().unwrap() {
            assert!(x - wall > 0.4 - 1e-5, "{}", x - wall);
        }
        assert_eq!(world.stats().unresolved, 0);
    }
}

/// Discs before a wall, or a row of kinematic discs, that moves to the right through the open plane.
fn pushed(
    seed: u64,
    (count, restitution): (usize, f32),
    speed: f32,
    is_row: bool,
    settings: WorldSettings,
) -> World {
    let mut random = Random::new(seed);
    let side = (count as f32 * 1.28).sqrt().max(2.0);
    let all = scattered(&mut random, &vec![0.4; count], [side, side]);
    let row: Vec<_> = (-12..=20).map(|k| [-0.5, k as f32]).collect();
    let row = if is_row { &row[..] } else { &[] };
    let all = bouncing(with_kinematic(all, row, 0.5, [speed, 0.0]), restitution);
    let mut world = world_of(all, settings);
    if !is_row {
        let wall = moving([[0.0, -90.0], [0.0, 90.0]], [speed, 0.0]);
        world.set_walls(vec![wall]).expect("valid");
    }
    world
}

fn assert_before(world: &World, what: &str) {
    let all = world.bodies().particles().unwrap();
    let count = all.movable.iter().filter(|&&moves| moves).count();
    let edge = world.walls().first().map_or_else(|| all.positions[count][0], |of| of.ends[0][0]);
    for [x, y] in &all.positions[..count] {
        assert!(*x >= edge || y.abs() > 10.0 && count < all.len(), "{x} behind {edge}: {what}");
    }
}

fn push_all(speeds: &[f32], counts: &[usize], seeds: u64, steps: usize) {
    for (&speed, &count) in speeds.iter().flat_map(|s| counts.iter().map(move |c| (s, c))) {
        for restitution in RESTITUTIONS {
            for (substeps, is_row) in [(1, false), (1, true), (4, false), (16, true)] {
                for seed in 0..seeds {
                    let (discs, settings) = ((count, restitution), settings(substeps, 0.0));
                    let mut world = pushed(seed, discs, speed, is_row, settings);
                    for step in 0..steps {
                        run(&mut world, 1);
                        let of = [speed, restitution];
                        let what = format!("{of:?} {count} {substeps} {is_row} {seed} {step}");
                        assert_before(&world, &what);
                    }
                }
            }
        }
    }
}

#[test]
fn no_disc_gets_behind_a_wall_or_a_row_that_pushes() {
    push_all(&[10.0, 30.0, 100.0], &[2, 5, 30], 1, 20);
}

/// A closed box that moves, half full of discs, and its side.
struct Lift {
    world: World,
    discs: usize,
    side: f32,
    period: Option<f32>,
}

#[derive(Clone, Copy, Debug)]
enum Sides {
    Walls,
    Discs,
    OnTorus,
}

fn lift(
    seed: u64,
    (sides, restitution): (Sides, f32),
    velocity: [f32; 2],
    mut settings: WorldSettings,
) -> Lift {
    let mut random = Random::new(seed);
    let radii: Vec<f32> = (0..30).map(|_| random.between(0.1, 0.4)).collect();
    let area: f32 = radii.iter().map(|r| std::f32::consts::PI * r * r).sum();
    let side = (2.0 * area).sqrt();
    let mut all = scattered(&mut random, &radii, [side, side]);
    let discs = all.len();
    if let Sides::Discs = sides {
        let count = (side / 0.3).ceil() as u32;
        let row = (0..=count).map(|k| side * k as f32 / count as f32);
        let row = row.flat_map(|t| [[t, -0.2], [t, side + 0.2], [-0.2, t], [side + 0.2, t]]);
        all = with_kinematic(all, &row.collect::<Vec<_>>(), 0.2, [0.0; 2]);
    }
    let mut period = None;
    if let Sides::OnTorus = sides {
        settings.container = Container::Torus { size: [40.0; 2] };
        period = Some(40.0);
    }
    let len = all.len();
    let mut world = world_of(bouncing(all, restitution), settings);
    let corners = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]];
    let of_walls = if period.is_some() { velocity } else { [0.0; 2] };
    let walls = (0..4).map(|k| moving([corners[k], corners[(k + 1) % 4]], of_walls));
    let walls: Vec<_> = if let Sides::Discs = sides { vec![] } else { walls.collect() };
    if period.is_none() {
        let numbers: Vec<i64> = (0..walls.len() as i64).collect();
        let ids = (discs as i64..len as i64).collect();
        world.set_walls(walls).expect("valid");
        let turns = if seed.is_multiple_of(2) { 1.0 } else { f32::INFINITY };
        world.set_forces(vec![motor(&numbers, ids, velocity, turns)]).expect("valid");
    } else {
        world.set_walls(walls).expect("valid");
    }
    Lift { world, discs, side, period }
}

fn assert_inside(of: &Lift, what: &str) {
    let Lift { world, discs, side, period } = of;
    let positions = world.bodies().positions().unwrap();
    let [x, y] = world
        .walls()
        .first()
        .map_or_else(|| [positions[*discs][0], positions[*discs][1] + 0.2], |wall| wall.ends[0]);
    for p in &positions[..*discs] {
        let mut offset = [p[0] - x, p[1] - y];
        if let Some(period) = period {
            offset = offset.map(|v| v - period * ((v - side / 2.0) / period).round());
        }
        assert!(offset.iter().all(|v| (0.0..=*side).contains(v)), "{offset:?} of {side}: {what}");
    }
}

fn lift_all(speeds: &[f32], substeps: &[usize], seeds: u64, steps: usize) {
    for (&speed, &substeps) in speeds.iter().flat_map(|s| substeps.iter().map(move |c| (s, c))) {
        for (restitution, sides) in RESTITUTIONS
            .into_iter()
            .flat_map(|e| [Sides::Walls, Sides::Discs, Sides::OnTorus].map(|sides| (e, sides)))
        {
            for (gravity, seed) in [0.0, 9.8].iter().flat_map(|g| (0..seeds).map(move |s| (*g, s)))
            {
                let direction = [[1.0, 0.0], [0.0, 1.0], [0.6, 0.8]][seed as usize % 3];
                let velocity = direction.map(|v: f32| v * speed);
                let settings = settings(substeps, gravity);
                let mut lift = lift(seed, (sides, restitution), velocity, settings);
                for step in 0..steps {
                    run(&mut lift.world, 1);
                    let of = [speed, restitution, gravity];
                    assert_inside(&lift, &format!("{of:?} {sides:?} {substeps} {seed} {step}"));
                }
            }
        }
    }
}

#[test]
fn no_disc_leaves_a_box_that_moves() {
    lift_all(&[5.0, 10.0, 100.0], &[1], 2, 40);
    lift_all(&[20.0], &[4], 1, 40);
}

#[test]
#[ignore = "takes minutes"]
fn no_disc_leaves_many_boxes_that_move() {
    lift_all(&[3.0, 5.0, 10.0, 20.0, 50.0, 100.0], &[1, 2, 4, 8, 16], 6, 200);
    push_all(&[10.0, 30.0, 60.0, 100.0], &[2, 3, 5, 10, 20, 30], 10, 100);
}

/// One disc between two walls, of which one or both come as near as `gap` again and again.
fn pressed(both: bool, gap: f32, speed: f32, restitution: f32, substeps: usize) -> World {
    let all = bouncing(still(&[[0.3, 0.0]], 0.4), restitution);
    let mut world = world_of(all, settings(substeps, 0.0));
    let walls = [-2.0, 2.0].map(|x| Wall::new([[x, -9.0], [x, 9.0]]));
    world.set_walls(walls.to_vec()).expect("valid");
    let way = (4.0 - gap) / if both { 2.0 } else { 1.0 };
    let cycle = 2.0 * way / speed;
    let left = motor(&[0], vec![], [speed, 0.0], cycle);
    let right = motor(&[1], vec![], [-speed, 0.0], cycle);
    world.set_forces(if both { vec![left, right] } else { vec![left] }).expect("valid");
    world
}

#[test]
fn a_disc_stays_between_walls_that_leave_it_no_room() {
    for (both, gap) in [(false, 0.1), (false, 0.5), (true, 0.1), (true, 0.5)] {
        for restitution in RESTITUTIONS {
            for (speed, substeps) in [(0.5, 1), (3.0, 1), (10.0, 1), (10.0, 8)] {
                let mut world = pressed(both, gap, speed, restitution, substeps);
                for _ in 0..(480.0 / speed).min(300.0) as usize {
                    let done = world.step(STEP, 1);
                    if restitution >= 0.8 && matches!(done, Err(Error::TooManyCollisions { .. })) {
                        // It becomes faster at each bounce, so the step is refused in the end.
                        break;
                    }
                    done.expect("a step succeeds");
                    let [left, right] = [0, 1].map(|wall| world.walls()[wall].ends[0][0]);
                    let x = world.bodies().positions().unwrap()[0][0];
                    assert!(
                        left < x && x < right,
                        "{x} of {left} to {right}: {both} {gap} {restitution} {speed} {substeps}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_disc_without_room_moves_with_the_mean_of_what_presses_it() {
    let all = bouncing(still(&[[0.0; 2]], 0.4), 0.0);
    let mut world = world_of(all, settings(1, 0.0));
    let left = moving([[-0.4, -9.0], [-0.4, 9.0]], [3.0, 0.0]);
    let right = moving([[0.4, -9.0], [0.4, 9.0]], [-1.0, 0.0]);
    world.set_walls(vec![left, right]).expect("valid");
    run(&mut world, 1);
    let [x, y] = world.bodies().positions().unwrap()[0];
    assert!((x - STEP as f32).abs() < 1e-6 && y == 0.0, "{x}");
    let [u, v] = world.bodies().velocities().unwrap()[0];
    assert!((u - 1.0).abs() < 1e-6 && v == 0.0, "{u}");
}

#[test]
fn an_exhausted_disc_moves_with_the_walls_around_it() {
    // It bounces 10⁵ times in the step.
    for (restitution, velocity) in [(0.99, [20.0, 0.0]), (1.0, [20.0, 0.0]), (1.0, [0.0; 2])] {
        let own = [velocity[0] + 1.0, 2.0];
        let all = bouncing(discs(&[([0.0; 2], own)], 0.4), restitution);
        let mut world = world_of(all, settings(1, 0.0));
        let walls = [-0.4 - 1e-7, 0.4 + 1e-7f32].map(|x| moving([[x, -9.0], [x, 9.0]], velocity));
        world.set_walls(walls.to_vec()).expect("valid");
        for step in 1..10 {
            run(&mut world, 1);
            // What is left of a velocity that is lost does not bounce.
            let again = if restitution < 1.0 && step > 1 { 0 } else { 1 };
            assert_eq!(world.stats().unresolved, again);
            let middle = velocity[0] * step as f32 * STEP as f32;
            let [x, _] = world.bodies().positions().unwrap()[0];
            assert!((x - middle).abs() < 1e-5, "{x} {middle}");
            let [u, v] = world.bodies().velocities().unwrap()[0];
            assert_eq!(v, 2.0);
            assert!((u - velocity[0]).abs() < 1.0 + 1e-4, "{u}");
            if restitution == 1.0 {
                assert!(((u - velocity[0]).abs() - 1.0).abs() < 1e-4, "it keeps its energy: {u}");
            }
        }
    }
}

/// A dense crowd before a wall that pushes it.
fn crowd(method: Method, threads: usize) -> World {
    let mut settings = settings(4, 0.0);
    (settings.method, settings.tree.threads) = (method, Some(threads));
    let mut random = Random::new(3);
    let all = (0..650).map(|k| {
        let of = |v: i32| 0.81 * v as f32 + random.between(0.0, 0.004);
        [k % 26, k / 26].map(of)
    });
    let all = Particles::new(all.collect(), vec![[0.0; 2]; 650], vec![0.4; 650], 1.0);
    let mut world = world_of(bouncing(all, 0.0), settings);
    let wall = moving([[-0.5, -99.0], [-0.5, 99.0]], [20.0, 3.0]);
    world.set_walls(vec![wall]).expect("valid");
    world
}

#[test]
fn methods_and_threads_do_not_show_in_a_crowd() {
    let mut first = crowd(Method::Quadtree, 1);
    run(&mut first, 2);
    assert_before(&first, "the crowd");
    for (method, threads) in [(Method::Quadtree, 4), (Method::Brute, 2)] {
        let mut other = crowd(method, threads);
        run(&mut other, 2);
        assert_eq!(
            other.state_hash().unwrap(),
            first.state_hash().unwrap(),
            "{method:?} {threads}"
        );
    }
}
