//! Friction and spin, against analysis and conservation laws.

use jostle_scenes::{STEP, random::Random};
use jostle_world::{Particles, Spin, World, WorldSettings};

use crate::common::worlds::{bouncing, boxed, discs, inside, run, run_for, still, world_of};

fn spin(friction: f32, velocity: f32) -> Spin {
    Spin { friction, velocity, angle: 0.0 }
}

/// Two discs that touch after a second.
struct Two {
    velocities: [[f32; 2]; 2],
    radii: [f32; 2],
    masses: [f32; 2],
    spins: [Spin; 2],
    restitution: f32,
}

impl Two {
    /// Velocities and angular velocities after the impact. The normal is +x.
    fn analytic(&self) -> [[f64; 3]; 2] {
        let Self { velocities: [a, b], radii, masses, spins, restitution } = self;
        let [m, n] = masses.map(f64::from);
        let [r, s] = radii.map(f64::from);
        let [v, w] = [a, b].map(|velocity| velocity.map(f64::from));
        let [p, q] = spins.map(|spin| f64::from(spin.velocity));
        let softness = 1.0 / m + 1.0 / n;
        let normal = -(1.0 + f64::from(*restitution)) * (w[0] - v[0]) / softness;
        let sliding = (w[1] - v[1]) - (p * r + q * s);
        // Points have no moment of inertia.
        let inertia = |m: f64, r: f64| if r > 0.0 { 0.5 * m * r * r } else { f64::INFINITY };
        let [i, j] = [inertia(m, r), inertia(n, s)];
        let most = f64::from(spins[0].friction * spins[1].friction).sqrt() * normal;
        let sticking = -sliding / (softness + r * r / i + s * s / j);
        let along = sticking.clamp(-most, most);
        [
            [v[0] - normal / m, v[1] - along / m, p - r * along / i],
            [w[0] + normal / n, w[1] + along / n, q - s * along / j],
        ]
    }

    fn simulated(&self) -> World {
        let start = |which: usize, x: f32| {
            [0, 1].map(|k| if k == 0 { x } else { 0.0 } - self.velocities[which][k])
        };
        let positions = vec![start(0, -self.radii[0]), start(1, self.radii[1])];
        let mut all = Particles::new(positions, self.velocities.to_vec(), self.radii.to_vec(), 1.0);
        all.masses = self.masses.to_vec();
        all.spins = self.spins.to_vec();
        let mut world = world_of(bouncing(all, self.restitution), WorldSettings::default());
        run_for(&mut world, 2.0, 1);
        world
    }
}

#[test]
fn oblique_bounces_stick_or_slide() {
    let mut random = Random::new(2);
    let mut kinds = [0, 0];
    for trial in 0..300 {
        let mut between = |low, high| random.between(low, high);
        let two = Two {
            velocities: [
                [between(0.5, 2.0), between(-1.0, 1.0)],
                [between(-1.0, 0.3), between(-1.0, 1.0)],
            ],
            radii: [between(0.3, 1.5), if trial % 7 == 0 { 0.0 } else { between(0.3, 1.5) }],
            masses: [between(0.2, 4.0), between(0.2, 4.0)],
            spins: [
                spin(between(0.0, 1.0), between(-3.0, 3.0)),
                spin(between(0.0, 1.0), if trial % 7 == 0 { 0.0 } else { between(-3.0, 3.0) }),
            ],
            restitution: between(0.0, 1.0),
        };
        let (world, expected) = (two.simulated(), two.analytic());
        let found = world.bodies().particles().unwrap();
        for (which, expected) in expected.into_iter().enumerate() {
            let [u, v] = found.velocities[which].map(f64::from);
            let turning = f64::from(found.spin(which).velocity);
            for (found, expected) in [u, v, turning].into_iter().zip(expected) {
                assert!((found - expected).abs() < 2e-5, "{trial}: {found} {expected}");
            }
            // The impact is in the middle of the step.
            let angle = f64::from(two.spins[which].velocity) + expected[2];
            let error = (found.spin(which).angle - angle) / std::f64::consts::TAU;
            assert!((error - error.round()).abs() < 2e-5, "{trial}: {error}");
        }
        let [a, b] = [0, 1].map(|which| found.spin(which).velocity * found.radii[which]);
        let sliding = (found.velocities[1][1] - found.velocities[0][1]) - (a + b);
        kinds[usize::from(sliding.abs() < 1e-5)] += 1;
    }
    assert!(kinds.iter().all(|&count| count > 50), "{kinds:?}");
}

#[test]
fn a_ball_that_bounces_on_a_floor_gets_spin() {
    // The floor is at y = 0 and y grows upwards.
    for (friction, is_sticking) in [(0.05, false), (2.0, true)] {
        let mut all = discs(&[([0.0, 3.0], [2.0, -2.0])], 1.0);
        all.spins = vec![spin(friction, 0.0)];
        let container = boxed([-50.0, 0.0], [50.0, 50.0]);
        let mut world = world_of(all, inside(container));
        run_for(&mut world, 1.5, 1);
        let Particles { velocities, spins, .. } = world.bodies().particles().unwrap();
        // The impulse along the normal is 4 for a mass of 1.
        let along = if is_sticking { -2.0 / 3.0 } else { -4.0 * friction };
        let expected = [2.0 + along, 2.0, 2.0 * along];
        let found = [velocities[0][0], velocities[0][1], spins[0].velocity];
        let errors = found.iter().zip(expected).map(|(found, expected)| (found - expected).abs());
        assert!(errors.fold(0.0, f32::max) < 1e-6, "{found:?} {expected:?}");
        assert!((spins[0].angle - f64::from(along)).abs() < 1e-6, "{}", spins[0].angle);
    }
}

/// Discs at random places that do not overlap, with friction and spin.
fn rough_cloud(count: usize, seed: u64) -> Particles {
    let mut random = Random::new(seed);
    let side = (count as f32).sqrt();
    let mut positions: Vec<[f32; 2]> = Vec::new();
    while positions.len() < count {
        let new = [random.between(0.0, side), random.between(0.0, side)];
        let far = |old: &[f32; 2]| (old[0] - new[0]).hypot(old[1] - new[1]) > 0.8;
        if positions.iter().all(far) {
            positions.push(new);
        }
    }
    let velocities =
        (0..count).map(|_| [random.between(-1.0, 1.0), random.between(-1.0, 1.0)]).collect();
    let radii = (0..count).map(|_| random.between(0.2, 0.4)).collect();
    let mut all = Particles::new(positions, velocities, radii, 1.0);
    all.masses = (0..count).map(|_| random.between(0.2, 2.0)).collect();
    all.restitution = (0..count).map(|_| random.between(0.5, 1.0)).collect();
    all.spins =
        (0..count).map(|_| spin(random.between(0.0, 1.0), random.between(-3.0, 3.0))).collect();
    all
}

fn angular_momentum(all: &Particles, about: [f64; 2]) -> f64 {
    let own = |row: usize| {
        let [x, y] = [0, 1].map(|k| {
            f64::from(all.positions[row][k]) + f64::from(all.residuals[row][k]) - about[k]
        });
        let ([u, v], r) = (all.velocities[row].map(f64::from), f64::from(all.radii[row]));
        let turning = 0.5 * r * r * f64::from(all.spin(row).velocity);
        f64::from(all.masses[row]) * (x * v - y * u + turning)
    };
    (0..all.len()).map(own).sum()
}

#[test]
fn impacts_with_friction_conserve_momentum_and_angular_momentum_and_add_no_energy() {
    for seed in 0..10 {
        let mut world = world_of(rough_cloud(60, seed), WorldSettings::default());
        let before = world.bodies().particles().unwrap();
        let (momentum, start) = (world.momentum(), world.kinetic_energy());
        let mut energy = start;
        for _ in 0..60 {
            run_for(&mut world, 0.05, 1);
            let new = world.kinetic_energy();
            assert!(new <= energy * (1.0 + 1e-6), "{new} after {energy}");
            energy = new;
        }
        let after = world.bodies().particles().unwrap();
        assert!(energy < 0.95 * start, "{energy} of {start}: hardly any impact");
        let found = world.momentum();
        assert!((0..2).all(|k| (found[k] - momentum[k]).abs() < 1e-5), "{found:?} {momentum:?}");
        for about in [[0.0; 2], [3.0, -7.0]] {
            let [old, new] = [&before, &after].map(|all| angular_momentum(all, about));
            assert!((new - old).abs() < 1e-4, "{old} {new}");
        }
    }
}

#[test]
fn simultaneous_impacts_with_friction_add_no_energy() {
    // A lattice of discs that touch, of which some begin to move.
    for seed in 0..40 {
        let mut random = Random::new(seed);
        let place = |row: i32, column: i32| {
            let shift = if row % 2 == 0 { 0.0 } else { 0.5 };
            [column as f32 + shift, row as f32 * 0.75f32.sqrt()]
        };
        let positions: Vec<[f32; 2]> =
            (0..4).flat_map(|row| (0..4).map(move |column| place(row, column))).collect();
        let mut velocity =
            |row: usize| if row.is_multiple_of(3) { random.between(-1.0, 1.0) } else { 0.0 };
        let velocities = (0..16).map(|row| [velocity(row), velocity(row)]).collect();
        let mut all = Particles::new(positions, velocities, vec![0.5; 16], 1.0);
        all.spins =
            (0..16).map(|_| spin(random.between(0.0, 2.0), random.between(-2.0, 2.0))).collect();
        let all = bouncing(all, random.between(0.0, 1.0));
        let mut world = world_of(all, WorldSettings::default());
        let (momentum, mut energy) = (world.momentum(), world.kinetic_energy());
        for _ in 0..20 {
            run_for(&mut world, 0.02, 1);
            let new = world.kinetic_energy();
            assert!(new <= energy * (1.0 + 1e-6), "{seed}: {new} after {energy}");
            energy = new;
        }
        let found = world.momentum();
        assert!((0..2).all(|k| (found[k] - momentum[k]).abs() < 1e-4), "{found:?} {momentum:?}");
    }
}

#[test]
fn a_disc_without_friction_keeps_its_angular_velocity() {
    for drag in [0.0, 2.0] {
        let positions = vec![[0.0, 0.0], [3.0, 0.2]];
        let mut all = Particles::new(positions, vec![[1.0, 0.0], [0.0; 2]], vec![1.0; 2], 1.0);
        all.spins = vec![spin(0.0, 1.5), spin(1.0, -0.25)];
        let settings = WorldSettings { drag, ..Default::default() };
        let mut world = world_of(all, settings);
        run_for(&mut world, 0.25, 8);
        let Particles { velocities, spins, .. } = world.bodies().particles().unwrap();
        assert!(drag > 0.0 || velocities[1][0] > 0.0, "they collide");
        let expected = [1.5 * 2.0, -0.25 * 2.0];
        for (spin, (velocity, angle)) in spins.iter().zip([1.5, -0.25].into_iter().zip(expected)) {
            assert_eq!(spin.velocity, velocity);
            assert!((spin.angle - angle).abs() < 1e-12, "{} {angle}", spin.angle);
        }
    }
}

#[test]
fn immovable_discs_keep_their_angular_velocity_and_points_do_not_turn() {
    let positions = vec![[0.0; 2], [5.0, 0.0], [9.0, 0.0]];
    let mut all = Particles::new(positions, vec![[0.0; 2]; 3], vec![1.0, 0.0, 1.0], 1.0);
    all.masses[1] = 1.0;
    all.movable[0] = false;
    all.spins = vec![spin(0.5, 3.0); 3];
    let mut world = world_of(all, WorldSettings::default());
    assert_eq!(world.bodies().angular_velocities().unwrap(), [3.0, 0.0, 3.0]);
    run(&mut world, 60);
    let angles = world.bodies().angles().unwrap();
    let expected = [3.0, 0.0, 3.0];
    assert!((0..3).all(|row| (angles[row] - expected[row]).abs() < 1e-6), "{angles:?}");
}

#[test]
fn particles_without_friction_and_rotation_have_no_column_for_them() {
    let mut all = rough_cloud(5, 0);
    let mut bare = all.clone();
    bare.spins.clear();
    let settings = WorldSettings::default();
    let expected = world_of(bare, settings).state_hash().unwrap();
    all.spins = vec![Spin::default(); 5];
    let mut world = world_of(all, settings);
    assert_eq!(world.state_hash().unwrap(), expected);
    let edit = |world: &mut World, friction: f32| {
        let change = |all: &mut Particles| {
            all.spins_mut()[3].friction = friction;
            Ok(())
        };
        world.edit(change).expect("valid");
    };
    edit(&mut world, 0.5);
    assert_ne!(world.state_hash().unwrap(), expected);
    assert_eq!(world.bodies().friction().unwrap(), [0.0, 0.0, 0.0, 0.5, 0.0]);
    edit(&mut world, 0.0);
    assert_eq!(world.state_hash().unwrap(), expected);
    assert!(world.bodies().particles().unwrap().spins.is_empty());
}

#[test]
fn merged_discs_keep_angular_momentum() {
    let mut all = Particles::new(
        vec![[0.0, 0.0], [3.0, 0.8], [30.0, 0.0], [33.0, 0.8]],
        vec![[1.0, 0.0], [-1.0, 0.0], [1.0, 0.0], [-1.0, 0.0]],
        vec![1.0; 4],
        1.0,
    );
    all.spins = vec![spin(0.2, 1.0), spin(0.6, 2.0), Spin::default(), Spin::default()];
    let settings =
        WorldSettings { on_touch: jostle_world::OnTouch::Merge, ..WorldSettings::default() };
    let mut world = world_of(all.clone(), settings);
    run_for(&mut world, 0.1, 20);
    let merged = world.bodies().particles().unwrap();
    assert_eq!(merged.len(), 2);
    assert_eq!(merged.spin(0).friction, 0.4);
    // Discs without friction do not turn.
    assert_eq!(merged.spin(1), Spin::default());
    let keep = |particles: &Particles, row: usize| {
        let mut part = particles.clone();
        part.retain(|at| if row == 0 { at < particles.len() / 2 } else { false });
        angular_momentum(&part, [0.0; 2])
    };
    assert!((keep(&merged, 0) - keep(&all, 0)).abs() < 1e-5);
}

/// A disc of radius 1 on the floor of a box, under a gravity that is tilted by `angle`.
fn on_an_incline(angle: f32, friction: f32, speed: f32) -> World {
    let mut all = discs(&[([0.0, 1.0], [speed, 0.0])], 1.0);
    all.spins = vec![spin(friction, 0.0)];
    let settings = WorldSettings {
        gravity: [10.0 * angle.sin(), -10.0 * angle.cos()],
        container: boxed([-5000.0, 0.0], [5000.0, 50.0]),
        ..Default::default()
    };
    world_of(bouncing(all, 0.5), settings)
}

#[test]
fn a_disc_slides_or_rolls_down_an_incline() {
    for angle in [0.1f32, 0.5, 1.0] {
        for friction in [0.0, 0.1, 0.3, 0.8] {
            let mut world = on_an_incline(angle, friction, 0.0);
            run(&mut world, 300);
            let (sin, cos) = (10.0 * angle.sin(), 10.0 * angle.cos());
            let slides = angle.tan() > 3.0 * friction;
            let expected = if slides { sin - friction * cos } else { 2.0 / 3.0 * sin };
            let turning = if slides { 2.0 * friction * cos } else { expected };
            let Particles { positions, velocities, spins, .. } =
                world.bodies().particles().unwrap();
            let time = 300.0 * STEP as f32;
            let close = |found: f32, expected: f32| {
                let error = (found - expected).abs();
                assert!(error <= 0.01 * expected.abs(), "{angle} {friction}: {found} {expected}");
            };
            close(velocities[0][0], expected * time);
            close(positions[0][0], 0.5 * expected * time * time);
            if friction > 0.0 {
                close(spins[0].velocity, -turning * time);
            }
        }
    }
}

#[test]
fn a_sliding_disc_begins_to_roll_at_two_thirds_of_its_speed() {
    for friction in [0.1, 0.5] {
        let mut world = on_an_incline(0.0, friction, 9.0);
        run(&mut world, 10);
        // Until then it is braked by μ g.
        let braked = 9.0 - 10.0 * friction * 10.0 * STEP as f32;
        assert!((world.bodies().velocities().unwrap()[0][0] - braked).abs() < 0.01 * braked);
        run(&mut world, 240);
        assert!(
            (world.bodies().velocities().unwrap()[0][0] - 6.0).abs() < 1e-4,
            "{:?}",
            world.bodies().velocities().unwrap()
        );
        assert!((world.bodies().angular_velocities().unwrap()[0] + 6.0).abs() < 1e-4);
    }
}

#[test]
fn results_scale_with_the_units() {
    // Powers of 2, so that rounding is the same.
    let scale = [1.0 / 1024.0, 1.0 / 128.0, 8.0];
    let worlds = [[1.0f32; 3], scale].map(|[length, time, mass]| {
        let mut all = rough_cloud(40, 3);
        all.positions.iter_mut().for_each(|p| *p = p.map(|x| (x + 1.0) * length));
        all.velocities.iter_mut().for_each(|v| *v = v.map(|v| v * length / time));
        all.radii.iter_mut().for_each(|r| *r *= length);
        all.masses.iter_mut().for_each(|m| *m *= mass);
        all.spins.iter_mut().for_each(|spin| spin.velocity /= time);
        let settings = WorldSettings {
            gravity: [0.0, -10.0 * length / (time * time)],
            container: boxed([0.0; 2], [9.0 * length; 2]),
            ..Default::default()
        };
        let mut world = world_of(all, settings);
        run_for(&mut world, 0.5 * STEP * f64::from(time), 60);
        world
    });
    let [one, other] = worlds.map(|world| world.bodies().particles().unwrap());
    for row in 0..one.len() {
        let [p, q] = [&one, &other].map(|all| all.positions[row]);
        assert_eq!(p, q.map(|x| x / scale[0]), "{row}");
        let [v, w] = [&one, &other].map(|all| all.spin(row).velocity);
        assert_eq!(v, w * scale[1], "{row}");
    }
}

#[test]
fn two_logs_hold_a_third_if_friction_is_large_enough() {
    // The force between two logs passes through the point where the lower one touches the floor.
    let least = (15.0f32).to_radians().tan();
    let moved = |friction: f32| {
        let positions = vec![[0.0, 0.5], [1.0, 0.5], [0.5, 0.5 + 0.75f32.sqrt()]];
        let mut all = bouncing(still(&positions, 0.5), 0.3);
        all.spins = vec![spin(friction, 0.0); 3];
        let settings = WorldSettings {
            gravity: [0.0, -10.0],
            container: boxed([-20.0, 0.0], [24.0, 50.0]),
            ..Default::default()
        };
        let mut world = world_of(all, settings);
        let before = world.bodies().positions().unwrap();
        run(&mut world, 300);
        let moved = before.iter().zip(world.bodies().positions().unwrap());
        moved.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f32::max)
    };
    for share in [0.0, 0.5, 0.97] {
        assert!(moved(share * least) > 1.0, "{share}: they roll apart");
    }
    for share in [1.03, 2.0, 5.0] {
        assert!(moved(share * least) < 1e-3, "{share}: they hold");
    }
}

/// The forces of contacts and walls on each disc in a step.
fn forces(world: &World, dt: f64) -> Vec<[f64; 2]> {
    let mut forces = vec![[0.0; 2]; world.len()];
    let mut add =
        |id: jostle_base::Id, sign: f64, [x, y]: [f32; 2], [normal, friction]: [f32; 2]| {
            let [x, y] = [x, y].map(f64::from);
            let [normal, friction] = [normal, friction].map(f64::from);
            let force = &mut forces[id as usize];
            force[0] += sign * (normal * x - friction * y) / dt;
            force[1] += sign * (normal * y + friction * x) / dt;
        };
    for touch in world.contacts().unwrap() {
        let impulses = [touch.normal_impulse, touch.friction_impulse];
        add(touch.pair[0], -1.0, touch.normal, impulses);
        add(touch.pair[1], 1.0, touch.normal, impulses);
    }
    for touch in world.wall_contacts().unwrap() {
        add(touch.id, 1.0, touch.normal, [touch.normal_impulse, touch.friction_impulse]);
    }
    forces
}

#[test]
fn contacts_carry_the_weight_of_discs_at_rest() {
    let positions = vec![[0.0, 0.5], [1.0, 0.5], [0.5, 0.5 + 0.75f32.sqrt()]];
    let mut all = bouncing(still(&positions, 0.5), 0.3);
    all.spins = vec![spin(0.6, 0.0); 3];
    let settings = WorldSettings {
        gravity: [0.0, -10.0],
        container: boxed([-20.0, 0.0], [24.0, 50.0]),
        ..Default::default()
    };
    let mut world = world_of(all, settings);
    run(&mut world, 120);
    let weight = 10.0 * 0.25;
    for [x, y] in forces(&world, STEP) {
        assert!(x.abs() < 2e-3 * weight && (y - weight).abs() < 2e-3 * weight, "{x} {y}");
    }
    let floor: f32 = world.wall_contacts().unwrap().iter().map(|touch| touch.normal_impulse).sum();
    assert!((f64::from(floor) / STEP / (3.0 * weight) - 1.0).abs() < 1e-4, "{floor}");
    assert_eq!(
        world.wall_contacts().unwrap().iter().map(|touch| touch.wall).collect::<Vec<_>>(),
        [-4, -4]
    );
    // The two below push the third up and are pushed outwards, which friction balances.
    assert!(world.wall_contacts().unwrap()[0].friction_impulse < -1e-4);
    assert!(world.wall_contacts().unwrap()[1].friction_impulse > 1e-4);
}

#[test]
fn the_walls_carry_the_weight_of_a_pile() {
    for friction in [0.0, 0.5] {
        let mut world = jostle_scenes::find("pile").unwrap().create(Some(500), 0).unwrap();
        // Asleep it has the impulses of the step in which it fell asleep.
        world.configure(WorldSettings { sleeping: false, ..*world.settings() }).unwrap();
        let roughen = |all: &mut Particles| {
            all.spins_mut().iter_mut().for_each(|spin| spin.friction = friction);
            Ok(())
        };
        world.edit(roughen).expect("valid");
        run(&mut world, 480);
        let masses: f64 =
            world.bodies().masses().unwrap().iter().map(|&mass| f64::from(mass)).sum();
        let weight = masses * f64::from(world.settings().gravity[1]);
        // With friction the side walls carry a part (H. A. Janssen, 1895).
        let upwards = |touch: &jostle_world::WallTouch| {
            let [x, y] = touch.normal.map(f64::from);
            let [normal, friction] = [touch.normal_impulse, touch.friction_impulse].map(f64::from);
            -(normal * y + friction * x)
        };
        let mut shares = Vec::new();
        for _ in 0..20 {
            let momentum = world.momentum()[1];
            run(&mut world, 1);
            let sum: f64 = world.wall_contacts().unwrap().iter().map(upwards).sum();
            // What the walls do not carry changes the momentum.
            let carried = weight - (world.momentum()[1] - momentum) / STEP;
            assert!((sum / STEP / carried - 1.0).abs() < 1e-4, "{friction}: {sum}");
            shares.push(sum / STEP / weight);
        }
        let share = shares.iter().sum::<f64>() / 20.0;
        assert!((share - 1.0).abs() < 1e-3, "{friction}: {share}");
    }
}

#[test]
fn impulses_are_those_of_impacts() {
    let two = Two {
        velocities: [[1.0, 0.5], [-1.0, 0.0]],
        radii: [0.5, 1.0],
        masses: [2.0, 3.0],
        spins: [spin(0.2, 1.0), spin(0.2, -0.5)],
        restitution: 0.5,
    };
    let (world, [expected, _]) = (two.simulated(), two.analytic());
    let touches = world.contacts().unwrap();
    let found = [touches[0].normal_impulse, touches[0].friction_impulse];
    let expected = [0, 1].map(|k| -2.0 * (expected[k] as f32 - two.velocities[0][k]));
    assert!((0..2).all(|k| (found[k] - expected[k]).abs() < 1e-5), "{found:?} {expected:?}");
    assert!(world.wall_contacts().unwrap().is_empty());
}

#[test]
fn impulses_of_walls_change_the_momentum() {
    for dt in [0.1, 0.5, 3.0] {
        let container = boxed([-0.5; 2], [8.5; 2]);
        let settings = inside(container);
        let mut world = world_of(rough_cloud(60, 1), settings);
        let mut pushed = 0;
        for _ in 0..10 {
            let before = world.momentum();
            run_for(&mut world, dt, 1);
            let after = world.momentum();
            let mut sum = [0.0; 2];
            for touch in world.wall_contacts().unwrap() {
                let ([x, y], normal, friction) =
                    (touch.normal, touch.normal_impulse, touch.friction_impulse);
                sum[0] += f64::from(normal * x - friction * y);
                sum[1] += f64::from(normal * y + friction * x);
                pushed += 1;
            }
            let error = |k: usize| (after[k] - before[k] - sum[k]).abs();
            assert!(error(0).max(error(1)) < 1e-4, "{dt}: {before:?} {after:?} {sum:?}");
        }
        assert!(pushed > 5, "{dt}: {pushed}");
    }
}

#[test]
fn impulses_of_walls_follow_their_particles() {
    let positions = vec![[2.0, 1.0], [5.0, 1.0], [8.0, 1.0]];
    let all = bouncing(still(&positions, 1.0), 0.3);
    let settings = WorldSettings {
        gravity: [0.0, -10.0],
        container: boxed([0.0; 2], [10.0; 2]),
        ..Default::default()
    };
    let mut world = world_of(all, settings);
    run(&mut world, 3);
    let ids =
        |world: &World| world.wall_contacts().unwrap().iter().map(|of| of.id).collect::<Vec<_>>();
    assert_eq!(ids(&world), [0, 1, 2]);
    let again = World::restore(&world.snapshot().unwrap()).unwrap();
    assert_eq!(again.wall_contacts().unwrap(), world.wall_contacts().unwrap());
    assert!(world.step(1e30, 1).is_err());
    assert_eq!(again.wall_contacts().unwrap(), world.wall_contacts().unwrap());
    world.remove(&[1]).unwrap();
    assert_eq!(ids(&world), [0, 2]);
    let container = boxed([0.0; 2], [20.0; 2]);
    world.configure(WorldSettings { container, ..*world.settings() }).unwrap();
    assert!(world.wall_contacts().unwrap().is_empty());
}
