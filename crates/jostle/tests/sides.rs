//! Coefficients of restitution of the sides of the container.

use jostle_scenes::random::Random;
use jostle_world::{Container, OnTouch, Particles, World, WorldSettings};

use crate::common::worlds::{STEP, discs, inside, run, world_of};

const BOX: Container = Container::Box { min: [0.0; 2], max: [20.0; 2] };
const CIRCLE: Container = Container::Circle { center: [10.0; 2], radius: 10.0 };

fn one(velocity: [f32; 2], settings: WorldSettings) -> World {
    let disc = discs(&[([10.0; 2], velocity)], 1.0);
    world_of(disc, settings)
}

#[test]
fn each_side_has_its_own() {
    let sides = [0.5, 0.25, 0.125, 0.0];
    let base = WorldSettings { container: BOX, restitution: 0.5, ..WorldSettings::default() };
    let settings = WorldSettings { container_restitution: sides, ..base };
    for (side, [x, y]) in [[-8.0, 0.0], [8.0, 0.0], [0.0, -8.0], [0.0, 8.0]].into_iter().enumerate()
    {
        let mut world = one([x, y], settings);
        run(&mut world, 90);
        let expected = [x, y].map(|v| -v * 0.5 * sides[side]);
        assert_eq!(world.bodies().velocities().unwrap(), [expected]);
        assert_eq!(world.wall_contacts().unwrap().len(), 0);
    }
}

/// Discs of many sizes that fall and pass through each other.
fn rain(settings: WorldSettings) -> World {
    let mut random = Random::new(3);
    let mut pair =
        |least: f32, most: f32| [random.between(least, most), random.between(least, most)];
    let positions = (0..200).map(|_| pair(6.0, 14.0)).collect();
    let velocities = (0..200).map(|_| pair(-5.0, 5.0)).collect();
    let radii = (0..200).map(|_| pair(0.0, 0.5)[0].max(0.1)).collect();
    let mut all = Particles::new(positions, velocities, radii, 1.0);
    all.spins_mut().iter_mut().for_each(|spin| spin.friction = 0.3);
    let base = WorldSettings { on_touch: OnTouch::Ignore, gravity: [1.0, -9.8], ..settings };
    world_of(all, base)
}

#[test]
fn equal_ones_are_like_that_of_the_world() {
    for container in [BOX, CIRCLE] {
        for restitution in [0.0, 0.3, 0.9, 1.0] {
            let base = inside(container);
            let mut expected = rain(WorldSettings { restitution, ..base });
            let container_restitution = [restitution; 4];
            let mut world = rain(WorldSettings { container_restitution, ..base });
            for steps in [1, 20, 200] {
                run(&mut expected, steps);
                run(&mut world, steps);
                assert_eq!(
                    world.state_hash().unwrap(),
                    expected.state_hash().unwrap(),
                    "{container:?} {restitution}"
                );
                assert_eq!(world.wall_contacts().unwrap(), expected.wall_contacts().unwrap());
            }
        }
    }
}

#[test]
fn an_elastic_gas_cools_at_one_side_and_rests_there() {
    let sides = [1.0, 1.0, 0.5, 1.0];
    let gravity = [0.0, -9.8];
    let base = WorldSettings { container: BOX, gravity, ..WorldSettings::default() };
    let mut world = one([3.0, 0.0], WorldSettings { container_restitution: sides, ..base });
    run(&mut world, 600);
    // The walls at its sides do not change its speed, and the floor takes what is along its normal.
    let ([[_, y]], [[u, v]]) = (
        world.bodies().positions().unwrap()[..].try_into().unwrap(),
        world.bodies().velocities().unwrap()[..].try_into().unwrap(),
    );
    assert!((y - 1.0f32).abs() < 1e-3 && v == 0.0, "{y} {v}");
    assert!((f32::abs(u) - 3.0).abs() < 1e-4, "{u}");
    let floor = world.wall_contacts().unwrap();
    assert_eq!(floor.len(), 1);
    assert_eq!(floor[0].wall, 2);
    let weight = 9.8 * STEP as f32;
    assert!((floor[0].normal_impulse / weight - 1.0).abs() < 1e-3);
}

#[test]
fn without_sides_they_change_nothing() {
    for container in [Container::None, Container::Torus { size: [20.0; 2] }] {
        let base = inside(container);
        let worlds = [[1.0; 4], [0.5, 0.0, 1.0, 0.3]].map(|container_restitution| {
            let mut world = rain(WorldSettings { container_restitution, ..base });
            run(&mut world, 30);
            world.state_hash().unwrap()
        });
        assert_eq!(worlds[0], worlds[1]);
    }
}

#[test]
fn they_outlast_new_walls_and_snapshots() {
    let settings = WorldSettings {
        container: BOX,
        container_restitution: [0.2, 0.4, 0.6, 0.8],
        ..WorldSettings::default()
    };
    let mut expected = rain(settings);
    let mut world = rain(WorldSettings { container_restitution: [1.0; 4], ..settings });
    world.configure(*expected.settings()).unwrap();
    world.set_walls(vec![jostle_world::Wall::new([[0.0, 0.0], [1.0, 0.0]])]).unwrap();
    world.set_walls(Vec::new()).unwrap();
    let mut again = World::restore(&expected.snapshot().unwrap()).unwrap();
    assert_eq!(again.settings(), expected.settings());
    for world in [&mut world, &mut again, &mut expected] {
        run(world, 100);
    }
    assert_eq!(again.snapshot().unwrap(), expected.snapshot().unwrap());
    assert_eq!(world.state_hash().unwrap(), expected.state_hash().unwrap());
}

#[test]
fn wrong_ones_are_refused() {
    let refusal = |container, container_restitution| {
        let base = inside(container);
        let settings = WorldSettings { container_restitution, ..base };
        World::new(Particles::default(), settings).unwrap_err().to_string()
    };
    assert_eq!(
        refusal(BOX, [1.0, 0.5, -0.5, 1.0]),
        "container_restitution[2] is -0.5; it must lie between 0 and 1"
    );
    assert_eq!(
        refusal(BOX, [f32::NAN; 4]),
        "container_restitution is NaN; it must lie between 0 and 1"
    );
    assert_eq!(
        refusal(CIRCLE, [1.0, 0.5, 1.0, 1.0]),
        "container_restitution[1] is 0.5; a circle has one wall, so all four must be equal"
    );
}
