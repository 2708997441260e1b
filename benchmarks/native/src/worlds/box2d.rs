//! Box2D v3, with AVX2 and its own scheduler.
//!
//! Its wrapper compiles it with assertions unless `CFLAGS="-O3 -DNDEBUG"` is set when this
//! program is built; the results say which it was.

use boxdd::{
    BodyId, BodyType, Foundation, FoundationConfig, MotionLocks, ShapeDef, SurfaceMaterial, Vec2,
    WorkerCount, World,
};

use super::{Engine, PIXELS_PER_METER, STEP, Start, State};

/// How the C code was compiled.
pub fn built() -> &'static str {
    if env!("C_FLAGS").contains("NDEBUG") { ", no assertions" } else { ", ASSERTIONS ON" }
}

/// See the module.
pub struct Box2d {
    world: World,
    bodies: Vec<BodyId>,
    substeps: i32,
}

impl Box2d {
    /// A world with a number of threads.
    pub fn new(start: &Start, workers: usize) -> Self {
        Self::try_new(start, workers).expect("Box2D takes the scene")
    }

    fn try_new(start: &Start, workers: usize) -> boxdd::Result<Self> {
        let foundation = Foundation::initialize(FoundationConfig::new(PIXELS_PER_METER))?;
        let mut rules = foundation
            .world_builder()
            .gravity(start.gravity)
            .enable_sleep(false)
            .enable_continuous(false)
            .worker_count(WorkerCount::new(workers as u32)?);
        if start.is_elastic() {
            rules = rules.restitution_threshold(0.0);
        }
        let mut world = foundation.create_world(rules.build()?)?;
        let material = |restitution| {
            SurfaceMaterial::default().with_friction(0.0)?.with_restitution(restitution)
        };
        // The larger of two restitutions is used.
        let wall = ShapeDef::builder().material(material(0.0)?).build()?;
        for (center, [width, height]) in start.wall_boxes() {
            let body = world.body_builder().position(center).build()?;
            let body = world.create_body(body)?;
            world.body(body)?.create_box(&wall, width, height)?;
        }
        let disc =
            ShapeDef::builder().material(material(start.restitution)?).density(1.0).build()?;
        let mut bodies = Vec::with_capacity(start.len());
        for row in 0..start.len() {
            let body = world
                .body_builder()
                .body_type(BodyType::Dynamic)
                .position(start.positions[row])
                .linear_velocity(start.velocities[row])
                .motion_locks(MotionLocks::new(false, false, true))
                .build()?;
            let body = world.create_body(body)?;
            world.body(body)?.create_centered_circle(&disc, start.radii[row])?;
            bodies.push(body);
        }
        Ok(Self { world, bodies, substeps: start.substeps as i32 })
    }

    fn try_state(&mut self) -> boxdd::Result<State> {
        let (mut positions, mut velocities) = (Vec::new(), Vec::new());
        for &id in &self.bodies {
            let body = self.world.body(id)?;
            let (position, velocity): (_, Vec2) = (body.position()?, body.linear_velocity()?);
            positions.push([position.x, position.y]);
            velocities.push([velocity.x, velocity.y]);
        }
        Ok((positions, velocities))
    }
}

impl Engine for Box2d {
    fn step(&mut self) {
        drop(self.world.step(STEP, self.substeps).expect("a step"));
    }

    fn state(&mut self) -> State {
        self.try_state().expect("all bodies are alive")
    }
}
