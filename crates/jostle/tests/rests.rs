//! Which contacts rest: the same rule at round walls, at the ends of walls and at flat ones.

use jostle_base::Method;
use jostle_world::{Container, Wall, World, WorldSettings};

use crate::common::worlds::{bouncing, change, discs, falling, run, surface, walled, world_of};

/// A disc that touches the lowest point of a round container and slides along it.
fn sliding(speed: f32) -> World {
    let container = Container::Circle { center: [0.0; 2], radius: 1.0 };
    let settings = WorldSettings { container, substeps: Some(1), ..falling() };
    world_of(bouncing(discs(&[([0.0, -0.5], [speed, 0.0])], 0.5), 0.0), settings)
}

/// Impacts on walls in the next step.
fn impacts(world: &mut World) -> u64 {
    world.begin_record().unwrap();
    run(world, 1);
    world.record().totals().collisions.walls
}

#[test]
fn a_disc_rests_on_a_round_wall_while_the_normal_hardly_turns() {
    // The centre slides on a circle of radius 0.5. In a step it moves by a third, and by two thirds of it.
    assert_eq!(impacts(&mut sliding(10.0)), 0);
    let mut fast = sliding(20.0);
    assert!(impacts(&mut fast) > 0);
    let particles = fast.bodies().particles().unwrap();
    let ([x, y], [u, v]) = (particles.positions[0], particles.velocities[0]);
    assert!(x.hypot(y) < 0.5 + 1e-4 && u.hypot(v) < 20.0 + 1e-3, "{x} {y} {u} {v}");
}

/// A disc that falls onto the upper ends of two posts, all with this velocity to the right.
fn on_posts(velocity: f32) -> World {
    let post = |x: f32| Wall {
        velocity: [velocity, 0.0],
        surface: surface(0.125),
        ..Wall::new([[x, 0.0], [x, -3.0]])
    };
    let particles = bouncing(discs(&[([0.0, 0.9], [velocity, 0.0])], 1.0), 0.5);
    walled(particles, vec![post(-0.6), post(0.6)], falling())
}

#[test]
fn a_disc_rests_on_the_ends_of_walls_that_carry_it_however_fast() {
    let mut still = on_posts(0.0);
    run(&mut still, 60);
    for velocity in [10.0, 300.0] {
        let mut moved = on_posts(velocity);
        run(&mut moved, 60);
        // The fast posts move by more than the radius of the disc in each of four sub-steps.
        assert_eq!(impacts(&mut moved), 0, "{velocity}");
        let (disc, end) = (moved.bodies().particles().unwrap(), moved.walls()[0].ends[0]);
        let [x, y] = [0, 1].map(|k| disc.positions[0][k] - end[k]);
        let [u, v] = disc.velocities[0];
        let height = still.bodies().particles().unwrap().positions[0][1];
        assert!((x - 0.6).abs() < 1e-3 && (y - height).abs() < 1e-4, "{velocity}: {x} {y}");
        assert!((u - velocity).abs() < 1e-3 && v.abs() < 1e-3, "{velocity}: {u} {v}");
    }
}

/// Discs that fall onto the ends of posts, each pair of which has its own velocity.
fn on_many_posts() -> World {
    let rows = (0..500).map(|k| ([8.0 * k as f32, 0.9], [0.0, -0.01 * k as f32]));
    let particles = bouncing(discs(&rows.collect::<Vec<_>>(), 1.0), 0.5);
    let posts = (0..1000).map(|k| {
        let x = 8.0 * (k / 2) as f32 + if k % 2 == 0 { -0.6 } else { 0.6 };
        let velocity = [0.0, (k / 2 % 9) as f32];
        Wall { velocity, surface: surface(0.125), ..Wall::new([[x, 0.0], [x, -3.0]]) }
    });
    walled(particles, posts.collect(), falling())
}

#[test]
fn neither_threads_nor_methods_show_at_ends_of_walls() {
    let ways = [1, 2, 8].map(|threads| (Method::Quadtree, threads));
    let hashes = ways.into_iter().chain([(Method::Brute, 1)]).map(|(method, threads)| {
        let mut world = on_many_posts();
        change(&mut world, |settings| {
            (settings.method, settings.tree.threads) = (method, Some(threads));
        });
        run(&mut world, 30);
        world.state_hash().unwrap()
    });
    let hashes: Vec<u64> = hashes.collect();
    assert!(hashes.iter().all(|hash| *hash == hashes[0]), "{hashes:x?}");
}
