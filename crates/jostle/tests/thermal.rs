//! Walls and a bath at a temperature.

use jostle_base::{Method, Settings};
use jostle_scenes::random::Random;
use jostle_world::forces::chance::Chance;
use jostle_world::forces::{Andersen, Influences, ThermalWalls, WallIds};
use jostle_world::{Container, Influence, OnTouch, Particles, Wall, World, WorldSettings};

use crate::common::worlds::{boxed, closed, discs, forced, gathered, inside, run};

const KT: f32 = 4.0;
const ALL: [bool; 4] = [true; 4];

fn walls(sides: [bool; 4], seed: u32) -> Influence {
    let [a, b, c, d] = sides;
    let sides = [a, b, c, d, sides == ALL];
    Influence::ThermalWalls(ThermalWalls {
        temperature: KT,
        sides,
        walls: WallIds::default(),
        seed,
    })
}

/// Line segments at a temperature.
fn segments(temperature: f32, walls: &[i64], seed: u32) -> Influence {
    let (sides, walls) = ([false; 5], WallIds(walls.to_vec()));
    Influence::ThermalWalls(ThermalWalls { temperature, sides, walls, seed })
}

fn bath(rate: f32) -> Influence {
    Influence::Andersen(Andersen { temperature: KT, rate, seed: 1 })
}

/// Discs of two masses on a lattice, with small velocities.
fn gas(count: usize, side: f32) -> Particles {
    let mut random = Random::new(5);
    let columns = (count as f32).sqrt().ceil() as usize;
    let place = |at: usize| (at as f32 + 0.5) * side / columns as f32;
    let positions = (0..count).map(|at| [place(at % columns), place(at / columns)]).collect();
    let velocities = (0..count).map(|_| [random.between(-1.0, 1.0), random.between(-1.0, 1.0)]);
    let mut all = Particles::new(positions, velocities.collect(), vec![0.3; count], 1.0);
    all.masses = (0..count).map(|at| if at % 2 == 0 { 1.0 } else { 4.0 }).collect();
    all
}

/// The largest difference between the distribution of some numbers and a function, times √n. It
/// is above 1.95 with a probability of 0.001.
fn kolmogorov_smirnov(mut numbers: Vec<f64>, distribution: impl Fn(f64) -> f64) -> f64 {
    numbers.sort_by(f64::total_cmp);
    let n = numbers.len() as f64;
    let step = |(index, &x): (usize, &f64)| {
        let (expected, below) = (distribution(x), index as f64 / n);
        (expected - below).abs().max((below + 1.0 / n - expected).abs())
    };
    numbers.iter().enumerate().map(step).fold(0.0, f64::max) * n.sqrt()
}

/// The normal distribution (M. Abramowitz and I. A. Stegun, 26.2.17; its error is below 10⁻⁷).
fn normal(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.231_641_9 * x.abs());
    let terms = [0.319_381_530, -0.356_563_782, 1.781_477_937, -1.821_255_978, 1.330_274_429];
    let sum = terms.iter().rev().fold(0.0, |sum, term| (sum + term) * t);
    let above = (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt() * sum;
    if x >= 0.0 { 1.0 - above } else { above }
}

#[test]
fn random_numbers_have_their_distributions() {
    let all: Vec<Chance> = (0..20_000).map(|at| Chance::of(7, &[f64::from(at), 1.0])).collect();
    let draw =
        |of: fn(&mut Chance) -> f64| all.iter().cloned().map(|mut one| of(&mut one)).collect();
    let exponential = kolmogorov_smirnov(draw(Chance::exponential), |x| 1.0 - (-x).exp());
    let flux = kolmogorov_smirnov(draw(Chance::flux), |v| 1.0 - (-0.5 * v * v).exp());
    let x = kolmogorov_smirnov(draw(|one| one.normal()[0]), normal);
    let y = kolmogorov_smirnov(draw(|one| one.normal()[1]), normal);
    let found = [exponential, flux, x, y];
    assert!(found.iter().all(|&distance| distance < 1.95), "{found:?}");
    // Also those that follow each other.
    let mut one = Chance::of(0, &[]);
    let many = (0..20_000).map(|_| one.normal()[0]).collect();
    assert!(kolmogorov_smirnov(many, normal) < 1.95);
    let product: f64 = all
        .iter()
        .cloned()
        .map(|mut one| {
            let [x, y] = one.normal();
            x * y
        })
        .sum();
    assert!(product.abs() < 4.0 * 20_000f64.sqrt(), "{product}");
}

#[test]
fn a_gas_gets_the_temperature_of_its_walls() {
    // Particles that pass through each other: each is heated by the walls alone.
    for container in
        [boxed([0.0; 2], [30.0; 2]), Container::Circle { center: [15.0; 2], radius: 22.0 }]
    {
        let base = inside(container);
        let settings = WorldSettings { on_touch: OnTouch::Ignore, ..base };
        let mut world = forced(gas(2000, 30.0), vec![walls(ALL, 3)], settings);
        world.step(1.0, 400).unwrap();
        check_temperature(&world, "walls");
    }
}

#[test]
fn a_gas_gets_the_temperature_of_line_segments() {
    let corners = [[-9.0, -2.0], [15.0, -20.0], [42.0, -3.0], [33.0, 36.0], [-2.0, 33.0]];
    let settings = WorldSettings { on_touch: OnTouch::Ignore, ..WorldSettings::default() };
    let mut world = forced(gas(2000, 30.0), vec![], settings);
    let mut walls = closed(&corners);
    // A plate in the middle, with both sides.
    walls.push(Wall::new([[10.0, 15.1], [22.0, 14.0]]));
    world.set_walls(walls).unwrap();
    world.set_forces(vec![segments(KT, &[0, 1, 2, 3, 4, 5], 3)]).unwrap();
    world.step(1.0, 400).unwrap();
    check_temperature(&world, "line segments");
}

#[test]
fn each_line_segment_has_its_own_temperature() {
    // Discs that bounce between a cold wall and a hot one, and off elastic walls.
    let corners = [[0.0, 0.0], [30.0, 0.0], [30.0, 30.0], [0.0, 30.0]];
    let base = WorldSettings { on_touch: OnTouch::Ignore, ..WorldSettings::default() };
    let mut world = forced(gas(2000, 30.0), vec![], base);
    world.set_walls(closed(&corners)).unwrap();
    let cold = segments(1.0, &[0], 1);
    world.set_forces(vec![cold, segments(9.0, &[2], 2)]).unwrap();
    world.step(1.0, 400).unwrap();
    // Without collisions the discs that move up come from the cold wall: v has the density of the
    // flux over v.
    for (sign, temperature) in [(1.0, 1.0), (-1.0, 9.0)] {
        let all = world.bodies().velocities().unwrap().into_iter().step_by(2);
        let own = all.map(|v| sign * f64::from(v[1])).filter(|v| *v > 0.0);
        let scaled = own.map(|v| v / f64::sqrt(temperature)).collect();
        let distance = kolmogorov_smirnov(scaled, |x| 2.0 * normal(x) - 1.0);
        assert!(distance < 1.95, "{temperature}: {distance}");
    }
}

#[test]
fn a_gas_gets_the_temperature_of_a_bath() {
    let settings =
        WorldSettings { container: Container::Torus { size: [60.0; 2] }, ..Default::default() };
    let mut world = forced(gas(2000, 60.0), vec![bath(5.0)], settings);
    run(&mut world, 120);
    check_temperature(&world, "a bath");
}

/// Compares velocities with a Maxwell distribution, for both masses.
fn check_temperature(world: &World, name: &str) {
    for (parity, mass) in [(0, 1.0f64), (1, 4.0)] {
        for axis in [0, 1] {
            let of = world.bodies().velocities().unwrap().into_iter().skip(parity).step_by(2);
            let scaled = of.map(|v| f64::from(v[axis]) * (mass / f64::from(KT)).sqrt());
            let distance = kolmogorov_smirnov(scaled.collect(), normal);
            assert!(distance < 1.95, "{name}: {distance}, mass {mass}, axis {axis}");
        }
    }
    // The standard deviation of the energy of n particles in two directions is kT √n.
    let n = world.len() as f64;
    let error = (world.kinetic_energy() / n / f64::from(KT) - 1.0) * n.sqrt();
    assert!(error.abs() < 4.0, "{name}: {error} standard deviations");
}

#[test]
fn a_disc_leaves_a_wall_as_from_a_gas() {
    // One bounce of each of many discs off the wall at min x.
    let n = 4000;
    let positions = (0..n).map(|at| [1.0 + at as f32 * 1e-3, 10.0]).collect();
    let all = Particles::new(positions, vec![[-10.0, 3.0]; n], vec![0.5; n], 8.0);
    let container = boxed([0.0; 2], [1e4; 2]);
    let base = inside(container);
    let settings = WorldSettings { on_touch: OnTouch::Ignore, ..base };
    let hot = walls([true, false, false, false], 9);
    let mut world = forced(all, vec![hot], settings);
    world.step(0.5, 1).unwrap();
    let scale = (2.0 / f64::from(KT)).sqrt();
    let column = |k: usize| {
        world.bodies().velocities().unwrap().iter().map(|v| f64::from(v[k]) * scale).collect()
    };
    let normal_speeds: Vec<f64> = column(0);
    assert!(kolmogorov_smirnov(normal_speeds, |v| 1.0 - (-0.5 * v * v).exp()) < 1.95);
    assert!(kolmogorov_smirnov(column(1), normal) < 1.95);
    // The impulses of the wall are the changes of momentum.
    for touch in world.wall_contacts().unwrap() {
        let [speed, _] = world.bodies().velocities().unwrap()[touch.id as usize];
        assert!((touch.normal_impulse - 2.0 * (speed + 10.0)).abs() < 1e-3);
    }
    assert_eq!(world.wall_contacts().unwrap().len(), n);
}

#[test]
fn a_disc_leaves_a_moving_line_segment_as_from_a_gas() {
    let n = 4000;
    for (x, velocity) in [(1.0, [-10.0, 3.0]), (-1.0, [10.0, 3.0])] {
        let positions = (0..n).map(|at| [x * (1.0 + at as f32 * 1e-3), 10.0]).collect();
        let all = Particles::new(positions, vec![velocity; n], vec![0.5; n], 8.0);
        let settings = WorldSettings { on_touch: OnTouch::Ignore, ..WorldSettings::default() };
        let mut world = forced(all, vec![], settings);
        let carried = [0.5, -2.0];
        let wall = Wall { velocity: carried, ..Wall::new([[0.0, -99.0], [0.0, 99.0]]) };
        world.set_walls(vec![wall]).unwrap();
        world.set_forces(vec![segments(KT, &[0], 9)]).unwrap();
        world.step(0.6, 1).unwrap();
        let scale = (2.0 / f64::from(KT)).sqrt();
        let column = |k: usize, sign: f64| {
            let own = move |v: [f32; 2]| sign * (f64::from(v[k]) - f64::from(carried[k])) * scale;
            world.bodies().velocities().unwrap().into_iter().map(own).collect::<Vec<f64>>()
        };
        let leaving = column(0, f64::from(x));
        assert!(kolmogorov_smirnov(leaving, |v| 1.0 - (-0.5 * v * v).exp()) < 1.95, "{x}");
        assert!(kolmogorov_smirnov(column(1, 1.0), normal) < 1.95, "{x}");
        assert_eq!(world.wall_contacts().unwrap().len(), n);
    }
}

#[test]
fn other_sides_stay_elastic() {
    let container = boxed([0.0; 2], [10.0; 2]);
    let settings = inside(container);
    let disc = |velocity| discs(&[([5.0; 2], velocity)], 1.0);
    let hot = walls([false, true, false, false], 0);
    for velocity in [[-8.0, 0.0], [0.0, -8.0], [0.0, 8.0]] {
        let mut world = forced(disc(velocity), vec![hot.clone()], settings);
        world.step(0.75, 1).unwrap();
        assert_eq!(world.bodies().velocities().unwrap(), [velocity.map(|v| 0.0 - v)]);
    }
    let mut world = forced(disc([8.0, 0.0]), vec![hot], settings);
    world.step(0.75, 1).unwrap();
    let [[u, v]] = world.bodies().velocities().unwrap()[..] else { panic!("one disc") };
    assert!(u < 0.0 && u != -8.0 && v != 0.0);
}

#[test]
fn a_thermal_floor_holds_an_atmosphere() {
    // The mean height over the floor is kT/mg; discs with tiny speeds are thrown up again.
    let container = boxed([0.0; 2], [40.0, 1e4]);
    let base = WorldSettings { container, gravity: [0.0, -10.0], ..WorldSettings::default() };
    let settings = WorldSettings { on_touch: OnTouch::Ignore, ..base };
    let mut all = gas(2000, 40.0);
    all.masses.fill(1.0);
    all.positions.iter_mut().for_each(|p| p[1] = 1.0);
    all.velocities.iter_mut().for_each(|v| *v = [v[0], 0.0]);
    let mut world = forced(all, vec![walls([false, false, true, false], 2)], settings);
    world.step(0.25, 160).unwrap();
    let heights = world.bodies().positions().unwrap().into_iter().map(|p| f64::from(p[1] - 0.3));
    let found = kolmogorov_smirnov(heights.collect(), |z| 1.0 - (-10.0 * z / f64::from(KT)).exp());
    assert!(found < 1.95, "{found}");
}

/// Everything that may show: collisions, gravity, several walls, a bath.
fn busy(settings: WorldSettings, order: &[u32]) -> World {
    let all = gathered(&gas(400, 22.0), order);
    let forces = vec![
        walls([true, false, false, true], 4),
        walls([false, true, false, false], 5),
        bath(0.5),
    ];
    let container = boxed([0.0; 2], [22.0; 2]);
    let settings = WorldSettings { container, gravity: [0.0, 3.0], ..settings };
    let mut world = forced(all, vec![], settings);
    let wall = |at: f32| Wall::new([[at, 6.0], [at + 3.0, 14.0]]);
    world.set_walls([3.0, 9.0, 15.0].map(wall).to_vec()).unwrap();
    world.set_forces([forces, vec![segments(2.0, &[0, 2], 8)]].concat()).unwrap();
    world
}

#[test]
fn it_does_not_show_how_they_are_computed() {
    let straight: Vec<u32> = (0..400).collect();
    let mut expected = busy(WorldSettings::default(), &straight);
    run(&mut expected, 120);
    let mut brute = busy(WorldSettings { method: Method::Brute, ..Default::default() }, &straight);
    run(&mut brute, 120);
    assert_eq!(brute.state_hash().unwrap(), expected.state_hash().unwrap());
    let mut half = busy(WorldSettings::default(), &straight);
    run(&mut half, 60);
    let mut half = World::restore(&half.snapshot().unwrap()).unwrap();
    assert_eq!(half.forces().unwrap(), expected.forces().unwrap());
    run(&mut half, 60);
    assert_eq!(half.snapshot().unwrap(), expected.snapshot().unwrap());
    let order: Vec<u32> = (0..400).map(|at| at * 137 % 400).collect();
    let mut other = busy(WorldSettings::default(), &order);
    run(&mut other, 120);
    let permuted = gathered(&expected.bodies().particles().unwrap(), &order);
    assert!(other.bodies().particles().unwrap() == permuted, "the order of adding");
    let mut again = busy(WorldSettings::default(), &straight);
    again.set_forces(vec![walls(ALL, 5)]).unwrap();
    run(&mut again, 120);
    assert_ne!(again.state_hash().unwrap(), expected.state_hash().unwrap());
}

#[test]
fn threads_do_not_show_in_heat() {
    let hashes = [1, 2, 8].map(|threads| {
        let tree = Settings { threads: Some(threads), ..Settings::default() };
        let container = boxed([0.0; 2], [160.0; 2]);
        let settings = WorldSettings { container, tree, ..WorldSettings::default() };
        let mut world = forced(gas(30_000, 160.0), vec![walls(ALL, 0), bath(3.0)], settings);
        run(&mut world, 4);
        world.state_hash().unwrap()
    });
    assert!(hashes.iter().all(|hash| *hash == hashes[0]));
}

#[test]
fn an_undone_step_heats_nothing() {
    let straight: Vec<u32> = (0..400).collect();
    let mut world = busy(WorldSettings::default(), &straight);
    run(&mut world, 3);
    let before = world.snapshot().unwrap();
    assert!(world.step(1e30, 1).is_err());
    assert_eq!(world.snapshot().unwrap(), before);
}

#[test]
fn wrong_ones_are_refused() {
    let refusal = |all: &[Influence]| {
        Influences::from(all.to_vec()).validate(|id| id == 0).unwrap_err().to_string()
    };
    let hot = |temperature| {
        Influence::ThermalWalls(ThermalWalls {
            temperature,
            sides: [true; 5],
            walls: WallIds::default(),
            seed: 0,
        })
    };
    assert_eq!(refusal(&[hot(0.0)]), "temperature is 0; it must be above 0");
    assert!(refusal(&[hot(f32::NAN)]).starts_with("temperature is NaN; it must be finite"));
    assert!(refusal(&[walls([false; 4], 0)]).starts_with("sides is ()"));
    assert_eq!(
        refusal(&[walls([true, false, false, false], 0), walls(ALL, 1)]),
        "forces[1] is another ThermalWalls; MIN_X has a temperature already"
    );
    assert_eq!(refusal(&[segments(1.0, &[3, 5, 3], 0)]), "walls[2] is 3; it is given twice");
    assert!(refusal(&[segments(1.0, &[-1], 0)]).starts_with("walls[0] is -1; no wall"));
    assert_eq!(
        refusal(&[segments(1.0, &[3], 0), walls(ALL, 0), segments(2.0, &[2, 3], 1)]),
        "forces[2] is another ThermalWalls; wall 3 has a temperature already"
    );
    let mut world = busy(WorldSettings::default(), &[0, 1, 2, 3]);
    let error = world.set_forces(vec![segments(1.0, &[1, 3], 0)]).unwrap_err().to_string();
    assert_eq!(error, "forces[0] is ThermalWalls of wall 3; no wall has this id");
    let error = world.set_walls(world.walls()[..2].to_vec()).unwrap_err().to_string();
    assert_eq!(error, "forces[3] is ThermalWalls of wall 2; no wall has this id");
    assert!(refusal(&[bath(-1.0)]).starts_with("rate is -1; "));
    assert!(
        refusal(&[bath(1.0), bath(1.0)]).starts_with("forces[1] is another AndersenThermostat")
    );
}
