//! The gates of the world's physics, each against an answer that does not come
//! from the world: analysis, conservation laws, geometry.

use jostle_base::settings::DEFAULT_MAX_PAIRS;
use jostle_base::{Id, Settings};
use jostle_index::{Columns, Each, Shapes, geometry, pairs};
use jostle_scenes::{STEP, random::Random};
use jostle_world::{
    Changes, Collisions, Container, Particles, Spin, Surface, Wall, World, WorldSettings,
};

use crate::common::worlds::{
    bouncing, boxed, discs, inside, run, run_for, still, wall, walled, world_of,
};

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Two discs and a rule; what becomes of them.
struct Two {
    positions: [[f32; 2]; 2],
    velocities: [[f32; 2]; 2],
    radii: [f32; 2],
    masses: [f32; 2],
    restitution: f32,
}

impl Two {
    fn world(&self, substeps: usize) -> World {
        let particles = Particles {
            positions: self.positions.to_vec(),
            residuals: vec![[0.0; 2]; 2],
            velocities: self.velocities.to_vec(),
            radii: self.radii.to_vec(),
            masses: self.masses.to_vec(),
            restitution: vec![self.restitution; 2],
            movable: vec![true; 2],
            ..Particles::default()
        };
        world_of(particles, WorldSettings { substeps: Some(substeps), ..WorldSettings::default() })
    }

    /// The velocities after the collision, from the moment of impact.
    fn analytic(&self) -> [[f64; 2]; 2] {
        let at = |v: [[f32; 2]; 2], k: usize| f64::from(v[1][k]) - f64::from(v[0][k]);
        let q = [at(self.positions, 0), at(self.positions, 1)];
        let w = [at(self.velocities, 0), at(self.velocities, 1)];
        let reach = f64::from(self.radii[0]) + f64::from(self.radii[1]);
        let (a, b, c) = (dot(w, w), dot(q, w), dot(q, q) - reach * reach);
        let time = (-b - (b * b - a * c).sqrt()) / a;
        let n = [(q[0] + w[0] * time) / reach, (q[1] + w[1] * time) / reach];
        let [m1, m2] = self.masses.map(f64::from);
        let impulse = -(1.0 + f64::from(self.restitution)) * dot(w, n) / (1.0 / m1 + 1.0 / m2);
        let after = |which: usize, share: f64| {
            [0, 1].map(|k| f64::from(self.velocities[which][k]) + share * impulse * n[k])
        };
        [after(0, -1.0 / m1), after(1, 1.0 / m2)]
    }

    /// Largest deviation of the world from the analysis, relative to the speed.
    fn error(&self, dt: f64, steps: usize, substeps: usize) -> f64 {
        let mut world = self.world(substeps);
        run_for(&mut world, dt, steps);
        let found = world.bodies().particles().unwrap().velocities;
        let scale = self.velocities.iter().flatten().fold(0.0f32, |m, v| m.max(v.abs()));
        let expected = self.analytic();
        let deviation = |i: usize, k: usize| (f64::from(found[i][k]) - expected[i][k]).abs();
        let all = [deviation(0, 0), deviation(0, 1), deviation(1, 0), deviation(1, 1)];
        all.into_iter().fold(0.0, f64::max) / f64::from(scale)
    }
}

#[test]
fn head_on_collisions_follow_the_analysis() {
    for restitution in [1.0, 0.8, 0.5] {
        for masses in [[1.0, 1.0], [1.0, 3.0], [100.0, 1.0], [1e-3, 1e3]] {
            for [x, y] in [[1.0, 0.0], [0.0, -1.0], [0.6, 0.8], [-0.28, 0.96]] {
                for substeps in [1, 4] {
                    let two = Two {
                        positions: [[0.0, 0.0], [30.0 * x, 30.0 * y]],
                        velocities: [[100.0 * x, 100.0 * y], [-20.0 * x, -20.0 * y]],
                        radii: [5.0, 8.0],
                        masses,
                        restitution,
                    };
                    let error = two.error(STEP, 30, substeps);
                    assert!(error < 1e-5, "e {restitution} m {masses:?} ({x}, {y}): {error:e}");
                }
            }
        }
    }
}

#[test]
fn equal_masses_swap_their_velocities() {
    let two = Two {
        positions: [[0.0, 0.0], [25.0, 0.0]],
        velocities: [[60.0, 0.0], [0.0, 0.0]],
        radii: [10.0; 2],
        masses: [2.0; 2],
        restitution: 1.0,
    };
    let mut world = two.world(4);
    run(&mut world, 60);
    assert_eq!(world.bodies().particles().unwrap().velocities, [[0.0, 0.0], [60.0, 0.0]]);
}

#[test]
fn oblique_collisions_take_the_normal_of_the_moment_of_impact() {
    let mut random = Random::new(1);
    let mut worst = 0.0f64;
    for _ in 0..2000 {
        let radii = [random.between(2.0, 10.0), random.between(2.0, 10.0)];
        let reach = radii[0] + radii[1];
        // Up to the smaller radius in a step, hit anywhere but at the very edge.
        let speed = random.between(0.05, 1.0) * radii[0].min(radii[1]) / STEP as f32;
        let aside = random.between(-0.95, 0.95) * reach;
        let way = random.between(1.01, 3.0) * reach;
        let two = Two {
            positions: [[0.0, 0.0], [way, aside]],
            velocities: [[speed, 0.0], [0.0, 0.0]],
            radii,
            masses: [random.between(0.5, 5.0), random.between(0.5, 5.0)],
            restitution: random.between(0.3, 1.0),
        };
        let steps = (2.0 * (way + reach) / (speed * STEP as f32)) as usize + 2;
        for substeps in [1, 4] {
            worst = worst.max(two.error(STEP, steps, substeps));
        }
    }
    assert!(worst < 0.01, "worst deviation {worst}");
}

#[test]
fn what_overlaps_and_parts_is_not_kicked() {
    for along in [[1.0, 0.0], [0.0, 1.0], [0.6, -0.8]] {
        let two = Two {
            positions: [[0.0, 0.0], along.map(|v: f32| 12.0 * v)],
            velocities: [along.map(|v| -7.0 * v), along.map(|v| 13.0 * v)],
            radii: [10.0; 2],
            masses: [1.0, 2.0],
            restitution: 1.0,
        };
        let mut world = two.world(4);
        run(&mut world, 120);
        assert_eq!(world.bodies().particles().unwrap().velocities, two.velocities);
    }
}

/// Discs on a jittered lattice over a square of `side`, velocities up to `speed`.
fn cloud(count: usize, side: f32, radius: f32, speed: f32, seed: u64) -> Particles {
    let mut random = Random::new(seed);
    let columns = (count as f32).sqrt().ceil() as usize;
    let step = side / columns as f32;
    let position =
        |i: usize| [(i % columns) as f32, (i / columns) as f32].map(|c| (c + 0.5) * step);
    let velocities = (0..count).map(|_| random.in_disc().map(|v| v * speed)).collect();
    Particles::new((0..count).map(position).collect(), velocities, vec![radius; count], 1.0)
}

#[test]
fn momentum_of_a_closed_system_stays() {
    let mut particles = cloud(1000, 480.0, 5.0, 200.0, 2);
    // Everything flies inwards, so that it keeps colliding.
    for (position, velocity) in particles.positions.iter().zip(&mut particles.velocities) {
        *velocity = [0, 1].map(|k| velocity[k] + 0.5 * (240.0 - position[k]));
    }
    let size = |p: &Particles| -> f64 {
        let speeds = p.velocities.iter().map(|v| f64::from(v[0].hypot(v[1])));
        speeds.zip(&p.masses).map(|(v, &m)| v * f64::from(m)).sum()
    };
    let total = size(&particles);
    let mut world = world_of(particles, WorldSettings::default());
    let before = world.momentum();
    run(&mut world, 1000);
    let after = world.momentum();
    let drift = (after[0] - before[0]).hypot(after[1] - before[1]) / total;
    assert!(drift <= 1e-5, "momentum drifted by {drift:e}");
}

#[test]
fn an_elastic_gas_keeps_its_energy() {
    let mut world = jostle_scenes::find("gas").unwrap().create(Some(1000), 3).unwrap();
    let start = world.kinetic_energy();
    for _ in 0..10 {
        run(&mut world, 100);
        let now = world.kinetic_energy();
        assert!((now / start - 1.0).abs() <= 1e-6, "energy {}", now / start);
    }
}

#[test]
fn an_inelastic_gas_never_gains_energy() {
    for restitution in [0.0, 0.5, 0.9] {
        let gas = bouncing(cloud(500, 300.0, 5.0, 200.0, 4), restitution);
        let mut world = world_of(gas, inside(boxed([0.0; 2], [300.0; 2])));
        let mut last = world.kinetic_energy();
        for step in 0..200 {
            run(&mut world, 1);
            let now = world.kinetic_energy();
            assert!(now <= last * (1.0 + 1e-6), "e {restitution}, step {step}: {last} → {now}");
            last = now;
        }
    }
}

/// Deepest overlap as a share of the smaller radius.
fn deepest_overlap(particles: &Particles) -> f32 {
    let radii = Each::Rows(particles.radii.clone());
    let shapes = Shapes::circles(particles.positions.clone(), radii).unwrap();
    let discs = Columns::of(&shapes).unwrap();
    let found = pairs::brute(&discs, None, DEFAULT_MAX_PAIRS).unwrap();
    let depth = |&[i, j]: &[u32; 2]| {
        let (a, b) = (discs.shape(i as usize), discs.shape(j as usize));
        geometry::contact(&a, &b).1 / a.radius.min(b.radius)
    };
    found.pairs.iter().map(depth).fold(0.0, f32::max)
}

#[test]
fn a_pile_comes_to_rest_and_stays() {
    for (seed, times) in [(0, [20, 25, 30]), (1, [5, 10, 15])] {
        let mut world = jostle_scenes::find("pile").unwrap().create(Some(1000), seed).unwrap();
        for seconds in times {
            let missing = f64::from(seconds) - world.time();
            run(&mut world, (missing * 60.0).round() as usize);
            let particles = world.bodies().particles().unwrap();
            let overlap = deepest_overlap(&particles);
            let speeds = particles.velocities.iter().map(|v| v[0].hypot(v[1]));
            let speed = speeds.sum::<f32>() / particles.len() as f32;
            println!("seed {seed}, {seconds} s: overlap {overlap:.4}, speed {speed:.4} px/s");
            assert!(overlap <= 0.02, "seed {seed}, {seconds} s: overlap {overlap}");
            assert!(speed <= 1.0, "seed {seed}, {seconds} s: mean speed {speed} px/s");
        }
    }
}

#[test]
fn no_shot_passes_through_a_disc() {
    let mut random = Random::new(5);
    for shot in 0..10_000 {
        let radius = random.between(1.0, 5.0);
        let target = random.between(1.0, 20.0);
        let way = random.between(1.0, 1000.0) * radius;
        let distance = (radius + target) + random.unit() * way;
        // Aimed by up to 0.9 of the sum of radii beside the centre.
        let aside = random.between(-0.9, 0.9) * (radius + target);
        let direction = loop {
            let [x, y] = random.in_disc();
            if x * x + y * y > 0.01 {
                break [x, y].map(|v| v / (x * x + y * y).sqrt());
            }
        };
        let [x, y] = direction;
        let start = [-distance * x - aside * y, -distance * y + aside * x];
        let particles = Particles {
            positions: vec![start, [0.0; 2]],
            residuals: vec![[0.0; 2]; 2],
            velocities: vec![direction.map(|v| v * way / STEP as f32), [0.0; 2]],
            radii: vec![radius, target],
            masses: vec![1.0, random.between(0.1, 10.0)],
            restitution: vec![1.0; 2],
            movable: vec![true, shot % 2 == 0],
            ..Particles::default()
        };
        let substeps = 1 + shot % 4;
        let mut world = world_of(
            particles,
            WorldSettings { substeps: Some(substeps), ..WorldSettings::default() },
        );
        let before = world.bodies().particles().unwrap().velocities[0];
        run(&mut world, 2 + (distance / way) as usize);
        let after = world.bodies().particles().unwrap().velocities[0];
        assert_ne!(before, after, "shot {shot} went through at {} radii a step", way / radius);
    }
}

#[test]
fn no_shot_passes_through_a_curtain_of_discs() {
    for seed in 0..7 {
        let mut random = Random::new(seed);
        let side = 400.0;
        // Discs that nothing moves, a shot's radius apart, across the whole box.
        let (peg, shot) = (10.0, 2.0);
        let pegs = (side / (2.0 * peg + shot)) as usize + 1;
        let spacing = side / pegs as f32;
        let mut positions: Vec<[f32; 2]> =
            (0..pegs).map(|i| [200.0, (i as f32 + 0.5) * spacing]).collect();
        let mut velocities = vec![[0.0; 2]; pegs];
        for _ in 0..100 {
            positions.push([random.between(5.0, 180.0), random.between(5.0, side - 5.0)]);
            velocities.push(random.in_disc().map(|v| v * 1000.0 * shot / STEP as f32));
        }
        let radii = [vec![peg; pegs], vec![shot; 100]].concat();
        let mut particles = Particles::new(positions, velocities, radii, 1.0);
        particles.movable[..pegs].fill(false);
        let settings = WorldSettings {
            container: boxed([0.0; 2], [side; 2]),
            substeps: Some(1 + seed as usize % 3),
            ..WorldSettings::default()
        };
        let mut world = world_of(particles, settings);
        for step in 0..20 {
            run(&mut world, 1);
            let all = world.bodies().particles().unwrap();
            for (index, [x, y]) in all.positions[pegs..].iter().enumerate() {
                let inside = (shot..=side - shot).contains(x) && (shot..=side - shot).contains(y);
                assert!(inside, "seed {seed}, step {step}: shot {index} left at ({x}, {y})");
                assert!(
                    *x < 200.0,
                    "seed {seed}, step {step}: shot {index} is behind at ({x}, {y})"
                );
            }
        }
    }
}

/// The reader's own check, in float64.
fn is_inside(container: &Container, [x, y]: [f32; 2], radius: f32) -> bool {
    let [x, y, r] = [x, y, radius].map(f64::from);
    match *container {
        Container::None => true,
        Container::Box { min, max } => {
            let ([left, top], [right, bottom]) = (min.map(f64::from), max.map(f64::from));
            x - r >= left && y - r >= top && x + r <= right && y + r <= bottom
        }
        Container::Circle { center, radius } => {
            let [u, v] = center.map(f64::from);
            ((x - u).powi(2) + (y - v).powi(2)).sqrt() <= f64::from(radius) - r
        }
        Container::Torus { size: [w, h] } => {
            x >= 0.0 && y >= 0.0 && x < f64::from(w) && y < f64::from(h)
        }
    }
}

#[test]
fn nothing_leaves_a_container() {
    let containers = [
        boxed([-3.0, 1.0], [333.3, 301.7]),
        Container::Circle { center: [160.0, 150.5], radius: 170.1 },
        Container::Torus { size: [320.0, 300.0] },
    ];
    for container in containers {
        for gravity in [[0.0, 0.0], [300.0, 900.0]] {
            let mut particles = cloud(300, 300.0, 5.0, 300.0, 6);
            // Some slow, some at hundreds of radii a step, some of odd size.
            for row in 0..particles.len() {
                if row % 10 == 0 {
                    particles.velocities[row] = particles.velocities[row].map(|v| v * 200.0);
                }
                particles.radii[row] = 0.1 + (row % 7) as f32 * 1.3;
            }
            let settings = WorldSettings { container, gravity, ..WorldSettings::default() };
            let mut world = world_of(bouncing(particles, 0.9), settings);
            for step in 0..100 {
                run(&mut world, 1);
                let all = world.bodies().particles().unwrap();
                for (row, (&position, &radius)) in all.positions.iter().zip(&all.radii).enumerate()
                {
                    let inside = is_inside(&container, position, radius);
                    assert!(inside, "{container:?}, step {step}: {row} at {position:?}");
                }
            }
        }
    }
}

#[test]
fn a_flight_around_a_torus_comes_back() {
    for speed in [10.0, 500.0, 20_000.0] {
        let particles = discs(&[([50.0, 20.0], [speed, -speed])], 1.0);
        let container = Container::Torus { size: [100.0, 100.0] };
        let mut world = world_of(particles, inside(container));
        run_for(&mut world, 0.01, 1000);
        let [x, y] = world.bodies().particles().unwrap().positions[0];
        let gone = f64::from(speed) * 10.0;
        let expected = [(50.0 + gone).rem_euclid(100.0), (20.0 - gone).rem_euclid(100.0)];
        let off = (f64::from(x) - expected[0]).abs().max((f64::from(y) - expected[1]).abs());
        assert!(off < 0.1, "speed {speed}: at ({x}, {y}), not {expected:?}");
    }
}

#[test]
fn pairs_across_the_seams_of_a_torus_collide() {
    let size = [100.0f32, 80.0];
    for [a, b] in [
        [[4.0, 40.0], [96.0, 40.0]],
        [[50.0, 4.0], [50.0, 76.0]],
        [[4.0, 4.0], [96.0, 76.0]],
        [[4.0, 76.0], [96.0, 4.0]],
    ] {
        for first in [[a, b], [b, a]] {
            // Each flies straight at the nearest image of the other.
            let toward = |from: [f32; 2], to: [f32; 2]| {
                [0, 1].map(|k| {
                    let way = to[k] - from[k];
                    20.0 * (way - (way / size[k]).round() * size[k]).signum()
                        * (way != 0.0) as u8 as f32
                })
            };
            let velocities = vec![toward(first[0], first[1]), toward(first[1], first[0])];
            let particles = Particles::new(first.to_vec(), velocities.clone(), vec![2.0; 2], 1.0);
            let container = Container::Torus { size };
            let mut world = world_of(particles, inside(container));
            run(&mut world, 30);
            let after = world.bodies().particles().unwrap().velocities;
            for k in 0..2 {
                let swapped = (after[0][k] - velocities[1][k]).abs() < 1e-3;
                assert!(swapped, "{first:?}: {velocities:?} became {after:?}");
            }
        }
    }
}

#[test]
fn a_swirl_in_a_round_container_keeps_its_spin() {
    let mut world = jostle_scenes::find("orbit").unwrap().create(Some(500), 7).unwrap();
    let spin = |world: &World| -> f64 {
        let all = world.bodies().particles().unwrap();
        let each = all.positions.iter().zip(&all.velocities).zip(&all.masses);
        each.map(|((p, v), &m)| {
            let ([x, y], [u, w]) = (p.map(f64::from), v.map(f64::from));
            f64::from(m) * (x * w - y * u)
        })
        .sum()
    };
    let before = spin(&world);
    run(&mut world, 1000);
    // Positions are corrected where bounces overlap, so not to rounding.
    assert!((spin(&world) / before - 1.0).abs() < 0.01, "{before} became {}", spin(&world));
}

#[test]
fn a_free_flight_follows_gravity_and_drag() {
    let particles = discs(&[([0.0; 2], [30.0, 0.0])], 1.0);
    let settings = WorldSettings { gravity: [0.0, 100.0], drag: 0.5, ..WorldSettings::default() };
    let mut world = world_of(particles, settings);
    run_for(&mut world, 1e-3, 2000);
    let [[u, v]] = world.bodies().particles().unwrap().velocities[..] else {
        panic!("one particle")
    };
    // dv/dt = g − d v from v₀: v = g/d + (v₀ − g/d) exp(−d t).
    let fade = (-0.5f64 * 2.0).exp();
    assert!((f64::from(u) - 30.0 * fade).abs() < 0.01, "{u}");
    assert!((f64::from(v) - 200.0 * (1.0 - fade)).abs() < 0.05, "{v}");
}

#[test]
fn coincident_centres_separate() {
    for gravity in [[0.0, 0.0], [0.0, 500.0]] {
        let particles = bouncing(still(&[[200.0, 200.0]; 200], 5.0), 0.2);
        let settings = WorldSettings {
            gravity,
            container: boxed([0.0; 2], [400.0; 2]),
            ..WorldSettings::default()
        };
        let mut world = world_of(particles, settings);
        run(&mut world, 1200);
        let overlap = deepest_overlap(&world.bodies().particles().unwrap());
        assert!(overlap < 0.05, "gravity {gravity:?}: still {overlap} deep");
    }
}

#[test]
fn static_particles_stay() {
    let mut particles = cloud(100, 200.0, 6.0, 300.0, 8);
    particles.movable[..50].fill(false);
    particles.velocities[..50].fill([0.0; 2]);
    let places = particles.positions[..50].to_vec();
    let settings = WorldSettings {
        gravity: [0.0, 900.0],
        container: boxed([0.0; 2], [200.0; 2]),
        ..WorldSettings::default()
    };
    let mut world = world_of(particles, settings);
    run(&mut world, 300);
    assert_eq!(world.bodies().particles().unwrap().positions[..50], places);
    assert!(world.bodies().particles().unwrap().velocities[..50].iter().all(|v| *v == [0.0; 2]));
}

/// What a disc meets at y = 0.
#[derive(Clone, Copy, Debug)]
enum Other {
    Disc,
    Wall,
    Side,
}

/// A disc of radius 1 meets something in the origin at a speed of 0.6 and slides along it. Both have coefficients of
/// restitution and of friction. Returns the velocity of the disc, and the number of impacts.
fn after_impact(own: [f32; 2], other: Other, of: [Option<f32>; 2], gap: f32) -> ([f32; 2], u64) {
    let start = [-4.0 * gap / 0.6, 1.0 + gap];
    let mut all = discs(&[(start, [4.0, -0.6]), ([0.0, -1.0], [0.0; 2])], 1.0);
    all.movable[1] = false;
    all.restitution = vec![own[0], of[0].unwrap_or(own[0])];
    let friction = [own[1], of[1].unwrap_or(own[1])];
    all.spins = friction.map(|friction| Spin { friction, ..Spin::default() }).to_vec();
    // So little that it only decides which contacts may rest.
    let mut settings = WorldSettings { gravity: [0.0, -1e-3], ..WorldSettings::default() };
    let surface = Surface { restitution: of[0], friction: of[1] };
    let mut walls = Vec::new();
    match other {
        Other::Disc => {}
        Other::Wall => walls.push(Wall { surface, ..wall([-90.0, 0.0], [90.0, 0.0]) }),
        Other::Side => {
            settings.container = boxed([-90.0, 0.0], [90.0; 2]);
            settings.sides.0[2] = surface;
        }
    }
    if !matches!(other, Other::Disc) {
        all.retain(|row| row == 0);
    }
    let mut world = walled(all, walls, settings);
    world.begin_record().unwrap();
    run(&mut world, 4);
    let Collisions { pairs, walls } = world.record().totals().collisions;
    (world.bodies().velocities().unwrap()[0], pairs + walls)
}

#[test]
fn a_contact_has_the_geometric_mean_of_the_coefficients_of_both() {
    let mean = |own: f32, of: Option<f32>| of.map_or(own, |of| (own * of).sqrt());
    let others = [[None, None], [Some(0.125), None], [None, Some(0.05)]];
    let others = others.into_iter().chain([[Some(0.0); 2], [Some(1.0); 2], [Some(0.3); 2]]);
    let cases = others.flat_map(|of| [[0.5, 0.2], [1.0, 0.4], [0.8, 0.0]].map(|own| (own, of)));
    for (own, of) in cases {
        for other in [Other::Disc, Other::Wall, Other::Side] {
            // Where they touch at the beginning, the contact is solved as those that rest.
            for (gap, impacts) in [(0.03, 1), (0.0, 0)] {
                let (found, count) = after_impact(own, other, of, gap);
                let [restitution, friction] = [0, 1].map(|k| mean(own[k], of[k]));
                let slower = friction * (1.0 + restitution) * 0.6;
                let expected = [4.0 - slower, restitution * 0.6];
                let error = (found[0] - expected[0]).abs().max((found[1] - expected[1]).abs());
                let at = format!("{own:?} {other:?} {of:?} {gap}");
                assert!(error < 1e-3, "{at}: {found:?} {expected:?}");
                assert_eq!(count, impacts, "{at}");
            }
        }
    }
}

#[test]
fn one_restitution_of_all_is_as_one_of_each() {
    let after = |restitution: f32, set: &dyn Fn(&mut World)| {
        let settings =
            WorldSettings { gravity: [0.0, -300.0], ..inside(boxed([0.0; 2], [200.0; 2])) };
        let mut world = world_of(bouncing(cloud(200, 200.0, 5.0, 100.0, 3), restitution), settings);
        set(&mut world);
        run(&mut world, 120);
        world.snapshot().unwrap()
    };
    let set = |world: &mut World, ids: &[Id], restitution| {
        let restitution = Some(restitution);
        world.set(ids, &Changes { restitution, ..Changes::default() }).unwrap();
    };
    let expected = after(0.5, &|_| ());
    let ids: Vec<Id> = (0..200).collect();
    assert!(after(1.0, &|world| set(world, &ids, Each::One(0.5))) == expected);
    assert!(after(1.0, &|world| set(world, &ids, Each::Rows(vec![0.5; 200]))) == expected);
    let one_by_one =
        |world: &mut World| ids.iter().for_each(|&id| set(world, &[id], Each::One(0.5)));
    assert!(after(1.0, &one_by_one) == expected);
    assert!(after(1.0, &|_| ()) != expected);
}

#[test]
fn contacts_tell_what_touched() {
    let particles = Particles::new(
        vec![[30.0, 0.0], [0.0; 2]],
        vec![[0.0; 2], [60.0, 0.0]],
        vec![10.0; 2],
        1.0,
    );
    let mut world = world_of(particles, WorldSettings::default());
    let mut touches = Vec::new();
    for _ in 0..30 {
        run(&mut world, 1);
        touches.extend(world.contacts().unwrap());
    }
    assert_eq!(touches.len(), 1, "{touches:?}");
    assert_eq!(touches[0].pair, [0, 1]);
    assert_eq!(touches[0].normal, [-1.0, 0.0]);
}

#[test]
fn a_world_without_particles_steps() {
    let mut world = world_of(Particles::default(), WorldSettings::default());
    run(&mut world, 10);
    assert_eq!((world.len(), world.momentum()), (0, [0.0; 2]));
    assert!((world.time() - 10.0 * STEP).abs() < 1e-12);
    let one_thread = Settings { threads: Some(1), ..Settings::default() };
    world.configure(WorldSettings { tree: one_thread, ..*world.settings() }).unwrap();
    run(&mut world, 1);
}

#[test]
fn removing_particles_keeps_the_contacts_of_the_others() {
    let positions = vec![[0.0, 0.0], [1.5, 0.0], [9.0, 0.0], [10.5, 0.0]];
    let particles = still(&positions, 1.0);
    let mut world = world_of(particles, WorldSettings::default());
    run(&mut world, 1);
    let pairs =
        |world: &World| world.contacts().unwrap().iter().map(|t| t.pair).collect::<Vec<_>>();
    assert_eq!(pairs(&world), [[0, 1], [2, 3]]);
    world.remove(&[1]).unwrap();
    assert_eq!(pairs(&world), [[2, 3]]);
    world.add(still(&[[50.0; 2]], 1.0)).unwrap();
    assert_eq!(pairs(&world), [[2, 3]]);
    run(&mut world, 1);
    assert_eq!(pairs(&world), [[2, 3]]);
    assert_eq!(world.bodies().radii().unwrap(), [1.0; 4]);
}

#[test]
fn a_pile_rests_on_while_its_top_is_taken_away() {
    let mut world = jostle_scenes::find("pile").unwrap().create(Some(300), 0).unwrap();
    run(&mut world, 900);
    for _ in 0..50 {
        let all = world.bodies().positions().unwrap();
        let top = (0..all.len()).min_by(|&a, &b| all[a][1].total_cmp(&all[b][1])).unwrap();
        world.remove(&[world.bodies().ids().unwrap()[top]]).unwrap();
        run(&mut world, 2);
        let speeds = world.bodies().velocities().unwrap().into_iter().map(|v| v[0].hypot(v[1]));
        let speed = speeds.sum::<f32>() / world.len() as f32;
        assert!(speed < 5.0, "{} left: mean speed {speed}", world.len());
    }
}

#[test]
fn a_train_keeps_its_order_when_it_hits_a_wall() {
    for (count, gap) in [(3, 1.0f32), (10, 0.1), (50, 1.0), (50, 30.0)] {
        for radii_a_step in [10.0, 100.0, 1000.0] {
            for (restitution, substeps) in [(0.0, 1), (0.5, 4), (1.0, 2)] {
                let place = |i: usize| [2.0 + i as f32 * (2.0 + gap), 50.0];
                let speed = radii_a_step / STEP as f32;
                let positions: Vec<[f32; 2]> = (0..count).map(place).collect();
                let wall = positions[count - 1][0] + 20.0;
                let particles =
                    Particles::new(positions, vec![[speed, 0.0]; count], vec![1.0; count], 1.0);
                let container = boxed([0.0; 2], [wall, 100.0]);
                let settings = WorldSettings {
                    substeps: Some(substeps),
                    container,
                    ..WorldSettings::default()
                };
                let mut world = world_of(bouncing(particles, restitution), settings);
                for step in 0..8 {
                    run(&mut world, 1);
                    // Side by side on a line they can only pass by passing through.
                    let x: Vec<f32> =
                        world.bodies().positions().unwrap().iter().map(|p| p[0]).collect();
                    let passed = x.windows(2).any(|pair| pair[1] < pair[0] - 0.1);
                    assert!(!passed, "{count} gap {gap} at {radii_a_step}, step {step}: {x:?}");
                }
            }
        }
    }
}

#[test]
fn a_heavy_disc_pushes_nothing_through_a_curtain() {
    for (heavy, seed) in [(60.0f32, 1), (20.0, 2)] {
        let mut random = Random::new(seed);
        let (side, peg) = (400.0, 10.0);
        let pegs = 20;
        let mut positions: Vec<[f32; 2]> =
            (0..pegs).map(|i| [250.0, (i as f32 + 0.5) * 20.0]).collect();
        let mut velocities = vec![[0.0; 2]; pegs];
        let mut radii = vec![peg; pegs];
        positions.push([80.0, 200.0]);
        velocities.push([3000.0, 0.0]);
        radii.push(heavy);
        for _ in 0..300 {
            positions.push([random.between(150.0, 235.0), random.between(5.0, 395.0)]);
            velocities.push([0.0; 2]);
            radii.push(1.0);
        }
        let mut particles = Particles::new(positions, velocities, radii, 1.0);
        particles.movable[..pegs].fill(false);
        particles.masses[pegs] = 1e5;
        let settings =
            WorldSettings { container: boxed([0.0; 2], [side; 2]), ..WorldSettings::default() };
        let mut world = world_of(particles, settings);
        // It strikes the curtain in the third step, then again every five to ten.
        for step in 0..60 {
            run(&mut world, 1);
            let behind =
                world.bodies().positions().unwrap()[pegs..].iter().filter(|p| p[0] > 250.0).count();
            assert_eq!(behind, 0, "radius {heavy}, step {step}");
        }
    }
}

#[test]
fn a_refused_step_leaves_the_world_as_it_was() {
    let particles = Particles::new(
        vec![[90.0, 0.0], [1.5, 0.0], [0.0, 0.0]],
        vec![[1e9, 0.0], [0.0; 2], [0.0; 2]],
        vec![1.0; 3],
        1.0,
    );
    let mut world = world_of(particles, WorldSettings::default());
    run_for(&mut world, 1e-9, 1);
    let (hash, contacts, time) =
        (world.state_hash().unwrap(), world.contacts().unwrap(), world.time());
    for dt in [1e30, f64::NAN, 0.0, -1.0, f64::INFINITY] {
        let error = world.step(dt, 1).unwrap_err().to_string();
        assert!(error.starts_with("dt is "), "{error}");
        assert_eq!(
            (world.state_hash().unwrap(), world.contacts().unwrap(), world.time()),
            (hash, contacts.clone(), time)
        );
    }
    let torus = Container::Torus { size: [100.0; 2] };
    world.configure(WorldSettings { container: torus, ..*world.settings() }).unwrap();
    assert!(world.step(1.0, 1).unwrap_err().to_string().contains("times the period"));
}

#[test]
fn signed_zeros_do_not_let_the_order_of_adding_show() {
    let make = |velocities: [[f32; 2]; 2]| {
        let all = Particles::new(vec![[0.0; 2]; 2], velocities.to_vec(), vec![1.0; 2], 1.0);
        let mut world = world_of(all, WorldSettings::default());
        run(&mut world, 20);
        world.bodies().positions().unwrap()
    };
    let (plus, minus) = ([0.0, 0.0], [-0.0, 0.0]);
    let [a, b] = make([plus, minus])[..] else { panic!("two particles") };
    assert_eq!(make([minus, plus]), [b, a]);
    assert_ne!(a, b);
}

#[test]
fn an_elastic_gas_in_free_fall_keeps_its_inner_energy() {
    // Gravity is the same for all, so it cannot change how they move against each other.
    let settings = WorldSettings { gravity: [0.0, 900.0], ..WorldSettings::default() };
    let mut world = world_of(cloud(400, 400.0, 8.0, 600.0, 9), settings);
    let inner = |world: &World| -> f64 {
        let velocities = world.bodies().velocities().unwrap();
        let count = velocities.len() as f64;
        let mean = [0, 1].map(|k| velocities.iter().map(|v| f64::from(v[k])).sum::<f64>() / count);
        let square = |v: &[f32; 2]| [0, 1].map(|k| (f64::from(v[k]) - mean[k]).powi(2));
        velocities.iter().map(square).map(|[x, y]| x + y).sum::<f64>()
    };
    let before = inner(&world);
    run(&mut world, 60);
    let kept = inner(&world) / before;
    assert!((0.97..1.001).contains(&kept), "kept {kept}");
}

/// Positions are stored in float32 with a residual, so slow discs move and collide far from the
/// origin as they do near it.
#[test]
fn slow_discs_far_from_the_origin_collide_as_near_it() {
    for (origin, speed) in [(1e4f32, 0.05f32), (-1e4, 0.01), (1e6, 0.05)] {
        for container in [Container::None, Container::Torus { size: [4.0 * origin.abs(); 2] }] {
            let discs = Particles::new(
                vec![[origin, -origin], [origin + 3.0, -origin]],
                vec![[speed, 0.0], [0.0; 2]],
                vec![1.0; 2],
                1.0,
            );
            let mut world = world_of(discs, inside(container));
            // They touch after 1/speed seconds; then the second disc moves alone.
            let steps = (120.0 / speed) as usize;
            run(&mut world, steps);
            let time = world.time();
            let inside = container.period().wrap([origin, -origin]);
            let expected = [1.0, 2.0 + f64::from(speed) * time];
            for (k, expected) in expected.into_iter().enumerate() {
                let [x, y] = world.bodies().positions().unwrap()[k];
                let found = f64::from(x) - f64::from(inside[0]);
                let ulp = f64::from(origin.abs()) * 2f64.powi(-22);
                assert!((found - expected).abs() < ulp, "{origin} {speed} {container:?}: {found}");
                assert_eq!(y, inside[1]);
            }
            assert_eq!(world.bodies().velocities().unwrap(), [[0.0; 2], [speed, 0.0]]);
        }
    }
}

#[test]
fn a_slow_disc_slides_along_a_floor_far_from_the_origin() {
    let disc = bouncing(discs(&[([1e6, 9.0], [0.05, 0.0])], 1.0), 0.5);
    let container = boxed([1e6 - 10.0, -10.0], [1e6 + 50.0, 10.0]);
    let settings = WorldSettings { container, gravity: [0.0, 10.0], ..Default::default() };
    let mut world = world_of(disc, settings);
    run(&mut world, 3600);
    let [x, y] = world.bodies().positions().unwrap()[0];
    assert!((f64::from(x) - 1e6 - 0.05 * world.time()).abs() < 0.07, "{x}");
    assert_eq!(y, 9.0);
}

#[test]
fn points_rest_and_bounce_on_a_floor_in_bounded_work() {
    for restitution in [0.5, 0.9, 1.0] {
        let mut points = Particles::new(
            vec![[100.0, 9.0], [101.0, 10.0], [10.0, 10.0]],
            vec![[0.1, 0.0], [0.0, -1e-9], [0.0, 1e-9]],
            vec![0.0; 3],
            1.0,
        );
        points.masses = vec![1.0; 3];
        let container = boxed([10.0, -10.0], [110.0, 10.0]);
        let gravity = [0.0, 10.0];
        let mut world = world_of(
            bouncing(points, restitution),
            WorldSettings { container, gravity, ..Default::default() },
        );
        for _ in 0..60 {
            run(&mut world, 1);
            assert_eq!(world.stats().unresolved, 0, "{restitution}");
        }
    }
}

/// Two discs that touch and collide as a sub-step begins, far from all else. Where contacts may rest,
/// too, each then falls along its parabola.
#[test]
fn discs_that_collide_as_a_sub_step_begins_fall_along_their_parabolas() {
    let (dt, gravity) = (0.1, -10.0);
    for drag in [0.0, 2.0] {
        let [positions, velocities] = [[[0.0, 50.0], [0.0, 48.0]], [[3.0, -8.0], [0.0, 0.0]]];
        let discs = Particles::new(positions.to_vec(), velocities.to_vec(), vec![1.0; 2], 1.0);
        let mut world = world_of(
            bouncing(discs, 0.5),
            WorldSettings {
                container: boxed([-100.0, 0.0], [100.0, 100.0]),
                gravity: [0.0, gravity as f32],
                drag: drag as f32,
                substeps: Some(1),
                ..Default::default()
            },
        );
        run_for(&mut world, dt, 1);
        // Of the speed 8 along the normal 3/4 go over to the lower disc.
        for (place, [u, v]) in [[3.0, -2.0], [0.0, -6.0]].into_iter().enumerate() {
            let time = if drag == 0.0 { dt } else { (1.0 - (-drag * dt).exp()) / drag };
            let fall = if drag == 0.0 { 0.5 * dt * dt } else { (dt - time) / drag };
            let [x, y] = world.bodies().positions().unwrap()[place].map(f64::from);
            let from = positions[place].map(f64::from);
            assert!((x - from[0] - u * time).abs() < 1e-5, "{drag}: {x}");
            assert!((y - from[1] - v * time - gravity * fall).abs() < 1e-5, "{drag}: {y}");
            let speed = f64::from(world.bodies().velocities().unwrap()[place][1]);
            let expected = v * (-drag * dt).exp() + gravity * time;
            assert!((speed - expected).abs() < 1e-5, "{drag}: {speed} {expected}");
        }
    }
}
