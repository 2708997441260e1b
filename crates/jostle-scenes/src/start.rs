//! The initial state of a scene, and what several scenes need to make one.

use jostle_world::container::Container;
use jostle_world::forces::Influence;
use jostle_world::forces::motor::turn;
use jostle_world::particles::Particles;
use jostle_world::walls::Wall;
use jostle_world::world::WorldSettings;

/// The initial state of a scene.
pub(crate) struct Start {
    pub(crate) particles: Particles,
    pub(crate) settings: WorldSettings,
    pub(crate) forces: Vec<Influence>,
    pub(crate) walls: Vec<Wall>,
}

impl Start {
    pub(crate) fn new(particles: Particles, settings: WorldSettings) -> Self {
        Self { particles, settings, forces: Vec::new(), walls: Vec::new() }
    }

    /// Sets the coefficient of restitution of all particles.
    pub(crate) fn restitution(mut self, of_all: f32) -> Self {
        self.particles.restitution.fill(of_all);
        self
    }

    pub(crate) fn with(mut self, force: Influence) -> Self {
        self.forces.push(force);
        self
    }

    /// Adds walls between consecutive corners.
    pub(crate) fn walled(mut self, corners: &[[f32; 2]]) -> Self {
        self.walls.extend(corners.windows(2).map(|ends| Wall::new([ends[0], ends[1]])));
        self
    }
}

/// The unit vector at an angle from +x towards +y, with the same bits on every machine.
pub(crate) fn direction(angle: f64) -> [f32; 2] {
    // `turn` returns the cosine less 1. It uses no function of the system's mathematical library:
    // these differ in the last bit.
    let [less, sine] = turn(angle);
    [(1.0 + less) as f32, sine as f32]
}

/// Area of a disc.
pub(crate) fn area_of(radius: f32) -> f32 {
    std::f32::consts::PI * radius * radius
}

/// Side of the square of which the area `covered` is the fraction `coverage`, at least `min`.
pub(crate) fn side_for(covered: f32, coverage: f32, min: f32) -> f32 {
    (covered / coverage).sqrt().max(min)
}

/// Default settings with a rectangular container.
pub(crate) fn boxed([min_x, min_y, max_x, max_y]: [f32; 4]) -> WorldSettings {
    let container = Container::Box { min: [min_x, min_y], max: [max_x, max_y] };
    WorldSettings { container, ..WorldSettings::default() }
}
