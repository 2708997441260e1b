//! Contacts at all scales: small discs and large ones, long walls, slow and fast, near the origin and
//! far from it. The answers are analytic.

use jostle_world::{Container, Particles, Wall, World, WorldSettings};

use crate::common::worlds::{boxed, walled, world_of};

/// What the small disc, of radius 1, meets.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Other {
    /// An immovable disc of this radius.
    Fixed(f64),
    /// An immovable disc of this radius that moves towards the small one.
    Kinematic(f64),
    /// A movable disc of this radius, with a mass in proportion to its area.
    Movable(f64),
    /// A wall from −L to L.
    Wall(f64),
    /// The floor of a box of this half width.
    Floor(f64),
    /// The inside of a round container of this radius.
    Round(f64),
}

impl Other {
    /// Whether a disc stays on it, or bounces on it again and again, although numbers are rounded. It
    /// rolls down a small disc.
    fn is_stable(self) -> bool {
        !matches!(self, Self::Movable(_)) && (self.radius() == 0.0 || self.radius() > 1e4)
    }

    fn radius(self) -> f64 {
        match self {
            Self::Fixed(radius) | Self::Kinematic(radius) | Self::Movable(radius) => radius,
            _ => 0.0,
        }
    }
}

/// A disc of radius 1 that approaches something. The place of contact is near (`place`, `place`), and
/// the normal there is +y turned by an angle clockwise.
#[derive(Clone, Copy, Debug)]
struct Case {
    other: Other,
    angle: f64,
    place: f64,
    /// Gap at the beginning.
    gap: f64,
    /// Displacement in a sub-step against the normal.
    travel: f64,
    restitution: f32,
    /// Acceleration against the normal.
    gravity: f64,
    /// Seconds of a step.
    dt: f64,
    substeps: usize,
}

/// A number as float32 and what rounding removed.
fn split(value: f64) -> [f32; 2] {
    let rounded = value as f32;
    [rounded, (value - f64::from(rounded)) as f32]
}

impl Case {
    fn is_stable(&self) -> bool {
        self.angle == 0.0 && !matches!(self.other, Other::Movable(_)) || self.other.is_stable()
    }

    fn normal(&self) -> [f64; 2] {
        [self.angle.sin(), self.angle.cos()]
    }

    /// The point that is so far from the place of contact, along the surface and along the normal.
    fn point(&self, along: f64, normal: f64) -> [f64; 2] {
        let [x, y] = self.normal();
        [self.place + y * along + x * normal, self.place - x * along + y * normal]
    }

    /// This point in float32.
    fn rounded(&self, along: f64, normal: f64) -> [f32; 2] {
        self.point(along, normal).map(|v| v as f32)
    }

    /// The ends of the wall.
    fn ends(&self, half: f64) -> [[f32; 2]; 2] {
        [self.rounded(-half, 0.0), self.rounded(half, 0.0)]
    }

    /// The distance from the surface of the other body to a point.
    fn distance(&self, [x, y]: [f64; 2], center: Option<[f64; 2]>) -> f64 {
        let from = |of: [f64; 2]| ((x - of[0]).powi(2) + (y - of[1]).powi(2)).sqrt();
        match self.other {
            Other::Wall(half) => {
                let [[a, b], [c, d]] = self.ends(half).map(|end| end.map(f64::from));
                let [u, v] = [c - a, d - b];
                ((y - b) * u - (x - a) * v) / (u * u + v * v).sqrt()
            }
            Other::Floor(_) => y - f64::from(self.place as f32),
            Other::Round(radius) => {
                let center = self.rounded(0.0, radius).map(f64::from);
                f64::from(radius as f32) - from(center)
            }
            _ => {
                from(center.expect("there is another disc")) - f64::from(self.other.radius() as f32)
            }
        }
    }

    /// The world; the disc has row 0, another disc row 1.
    fn world(&self) -> World {
        let radius = self.other.radius();
        let center = self.rounded(0.0, -radius);
        let [x, y] = self.normal();
        // The surface of the other body, whose numbers are float32, is not exactly at the place.
        let near = self.point(0.0, 1.0 + self.gap);
        let by = 1.0 + self.gap - self.distance(near, Some(center.map(f64::from)));
        let [[px, rx], [py, ry]] = [near[0] + by * x, near[1] + by * y].map(split);
        let speed = self.travel * self.substeps as f64 / self.dt;
        let velocity = |speed: f64| [(speed * x) as f32, (speed * y) as f32];
        let mut particles = Particles {
            positions: vec![[px, py]],
            residuals: vec![[rx, ry]],
            velocities: vec![velocity(-speed)],
            radii: vec![1.0],
            masses: vec![1.0],
            restitution: vec![self.restitution],
            movable: vec![true],
            ..Particles::default()
        };
        if radius > 0.0 {
            particles.positions.push(center);
            particles.residuals.push([0.0; 2]);
            let is_kinematic = matches!(self.other, Other::Kinematic(_));
            particles.velocities.push(velocity(if is_kinematic { 0.5 * speed } else { 0.0 }));
            particles.radii.push(radius as f32);
            particles.masses.push((radius * radius) as f32);
            particles.restitution.push(self.restitution);
            particles.movable.push(matches!(self.other, Other::Movable(_)));
        }
        let container = match self.other {
            Other::Floor(half) => boxed(
                [(self.place - half) as f32, self.place as f32],
                [self.place + half, self.place + 2.0 * half].map(|v| v as f32),
            ),
            Other::Round(radius) => {
                Container::Circle { center: self.rounded(0.0, radius), radius: radius as f32 }
            }
            _ => Container::None,
        };
        let settings = WorldSettings {
            gravity: velocity(-self.gravity),
            container,
            substeps: Some(self.substeps),
            ..WorldSettings::default()
        };
        let mut world = world_of(particles, settings);
        if let Other::Wall(half) = self.other {
            world.set_walls(vec![Wall::new(self.ends(half))]).expect("the wall is valid");
        }
        world
    }

    /// The gap between the surfaces, from the stored positions with their residuals.
    fn gap(&self, world: &World) -> f64 {
        let particles = world.bodies().particles().unwrap();
        let row = |row: usize| {
            let [x, y] = *particles.positions.get(row)?;
            let [rx, ry] = particles.residuals[row];
            Some([f64::from(x) + f64::from(rx), f64::from(y) + f64::from(ry)])
        };
        self.distance(row(0).expect("there is a disc"), row(1)) - 1.0
    }

    /// The velocity of approach.
    fn approach(&self, world: &World) -> f64 {
        let velocity = |row: usize| {
            let velocity = world
                .bodies()
                .particles()
                .unwrap()
                .velocities
                .get(row)
                .copied()
                .unwrap_or_default();
            let [x, y] = self.normal();
            f64::from(velocity[0]) * x + f64::from(velocity[1]) * y
        };
        velocity(1) - velocity(0)
    }

    /// One spacing of float32 at the place.
    fn coarse(&self) -> f64 {
        self.place.abs() * f64::from(f32::EPSILON)
    }

    /// How deep the disc may be: 0.5 % of its radius, and far from the origin one spacing of float32.
    fn allowed(&self) -> f64 {
        0.005 + self.coarse()
    }

    fn step(&self, world: &mut World) {
        world.step(self.dt, 1).unwrap_or_else(|error| panic!("{self:?}: {error}"));
        let gap = self.gap(world);
        assert!(gap > -self.allowed(), "{self:?}: it is {} radii deep", -gap);
    }

    /// Without gravity: the disc bounces with its restitution.
    fn check_bounce(&self) {
        let mut world = self.world();
        let before = self.approach(&world);
        let gap = self.gap(&world).max(0.0);
        let travel = before * self.dt;
        let steps = 3 + (gap / travel).ceil() as usize;
        for _ in 0..steps {
            self.step(&mut world);
        }
        let expected = -before * f64::from(self.restitution);
        let error = (self.approach(&world) - expected).abs() / before;
        assert!(error < 1e-3, "{self:?}: approach {before}, then {}", self.approach(&world));
        // Nothing follows.
        let after = self.approach(&world);
        for _ in 0..3 {
            self.step(&mut world);
        }
        assert_eq!(self.approach(&world), after, "{self:?}: it changed later");
    }
}

impl Case {
    /// Under gravity: the disc is on the surface in the end.
    fn check_rest(&self, steps: usize) {
        let mut world = self.world();
        // Fallen for so long, it is at rest.
        let h = self.dt / self.substeps as f64;
        let fall = (2.0 * self.gap.max(0.0) / self.gravity).sqrt() / h;
        if 8.0 * fall > (steps * self.substeps) as f64 {
            return;
        }
        for _ in 0..steps {
            self.step(&mut world);
        }
        let gap = self.gap(&world);
        assert!(gap.abs() <= self.allowed(), "{self:?}: it rests {gap} radii above the surface");
    }

    /// An elastic disc falls from a height, in spacings of float32, and returns to it. A sub-step is as
    /// long as the disc falls by `travel` of the height in it from rest.
    fn check_bounces(&self, height: f64, travel: f64) {
        // The coordinates near the surface are about 1 at the origin.
        let height = height * f64::from(f32::EPSILON) * self.place.max(1.0);
        let h = self.dt / self.substeps as f64;
        let gravity = 2.0 * travel * height / (h * h);
        let case = Self { gap: height, gravity, ..*self };
        let mut world = case.world();
        let energy = |world: &World| {
            let speed = case.approach(world);
            0.5 * speed * speed + gravity * case.gap(world)
        };
        // At most ten bounces, each of which takes 2 √(2 height/gravity) seconds.
        let bounce = 2.0 / travel.sqrt();
        let steps = ((10.0 * bounce) as usize / self.substeps).clamp(20, 300);
        let before = energy(&world);
        for _ in 0..steps {
            case.step(&mut world);
            let error = (energy(&world) / before - 1.0).abs();
            // 0.1 % of the speed in each of ten bounces.
            assert!(error < 2e-2, "{case:?}: height {height}, energy {error} off");
        }
    }
}

/// Everything that a disc of radius 1 may meet, of some sizes.
fn others() -> impl Iterator<Item = Other> {
    [1.0, 30.0, 1e3, 1e5, 1e7].into_iter().flat_map(|size| {
        let discs = [Other::Fixed(size), Other::Kinematic(size), Other::Movable(size)];
        let walls = [
            Other::Wall(5.0 * size),
            Other::Floor(30.0 * size),
            Other::Round((0.01 * size).max(30.0)),
        ];
        discs.into_iter().chain(walls)
    })
}

/// Displacements in a sub-step, in radii.
fn travels() -> impl Iterator<Item = f64> {
    (0..=9).map(|exponent| 10f64.powi(-exponent))
}

/// Calls `act` with each combination of what the disc meets, of restitution, places, directions and
/// numbers of sub-steps.
fn each_case(mut act: impl FnMut(Case)) {
    for (other, restitution) in others().flat_map(|other| [0.0, 0.5, 1.0].map(|e| (other, e))) {
        for (place, substeps) in [(0.0, 4), (1e5, 1)] {
            for angle in [0.0, 0.7] {
                if angle == 0.0 || !matches!(other, Other::Floor(_)) {
                    let [travel, gravity, gap, dt] = [0.0, 0.0, 0.0, 1.0 / 60.0];
                    act(Case {
                        other,
                        angle,
                        place,
                        gap,
                        travel,
                        restitution,
                        gravity,
                        dt,
                        substeps,
                    });
                }
            }
        }
    }
}

#[test]
fn every_approach_ends_with_a_bounce() {
    each_case(|case| {
        // There a residual has about this size, which no disc moves less.
        let is_coarse = case.place > 0.0 && matches!(case.other, Other::Round(_));
        for travel in travels().filter(|&travel| !is_coarse || travel > 1e-9) {
            Case { travel, gap: 2.3 * travel, ..case }.check_bounce();
        }
    });
}

/// The disc falls from heights between nothing and a radius, and comes to rest on the surface.
#[test]
fn a_disc_rests_on_the_surface() {
    each_case(|case| {
        if case.restitution == 1.0 || !case.is_stable() {
            return;
        }
        for gap in [-1e-4, 0.0, 0.02] {
            for exponent in [-1, -4, -9] {
                // What gravity adds to the displacement in a sub-step.
                let h = case.dt / case.substeps as f64;
                let gravity = 10f64.powi(exponent) / (h * h);
                let case = Case { gap, gravity, ..case };
                case.check_rest(150);
            }
        }
    });
}

/// An elastic disc bounces under gravity to the same height again and again.
#[test]
fn an_elastic_disc_bounces_under_gravity() {
    each_case(|case| {
        if case.restitution < 1.0 || !case.is_stable() {
            return;
        }
        for height in [12.0, 400.0] {
            for travel in [1e-1, 1e-3, 1e-6] {
                case.check_bounces(height, travel);
            }
        }
    });
}

/// Discs that overlap are moved apart, also where nothing presses them together.
#[test]
fn overlaps_are_corrected() {
    each_case(|case| {
        for gap in [-0.02, -0.5, -0.9] {
            let case = Case { gap, ..case };
            let mut world = case.world();
            for _ in 0..120 {
                world.step(case.dt, 1).expect("a step succeeds");
            }
            let left = case.gap(&world);
            let most = case.allowed();
            assert!(left > -most, "{case:?}: it overlaps by {} radii", -left);
            assert!(left < most, "{case:?}: it is {left} radii apart");
        }
    });
}

/// A disc rolls without friction over a floor of pieces; returns the speed that it loses, as a share.
fn lost_on_floor(pieces: &[[[f32; 2]; 2]], speed: f32, restitution: f32) -> f64 {
    let particles = Particles {
        positions: vec![[1.0, 1.0]],
        residuals: vec![[0.0; 2]],
        velocities: vec![[speed, 0.0]],
        radii: vec![1.0],
        masses: vec![1.0],
        restitution: vec![restitution],
        movable: vec![true],
        ..Particles::default()
    };
    let settings = WorldSettings { gravity: [0.0, -10.0], ..WorldSettings::default() };
    let mut world = walled(particles, pieces.iter().copied().map(Wall::new).collect(), settings);
    world.step(1.0 / 60.0, (48.0 / f64::from(speed) * 60.0) as usize).expect("steps succeed");
    let [x, y] = world.bodies().particles().unwrap().positions[0];
    assert!(x > 45.0 && (0.99..1.2).contains(&y), "the disc is at ({x}, {y})");
    1.0 - f64::from(world.bodies().particles().unwrap().velocities[0][0] / speed)
}

/// Pieces of 0.25 radii, 190 joints.
#[test]
fn a_disc_rolls_over_pieces_that_miss_each_other() {
    let mut random = jostle_scenes::random::Random::new(3);
    for exponent in 0..=5 {
        let size = 1e-3 * 10f64.powi(-exponent);
        for (kind, is_random) in [(0, false), (1, false), (2, false), (3, true), (4, true)] {
            let pieces: Vec<_> = (0..210)
                .map(|number| {
                    let start = 0.25 * f64::from(number) - 1.0;
                    let share = if is_random { f64::from(random.unit()) } else { 1.0 };
                    let sign = if number % 2 == 0 { 0.5 } else { -0.5 };
                    let (along, up) = match kind {
                        0 => (-size, 0.0),
                        1 => (size, 0.0),
                        2 => (0.0, sign * size),
                        3 => (2.0 * (share - 0.5) * size, 0.0),
                        _ => (0.0, (share - 0.5) * size),
                    };
                    [[start, up], [start + 0.25 + along, up]].map(|end| end.map(|v| v as f32))
                })
                .collect();
            for (speed, restitution) in [(10.0, 0.0), (10.0, 0.5), (2.0, 0.0), (40.0, 0.0)] {
                let lost = lost_on_floor(&pieces, speed, restitution);
                assert!(
                    lost.abs() < 1e-3,
                    "kind {kind}, size {size}, speed {speed}, e = {restitution}: {lost} lost"
                );
            }
        }
    }
}

/// Random cases for 10⁵ steps each: `cargo test --package jostle --test all many_scales -- --ignored`.
#[test]
#[ignore = "it takes a minute"]
fn many_scales() {
    let others: Vec<Other> = others().collect();
    let mut random = jostle_scenes::random::Random::new(7);
    for _ in 0..100 {
        let other = others[random.whole(0, others.len() as u32 - 1) as usize];
        let substeps = [1, 2, 4, 8][random.whole(0, 3) as usize];
        let dt = [1.0, 1.0 / 60.0, 1e-4][random.whole(0, 2) as usize];
        let mut power = |most: f32| 10f64.powf(f64::from(random.between(-most, 0.0)));
        let (travel, fall) = (power(9.0), power(10.0));
        let h = dt / substeps as f64;
        let gravity = if random.unit() < 0.3 { 0.0 } else { fall / (h * h) };
        let can_turn = !matches!(other, Other::Floor(_));
        let case = Case {
            other,
            angle: if can_turn { f64::from(random.between(0.0, 6.2)) } else { 0.0 },
            place: [0.0, 1e5][random.whole(0, 1) as usize],
            gap: travel * f64::from(random.between(0.0, 10.0)),
            travel,
            restitution: [0.0, 0.5, 0.9, 1.0][random.whole(0, 3) as usize],
            gravity,
            dt,
            substeps,
        };
        let mut world = case.world();
        for _ in 0..100_000 {
            case.step(&mut world);
            let [x, y] = world.bodies().positions().unwrap()[0].map(|v| f64::from(v) - case.place);
            // It has bounced away, or rolled off a small disc.
            if x.abs().max(y.abs()) > 20.0 + 0.01 * case.place {
                break;
            }
        }
    }
}
