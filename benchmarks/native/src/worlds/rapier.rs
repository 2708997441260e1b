//! Rapier 2D, with its own pool of threads.

use rapier2d::prelude::*;

use super::{Engine, PIXELS_PER_METER, STEP, Start, State};

/// See the module.
pub struct Rapier {
    world: PhysicsWorld,
    bodies: Vec<RigidBodyHandle>,
}

impl Rapier {
    /// A world with a number of threads.
    pub fn new(start: &Start, workers: usize) -> Self {
        let gravity = Vector::from(start.gravity);
        let mut world = PhysicsWorld { gravity, ..PhysicsWorld::default() };
        let rules = &mut world.integration_parameters;
        rules.dt = STEP;
        rules.length_unit = PIXELS_PER_METER;
        rules.num_solver_iterations = start.substeps;
        rules.max_ccd_substeps = 0;
        world.configure_thread_pool(workers).expect("a thread pool");
        for (center, [width, height]) in start.wall_boxes() {
            let body = RigidBodyBuilder::fixed().translation(Vector::from(center));
            world.insert(body, smooth(ColliderBuilder::cuboid(width, height), 0.0));
        }
        let insert = |row: usize| {
            let body = RigidBodyBuilder::dynamic()
                .translation(Vector::from(start.positions[row]))
                .linvel(Vector::from(start.velocities[row]))
                .lock_rotations()
                .can_sleep(false);
            let ball = smooth(ColliderBuilder::ball(start.radii[row]), start.restitution);
            world.insert(body, ball.density(1.0)).0
        };
        let bodies = (0..start.len()).map(insert).collect();
        Self { world, bodies }
    }
}

/// Without friction; the larger of two restitutions is used.
fn smooth(collider: ColliderBuilder, restitution: f32) -> ColliderBuilder {
    let rule = CoefficientCombineRule::Max;
    collider.friction(0.0).restitution(restitution).restitution_combine_rule(rule)
}

impl Engine for Rapier {
    fn step(&mut self) {
        self.world.step();
    }

    fn state(&mut self) -> State {
        let bodies = self.bodies.iter().map(|&handle| &self.world.bodies[handle]);
        bodies.map(|body| (body.translation().to_array(), body.linvel().to_array())).unzip()
    }
}
