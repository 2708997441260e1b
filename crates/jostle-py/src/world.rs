//! `jostle.World`: its constructor; the files in this folder have its methods and properties, by subject.

mod boundaries;
mod columns;
mod edits;
mod external;
mod free_positions;
mod ids;
mod properties;
mod queries;
mod ranks;
mod snapshots;
mod state;
mod steps;
mod touches;
mod wall_queries;
mod wall_view;

use std::time::Duration;

use jostle_world::{Changes, Container, Stage, World, WorldSettings};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::{number, point};
use crate::containers;
use crate::error::refused;
use crate::forces;
use crate::ids::left_operand;
use crate::interrupt::detached_to_the_end;
use crate::keywords::Keywords;
use crate::lock::{Guard, Shared};
use crate::particles::{self, Arguments};
use crate::settings;
use crate::walls;
pub use ranks::{begin_hash, checksum, hash_parts, hash_records, record_fields};
pub use wall_view::PyWalls;

/// Particles: discs that move, collide and bounce off walls.
///
/// Each particle has an id, which never changes and is never used again: 0, 1, 2, ... in the
/// order of adding. The columns are in the order of `ids`, and `rows` gives the rows of ids; as
/// long as no particle was removed and none merged, the id of a particle is its row. All columns
/// are float32; other numbers are converted. The residuals of positions, which rounding to float32
/// removes, are kept from step to step; assigned positions are exact. The same
/// input gives the same bits on every machine, for every number of threads and for both
/// methods.
///
/// Parameters
/// ----------
/// positions : array_like, shape (n, 2)
///     Centres, in units of length.
/// radii : array_like, a number or shape (n,)
///     In units of length: 0, or between 1e-18 and 1e18.
/// velocities : array_like, shape (2,) or (n, 2), default (0.0, 0.0)
///     In units of length per second.
/// masses : array_like, a number or shape (n,), optional
///     In units of mass, above 0. If omitted, the squares of the radii, without π, as in the
///     article; required for a particle of radius 0.
/// angles : array_like, a number or shape (n,), default 0.0
///     In radians, positive from +x to +y.
/// angular_velocities : array_like, a number or shape (n,), default 0.0
///     In radians per second. The moment of inertia of a disc is m r²/2. Particles of
///     radius 0 do not rotate: their angular velocity becomes 0. `drag` does not change angular
///     velocities.
/// friction : array_like, a number or shape (n,), default 0.0
///     Coefficient of friction of each particle (Coulomb), at least 0. A contact has the square
///     root of the product of both. Without friction particles do not begin to rotate.
/// restitution : array_like, a number or shape (n,), default 1.0
///     Coefficient of restitution of each particle: 0 inelastic, 1 elastic. A contact has the square
///     root of the product of both.
/// movable : array_like of bool, one or shape (n,), default True
///     Whether contacts and forces can change the velocity of the particle. An immovable particle
///     keeps the velocity and the angular velocity that it is given:
///     if both are 0 it is static, else kinematic. It pushes others and is not pushed, and walls
///     and the container do not stop it.
/// sensors : array_like of bool, one or shape (n,), default False
///     Whether the particle is a sensor: it neither pushes others nor is pushed by them, and
///     `events` and `contacts` report what touches it. See `World.sensors`.
/// kinds : array_like of int, a number or shape (n,), default 0
///     Kinds of the particles in each `PairForce`, from 0 to 63.
/// categories, masks : array_like of int, a number or shape (n,), default 1 and all bits
///     Bit sets of 32 bits: two particles may touch only if ``categories[i] & masks[j]`` and
///     ``categories[j] & masks[i]``; others pass through each other at no cost. Walls have categories
///     and masks, too. The container and forces do not depend on them.
/// gravity : array_like, shape (2,), default (0.0, 0.0)
///     Acceleration, in units of length per second squared.
/// drag : float, default 0.0
///     Linear damping, per second: dv/dt = -drag v.
/// container : Box, Circle or None, optional
///     The region of the particles, with the coefficients of its sides. The first step moves
///     particles that are outside into it.
/// period : float or array_like, shape (2,), optional
///     Width and height of a periodic plane, in place of a container: a particle that leaves on one
///     side enters on the other. Positions are from 0 to the period.
/// walls : array_like, shape (m, 2, 2), or dict, optional
///     Line segments, solid from both sides, from one end to the other; `polyline` makes
///     them from points. A particle stays on the side on which its centre is. One that overlaps
///     a wall is pushed out in several steps. On a periodic plane walls act across its sides,
///     and a wall may extend over each side once at most. Or a dict of the arguments of
///     `World.walls.add`: `segments`, `velocities`, `friction`, `restitution`, `sensors`,
///     `one_way`, `categories` and `masks`. The walls have the ids 0, 1, 2, ...
/// forces : sequence of forces, default ()
///     `Attractor`, `Gravitation`, `Springs`, `PairForce`, `Flocking`, `Thermostat`,
///     `ThermalWalls`, `AndersenThermostat`, `Motor`, `Grab` and `Pump`, in addition to gravity and
///     contacts.
/// on_touch : {"bounce", "merge", "ignore"}, default "bounce"
///     What happens to particles that touch. "merge" merges them at the end of the
///     step, at their centre of mass: area, mass and momentum are summed, restitution and
///     friction are the means weighted by mass, and the id is the smallest, see `renumbered`. The
///     merged particle has all bits of their categories and masks. If one has friction or rotates,
///     angular momentum is conserved. If some of the particles are immovable, so is the merged
///     one, which has the position and the velocity of the heaviest of these; momentum is lost.
///     Particles do not merge if the result would not fit into the container. "ignore" lets them
///     pass through each other.
/// sleeping : bool, default True
///     Whether islands of touching particles that rest fall asleep under gravity, if the
///     coefficients of restitution at walls are below 1; see `asleep`. It stops motion with a mean
///     speed below 0.01 √(g r), where r is the radius.
/// substeps : int, optional
///     Sub-steps of a step, in which forces act and resting contacts are solved. None, the
///     default, takes as many as the scene needs: 4 with attractors, gravitation, springs or given
///     accelerations, or with gravity or forces and friction or a restitution below 1; otherwise 1. If
///     contacts may rest and a particle presses on a touching one with 1/10,000 to 1/128 of its mass,
///     there are 2 to 8 times as many. A step whose
///     particles travel far is divided into parts, which share the sub-steps; each part has at least one.
/// track_events : bool, default False
///     Whether `events` and `wall_events` report what began and ceased to touch in each call of
///     `step`.
/// method : {"quadtree", "brute"}, default "quadtree"
///     How pairs are found; the pairs are the same.
/// threads : int, optional
///     Number of threads, at most one for each core, which is the default.
/// leaf_capacity : int, default 96
///     Particles that a box of the tree may hold before it splits.
/// max_depth : int, default 4096
///     Maximum number of subdivisions of the tree; the default never prevents a split.
///
/// Raises
/// ------
/// TypeError
///     If an argument has the wrong type.
/// ValueError
///     If a shape is wrong, a value is out of range, a particle does not fit into the container, or
///     there are a container and a period; the message says which.
///
/// See Also
/// --------
/// jostle.scenes.create : The world of a named scene.
/// WorldContacts, WallContacts : Pairs and walls that touched, with impulses.
///
/// Notes
/// -----
/// Between collisions dv/dt = gravity - drag v + a, where a is the acceleration by `forces` and by
/// `accelerations`. Surfaces that touch and approach at the normal speed u separate at e u, where e
/// is the coefficient of restitution. An impulse P along the normal allows a friction impulse of at
/// most μ P, where μ is the coefficient of friction.
///
/// References
/// ----------
/// O. R. Walton, *Numerical simulation of inelastic, frictional particle-particle interactions*,
/// in: Particulate Two-Phase Flow (1993), for friction in bounces.
/// E. Catto, *Iterative Dynamics with Temporal Coherence*, Game Developers Conference (2005), for
/// resting contacts.
/// B. D. Lubachevsky, *How to Simulate Billiards and Similar Systems*, Journal of Computational
/// Physics 94 (1991), for collisions in the order of time.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> world = jostle.World([(0, 0), (3, 0)], 1.0, velocities=[(1, 0), (0, 0)])
/// >>> world.step(0.1, steps=20)  # the left disc hits the right one after a second
/// >>> world.velocities
/// array([[0., 0.],
///        [1., 0.]], dtype=float32)
///
/// A disc that slides on a floor with friction begins to roll, at two thirds of its speed:
///
/// >>> world = jostle.World(
/// ...     [(0, 9)], 1.0, velocities=[(3, 0)], gravity=(0, 9.8), restitution=0.5, friction=0.4,
/// ...     container=jostle.Box(-99, -50, 99, 10),
/// ... )
/// >>> world.step(1 / 60, steps=120)
/// >>> world.velocities.round(3), world.angular_velocities.round(3)
/// (array([[2., 0.]], dtype=float32), array([2.], dtype=float32))
#[pyclass(module = "jostle", name = "World", frozen)]
pub struct PyWorld {
    state: Shared<State>,
}

struct State {
    world: World,
    /// The time of each stage of the last step.
    profile: [Duration; Stage::ALL.len()],
}

#[pymethods]
impl PyWorld {
    #[new]
    #[pyo3(
        signature = (*arguments, **keywords),
        text_signature = "(positions=None, radii=None, *, velocities=(0.0, 0.0), masses=None, \
                          angles=0.0, angular_velocities=0.0, friction=0.0, restitution=1.0, \
                          movable=True, sensors=False, kinds=0, categories=1, masks=4294967295, \
                          gravity=(0.0, 0.0), drag=0.0, container=None, period=None, walls=None, \
                          forces=(), on_touch='bounce', sleeping=True, substeps=None, \
                          track_events=False, method='quadtree', threads=None, \
                          leaf_capacity=96, max_depth=4096)"
    )]
    fn new<'py>(
        py: Python<'py>,
        arguments: &Bound<'py, PyTuple>,
        keywords: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Self> {
        let names = ["positions", "radii"];
        let mut keywords = Keywords::of_all("World()", &names, arguments, keywords)?;
        let positions = keywords.take_some("positions");
        let arguments = Arguments::of(&mut keywords)?;
        let rules = read_rules(&mut keywords)?;
        let (walls, named) = walls::read(keywords.take_some("walls").as_ref())?;
        let forces = keywords.take("forces");
        keywords.end()?;
        let forces = forces.map_or(Ok(Vec::new()), |all| forces::read(&all))?;
        let (columns, len) = read_particles(positions.as_ref(), arguments)?;
        let world = py.detach(|| {
            let mut world = World::new(particles::particles(&columns, len)?, rules)?;
            world.add_walls(&walls).map_err(|error| walls::renamed(error, named))?;
            world.set_forces(forces)?;
            Ok(world)
        });
        Ok(Self::of(world.map_err(refused)?))
    }

    fn __contains__(&self, py: Python<'_>, id: &Bound<'_, PyAny>) -> PyResult<bool> {
        let id = left_operand(id, "np.isin(ids, world.ids) tests many")?;
        id.map_or(Ok(false), |id| Ok(self.state(py)?.world.bodies().contains(id)))
    }

    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        self.len(py)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let state = self.state(py)?;
        let (len, time) = (state.world.len(), state.world.time());
        Ok(format!("<jostle.World of {len} particles after {time:.3} s>"))
    }
}

impl PyWorld {
    /// The Python object for a world.
    pub fn of(world: World) -> Self {
        let state = State { world, profile: Default::default() };
        Self { state: Shared::new(state, "world", "restore a snapshot or make a new one") }
    }

    /// Calls `act` with the world, with the GIL held, for short use.
    fn state(&self, py: Python<'_>) -> PyResult<Guard<'_, State>> {
        self.state.lock_attached(py)
    }

    /// Calls `act` with the world, without the GIL.
    fn long<R: Send>(
        &self,
        py: Python<'_>,
        act: impl FnOnce(&mut State) -> R + Send,
    ) -> PyResult<R> {
        detached_to_the_end(py, || Ok(act(&mut *self.state.lock()?)))?
    }

    fn len(&self, py: Python<'_>) -> PyResult<usize> {
        Ok(self.state(py)?.world.len())
    }

    fn rules(&self, py: Python<'_>) -> PyResult<WorldSettings> {
        Ok(*self.state(py)?.world.settings())
    }

    fn change_rules(
        &self,
        py: Python<'_>,
        change: impl FnOnce(&mut WorldSettings) + Send,
    ) -> PyResult<()> {
        let changed = self.long(py, |state| {
            let mut rules = *state.world.settings();
            change(&mut rules);
            state.world.configure(rules)
        });
        changed?.map_err(refused)
    }
}

/// The columns of the particles of a new world, and how many these are.
fn read_particles<'py>(
    positions: Option<&Bound<'py, PyAny>>,
    arguments: Arguments<'py>,
) -> PyResult<(Changes, usize)> {
    let needs = |name, other| PyTypeError::new_err(format!("World() needs {name} with {other}"));
    match (positions, arguments.first()) {
        (None, Some(column)) => Err(needs("positions", column)),
        (Some(_), _) if arguments.radii.is_none() => Err(needs("radii", "positions")),
        (Some(positions), _) => {
            let (columns, many) = arguments.read_new(positions)?;
            Ok((columns, many.unwrap_or(1)))
        }
        (None, None) => Ok((Changes::default(), 0)),
    }
}

/// The settings of a new world.
fn read_rules(keywords: &mut Keywords<'_>) -> PyResult<WorldSettings> {
    let mut given = |name| keywords.given(name);
    let (gravity, drag) = (given("gravity"), given("drag"));
    let (on_touch, method) = (given("on_touch"), given("method"));
    let (sleeping, track_events) = (given("sleeping"), given("track_events"));
    let tree = settings::tree(keywords)?;
    let substeps = keywords.take_some("substeps");
    let (mut container, sides) =
        containers::read("container", keywords.take_some("container").as_ref())?;
    if let Some(size) = containers::period(keywords.take_some("period").as_ref())? {
        if container != Container::None {
            return Err(containers::both());
        }
        container = Container::Torus { size };
    }
    let default = WorldSettings::default();
    Ok(WorldSettings {
        gravity: gravity.value().map_or(Ok(default.gravity), |xy| point("gravity", xy))?,
        drag: drag.value().map_or(Ok(0.0), |of| number("drag", of))? as f32,
        container,
        sides,
        on_touch: settings::on_touch(&on_touch)?,
        method: settings::method(&method)?,
        substeps: settings::substeps(substeps.as_ref())?,
        sleeping: settings::sleeping(&sleeping)?,
        track_events: settings::track_events(&track_events)?,
        tree,
    })
}
