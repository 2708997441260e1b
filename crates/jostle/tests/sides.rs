//! Coefficients of restitution and of friction of the sides of the container.

use jostle_scenes::random::Random;
use jostle_world::{Container, OnTouch, Particles, Sides, Surface, World, WorldSettings};

use crate::common::worlds::{
    STEP, bouncing, discs, inside, run, surface, wall, with_friction, world_of,
};

const BOX: Container = Container::Box { min: [0.0; 2], max: [20.0; 2] };
const CIRCLE: Container = Container::Circle { center: [10.0; 2], radius: 10.0 };

fn one(velocity: [f32; 2], restitution: f32, settings: WorldSettings) -> World {
    world_of(bouncing(discs(&[([10.0; 2], velocity)], 1.0), restitution), settings)
}

#[test]
fn each_side_has_its_own() {
    let sides = [None, Some(0.125), Some(0.031_25), Some(0.0)];
    let of_sides = sides.map(|restitution| Surface { restitution, friction: None });
    let settings = WorldSettings { sides: Sides(of_sides), ..inside(BOX) };
    for (side, [x, y]) in [[-8.0, 0.0], [8.0, 0.0], [0.0, -8.0], [0.0, 8.0]].into_iter().enumerate()
    {
        let mut world = one([x, y], 0.5, settings);
        run(&mut world, 90);
        let expected = [x, y].map(|v| -v * [0.5, 0.25, 0.125, 0.0][side]);
        assert_eq!(world.bodies().velocities().unwrap(), [expected]);
        assert_eq!(world.wall_contacts().unwrap().len(), 0);
    }
}

/// The floor of a box brakes a disc that slides on it, with a deceleration of μ g.
#[test]
fn a_side_brakes_with_the_friction_of_both() {
    for (friction, expected) in [(None, 0.4), (Some(0.1), 0.2), (Some(0.0), 0.0)] {
        let mut sides = Sides::default();
        sides.0[2].friction = friction;
        let settings = WorldSettings { sides, gravity: [0.0, -9.8], ..inside(BOX) };
        let disc = with_friction(bouncing(discs(&[([3.0, 1.0], [6.0, 0.0])], 1.0), 0.5), 0.4);
        let mut world = world_of(disc, settings);
        run(&mut world, 12);
        let braked = 6.0 - f64::from(world.bodies().velocities().unwrap()[0][0]);
        let found = braked / (9.8 * 12.0 * STEP);
        assert!((found - expected).abs() < 1e-3, "{friction:?}: {found}");
    }
}

/// Discs of many sizes that fall and pass through each other.
fn rain(restitution: f32, settings: WorldSettings) -> World {
    let mut random = Random::new(3);
    let mut pair =
        |least: f32, most: f32| [random.between(least, most), random.between(least, most)];
    let positions = (0..200).map(|_| pair(6.0, 14.0)).collect();
    let velocities = (0..200).map(|_| pair(-5.0, 5.0)).collect();
    let radii = (0..200).map(|_| pair(0.0, 0.5)[0].max(0.1)).collect();
    let mut all = bouncing(Particles::new(positions, velocities, radii, 1.0), restitution);
    all.spins_mut().iter_mut().for_each(|spin| spin.friction = 0.3);
    let base = WorldSettings { on_touch: OnTouch::Ignore, gravity: [1.0, -9.8], ..settings };
    world_of(all, base)
}

#[test]
fn those_of_the_discs_are_like_none() {
    for container in [BOX, CIRCLE] {
        for restitution in [0.0, 0.3, 0.9, 1.0] {
            let base = inside(container);
            let mut expected = rain(restitution, base);
            let of_discs = Surface { restitution: Some(restitution), friction: Some(0.3) };
            let sides = Sides([of_discs; 4]);
            let mut world = rain(restitution, WorldSettings { sides, ..base });
            for steps in [1, 20, 60] {
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
    let mut sides = Sides::default();
    sides.0[2] = surface(0.25);
    let settings = WorldSettings { sides, gravity: [0.0, -9.8], ..inside(BOX) };
    let mut world = one([3.0, 0.0], 1.0, settings);
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
    assert_eq!(floor[0].wall, -4);
    let weight = 9.8 * STEP as f32;
    assert!((floor[0].normal_impulse / weight - 1.0).abs() < 1e-3);
}

#[test]
fn without_sides_they_change_nothing() {
    for container in [Container::None, Container::Torus { size: [20.0; 2] }] {
        let base = inside(container);
        let rough = Surface { friction: Some(0.9), ..surface(0.3) };
        let different = Sides([surface(0.5), surface(0.0), Surface::default(), rough]);
        let worlds = [Sides::default(), different].map(|sides| {
            let mut world = rain(1.0, WorldSettings { sides, ..base });
            run(&mut world, 30);
            world.state_hash().unwrap()
        });
        assert_eq!(worlds[0], worlds[1]);
    }
}

#[test]
fn they_outlast_new_walls_and_snapshots() {
    let different = |k: f32| Surface { restitution: Some(0.2 * k), friction: Some(0.9 - 0.2 * k) };
    let sides = Sides([1.0, 2.0, 3.0, 4.0].map(different));
    let mut expected = rain(1.0, WorldSettings { sides, ..inside(BOX) });
    let mut world = rain(1.0, inside(BOX));
    world.configure(*expected.settings()).unwrap();
    world.set_walls(vec![wall([0.0, 0.0], [1.0, 0.0])]).unwrap();
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
    let refusal = |container, which: usize, of: Surface| {
        let mut sides = Sides::default();
        sides.0[which] = of;
        let settings = WorldSettings { sides, ..inside(container) };
        World::new(Particles::default(), settings).unwrap_err().to_string()
    };
    let rough = |friction| Surface { friction: Some(friction), ..Surface::default() };
    assert_eq!(
        refusal(BOX, 2, surface(-0.5)),
        "restitution[2] is -0.5; it must lie between 0 and 1"
    );
    assert_eq!(
        refusal(BOX, 0, surface(f32::NAN)),
        "restitution[0] is NaN; it must lie between 0 and 1"
    );
    assert_eq!(refusal(BOX, 3, rough(-1.0)), "friction[3] is -1; it must be finite and at least 0");
    for of in [surface(0.5), rough(0.5)] {
        assert_eq!(
            refusal(CIRCLE, 1, of),
            "sides is side 1; a circle has one side, so all four must be equal"
        );
    }
}
