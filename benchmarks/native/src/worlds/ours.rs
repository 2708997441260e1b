//! jostle's world.

use jostle_base::Settings;
use jostle_world::{Container, Particles, World, WorldSettings};

use super::{Engine, STEP, Start, State};

/// See the module.
pub struct Ours(World);

impl Ours {
    /// A world with a number of threads.
    pub fn new(start: &Start, workers: usize) -> Self {
        let Start { positions, velocities, radii, .. } = start;
        let [min_x, min_y, max_x, max_y] = start.walls;
        let settings = WorldSettings {
            gravity: start.gravity,
            container: Container::Box { min: [min_x, min_y], max: [max_x, max_y] },
            substeps: Some(start.substeps),
            sleeping: false,
            tree: Settings { threads: Some(workers), ..Settings::default() },
            ..WorldSettings::default()
        };
        let mut discs = Particles::new(positions.clone(), velocities.clone(), radii.clone(), 1.0);
        discs.restitution.fill(start.restitution);
        Self(World::new(discs, settings).expect("a valid start"))
    }
}

impl Engine for Ours {
    fn step(&mut self) {
        self.0.step(f64::from(STEP), 1).expect("a step");
    }

    fn state(&mut self) -> State {
        let bodies = self.0.bodies();
        (bodies.positions().expect("memory"), bodies.velocities().expect("memory"))
    }
}
