//! The engines whose steps are compared, behind a common interface.
//!
//! All get the same discs, walls and gravity. Rotation is locked, friction is zero and nothing
//! sleeps. Only jostle, where it cannot be turned off, has continuous collision with the walls.

mod box2d;
mod ours;
mod rapier;

use jostle_scenes as scenes;
use jostle_world::{Container, World};

use crate::machine::version_of;

/// Seconds a step.
pub const STEP: f32 = 1.0 / 60.0;

/// Pixels per metre, for engines whose tolerances are in metres: a disc is half to one metre wide.
const PIXELS_PER_METER: f32 = 10.0;

/// The initial state of all engines.
#[derive(Debug)]
pub struct Start {
    /// Centres.
    pub positions: Vec<[f32; 2]>,
    /// Velocities.
    pub velocities: Vec<[f32; 2]>,
    /// Radii.
    pub radii: Vec<f32>,
    /// The walls: min x, min y, max x, max y.
    pub walls: [f32; 4],
    /// Acceleration of everything.
    pub gravity: [f32; 2],
    /// Coefficient of restitution of all discs.
    pub restitution: f32,
    /// Sub-steps of a step, the same for all.
    pub substeps: usize,
}

impl Start {
    /// One of jostle's scenes after some of its steps.
    pub fn of(scene: &str, count: usize, steps: usize, substeps: Option<usize>) -> Self {
        let scene = scenes::find(scene).expect("a scene of the library");
        let mut world = scene.create(Some(count), 1).expect("any number of particles");
        world.step(f64::from(STEP), steps).expect("a step");
        Self::from(&world, substeps)
    }

    fn from(world: &World, substeps: Option<usize>) -> Self {
        let settings = world.settings();
        let Container::Box { min, max } = settings.container else {
            panic!("the engines compared know only boxes");
        };
        let bodies = world.bodies();
        Self {
            positions: bodies.positions().expect("memory"),
            velocities: bodies.velocities().expect("memory"),
            radii: bodies.radii().expect("memory"),
            walls: [min[0], min[1], max[0], max[1]],
            gravity: settings.gravity,
            restitution: bodies.restitution().expect("memory")[0],
            substeps: substeps.unwrap_or(world.substeps()),
        }
    }

    /// Number of discs.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether collisions are elastic.
    fn is_elastic(&self) -> bool {
        self.restitution == 1.0
    }

    /// The four walls as boxes, centre and half sizes, too thick to tunnel through.
    fn wall_boxes(&self) -> [([f32; 2], [f32; 2]); 4] {
        let [left, top, right, bottom] = self.walls;
        let (half, thick) = ([(right - left) / 2.0, (bottom - top) / 2.0], 50.0);
        let middle = [(left + right) / 2.0, (top + bottom) / 2.0];
        let (across, along) = ([half[0] + 2.0 * thick, thick], [thick, half[1]]);
        [
            ([middle[0], top - thick], across),
            ([middle[0], bottom + thick], across),
            ([left - thick, middle[1]], along),
            ([right + thick, middle[1]], along),
        ]
    }
}

/// Centres and velocities.
pub type State = (Vec<[f32; 2]>, Vec<[f32; 2]>);

/// An engine with a world.
pub trait Engine {
    /// Advances the world by [`STEP`].
    fn step(&mut self);

    /// Centres and velocities, in the order of the start.
    fn state(&mut self) -> State;
}

/// An engine with its name and version in the results.
pub struct Contender {
    /// Its name.
    pub name: &'static str,
    /// Its version.
    pub version: String,
    /// The engine.
    pub engine: Box<dyn Engine>,
    /// Remarks, each with a comma in front.
    pub remark: String,
}

/// All engines, ours first.
pub fn all(start: &Start, workers: usize, wanted: impl Fn(&str) -> bool) -> Vec<Contender> {
    let mut contenders = Vec::new();
    let mut add = |name, package, make: &dyn Fn() -> (Box<dyn Engine>, &'static str)| {
        if wanted(name) {
            let (engine, remark) = make();
            let version = version_of(package).to_owned();
            contenders.push(Contender { name, version, engine, remark: remark.to_owned() });
        }
    };
    add("jostle", "jostle", &|| (Box::new(ours::Ours::new(start, workers)), ""));
    add("Box2D", "boxdd", &|| (Box::new(box2d::Box2d::new(start, workers)), box2d::built()));
    add("Rapier", "rapier2d", &|| (Box::new(rapier::Rapier::new(start, workers)), ""));
    contenders
}
