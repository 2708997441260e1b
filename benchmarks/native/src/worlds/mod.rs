//! The engines whose steps are compared, behind the few calls that a comparison needs.
//!
//! All get the same discs, walls and gravity. Rotation is locked, friction zero, nothing
//! sleeps, and nothing is swept against the walls but by ours, which cannot do without.

mod box2d;
mod ours;
mod rapier;

use jostle::{Container, World, scenes};

use crate::machine::version_of;

/// Seconds a step.
pub const STEP: f32 = 1.0 / 60.0;

/// Pixels to what engines made for metres take for one: a disc is then half to one metre wide.
const PIXELS_PER_METER: f32 = 10.0;

/// Where all engines begin.
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
    /// Share of the speed that a bounce keeps.
    pub restitution: f32,
    /// Parts of a step, the same for all.
    pub substeps: usize,
}

impl Start {
    /// One of the library's scenes, after so many steps of ours.
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
        Self {
            positions: world.positions(),
            velocities: world.velocities(),
            radii: world.radii(),
            walls: [min[0], min[1], max[0], max[1]],
            gravity: settings.gravity,
            restitution: settings.restitution,
            substeps: substeps.unwrap_or(world.substeps()),
        }
    }

    /// Number of discs.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether discs bounce for ever.
    fn is_elastic(&self) -> bool {
        self.restitution == 1.0
    }

    /// The four walls as boxes, centre and half sizes, so thick that nothing gets through.
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

/// An engine with a world in it.
pub trait Engine {
    /// Moves the world on by [`STEP`].
    fn step(&mut self);

    /// Centres and velocities, in the order of the start.
    fn state(&mut self) -> State;
}

/// An engine under the name and version that the results give it.
pub struct Contender {
    /// What it is called.
    pub name: &'static str,
    /// Its version.
    pub version: String,
    /// The engine.
    pub engine: Box<dyn Engine>,
    /// What else is to be said, each with a comma in front.
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
