//! Nothing that never touches a particle changes a bit of it.

use jostle_index::Filter;
use jostle_scenes::random::Random;
use jostle_world::{Container, Particles, Wall, WorldSettings};

use crate::common::worlds::{bouncing, boxed, walled};

/// What the particles of a scene touch, and what none of them touches.
const OWN: Filter = Filter { category: 1, mask: 1 };
const OTHER: Filter = Filter { category: 2, mask: 2 };
const NONE: Filter = Filter { category: 2, mask: 0 };

/// Side of the region in which the scenes are.
const SIDE: f32 = 40.0;

/// A scene: its particles, walls and settings, the seconds of a step and their number.
#[derive(Clone)]
struct Base {
    name: String,
    particles: Particles,
    walls: Vec<Wall>,
    settings: WorldSettings,
    dt: f64,
    steps: usize,
}

/// Something that is added.
type Addition = (&'static str, fn(&Base, &mut Random) -> (Particles, Vec<Wall>));

fn containers() -> [Container; 4] {
    let half = 0.5 * SIDE;
    [
        Container::None,
        boxed([0.0; 2], [SIDE; 2]),
        Container::Circle { center: [half; 2], radius: 1.6 * half },
        Container::Torus { size: [SIDE; 2] },
    ]
}

/// A floor and two sides, for a plane without a container.
fn trough() -> Vec<Wall> {
    let ends = [
        [[0.0, 0.0], [SIDE, 0.0]],
        [[0.0, 0.0], [0.0, 3.0 * SIDE]],
        [[SIDE, 0.0], [SIDE, 3.0 * SIDE]],
    ];
    ends.map(Wall::new).to_vec()
}

/// Discs in rows, without overlap, at random speeds.
fn discs(count: usize, speed: f32, filter: Filter, random: &mut Random) -> Particles {
    let columns = (count as f32).sqrt().ceil();
    let spacing = (SIDE - 2.0) / columns;
    let place = |row: usize, random: &mut Random| {
        let at = [row as f32 % columns, (row as f32 / columns).floor()];
        [0, 1].map(|k| 1.0 + (at[k] + random.between(0.45, 0.55)) * spacing)
    };
    let positions = (0..count).map(|row| place(row, random)).collect();
    let velocities = (0..count).map(|_| random.in_disc().map(|v| v * speed)).collect();
    let radii = (0..count).map(|_| spacing * random.between(0.3, 0.42)).collect();
    let mut all = Particles::new(positions, velocities, radii, 1.0);
    all.filters_mut().fill(filter);
    all
}

/// A few discs of one radius, at random places.
fn scattered(
    count: usize,
    (radius, speed): (f32, f32),
    filter: Filter,
    random: &mut Random,
) -> Particles {
    let place = |_| [0, 1].map(|_| random.between(1.0, SIDE - 1.0));
    let positions = (0..count).map(place).collect();
    let velocities = (0..count).map(|_| random.in_disc().map(|v| v * speed)).collect();
    let mut all = Particles::new(positions, velocities, vec![radius; count], 1.0);
    all.filters_mut().fill(filter);
    all
}

/// Immovable ones of those.
fn immovable(mut all: Particles, speed: f32) -> Particles {
    all.movable.fill(false);
    all.velocities.iter_mut().for_each(|v| *v = v.map(|v| v * speed));
    all
}

fn sensors(mut all: Particles) -> Particles {
    all.filters_mut().fill(OWN);
    all.sensors_mut().fill(true);
    all
}

/// How far away from the scene a few particles are. Those in a container cannot be outside.
fn far(base: &Base, mut all: Particles) -> Particles {
    if base.settings.container == Container::None {
        all.positions.iter_mut().for_each(|[x, _]| *x += 900.0);
    }
    all
}

fn no_walls(all: Particles) -> (Particles, Vec<Wall>) {
    (all, Vec::new())
}

/// Everything that is added to each scene.
const ADDITIONS: [Addition; 14] = [
    ("immovable far away", |base, random| {
        no_walls(far(base, immovable(scattered(1, (0.4, 0.0), NONE, random), 0.0)))
    }),
    ("large immovable", |_, random| {
        no_walls(immovable(scattered(2, (9.0, 0.0), NONE, random), 0.0))
    }),
    ("small immovable, many", |_, random| {
        no_walls(immovable(scattered(300, (0.01, 0.0), NONE, random), 0.0))
    }),
    ("fast", |base, random| no_walls(far(base, scattered(2, (0.3, 900.0), NONE, random)))),
    ("many slow", |_, random| no_walls(scattered(200, (0.1, 0.0), NONE, random))),
    ("many fast", |_, random| no_walls(scattered(200, (0.2, 300.0), NONE, random))),
    ("kinematic", |_, random| no_walls(immovable(scattered(3, (0.5, 5.0), NONE, random), 1.0))),
    ("static sensors", |_, random| {
        no_walls(sensors(immovable(scattered(3, (2.0, 0.0), OWN, random), 0.0)))
    }),
    ("moving sensors", |_, random| no_walls(sensors(scattered(3, (1.0, 30.0), OWN, random)))),
    ("heavy and light", |_, random| {
        let mut all = discs(100, 5.0, OTHER, random);
        all.masses.iter_mut().step_by(3).for_each(|mass| *mass *= 200.0);
        no_walls(all)
    }),
    ("inelastic", |_, random| {
        let mut all = discs(100, 3.0, OTHER, random);
        all.restitution.fill(0.3);
        no_walls(all)
    }),
    ("rough", |_, random| {
        let mut all = discs(100, 3.0, OTHER, random);
        all.spins_mut().iter_mut().for_each(|spin| spin.friction = 0.4);
        no_walls(all)
    }),
    ("another world", |base, _| {
        let mut all = base.particles.clone();
        all.filters_mut().fill(OTHER);
        all.velocities.iter_mut().for_each(|[u, v]| (*u, *v) = (*v + 0.1, -*u));
        no_walls(all)
    }),
    ("walls far away", |base, _| {
        if let Container::Torus { .. } = base.settings.container {
            return no_walls(Particles::default());
        }
        let wall = Wall::new([[2000.0, 0.0], [2000.0, 50.0]]);
        // Nothing falls asleep while a wall moves.
        let speed = if base.settings.sleeping { 0.0 } else { 3.0 };
        let moving = Wall { velocity: [speed, 0.0], ..wall };
        (Particles::default(), vec![wall, Wall { ends: [[3000.0; 2], [3010.0; 2]], ..moving }])
    }),
];

/// Positions, velocities and rotations of the particles of a scene, and the contacts among them, in
/// bits.
fn state(base: &Base, extra: Option<(Particles, Vec<Wall>)>) -> Vec<u64> {
    let (mut particles, mut walls) = (base.particles.clone(), base.walls.clone());
    let count = particles.len();
    if let Some((more, more_walls)) = extra {
        particles.extend(&more);
        walls.extend(more_walls);
    }
    let mut world = walled(particles, walls, base.settings);
    world.step(base.dt, base.steps).expect("a step succeeds");
    let all = world.bodies().particles().unwrap();
    let numbers = |all: &[[f32; 2]]| {
        all[..count].iter().flatten().map(|v| u64::from(v.to_bits())).collect::<Vec<u64>>()
    };
    let mut bits = numbers(&all.positions);
    bits.extend(numbers(&all.residuals));
    bits.extend(numbers(&all.velocities));
    for row in 0..count {
        let spin = all.spin(row);
        bits.extend([spin.angle.to_bits(), u64::from(spin.velocity.to_bits())]);
    }
    let mut touches = world.contacts().expect("few");
    touches.retain(|of| of.pair.iter().all(|&id| (id as usize) < count));
    touches.sort_unstable_by_key(|of| of.pair);
    for of in touches {
        let numbers =
            [of.normal[0], of.normal[1], of.depth, of.normal_impulse, of.friction_impulse];
        bits.extend(of.pair.map(|id| id as u64));
        bits.extend(numbers.map(|v| u64::from(v.to_bits())));
    }
    bits
}

/// Checks that no addition changes a scene.
fn check(bases: impl Iterator<Item = Base>) {
    let mut wrong = Vec::new();
    for (seed, base) in (0..).zip(bases) {
        let expected = state(&base, None);
        for (name, addition) in ADDITIONS {
            // A sensor that moves keeps awake what it touches.
            if base.settings.sleeping && name == "moving sensors" {
                continue;
            }
            let mut random = Random::new(100 + seed);
            let found = state(&base, Some(addition(&base, &mut random)));
            if found != expected {
                wrong.push(format!("{}: {name}", base.name));
            }
        }
    }
    assert!(wrong.is_empty(), "{} changed:\n{}", wrong.len(), wrong.join("\n"));
}

/// A pile under gravity, for which everything may matter.
fn pile(seed: u64) -> Base {
    let mut random = Random::new(seed);
    let container = containers()[seed as usize % 3];
    let substeps = Some([4, 1, 8, 2][seed as usize % 4]);
    let particles = discs(60 + 30 * (seed as usize % 4), 3.0, OWN, &mut random);
    let mut particles = bouncing(particles, [0.5, 0.0, 0.9][seed as usize % 3]);
    if seed % 3 == 1 {
        particles.spins_mut().iter_mut().for_each(|spin| spin.friction = 0.3);
    }
    if seed % 5 == 2 {
        particles.restitution.iter_mut().step_by(2).for_each(|e| *e = 0.2);
    }
    let walls = if container == Container::None { trough() } else { Vec::new() };
    let settings = WorldSettings {
        gravity: [0.0, -30.0],
        container,
        substeps,
        sleeping: false,
        ..WorldSettings::default()
    };
    let name = format!("pile {seed} in {container:?}");
    Base { name, particles, walls, settings, dt: 1.0 / 60.0, steps: 90 }
}

/// A gas whose particles move by some radii in a step.
fn gas(seed: u64, radii: f32) -> Base {
    let mut random = Random::new(seed);
    let container = containers()[seed as usize % 4];
    let restitution = [1.0, 0.95, 1.0, 0.6][(seed / 4) as usize % 4];
    let particles = bouncing(discs(150, 10.0, OWN, &mut random), restitution);
    let walls = if seed % 8 == 4 { trough() } else { Vec::new() };
    let settings = WorldSettings {
        container,
        substeps: [None, Some(1), Some(3)][seed as usize % 3],
        sleeping: false,
        ..WorldSettings::default()
    };
    let name = format!("gas {seed} of {radii} radii a step in {container:?}");
    Base { name, particles, walls, settings, dt: f64::from(radii) / 10.0, steps: 6 }
}

/// Elastic discs that fall and never rest, whatever others do.
fn elastic(seed: u64) -> Base {
    let base = pile(seed);
    let mut particles = bouncing(base.particles.clone(), 1.0);
    particles.spins_mut().fill(Default::default());
    Base { name: format!("elastic {}", base.name), particles, ..base }
}

#[test]
fn what_touches_nothing_changes_no_pile() {
    check((0..6).map(pile).map(|base| Base { steps: 40, ..base }));
}

/// A pile that falls asleep.
fn sleeper(seed: u64) -> Base {
    let base = pile(4 * seed);
    let settings = WorldSettings { sleeping: true, ..base.settings };
    let mut particles = bouncing(base.particles.clone(), 0.2);
    particles.spins_mut().iter_mut().for_each(|spin| spin.friction = 0.6);
    Base { name: format!("sleeping {}", base.name), particles, settings, steps: 420, ..base }
}

#[test]
fn what_touches_nothing_wakes_no_pile() {
    let bases: Vec<Base> = (0..3).map(sleeper).collect();
    let count_asleep = |base: &Base| {
        let mut world = walled(base.particles.clone(), base.walls.clone(), base.settings);
        world.step(base.dt, base.steps).expect("a step succeeds");
        world.bodies().asleep().unwrap().iter().filter(|asleep| **asleep).count()
    };
    assert!(bases.iter().map(count_asleep).sum::<usize>() > 20);
    check(bases.into_iter());
}

#[test]
fn what_loses_energy_elsewhere_changes_no_elastic_discs() {
    check((0..3).map(elastic).map(|base| Base { steps: 30, ..base }));
}

#[test]
fn what_touches_nothing_changes_no_gas() {
    check((0..8).map(|seed| gas(seed, 0.5)));
}

#[test]
fn what_touches_nothing_changes_no_gas_in_long_steps() {
    let all = (0..8).map(|seed| gas(seed, if seed % 3 == 0 { 40.0 } else { 5.0 }));
    check(all.map(|base| Base { steps: 2, ..base }));
}

/// More scenes, for minutes: `cargo test --release --package jostle --test all locality -- --ignored`.
#[test]
#[ignore = "it takes minutes"]
fn what_touches_nothing_changes_nothing() {
    check((0..60).map(pile));
    check((0..12).map(elastic));
    check((0..12).map(sleeper));
    check((0..60).map(|seed| gas(seed, [0.01, 0.5, 5.0, 40.0, 300.0][seed as usize % 5])));
}
