//! The gates of forces, each against an answer that does not come from the world:
//! analysis, conservation laws, sums in float64.

use std::f64::consts::PI;

use jostle_base::{Id, Method};
use jostle_scenes::random::Random;
use jostle_world::forces::{
    self, Attractor, ForceInput, Gravitation, Influences, Law, Pole, Spring, Springs, Thermostat,
};
use jostle_world::{Container, Influence, Particles, World, WorldSettings};

use crate::common::worlds::{
    boxed, falling, forced, gathered, inside, restored, run, run_for, world_of,
};

fn particles(positions: Vec<[f32; 2]>, velocities: Vec<[f32; 2]>, masses: Vec<f32>) -> Particles {
    let len = positions.len();
    let mut all = Particles::new(positions, velocities, vec![0.01; len], 1.0);
    all.masses = masses;
    all
}

fn distance(a: [f32; 2], b: [f32; 2]) -> f64 {
    let [x, y] = [0, 1].map(|k| f64::from(a[k]) - f64::from(b[k]));
    (x * x + y * y).sqrt()
}

fn gravitation(theta: f32) -> Gravitation {
    Gravitation { g: 1.0, softening: 0.0, theta }
}

fn spring(pair: [Id; 2], length: f32, stiffness: f32) -> Spring {
    Spring { pair, length, stiffness, damping: 0.0, max_stretch: f32::INFINITY }
}

fn attractor(pole: Pole, strength: f32, law: Law) -> Influence {
    Influence::Attractor(Attractor { pole, strength, law })
}

// ---- gravitation ---------------------------------------------------------------------------------

fn uniform(count: usize, seed: u64) -> Vec<[f32; 2]> {
    let mut random = Random::new(seed);
    (0..count).map(|_| [random.between(0.0, 100.0), random.between(0.0, 100.0)]).collect()
}

fn clustered(count: usize, seed: u64) -> Vec<[f32; 2]> {
    let mut random = Random::new(seed);
    let centers = uniform(10, seed + 1);
    let around = |random: &mut Random| {
        let step = random.between(0.0, 1.0);
        [random.between(-1.0, 1.0) * step * step, random.between(-1.0, 1.0) * step * step]
    };
    let mut at = |row: usize| {
        let [x, y] = around(&mut random);
        [centers[row % 10][0] + 3.0 * x, centers[row % 10][1] + 3.0 * y]
    };
    (0..count).map(&mut at).collect()
}

fn mixed_masses(count: usize) -> Vec<f32> {
    let mut random = Random::new(3);
    (0..count).map(|_| 10f32.powi(random.between(-2.0, 3.0) as i32)).collect()
}

fn accelerations(
    gravitation: Gravitation,
    positions: &[[f32; 2]],
    masses: &[f32],
    container: Container,
    threads: Option<usize>,
) -> Vec<[f32; 2]> {
    let radii = vec![0.0; masses.len()];
    let (velocities, rows) =
        (&vec![[0.0; 2]; radii.len()], &(0..radii.len() as u32).collect::<Vec<_>>());
    let (radii, places, seconds, method) = (&radii[..], &[][..], 0.0, Method::Quadtree);
    let bodies = ForceInput {
        positions,
        velocities,
        masses,
        radii,
        kinds: &[],
        movable: &[],
        rows,
        own_rows: u32::MAX,
        indices: places,
        container,
        seconds,
        method,
        threads,
        extent: None,
    };
    let mut found = Vec::new();
    let influences = Influences::from(vec![Influence::Gravitation(gravitation)]);
    influences.accelerate(&bodies, &mut forces::Scratch::default(), &mut found).unwrap();
    found
}

/// The sum over all, in float64.
fn exact(positions: &[[f32; 2]], masses: &[f32], softening: f64) -> Vec<[f64; 2]> {
    let pull = |at: &[f32; 2]| {
        let mut sum = [0.0; 2];
        for (from, &mass) in positions.iter().zip(masses) {
            let [x, y] = [0, 1].map(|k| f64::from(from[k]) - f64::from(at[k]));
            let square = x * x + y * y + softening * softening;
            if square > 0.0 {
                let factor = f64::from(mass) / (square * square.sqrt());
                sum = [sum[0] + x * factor, sum[1] + y * factor];
            }
        }
        sum
    };
    positions.iter().map(pull).collect()
}

/// Root of the mean square of the error, over that of the acceleration.
fn rms(found: &[[f32; 2]], exact: &[[f64; 2]]) -> f64 {
    let square = |[x, y]: [f64; 2]| x * x + y * y;
    let errors =
        found.iter().zip(exact).map(|(a, b)| square([0, 1].map(|k| f64::from(a[k]) - b[k])));
    let all: f64 = exact.iter().map(|&a| square(a)).sum();
    (errors.sum::<f64>() / all).sqrt()
}

/// Median of the errors, each over the acceleration of its own body.
fn median_error(found: &[[f32; 2]], exact: &[[f64; 2]]) -> f64 {
    let length = |[x, y]: [f64; 2]| (x * x + y * y).sqrt();
    let pairs = found.iter().zip(exact);
    let mut all: Vec<f64> =
        pairs.map(|(a, b)| length([0, 1].map(|k| f64::from(a[k]) - b[k])) / length(*b)).collect();
    all.sort_by(f64::total_cmp);
    all[all.len() / 2]
}

#[test]
fn gravitation_is_within_a_percent_of_the_sum_over_all() {
    let count = 5000;
    for (name, positions) in [("uniform", uniform(count, 1)), ("clustered", clustered(count, 2))] {
        for (kind, masses) in [("equal", vec![1.0; count]), ("mixed", mixed_masses(count))] {
            for softening in [0.0, 0.5] {
                let gravitation = Gravitation { softening, ..gravitation(0.5) };
                let found = accelerations(gravitation, &positions, &masses, Container::None, None);
                let exact = exact(&positions, &masses, f64::from(softening));
                let (error, median) = (rms(&found, &exact), median_error(&found, &exact));
                println!("{name}, {kind}, softening {softening}: {error:.5}, median {median:.5}");
                assert!(error < 0.01 && median < 0.02, "{name}, {kind}, {softening}: {error}");
            }
        }
    }
}

#[test]
fn theta_0_and_few_bodies_are_the_sum_over_all() {
    for (count, theta) in [(2, 0.5), (300, 1.0), (3000, 0.0)] {
        let (positions, masses) = (clustered(count, 5), mixed_masses(count));
        let gravitation = Gravitation { softening: 0.01, ..gravitation(theta) };
        let found = accelerations(gravitation, &positions, &masses, Container::None, None);
        let error = rms(&found, &exact(&positions, &masses, f64::from(0.01f32)));
        assert!(error < 1e-6, "{count} bodies: {error}");
    }
}

#[test]
fn on_a_torus_everything_pulls_from_its_nearest_image() {
    let (count, side) = (3000, 100.0f32);
    let (positions, masses) = (uniform(count, 8), mixed_masses(count));
    let torus = Container::Torus { size: [side; 2] };
    let tree = accelerations(gravitation(0.5), &positions, &masses, torus, None);
    let direct = accelerations(gravitation(0.0), &positions, &masses, torus, None);
    let direct: Vec<[f64; 2]> = direct.iter().map(|a| a.map(f64::from)).collect();
    let error = rms(&tree, &direct);
    assert!(error < 0.01, "{error}");
    let pair = [[1.0, 50.0], [99.0, 50.0]];
    let found = accelerations(gravitation(0.5), &pair, &[1.0; 2], torus, None);
    assert_eq!(found, [[-0.25, 0.0], [0.25, 0.0]]);
}

#[test]
fn coincident_and_absurd_bodies_leave_finite_accelerations() {
    let coincident = vec![[3.0, 4.0]; 2000];
    let found =
        accelerations(gravitation(0.5), &coincident, &vec![1.0; 2000], Container::None, None);
    assert!(found.iter().all(|a| *a == [0.0; 2]));
    let near = [[0.0, 0.0], [1e-30, 0.0], [1e18, -1e18], [1e-20, 1e18]];
    let found = accelerations(gravitation(0.5), &near, &[1e30; 4], Container::None, None);
    assert!(found.iter().flatten().all(|v| v.is_finite()), "{found:?}");
}

/// How far two bodies are from their start after a hundred revolutions, in axes of their orbit.
fn orbit_error(softer: f32, angle: f32) -> f64 {
    // Masses 3 and 1 at distance 4. Slower than in a circle, where the speed of one against the
    // other is √(4 / 4), the orbit is an ellipse: 1/a = 2/d − v²/GM.
    let speed = softer;
    let axis = 1.0 / (2.0 / 4.0 - f64::from(speed * speed) / 4.0);
    // In a circle the period is 2π √(4³ / (3 + 1)).
    let period = 2.0 * PI * 4.0 * (axis / 4.0).powf(1.5);
    let turned =
        |[x, y]: [f32; 2]| [x * angle.cos() - y * angle.sin(), x * angle.sin() + y * angle.cos()];
    let start = [[-1.0, 0.0], [3.0, 0.0]].map(turned).to_vec();
    let velocities = [[0.0, -0.25 * speed], [0.0, 0.75 * speed]].map(turned).to_vec();
    let bodies = particles(start.clone(), velocities, vec![3.0, 1.0]);
    let forces = vec![Influence::Gravitation(gravitation(0.5))];
    let mut world = forced(bodies, forces, WorldSettings::default());
    let steps = 250 * 100; // of four sub-steps
    run_for(&mut world, 100.0 * period / steps as f64, steps);
    assert!(world.momentum().iter().all(|p| p.abs() < 1e-4), "{:?}", world.momentum());
    distance(world.bodies().positions().unwrap()[1], start[1]) / axis
}

#[test]
fn two_bodies_close_their_orbit_after_a_hundred_revolutions() {
    // In exact arithmetic these steps are off by 0.006 in a circle and 0.010 in the ellipse. The
    // rounding of the state to float32 adds about as much, more in some directions than in others.
    for softer in [1.0f32, 0.8] {
        let errors = [0.0, 0.3, 0.6].map(|angle| orbit_error(softer, angle));
        let mean = errors.iter().sum::<f64>() / 3.0;
        println!("orbit with speed {softer}: off by {mean:.5} of its axis, {errors:.5?}");
        assert!(mean < 0.015, "{errors:?}");
    }
}

#[test]
fn momentum_is_kept() {
    let count = 3000;
    let mut bodies = particles(clustered(count, 4), vec![[0.0; 2]; count], mixed_masses(count));
    bodies.velocities = uniform(count, 6).iter().map(|v| v.map(|v| v * 0.01)).collect();
    let ties = (0..2000).map(|i| spring([i, i + 1], 0.5, 50.0)).collect();
    let force = Gravitation { g: 0.01, softening: 0.05, theta: 0.5 };
    let forces = vec![Influence::Gravitation(force), Influence::Springs(Springs(ties))];
    let scale: f64 = {
        let pairs = bodies.masses.iter().zip(&bodies.velocities);
        pairs.map(|(&m, v)| f64::from(m) * f64::from(v[0].hypot(v[1]))).sum()
    };
    let mut world = forced(bodies, forces, WorldSettings::default());
    // The discs overlap at first, and one that is hit too often stands still for the rest of a step.
    let mut steps = 0;
    let mut before = world.momentum();
    while steps < 50 {
        run_for(&mut world, 0.002, 1);
        steps = if world.stats().unresolved > 0 { 0 } else { steps + 1 };
        assert!(world.time() < 5.0, "discs are hit too often");
        if steps == 0 {
            before = world.momentum();
        }
    }
    let after = world.momentum();
    let error = (0..2).map(|k| (after[k] - before[k]).abs()).fold(0.0, f64::max) / scale;
    println!("momentum after 50 steps: off by {error:e}");
    assert!(error < 1e-6, "{before:?} became {after:?}");
}

// ---- attractors ----------------------------------------------------------------------------------

#[test]
fn a_harmonic_attractor_swings_with_its_period() {
    let bodies = particles(vec![[3.0, 1.0]], vec![[0.0, 0.0]], vec![7.0]);
    let pole = Pole::Point([1.0, 1.0]);
    let mut world =
        forced(bodies, vec![attractor(pole, 4.0, Law::Harmonic)], WorldSettings::default());
    run_for(&mut world, PI / 2.0 / 100.0, 100); // half a period of 2π / √4
    assert!(
        distance(world.bodies().positions().unwrap()[0], [-1.0, 1.0]) < 1e-3,
        "{:?}",
        world.bodies().positions().unwrap()
    );
    run_for(&mut world, PI / 2.0 / 100.0, 100);
    assert!(
        distance(world.bodies().positions().unwrap()[0], [3.0, 1.0]) < 1e-3,
        "{:?}",
        world.bodies().positions().unwrap()
    );
}

#[test]
fn an_inverse_square_attractor_holds_an_orbit() {
    let bodies = particles(vec![[2.0, 0.0]], vec![[0.0, 1.0]], vec![1.0]);
    let pole = Pole::Point([0.0, 0.0]);
    let forces = vec![attractor(pole, 2.0, Law::InverseSquare)];
    let mut world = forced(bodies, forces, WorldSettings::default());
    run_for(&mut world, 4.0 * PI / 200.0, 200 * 10);
    assert!(
        distance(world.bodies().positions().unwrap()[0], [2.0, 0.0]) < 0.02,
        "{:?}",
        world.bodies().positions().unwrap()
    );
}

#[test]
fn nothing_is_flung_out_of_an_inverse_square_attractor() {
    let mut bodies = particles(vec![[1.0, 0.0]], vec![[0.0, 0.0]], vec![1.0]);
    bodies.radii = vec![0.1];
    let forces = vec![attractor(Pole::Point([0.0, 0.0]), 1.0, Law::InverseSquare)];
    let mut world = forced(bodies, forces, WorldSettings::default());
    for _ in 0..500 {
        run_for(&mut world, 0.01, 1);
        assert!(
            distance(world.bodies().positions().unwrap()[0], [0.0, 0.0]) < 1.05,
            "{:?}",
            world.bodies().positions().unwrap()
        );
    }
}

#[test]
fn an_attractor_follows_its_particle_and_goes_with_it() {
    let bodies = particles(
        vec![[50.0, 50.0], [0.0, 0.0], [1.0, 0.0]],
        vec![[0.0; 2], [1.0, 0.0], [1.0, 0.0]],
        vec![1.0; 3],
    );
    let mut world = forced(
        bodies,
        vec![
            attractor(Pole::Particle(1), 1.0, Law::Harmonic),
            attractor(Pole::Particle(2), 1.0, Law::Harmonic),
        ],
        WorldSettings::default(),
    );
    world.remove(&[0]).expect("it is there");
    let poles = [1, 2].map(|id| attractor(Pole::Particle(id), 1.0, Law::Harmonic));
    assert_eq!(world.forces().unwrap(), poles);
    world.remove(&[2]).expect("it is there");
    assert_eq!(world.forces().unwrap(), &poles[..1]);
    run_for(&mut world, 0.5, 2);
    assert_eq!(world.bodies().positions().unwrap(), [[1.0, 0.0]]); // its own attractor does not move it
}

// ---- springs -------------------------------------------------------------------------------------

/// Seconds between the first two upward crossings of `middle` by the end's x.
fn period(world: &mut World, row: usize, middle: f32, dt: f64) -> f64 {
    let mut crossings = Vec::new();
    let mut last = world.bodies().positions().unwrap()[row][0];
    while crossings.len() < 11 {
        run_for(world, dt, 1);
        let now = world.bodies().positions().unwrap()[row][0];
        if last < middle && now >= middle {
            crossings.push(world.time() - dt * f64::from((now - middle) / (now - last)));
        }
        last = now;
        assert!(world.time() < 1e4, "it does not swing");
    }
    (crossings[10] - crossings[0]) / 10.0
}

#[test]
fn a_spring_swings_with_its_period() {
    for (stiffness, mass) in [(1.0f32, 1.0f32), (40.0, 2.5), (1e4, 1.0)] {
        let expected = 2.0 * PI * f64::from(mass / stiffness).sqrt();
        let dt = expected / 37.3;
        for free in [false, true] {
            let mut bodies =
                particles(vec![[0.0, 0.0], [2.2, 0.0]], vec![[0.0; 2]; 2], vec![3.0 * mass, mass]);
            bodies.movable[0] = free;
            let forces = vec![Influence::Springs(Springs(vec![spring([0, 1], 2.0, stiffness)]))];
            let mut world = forced(bodies, forces, WorldSettings::default());
            // Two free ends swing as one of the reduced mass does.
            let expected = if free { expected * 0.75f64.sqrt() } else { expected };
            let middle = if free { 1.5 * 0.1 + 2.0 - 0.1 } else { 2.0 };
            let found = period(&mut world, 1, middle, dt);
            println!("k {stiffness}, m {mass}, free {free}: {found:.6} for {expected:.6}");
            assert!((found / expected - 1.0).abs() < 0.01, "{found} instead of {expected}");
        }
    }
}

#[test]
fn stiff_springs_stay_bounded() {
    for stiffness in [1e4f32, 1e8, 1e14] {
        // A cloth of 10 × 10, and a blow to its corner.
        let at = |i: u32| [(i % 10) as f32, (i / 10) as f32];
        let mut bodies = particles((0..100).map(at).collect(), vec![[0.0; 2]; 100], vec![1.0; 100]);
        bodies.radii = vec![0.0; 100]; // nothing touches: the springs alone
        bodies.velocities[0] = [30.0, 10.0];
        let right = (0..100).filter(|i| i % 10 < 9).map(|i| spring([i, i + 1], 1.0, stiffness));
        let down = (0..90).map(|i| spring([i, i + 10], 1.0, stiffness));
        let springs = right.chain(down).map(|tie| Spring { damping: 1e-3 * stiffness, ..tie });
        let mut world = forced(
            bodies,
            vec![Influence::Springs(Springs(springs.collect()))],
            WorldSettings::default(),
        );
        let energy = world.kinetic_energy();
        run(&mut world, 600);
        assert!(world.kinetic_energy() < energy, "{stiffness}: {}", world.kinetic_energy());
        let momentum = world.momentum();
        assert!((momentum[0] - 30.0).abs() < 0.01 && (momentum[1] - 10.0).abs() < 0.01);
        let [a, b] =
            [world.bodies().positions().unwrap()[0], world.bodies().positions().unwrap()[99]];
        assert!(distance(a, b) < 40.0, "{stiffness}: {a:?} {b:?}");
    }
}

#[test]
fn a_spring_breaks_where_it_is_stretched_too_far() {
    for (speed, breaks) in [(0.9f32, false), (1.1, true)] {
        let mut bodies =
            particles(vec![[0.0, 0.0], [1.0, 0.0]], vec![[0.0; 2], [speed, 0.0]], vec![1.0; 2]);
        bodies.movable[0] = false;
        // It swings out by v √(m/k).
        let tie = Spring { max_stretch: 0.5, ..spring([0, 1], 1.0, 4.0) };
        let mut world =
            forced(bodies, vec![Influence::Springs(Springs(vec![tie]))], WorldSettings::default());
        run_for(&mut world, 0.01, 1000);
        assert_eq!(
            world.forces().unwrap(),
            [Influence::Springs(Springs(if breaks { vec![] } else { vec![tie] }))]
        );
        assert_eq!(world.bodies().positions().unwrap()[1][0] > 2.0, breaks);
    }
}

/// Stiff springs are solved with resting contacts, in several sub-steps. Without them elastic discs that fall
/// need one.
#[test]
fn a_step_does_not_depend_on_springs_that_were_removed() {
    let all = particles(
        vec![[0.0, 5.0], [1.0, 5.0], [0.3, 1.0]],
        vec![[0.0; 2], [3.0, 0.0], [0.0, 2.0]],
        vec![1.0; 3],
    );
    let tie = Influence::Springs(Springs(vec![spring([0, 1], 1.0, 1e6)]));
    let settings = WorldSettings { container: boxed([-2.0, 0.0], [3.0, 9.0]), ..falling() };
    let mut world = forced(all, vec![tie], settings);
    run(&mut world, 1);
    assert_eq!(world.stats().substeps, 4);
    world.set_forces(Vec::new()).expect("no force is valid");
    let mut again = restored(&world);
    run(&mut world, 1);
    run(&mut again, 1);
    assert_eq!(world.stats().substeps, 1);
    assert_eq!(world.state_hash().unwrap(), again.state_hash().unwrap());
}

#[test]
fn a_spring_goes_with_either_end() {
    let bodies = particles(uniform(5, 0), vec![[0.0; 2]; 5], vec![1.0; 5]);
    let ties = vec![spring([0, 1], 1.0, 1.0), spring([4, 2], 1.0, 1.0), spring([2, 3], 1.0, 1.0)];
    let mut world =
        forced(bodies, vec![Influence::Springs(Springs(ties))], WorldSettings::default());
    world.remove(&[3, 0]).expect("they are there");
    assert_eq!(
        world.forces().unwrap(),
        [Influence::Springs(Springs(vec![spring([4, 2], 1.0, 1.0)]))]
    );
    run_for(&mut world, 0.1, 10);
}

#[test]
fn springs_reach_over_the_seam_of_a_torus() {
    let bodies = particles(vec![[1.0, 5.0], [9.0, 5.0]], vec![[0.0; 2]; 2], vec![1.0; 2]);
    let settings =
        WorldSettings { container: Container::Torus { size: [10.0; 2] }, ..Default::default() };
    let tie = Spring { damping: 2.0, ..spring([0, 1], 1.0, 5.0) };
    let mut world = forced(bodies, vec![Influence::Springs(Springs(vec![tie]))], settings);
    run_for(&mut world, 0.05, 400);
    let [a, b] = [world.bodies().positions().unwrap()[0], world.bodies().positions().unwrap()[1]];
    assert!((a[0] - 0.5).abs() < 1e-3 && (b[0] - 9.5).abs() < 1e-3, "{a:?} {b:?}");
}

// ---- thermostat ----------------------------------------------------------------------------------

fn gas(count: usize) -> Particles {
    let mut random = Random::new(11);
    let mut number = |most: f32| random.between(-most, most);
    let positions = (0..count).map(|_| [number(9.0), number(9.0)]).collect();
    let velocities = (0..count).map(|_| [number(0.2), number(0.2)]).collect();
    Particles::new(positions, velocities, vec![0.1; count], 1.0)
}

#[test]
fn a_thermostat_reaches_its_speed() {
    let walls = boxed([-10.0; 2], [10.0; 2]);
    let round = Container::Circle { center: [0.0; 2], radius: 14.0 };
    for container in [walls, round] {
        let settings = inside(container);
        let forces = vec![Influence::Thermostat(Thermostat { speed: 3.0, rate: 0.2 })];
        let alone = particles(vec![[0.0, 0.0]], vec![[0.3, 0.1]], vec![1.0]);
        let mut world = forced(alone, forces.clone(), settings);
        run_for(&mut world, 0.1, 10_000);
        let [x, y] = world.bodies().velocities().unwrap()[0].map(f64::from);
        let speed = (x * x + y * y).sqrt();
        assert!((speed - 3.0).abs() < 1e-3, "{speed} in {container:?}");
        let mut gas = forced(gas(200), forces, settings);
        run_for(&mut gas, 0.05, 4000);
        let mass: f32 = gas.bodies().masses().unwrap().iter().sum();
        let speed = (2.0 * gas.kinetic_energy() / f64::from(mass)).sqrt();
        println!("a gas has the speed {speed:.3} in {container:?}");
        assert!((2.0..4.5).contains(&speed), "{speed} in {container:?}");
    }
}

// ---- energy --------------------------------------------------------------------------------------

/// The largest change of the total energy in 1,000 steps, over the kinetic energy at its most.
fn drift(world: &mut World, dt: f64) -> f64 {
    let total = |world: &World| world.kinetic_energy() + world.potential_energy().unwrap();
    let (first, mut most, mut worst) = (total(world), 0.0f64, 0.0f64);
    for _ in 0..1000 {
        run_for(world, dt, 1);
        worst = worst.max((total(world) - first).abs());
        most = most.max(world.kinetic_energy());
    }
    println!("off by {:.2e} of {most}", worst / most);
    worst / most
}

#[test]
fn a_spring_pendulum_keeps_its_energy() {
    let mut bodies = particles(vec![[0.0, 0.0], [2.5, 0.0]], vec![[0.0; 2]; 2], vec![1.0, 2.0]);
    bodies.movable[0] = false;
    let settings = WorldSettings { gravity: [0.0, 9.8], ..WorldSettings::default() };
    let forces = vec![Influence::Springs(Springs(vec![spring([0, 1], 2.0, 150.0)]))];
    assert!(drift(&mut forced(bodies, forces, settings), 1.0 / 60.0) < 0.01);
}

#[test]
fn a_kepler_orbit_keeps_its_energy() {
    let two =
        particles(vec![[-1.0, 0.0], [3.0, 0.0]], vec![[0.0, -0.2], [0.0, 0.6]], vec![3.0, 1.0]);
    let pull = Influence::Gravitation(gravitation(0.5));
    assert!(drift(&mut forced(two, vec![pull], WorldSettings::default()), 0.05) < 1e-4);
    let one = particles(vec![[3.0, 0.0]], vec![[0.0, 0.6]], vec![2.0]);
    let pull = attractor(Pole::Point([0.0, 0.0]), 1.5, Law::InverseSquare);
    assert!(drift(&mut forced(one, vec![pull], WorldSettings::default()), 0.05) < 1e-4);
}

#[test]
fn a_harmonic_swing_keeps_its_energy() {
    let bodies = particles(vec![[3.0, 1.0]], vec![[0.0, 2.0]], vec![7.0]);
    let pull = attractor(Pole::Point([1.0, 1.0]), 4.0, Law::Harmonic);
    let mut world = forced(bodies, vec![pull], WorldSettings::default());
    assert!(drift(&mut world, 0.02) < 1e-4);
}

#[test]
fn potentials_follow_their_formulas() {
    let energy = |positions: &[[f32; 2]], radius: f32, container, forces| {
        let len = positions.len();
        let masses = (1..=len).map(|mass| mass as f32).collect();
        let mut bodies = particles(positions.to_vec(), vec![[0.0; 2]; len], masses);
        bodies.radii = vec![radius; len];
        let settings = inside(container);
        forced(bodies, forces, settings).potential_energy().unwrap()
    };
    let near = |found: f64, expected: f64| {
        assert!((found - expected).abs() < 1e-6 * expected.abs(), "{found} for {expected}");
    };
    let two = [[0.0, 0.0], [3.0, 4.0]]; // masses 1 and 2
    let origin = Pole::Point([0.0, 0.0]);
    let none = Container::None;
    near(energy(&two, 0.5, none, vec![attractor(origin, 6.0, Law::Harmonic)]), 2.0 * 3.0 * 25.0);
    // The one at the pole: −3/2 · strength / radius; the other feels a point.
    let inverse = attractor(origin, 6.0, Law::InverseSquare);
    near(energy(&two, 0.5, none, vec![inverse.clone()]), -1.5 * 6.0 / 0.5 - 2.0 * 6.0 / 5.0);
    near(energy(&two[1..], 8.0, none, vec![inverse]), 6.0 * (25.0 / 64.0 - 3.0) / 16.0);
    let follower = attractor(Pole::Particle(0), 6.0, Law::InverseSquare);
    near(energy(&two, 0.5, none, vec![follower]), -2.0 * 6.0 / 5.0);
    let ties = vec![spring([0, 1], 2.0, 10.0), spring([1, 0], 5.5, 4.0)];
    near(energy(&two, 0.5, none, vec![Influence::Springs(Springs(ties))]), 5.0 * 9.0 + 2.0 * 0.25);
    let three = [[0.0, 0.0], [3.0, 4.0], [0.0, 10.0]]; // masses 1, 2, 3
    let pull = Gravitation { g: 7.0, softening: 0.0, theta: 0.5 };
    let sum = 2.0 / 5.0 + 3.0 / 10.0 + 6.0 / 45f64.sqrt();
    near(energy(&three, 0.5, none, vec![Influence::Gravitation(pull)]), -7.0 * sum);
    let softer = Gravitation { softening: 12.0, ..pull };
    near(energy(&two, 0.5, none, vec![Influence::Gravitation(softer)]), -7.0 * 2.0 / 13.0);
    let torus = Container::Torus { size: [100.0; 2] };
    let across = [[1.0, 1.0], [98.0, 97.0]];
    near(energy(&across, 0.5, torus, vec![Influence::Gravitation(pull)]), -7.0 * 2.0 / 5.0);
}

#[test]
fn many_bodies_have_the_energy_of_the_sum_over_all() {
    let count = 3000;
    for softening in [0.0, 0.5] {
        let of = |theta| {
            let bodies = particles(clustered(count, 2), vec![[0.0; 2]; count], mixed_masses(count));
            let pull = Gravitation { softening, ..gravitation(theta) };
            forced(bodies, vec![Influence::Gravitation(pull)], WorldSettings::default())
                .potential_energy()
                .unwrap()
        };
        let (tree, direct) = (of(0.5), of(0.0));
        println!("{tree} for {direct}");
        assert!((tree / direct - 1.0).abs() < 1e-3, "{tree} for {direct}");
    }
}

// ---- the same bits -------------------------------------------------------------------------------

/// Every kind of force; `row` says where a particle stands.
fn all_forces(count: u32, row: impl Fn(u32) -> u32) -> Vec<Influence> {
    let row = |particle: u32| Id::from(row(particle));
    let tie = |i: u32| Spring {
        pair: [row(i), row((i * 7 + 1) % count)],
        length: 1.0,
        stiffness: 10.0 + (i % 9) as f32,
        damping: 0.1,
        max_stretch: 60.0,
    };
    let mut springs: Vec<Spring> =
        (0..count / 2).filter(|i| (i * 7 + 1) % count != *i).map(tie).collect();
    springs.sort_by_key(|spring| spring.pair); // another order in every world
    vec![
        attractor(Pole::Point([40.0, 60.0]), 0.1, Law::Harmonic),
        attractor(Pole::Particle(row(17)), 3.0, Law::InverseSquare),
        Influence::Gravitation(Gravitation { g: 0.01, softening: 0.1, theta: 0.6 }),
        Influence::Springs(Springs(springs)),
        Influence::Thermostat(Thermostat { speed: 2.0, rate: 0.3 }),
    ]
}

/// Many touch, but in the middle of the clusters not hundreds each.
fn crowd(count: usize) -> Particles {
    crowd_of(count, 200.0 / count as f32)
}

fn crowd_of(count: usize, radius: f32) -> Particles {
    let mut all = particles(clustered(count, 9), vec![[0.0; 2]; count], mixed_masses(count));
    all.velocities = uniform(count, 10).iter().map(|v| v.map(|v| v * 0.05)).collect();
    all.radii = vec![radius; count];
    all.movable[5] = false;
    all
}

fn containers() -> [Container; 3] {
    let walls = boxed([-10.0; 2], [120.0; 2]);
    [Container::None, walls, Container::Torus { size: [110.0; 2] }]
}

#[test]
fn threads_and_methods_do_not_show() {
    for container in containers() {
        let hash = |count, (dt, steps), threads, method| {
            let mut settings = WorldSettings { container, method, ..WorldSettings::default() };
            settings.tree.threads = threads;
            let radius = if count > 1000 { 0.003 } else { 0.2 };
            let mut world =
                forced(crowd_of(count, radius), all_forces(count as u32, |i| i), settings);
            run_for(&mut world, dt, steps);
            world.state_hash().unwrap()
        };
        // Enough to wake other threads.
        let many = |threads| hash(8_500, (0.0002, 1), Some(threads), Method::Quadtree);
        assert_eq!(many(1), many(2), "{container:?}");
        let few = |threads, method| hash(1000, (0.01, 3), Some(threads), method);
        assert_eq!(few(1, Method::Quadtree), few(3, Method::Brute), "{container:?}");
    }
}

#[test]
fn the_order_of_adding_does_not_show() {
    for (container, count) in containers().into_iter().flat_map(|c| [(c, 100), (c, 1000)]) {
        let all = crowd(count);
        let mut order: Vec<u32> = (0..count as u32).collect();
        let mut random = Random::new(12);
        for i in (1..count).rev() {
            order.swap(i, random.between(0.0, (i + 1) as f32) as usize % (i + 1));
        }
        let shuffled = gathered(&all, &order);
        let mut row_of = vec![0; count];
        order.iter().enumerate().for_each(|(row, &i)| row_of[i as usize] = row as u32);
        let settings = inside(container);
        let mut first = forced(all, all_forces(count as u32, |i| i), settings);
        let mut second =
            forced(shuffled, all_forces(count as u32, |i| row_of[i as usize]), settings);
        run_for(&mut first, 0.01, 10);
        run_for(&mut second, 0.01, 10);
        let (first, second) =
            (first.bodies().particles().unwrap(), second.bodies().particles().unwrap());
        let back = gathered(&second, &row_of);
        assert!(back == first, "{count} in {container:?}");
    }
}

#[test]
fn many_steps_in_one_call_are_the_same() {
    let make = || forced(crowd(500), all_forces(500, |i| i), WorldSettings::default());
    let (mut once, mut often) = (make(), make());
    run_for(&mut once, 0.01, 20);
    (0..20).for_each(|_| run_for(&mut often, 0.01, 1));
    assert_eq!(once.state_hash().unwrap(), often.state_hash().unwrap());
}

#[test]
fn forces_can_be_taken_away() {
    let mut world = forced(crowd(500), all_forces(500, |i| i), WorldSettings::default());
    run_for(&mut world, 0.01, 5);
    let mut without = world_of(world.bodies().particles().unwrap(), *world.settings());
    world.set_forces(Vec::new()).expect("none is fine");
    run_for(&mut world, 0.01, 1);
    run_for(&mut without, 0.01, 1);
    assert_eq!(world.state_hash().unwrap(), without.state_hash().unwrap());
}

// ---- refusals ------------------------------------------------------------------------------------

#[test]
fn what_cannot_be_is_refused_by_name() {
    let bodies = particles(uniform(3, 0), vec![[0.0; 2]; 3], vec![1.0; 3]);
    let mut world = forced(bodies, Vec::new(), WorldSettings::default());
    let thermostat = Influence::Thermostat(Thermostat { speed: 1.0, rate: 0.5 });
    let wrong = [
        (
            vec![attractor(Pole::Particle(3), 1.0, Law::Harmonic)],
            "forces[0] is a force on particle 3",
        ),
        (vec![attractor(Pole::Point([f32::NAN, 0.0]), 1.0, Law::Harmonic)], "point is (NaN, 0)"),
        (vec![Influence::Gravitation(gravitation(1.5))], "theta is 1.5"),
        (vec![Influence::Springs(Springs(vec![spring([1, 1], 1.0, 1.0)]))], "pairs[0] is (1, 1)"),
        (vec![Influence::Springs(Springs(vec![spring([0, 1], -1.0, 1.0)]))], "lengths[0] is -1"),
        (vec![thermostat.clone(), thermostat], "forces[1] is another Thermostat"),
    ];
    for (forces, said) in wrong {
        let error = world.set_forces(forces).expect_err(said).to_string();
        assert!(error.starts_with(said), "{error}");
        assert!(world.forces().unwrap().is_empty());
    }
}

#[test]
fn a_step_too_long_for_the_forces_is_refused() {
    let bodies = particles(uniform(3, 0), vec![[0.0; 2]; 3], vec![1.0; 3]);
    let pull = attractor(Pole::Point([1e6, 0.0]), 1.0, Law::Harmonic);
    let tie = Influence::Springs(Springs(vec![spring([0, 1], 1e6, 1.0)]));
    for force in [pull, tie] {
        let mut world = forced(bodies.clone(), vec![force], WorldSettings::default());
        let error = world.step(1e20, 1).expect_err("too long").to_string();
        assert!(error.contains("forces would move particle "), "{error}");
        assert_eq!(world.bodies().positions().unwrap(), bodies.positions);
        run_for(&mut world, 0.01, 1);
    }
}
