//! Contacts at all scales: small discs and large ones, long walls, slow and fast, near the origin and
//! far from it. The answers are analytic.

use jostle::{Container, Particles, Wall, World, WorldSettings};

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
    fn radius(self) -> f64 {
        match self {
            Self::Fixed(radius) | Self::Kinematic(radius) | Self::Movable(radius) => radius,
            _ => 0.0,
        }
    }
}

/// A small disc that approaches something, which is below it: towards −y. The place of contact is
/// near (`place`, `place`).
#[derive(Clone, Copy, Debug)]
struct Case {
    other: Other,
    /// Displacement of the small disc in a sub-step, in radii.
    travel: f64,
    restitution: f32,
    gravity: f64,
    /// Seconds of a step.
    dt: f64,
    place: f64,
    /// Gap at the beginning, in radii.
    gap: f64,
    substeps: usize,
}

/// A number as float32 and what rounding removed.
fn split(value: f64) -> [f32; 2] {
    let rounded = value as f32;
    [rounded, (value - f64::from(rounded)) as f32]
}

impl Case {
    /// The world; the small disc has row 0.
    fn world(&self) -> World {
        let (place, radius) = (self.place, self.other.radius());
        // The centre of the other disc is a float32; the small one is placed against it.
        let center = f64::from((place - radius) as f32);
        let height = match self.other {
            Other::Wall(_) | Other::Floor(_) | Other::Round(_) => place,
            _ => center + radius,
        };
        let [y, residual] = split(height + 1.0 + self.gap);
        let speed = (self.travel * self.substeps as f64 / self.dt) as f32;
        let mut particles = Particles {
            positions: vec![[place as f32, y]],
            residuals: vec![[0.0, residual]],
            velocities: vec![[0.0, -speed]],
            radii: vec![1.0],
            masses: vec![1.0],
            restitutions: vec![1.0],
            movable: vec![true],
            ..Particles::default()
        };
        if radius > 0.0 {
            particles.positions.push([place as f32, center as f32]);
            particles.residuals.push([0.0; 2]);
            let is_kinematic = matches!(self.other, Other::Kinematic(_));
            particles.velocities.push([0.0, if is_kinematic { 0.5 * speed } else { 0.0 }]);
            particles.radii.push(radius as f32);
            particles.masses.push((radius * radius) as f32);
            particles.restitutions.push(1.0);
            particles.movable.push(matches!(self.other, Other::Movable(_)));
        }
        let side = |length: f64| (place - length) as f32;
        let container = match self.other {
            Other::Floor(half) => Container::Box {
                min: [side(half), place as f32],
                max: [(place + half) as f32, (place + 2.0 * half) as f32],
            },
            Other::Round(radius) => {
                let center = (place + radius) as f32;
                let bottom = f64::from(center) - place;
                Container::Circle { center: [place as f32, center], radius: bottom as f32 }
            }
            _ => Container::None,
        };
        let settings = WorldSettings {
            restitution: self.restitution,
            gravity: [0.0, -self.gravity as f32],
            container,
            substeps: Some(self.substeps),
            ..WorldSettings::default()
        };
        let mut world = World::new(particles, settings).expect("the case is valid");
        if let Other::Wall(half) = self.other {
            let ends = [[side(half), place as f32], [(place + half) as f32, place as f32]];
            world.set_walls(vec![Wall::new(ends)]).expect("the wall is valid");
        }
        world
    }

    /// The gap between the surfaces, from the stored positions with their residuals.
    fn gap(&self, world: &World) -> f64 {
        let particles = world.particles();
        let row = |row: usize| {
            [0, 1].map(|k| {
                f64::from(particles.positions[row][k]) + f64::from(particles.residuals[row][k])
            })
        };
        let [x, y] = row(0);
        match self.other {
            Other::Fixed(radius) | Other::Kinematic(radius) | Other::Movable(radius) => {
                let [p, q] = row(1);
                let radius = f64::from(radius as f32);
                ((x - p).powi(2) + (y - q).powi(2)).sqrt() - 1.0 - radius
            }
            Other::Wall(_) | Other::Floor(_) => y - self.place - 1.0,
            Other::Round(radius) => {
                let center = f64::from((self.place + radius) as f32);
                let offset = ((x - self.place).powi(2) + (y - center).powi(2)).sqrt();
                center - self.place - 1.0 - offset
            }
        }
    }

    /// The velocity of approach.
    fn approach(&self, world: &World) -> f64 {
        let velocities = &world.particles().velocities;
        let other = velocities.get(1).map_or(0.0, |v| f64::from(v[1]));
        other - f64::from(velocities[0][1])
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
        let steps = ((10.0 * bounce) as usize / self.substeps).clamp(20, 600);
        let before = energy(&world);
        for _ in 0..steps {
            case.step(&mut world);
            let error = (energy(&world) / before - 1.0).abs();
            assert!(error < 4e-3, "{case:?}: height {height}, energy {error} off");
        }
    }
}

/// Everything that a disc of radius 1 may meet, up to this ratio of sizes.
fn others(most: i32) -> impl Iterator<Item = Other> {
    let sizes = (0..=most).map(|exponent| 10f64.powi(exponent));
    sizes.flat_map(|size| {
        let discs = [Other::Fixed(size), Other::Kinematic(size), Other::Movable(size)];
        let walls = [Other::Wall(10.0 * size), Other::Floor(10.0 * size), Other::Round(10.0 * size)];
        discs.into_iter().chain(walls)
    })
}

/// Displacements in a sub-step, in radii.
fn travels() -> impl Iterator<Item = f64> {
    (0..=9).map(|exponent| 10f64.powi(-exponent))
}

/// Calls `act` with each combination of what the small disc meets, of restitutions, places and
/// numbers of sub-steps.
fn each_case(most: i32, mut act: impl FnMut(Case)) {
    for other in others(most) {
        for restitution in [0.0, 0.5, 1.0] {
            for place in [0.0, 1e5] {
                for substeps in [1, 4] {
                    let (travel, gravity, dt, gap) = (0.0, 0.0, 1.0 / 60.0, 0.0);
                    let case =
                        Case { other, travel, restitution, gravity, dt, place, gap, substeps };
                    act(case);
                }
            }
        }
    }
}

#[test]
fn every_approach_ends_with_a_bounce() {
    each_case(7, |case| {
        for travel in travels() {
            Case { travel, gap: 2.3 * travel, ..case }.check_bounce();
        }
    });
}

/// The disc falls from heights between nothing and a radius, and comes to rest on the surface.
#[test]
fn a_disc_rests_on_the_surface() {
    each_case(7, |case| {
        if case.restitution == 1.0 || matches!(case.other, Other::Movable(_)) {
            return;
        }
        for gap in [-1e-4, 0.0, 1e-6, 0.02] {
            for exponent in [-1, -4, -9] {
                // The square of the sub-step is 1 over this in units of r/g.
                let travel = 10f64.powi(exponent);
                let h = case.dt / case.substeps as f64;
                let gravity = travel / (h * h);
                let case = Case { gap, gravity, ..case };
                case.check_rest(400);
            }
        }
    });
}

/// An elastic disc bounces under gravity to the same height again and again.
#[test]
fn an_elastic_disc_bounces_under_gravity() {
    each_case(7, |case| {
        if case.restitution < 1.0 || matches!(case.other, Other::Movable(_)) {
            return;
        }
        for height in [2.0, 30.0, 1e4] {
            for travel in [1e-1, 1e-3, 1e-6] {
                case.check_bounces(height, travel);
            }
        }
    });
}

/// Discs that overlap are moved apart, also where nothing presses them together.
#[test]
fn overlaps_are_corrected() {
    each_case(7, |case| {
        for gap in [-0.02, -0.5, -1.0] {
            let case = Case { gap, ..case };
            let mut world = case.world();
            for _ in 0..120 {
                world.step(case.dt, 1).expect("a step succeeds");
            }
            let left = case.gap(&world);
            assert!(left > -0.006 - case.coarse(), "{case:?}: still {} radii", -left);
            assert!(left < 0.006 + case.coarse(), "{case:?}: {left} radii apart");
        }
    });
}
