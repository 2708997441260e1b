//! Walls on a torus: they act as copies of them that fill the plane.

use jostle_base::Method;
use jostle_scenes::random::Random;
use jostle_world::{Container, Particles, Wall, World, WorldSettings};

use crate::common::worlds::{Row, STEP, bouncing, discs, gathered, run, walled, world_of};

fn on(size: [f32; 2], settings: WorldSettings) -> WorldSettings {
    WorldSettings { container: Container::Torus { size }, ..settings }
}

fn falling() -> WorldSettings {
    WorldSettings { gravity: [0.0, -9.8], sleeping: false, ..WorldSettings::default() }
}

/// The minimum image of the difference of two positions.
fn difference([a, b]: [[f32; 2]; 2], size: [f32; 2]) -> [f64; 2] {
    [0, 1].map(|k| {
        let (side, by) = (f64::from(size[k]), f64::from(b[k]) - f64::from(a[k]));
        by - side * (by / side).round()
    })
}

/// A torus of `size` with discs and walls, and a plane with so many copies of it on each side.
fn both(
    rows: &[Row],
    walls: &[Wall],
    (size, copies): ([f32; 2], i32),
    (radius, restitution): (f32, f32),
    settings: WorldSettings,
) -> [World; 2] {
    let discs = |rows| bouncing(discs(rows, radius), restitution);
    let torus = walled(discs(rows), walls.to_vec(), on(size, settings));
    let tiles = (-copies..=copies).flat_map(|x| (-copies..=copies).map(move |y| [x, y]));
    // Those of the middle first.
    let tiles = std::iter::once([0, 0]).chain(tiles.filter(|tile| *tile != [0, 0]));
    let (mut all_rows, mut all_walls) = (Vec::new(), Vec::new());
    for tile in tiles {
        let moved = |p: [f32; 2]| [0, 1].map(|k| p[k] + tile[k] as f32 * size[k]);
        all_rows.extend(rows.iter().map(|&(at, velocity)| (moved(at), velocity)));
        all_walls.extend(walls.iter().map(|wall| Wall { ends: wall.ends.map(moved), ..*wall }));
    }
    [torus, walled(discs(&all_rows), all_walls, settings)]
}

/// Refuses discs of the two that differ, or do not move alike.
fn check(worlds: &[World; 2], count: usize, size: [f32; 2], tolerance: f64, name: &str) {
    let [torus, plane] = worlds;
    for k in 0..count {
        let [x, y] =
            difference([torus, plane].map(|world| world.bodies().positions().unwrap()[k]), size);
        let [[u, v], [p, q]] =
            [torus, plane].map(|world| world.bodies().velocities().unwrap()[k].map(f64::from));
        let (far, fast) = (x.hypot(y), (u - p).hypot(v - q));
        assert!(far < tolerance && fast < 30.0 * tolerance, "{name}: disc {k}: {far} {fast}");
    }
}

/// Walls and discs at random, of which none overlap at first.
fn scene(seed: u64, size: [f32; 2], radius: f32) -> (Vec<Row>, Vec<Wall>) {
    let mut random = Random::new(seed);
    let mut walls = Vec::new();
    for _ in 0..6 {
        // Some begin outside the torus.
        let [x, y] = size.map(|side| random.between(-side, 2.0 * side));
        let by = size.map(|side| random.between(-0.4 * side, 0.4 * side));
        walls.push(Wall::new([[x, y], [x + by[0], y + by[1]]]));
    }
    // One from side to side, with a corner at the periodic boundary.
    let low = random.between(0.0, size[1]);
    let high = low + random.between(-3.0, 3.0);
    let middle = [0.4 * size[0], high];
    walls.push(Wall::new([[0.0, low], middle]));
    walls.push(Wall::new([middle, [size[0], low]]));
    let near = |at: [f32; 2], wall: &Wall| {
        let [a, b] = wall.ends.map(|end| end.map(f64::from));
        let along = [b[0] - a[0], b[1] - a[1]];
        let square = along[0] * along[0] + along[1] * along[1];
        let tiles = (-3..=3).flat_map(|x| (-3..=3).map(move |y| [x, y]));
        let gaps = tiles.map(|tile: [i32; 2]| {
            let p =
                [0, 1].map(|k| f64::from(at[k]) + f64::from(tile[k]) * f64::from(size[k]) - a[k]);
            let share = ((p[0] * along[0] + p[1] * along[1]) / square).clamp(0.0, 1.0);
            (p[0] - share * along[0]).hypot(p[1] - share * along[1])
        });
        gaps.fold(f64::INFINITY, f64::min) < 1.05 * f64::from(radius)
    };
    let mut rows: Vec<Row> = Vec::new();
    for _ in 0..300 {
        let at = size.map(|side| random.between(0.0, side));
        let velocity = [random.between(-9.0, 9.0), random.between(-9.0, 9.0)];
        let meets = |row: &Row| {
            let [x, y] = difference([row.0, at], size);
            x.hypot(y) < 2.1 * f64::from(radius)
        };
        if rows.len() < 12 && !rows.iter().any(meets) && !walls.iter().any(|wall| near(at, wall)) {
            rows.push((at, velocity));
        }
    }
    (rows, walls)
}

#[test]
fn they_act_as_copies_in_the_plane() {
    let size = [21.0, 17.0];
    for seed in 0..12 {
        let (mut rows, mut walls) = scene(seed, size, 0.8);
        assert!(rows.len() > 4 && walls.len() == 8);
        if seed % 3 == 1 {
            walls.iter_mut().for_each(|wall| wall.velocity = [3.0, -2.0]);
        }
        if seed % 4 == 3 {
            // Much faster: around the torus in a step.
            rows.truncate(1);
            rows[0].1 = rows[0].1.map(|v| 200.0 * v);
        }
        for (gravity, restitution) in [(0.0, 1.0), (0.0, 0.6), (-9.8, 1.0), (-9.8, 0.3)] {
            let settings = WorldSettings { gravity: [0.0, gravity], ..falling() };
            let copies = if seed % 4 == 3 { 8 } else { 2 };
            let mut worlds = both(&rows, &walls, (size, copies), (0.8, restitution), settings);
            for step in 0..if seed % 4 == 3 { 1 } else { 12 } {
                worlds.iter_mut().for_each(|world| run(world, 1));
                let name = format!("seed {seed} g {gravity} e {restitution} step {step}");
                check(&worlds, rows.len(), size, 2e-3, &name);
            }
        }
    }
}

#[test]
fn a_disc_rolls_over_the_boundary_without_a_bump() {
    let size = [30.0, 20.0];
    let one = vec![Wall::new([[0.0, 5.0], [30.0, 5.0]])];
    let shifted = vec![Wall::new([[-12.0, 25.0], [18.0, 25.0]])];
    let several = [0.0, 7.0, 19.0, 30.0].windows(2).map(|x| Wall::new([[x[0], 5.0], [x[1], 5.0]]));
    for (name, walls) in [("one", one), ("shifted", shifted), ("several", several.collect())] {
        for (restitution, speed) in [(1.0, 3.0), (0.5, 17.0), (0.0, 400.0)] {
            let disc = bouncing(discs(&[([0.1, 6.0], [speed, 0.0])], 1.0), restitution);
            let mut world = walled(disc, walls.clone(), on(size, falling()));
            for step in 0..120 {
                run(&mut world, 1);
                let ([_, y], [u, v]) = (
                    world.bodies().positions().unwrap()[0],
                    world.bodies().velocities().unwrap()[0],
                );
                let at = format!("{name} e {restitution} speed {speed} step {step}: {y} {u} {v}");
                assert!((y - 6.0).abs() < 1e-5 && v.abs() < 0.2, "{at}");
                assert!((u / speed - 1.0).abs() < 1e-5, "{at}");
            }
        }
    }
}

#[test]
fn a_disc_may_touch_two_images_of_a_wall() {
    // The gap between the ends of the wall is 4 wide.
    let size = [10.0, 12.0];
    let walls = [Wall::new([[2.0, 3.0], [8.0, 3.0]])];
    for (x, restitution) in [(0.0, 1.0), (0.0, 0.5), (0.3, 1.0), (0.3, 0.5), (0.3, 0.0)] {
        for gravity in [0.0, -9.8] {
            let settings = WorldSettings { gravity: [0.0, gravity], ..falling() };
            let rows = [([x, 7.0], [0.0, -6.0])];
            let mut worlds = both(&rows, &walls, (size, 1), (2.5, restitution), settings);
            worlds.iter_mut().for_each(|world| run(world, 60));
            check(&worlds, 1, size, 2e-3, &format!("{x} {restitution} {gravity}"));
        }
    }
    let disc = bouncing(discs(&[([0.3, 7.0], [0.0; 2])], 2.5), 0.3);
    let mut rests = walled(disc, walls.to_vec(), on(size, falling()));
    run(&mut rests, 900);
    let [x, y] = rests.bodies().positions().unwrap()[0];
    let x = difference([[0.0; 2], [x, y]], size)[0];
    assert!(x.abs() < 1e-2 && (y - 4.5).abs() < 1e-2, "{x} {y}");
}

#[test]
fn nothing_leaves_a_polygon_at_the_boundary() {
    let size = [12.0, 10.0];
    let corners = [[-4.0, -3.0], [3.0, -4.0], [4.5, 3.0], [-2.0, 4.0]];
    let mut walls: Vec<Wall> = corners.windows(2).map(|two| Wall::new([two[0], two[1]])).collect();
    walls.push(Wall::new([corners[3], corners[0]]));
    for (speed, restitution, gravity) in
        [(1.0, 1.0, 0.0), (300.0, 1.0, 0.0), (30_000.0, 1.0, 0.0), (40.0, 0.5, -9.8)]
    {
        let rows: Vec<_> = (0..6)
            .map(|k| {
                let angle = k as f32;
                let at = [(k % 3) as f32 * 0.9 - 0.9, (k / 3) as f32 * 0.9 - 0.5];
                (at, [speed * angle.cos(), speed * angle.sin()])
            })
            .collect();
        let settings = WorldSettings { gravity: [0.0, gravity], ..falling() };
        let mut world =
            walled(bouncing(discs(&rows, 0.4), restitution), walls.clone(), on(size, settings));
        let before = world.kinetic_energy();
        for step in 0..40 {
            run(&mut world, 1);
            for at in world.bodies().positions().unwrap() {
                let [x, y] = difference([[0.0; 2], at], size);
                for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                    let [u, v] = [0, 1].map(|k| f64::from(b[k] - a[k]));
                    let (p, q) = (x - f64::from(a[0]), y - f64::from(a[1]));
                    let gap = (u * q - v * p) / u.hypot(v) / 0.4 - 1.0;
                    assert!(gap > -0.02, "speed {speed} step {step}: {x} {y} {gap}");
                }
            }
        }
        if restitution == 1.0 {
            assert!((world.kinetic_energy() / before - 1.0).abs() < 1e-4, "{speed}");
        }
    }
}

/// Many discs among walls at random.
fn crowd(
    (count, restitution): (usize, f32),
    settings: WorldSettings,
    order: Option<&[u32]>,
) -> World {
    let mut random = Random::new(8);
    let side = (count as f32).sqrt() * 3.0;
    let mut point = |low: f32, high: f32| [random.between(low, high), random.between(low, high)];
    let rows: Vec<_> = (0..count).map(|_| (point(0.0, side), point(-9.0, 9.0))).collect();
    let walls = (0..count / 4).map(|k| {
        let (a, by) = (point(0.0, side), point(0.3, 4.0));
        let moving = if k % 7 == 0 { [2.0, 1.0] } else { [0.0; 2] };
        Wall { velocity: moving, ..Wall::new([a, [a[0] + by[0], a[1] - by[1]]]) }
    });
    let walls = walls.collect();
    let (straight, mut all) = (bouncing(discs(&rows, 0.9), restitution), Particles::default());
    let own: Vec<u32> = (0..count as u32).collect();
    all.gather(&straight, order.unwrap_or(&own), None);
    walled(all, walls, on([side; 2], settings))
}

#[test]
fn they_do_not_show_how_they_are_computed() {
    for (restitution, settings) in [(0.5, falling()), (1.0, WorldSettings::default())] {
        let mut expected = crowd((300, restitution), settings, None);
        run(&mut expected, 40);
        let mut brute =
            crowd((300, restitution), WorldSettings { method: Method::Brute, ..settings }, None);
        run(&mut brute, 40);
        assert_eq!(brute.state_hash().unwrap(), expected.state_hash().unwrap(), "brute force");
        assert_eq!(
            brute.wall_contacts().unwrap(),
            expected.wall_contacts().unwrap(),
            "brute force"
        );
        let mut half = crowd((300, restitution), settings, None);
        run(&mut half, 20);
        let mut half = World::restore(&half.snapshot().unwrap()).expect("valid");
        run(&mut half, 20);
        assert_eq!(half.snapshot().unwrap(), expected.snapshot().unwrap(), "a snapshot");
        let order: Vec<u32> = (0..300).map(|k| (k * 77 + 5) % 300).collect();
        let mut mixed = crowd((300, restitution), settings, Some(&order));
        run(&mut mixed, 40);
        let particles = gathered(&expected.bodies().particles().unwrap(), &order);
        assert!(mixed.bodies().particles().unwrap() == particles, "the order of adding");
    }
}

#[test]
fn threads_do_not_show_in_them() {
    for (restitution, settings) in [(0.5, falling()), (1.0, WorldSettings::default())] {
        let found = [1, 3].map(|threads| {
            let mut settings = settings;
            settings.tree.threads = Some(threads);
            let mut world = crowd((12_000, restitution), settings, None);
            run(&mut world, 2);
            (world.state_hash().unwrap(), world.wall_contacts().unwrap())
        });
        assert!(found[0] == found[1]);
    }
}

#[test]
fn walls_that_do_not_fit_are_refused() {
    let long = Wall::new([[0.0, 1.0], [12.5, 1.0]]);
    let disc = || discs(&[([5.0; 2], [1.0, 0.0])], 1.0);
    let mut torus = world_of(disc(), on([12.0, 9.0], WorldSettings::default()));
    let error = torus.set_walls(vec![long]).expect_err("it is too long").to_string();
    let expected = "walls[0] is ((0, 1), (12.5, 1)); in a periodic world a wall may extend over each side \
                    once at most";
    assert_eq!(error, expected);
    assert!(torus.walls().is_empty());
    let mut plane = walled(disc(), vec![long], WorldSettings::default());
    let before = plane.snapshot().unwrap();
    let error = plane.configure(on([12.0, 9.0], WorldSettings::default())).expect_err("too long");
    assert_eq!(error.to_string(), expected);
    assert_eq!(plane.snapshot().unwrap(), before);
    plane.configure(on([13.0, 9.0], WorldSettings::default())).expect("it fits");
    let fast = Wall { velocity: [800.0, 0.0], ..long };
    plane.set_walls(vec![fast]).expect("valid");
    let error = plane.step(STEP, 1).expect_err("it is too fast").to_string();
    assert!(
        error.ends_with("wall 0 would travel more than the period; take smaller steps"),
        "{error}"
    );
}
