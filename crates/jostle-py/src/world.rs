//! `jostle.World`.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use jostle::{Defaults, Each, Error, Filter, Id, Stage, Wall, World, WorldSettings};
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes, PyDict, PyMemoryView, PyTuple, PyType};

use crate::arrays::{
    Given, bit_sets, column, count, decimal, number, point, read_only, reals, table,
};
use crate::containers;
use crate::error::{refused, type_error};
use crate::files;
use crate::forces;
use crate::ids::{Ids, one_id};
use crate::interrupt::{detached, detached_to_the_end};
use crate::lock::{Guard, Shared};
use crate::particles::{Draft, only_vector, truths, vectors};
use crate::quadtree::PyQuadtree;
use crate::queries::result_of;
use crate::results;
use crate::settings;
use crate::walls;

/// Interval at which a call of `step` runs signal handlers and lets other threads use the world,
/// between two steps.
const LOOK_UP: Duration = Duration::from_millis(50);

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
/// velocities : array_like, shape (n, 2)
///     In units of length per second.
/// radii : array_like, a number or shape (n,)
///     In units of length: 0, or between 1e-18 and 1e18. If `radii`, `masses`, `densities` or
///     `friction` is one number, it is also the default of particles that are added later.
/// masses : array_like, a number or shape (n,), optional
///     Above 0. If omitted, density times radius squared, as in the article; required for
///     a particle of radius 0.
/// densities : array_like, a number or shape (n,), default 1.0
///     Used if `masses` are omitted.
/// movable : array_like of bool, one or shape (n,), optional
///     Whether contacts and forces can change the velocity of the particle. If omitted, all are
///     movable. A particle that is not movable keeps the velocity and the angular velocity that it
///     is given: without any it is static, else kinematic. It pushes others and is not pushed,
///     and walls and the container do not stop it.
/// gravity : array_like, shape (2,), default (0.0, 0.0)
///     Acceleration, in units of length per second squared.
/// drag : float, default 0.0
///     Linear damping, per second: dv/dt = -drag v.
/// restitution : array_like, a number or shape (n,), default 1.0
///     Coefficient of restitution: 0 inelastic, 1 elastic. A number is the world's, an
///     array has one for each particle. The coefficient of a contact is the product of
///     the world's and those of both particles; at a wall, of the world's, that of the
///     particle and that of the wall.
/// friction : array_like, a number or shape (n,), default 0.0
///     Coefficient of friction of each particle (Coulomb), at least 0. A contact has the square
///     root of the product of both; at a wall, that of the particle. Without friction particles
///     do not begin to rotate.
/// angles : array_like, a number or shape (n,), optional
///     In radians, positive from +x to +y; 0 if omitted.
/// angular_velocities : array_like, a number or shape (n,), optional
///     In radians per second; 0 if omitted. The moment of inertia of a disc is m r²/2. Particles of
///     radius 0 do not rotate: their angular velocity becomes 0. `drag` does not change angular
///     velocities.
/// categories, masks : array_like of int, a number or shape (n,), optional
///     Bit sets of 32 bits: two particles may touch only if ``categories[i] & masks[j]`` and
///     ``categories[j] & masks[i]``; others pass through each other at no cost. If omitted,
///     categories are 1 and masks have all bits. Walls, the container and forces do not depend on
///     them.
/// sensors : array_like of bool, one or shape (n,), optional
///     Whether the particle is a sensor: it neither pushes others nor is pushed by them, and
///     `events` and `contacts` report what touches it. If omitted, none is. See `World.sensors`.
/// container : Box, Circle, Torus or None, optional
///     The region of the particles. The first step moves particles that are outside into it.
/// container_restitution : array_like, a number or shape (4,), default 1.0
///     Coefficients of restitution of the sides of the container at min x, max x, min y and max y,
///     the order of the numbers in `wall_contacts`; one number for all, and for a `Circle`. At a
///     side it is multiplied by the world's and that of the particle.
/// walls : array_like, shape (m, 2, 2), optional
///     Line segments, solid from both sides, from one end to the other; `polyline` makes
///     them from points. A particle stays on the side on which its centre is. One that overlaps
///     a wall is pushed out in several steps. On a `Torus` walls act across the periodic boundary,
///     and a wall may extend over each side once at most.
/// wall_velocities : array_like, shape (2,) or (m, 2), optional
///     Velocities of the walls, in units of length per second; 0 if omitted. Moving walls push
///     particles and are not pushed. Walls that share an end should have the same velocity. Nothing
///     falls asleep while a wall moves.
/// wall_restitution : array_like, a number or shape (m,), default 1.0
///     Coefficients of restitution of the walls; at a wall it is multiplied by the world's and that
///     of the particle.
/// wall_friction : array_like, a number or shape (m,), optional
///     Coefficients of friction of the walls. A contact has the square root of the product with
///     that of the particle. If omitted, and for a wall with NaN, it is that of the particle.
/// forces : sequence of forces, default ()
///     `Attractor`, `Gravitation`, `Springs`, `Thermostat`, `ThermalWalls`,
///     `AndersenThermostat` and `Motor`, in addition to gravity and contacts.
/// on_touch : {"bounce", "merge", "ignore"}, default "bounce"
///     What happens to particles that touch. "merge" merges them at the end of the
///     step, at their centre of mass: area, mass and momentum are summed, restitution and
///     friction are the means weighted by mass, and the id is the smallest, see `renumbered`. The
///     merged particle has all bits of their categories and masks. If one has friction or rotates,
///     angular momentum is conserved. If some of the particles are not movable, the merged
///     particle is not movable either and has the place and the velocity of the heaviest of
///     these; momentum is lost. Particles do not merge if the
///     result would not fit into the container. "ignore" lets them pass through each other.
/// method : {"quadtree", "brute"}, default "quadtree"
///     How pairs are found; the pairs are the same.
/// threads : int, optional
///     Number of threads, at most one for each core, which is the default.
/// leaf_capacity : int, default 96
///     Particles that a box of the tree may hold before it splits.
/// max_depth : int, default 4096
///     Maximum number of subdivisions of the tree; the default never prevents a split.
/// substeps : int, optional
///     Sub-steps of a step, in which forces act and resting contacts are solved. None, the
///     default, takes as many as the scene needs: 4 with attractors, gravitation or springs, or
///     with gravity and a restitution below 1; otherwise 1. A step whose particles travel far is
///     divided into parts, which share the sub-steps; each part has at least one.
/// sleeping : bool, default True
///     Whether islands of touching particles that rest fall asleep under gravity, if the
///     coefficients of restitution at walls are below 1; see `asleep`. It stops motion with a mean
///     speed below 0.01 √(g r), where r is the radius.
/// track_events : bool, default False
///     Whether `events` reports which pairs began and ceased to touch in each call of `step`.
///
/// Raises
/// ------
/// TypeError
///     If an argument has the wrong type.
/// ValueError
///     If a shape is wrong, a value is out of range, or a particle does not fit
///     into the container; the message says which.
///
/// See Also
/// --------
/// jostle.scenes.create : The world of a named scene.
/// WorldContacts, WallContacts : Pairs and walls that touched, with impulses.
///
/// References
/// ----------
/// O. R. Walton, *Numerical simulation of inelastic, frictional particle-particle interactions*,
/// in: Particulate Two-Phase Flow (1993), for friction in bounces.
/// E. Catto, *Iterative Dynamics with Temporal Coherence*, Game Developers Conference (2005), for
/// resting contacts.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> world = jostle.World([(0, 0), (3, 0)], [(1, 0), (0, 0)], radii=1.0)
/// >>> world.step(0.1, steps=20)  # the left disc hits the right one after a second
/// >>> world.velocities
/// array([[0., 0.],
///        [1., 0.]], dtype=float32)
///
/// A disc that slides on a floor with friction begins to roll, at two thirds of its speed:
///
/// >>> world = jostle.World(
/// ...     [(0, 9)], [(3, 0)], radii=1.0, gravity=(0, 9.8), restitution=0.5, friction=0.4,
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
        signature = (
            positions, velocities, radii, *, masses=None, densities=Given::NOTHING, movable=None,
            gravity=Given::NOTHING, drag=Given::NOTHING, restitution=Given::NOTHING,
            friction=Given::NOTHING, angles=None, angular_velocities=None, categories=None,
            masks=None, sensors=None, container=None, container_restitution=Given::NOTHING, walls=None,
            wall_velocities=None, wall_restitution=Given::NOTHING, wall_friction=None,
            forces=Given::NOTHING, on_touch=Given::NOTHING,
            method=Given::NOTHING, threads=None, leaf_capacity=Given::NOTHING, max_depth=Given::NOTHING, substeps=None,
            sleeping=Given::NOTHING, track_events=Given::NOTHING,
        ),
        text_signature = "(positions, velocities, radii, *, masses=None, densities=1.0, \
                          movable=None, gravity=(0.0, 0.0), drag=0.0, restitution=1.0, \
                          friction=0.0, angles=None, angular_velocities=None, categories=None, \
                          masks=None, sensors=None, container=None, \
                          container_restitution=1.0, walls=None, \
                          wall_velocities=None, wall_restitution=1.0, \
                          wall_friction=None, forces=(), on_touch='bounce', method='quadtree', \
                          threads=None, leaf_capacity=96, max_depth=4096, substeps=None, sleeping=True, \
                          track_events=False)"
    )]
    #[expect(clippy::too_many_arguments, reason = "they are Python's keywords")]
    fn new<'py>(
        py: Python<'py>,
        positions: &Bound<'py, PyAny>,
        velocities: &Bound<'py, PyAny>,
        radii: &Bound<'py, PyAny>,
        masses: Option<&Bound<'py, PyAny>>,
        densities: Given<'py>,
        movable: Option<&Bound<'py, PyAny>>,
        gravity: Given<'py>,
        drag: Given<'py>,
        restitution: Given<'py>,
        friction: Given<'py>,
        angles: Option<&Bound<'py, PyAny>>,
        angular_velocities: Option<&Bound<'py, PyAny>>,
        categories: Option<&Bound<'py, PyAny>>,
        masks: Option<&Bound<'py, PyAny>>,
        sensors: Option<&Bound<'py, PyAny>>,
        container: Option<&Bound<'py, PyAny>>,
        container_restitution: Given<'py>,
        walls: Option<&Bound<'py, PyAny>>,
        wall_velocities: Option<&Bound<'py, PyAny>>,
        wall_restitution: Given<'py>,
        wall_friction: Option<&Bound<'py, PyAny>>,
        forces: Given<'py>,
        on_touch: Given<'py>,
        method: Given<'py>,
        threads: Option<&Bound<'py, PyAny>>,
        leaf_capacity: Given<'py>,
        max_depth: Given<'py>,
        substeps: Option<&Bound<'py, PyAny>>,
        sleeping: Given<'py>,
        track_events: Given<'py>,
    ) -> PyResult<Self> {
        let (mut draft, len) = Draft::of_new(positions, velocities, radii)?;
        draft.masses = reals("masses", masses, len)?;
        draft.densities = reals("densities", densities.value(), len)?;
        draft.movable = truths("movable", movable, len)?;
        draft.friction = reals("friction", friction.value(), len)?;
        draft.angles = reals("angles", angles, len)?;
        draft.angular_velocities = reals("angular_velocities", angular_velocities, len)?;
        draft.categories = bit_sets("categories", categories, len)?;
        draft.masks = bit_sets("masks", masks, len)?;
        draft.sensors = truths("sensors", sensors, len)?;
        let mut rules = WorldSettings {
            container: containers::read(container)?,
            on_touch: settings::on_touch(&on_touch)?,
            method: settings::method(&method)?,
            substeps: settings::substeps(substeps)?,
            sleeping: settings::sleeping(&sleeping)?,
            track_events: settings::track_events(&track_events)?,
            tree: settings::tree(&leaf_capacity, &max_depth, threads)?,
            ..WorldSettings::default()
        };
        if let Some(gravity) = gravity.value() {
            rules.gravity = point("gravity", gravity)?;
        }
        if let Some(drag) = drag.value() {
            rules.drag = number("drag", drag)? as f32;
        }
        if let Some(sides) = settings::sides(&container_restitution)? {
            rules.container_restitution = sides;
        }
        match reals("restitution", restitution.value(), len)? {
            Some(Each::One(one)) => rules.restitution = one,
            rows => draft.restitutions = rows,
        }
        let forces = forces.value().map_or(Ok(Vec::new()), forces::read)?;
        let mut walls = walls::read(walls)?;
        walls::set_velocities(&mut walls, wall_velocities)?;
        walls::set_restitution(&mut walls, &wall_restitution)?;
        walls::set_friction(&mut walls, wall_friction)?;
        let world = py.detach(|| {
            let defaults = draft.defaults(Defaults::default());
            let mut world = World::new(draft.particles(len, &defaults)?, rules)?;
            world.set_defaults(defaults)?;
            world.set_walls(walls)?;
            world.set_forces(forces)?;
            Ok(world)
        });
        Ok(Self::of(world.map_err(refused)?))
    }

    /// Advance the simulation.
    ///
    /// Other threads may read the world during the call; they see its state between two steps.
    /// If a step is refused, or interrupted with Ctrl-C, the world keeps the state before
    /// that step. In a call with `steps` above 1, the previous steps remain done.
    ///
    /// Parameters
    /// ----------
    /// dt : float
    ///     Length of a step in seconds, above 0.
    /// steps : int, default 1
    ///     Number of steps.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If `dt` is not finite and above 0, if a particle would move too far, if too many
    ///     particles are in one place, or if a number would become infinite or NaN; then the
    ///     message names the particle.
    /// KeyboardInterrupt
    ///     After Ctrl-C, within a fraction of a second also during a long step.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0)], [(8, 0)], radii=1.0)
    /// >>> world.step(0.25, steps=2)
    /// >>> world.positions
    /// array([[4., 0.]], dtype=float32)
    #[pyo3(signature = (dt, steps=Given::NOTHING), text_signature = "($self, dt, steps=1)")]
    fn step(&self, py: Python<'_>, dt: &Bound<'_, PyAny>, steps: Given<'_>) -> PyResult<()> {
        let dt = number("dt", dt)?;
        let mut left = steps.value().map_or(Ok(1), |value| count("steps", value, 0))?;
        // Checked before anything changes.
        self.long(py, |state| state.begin(dt))?.map_err(refused)?;
        while left > 0 {
            left = self.step_some(py, dt, left)?;
            py.check_signals()?;
        }
        Ok(())
    }

    /// Add one particle or many, after the others.
    ///
    /// The default of an omitted argument is the number that was last given for all particles: to
    /// `World`, as in ``World(..., friction=0.5)``, or by assignment, as in ``world.friction =
    /// 0.5``. An array with a number for each particle does not change the default.
    ///
    /// Parameters
    /// ----------
    /// positions, velocities : array_like, shape (k, 2), or (2,) for one particle
    /// radii : array_like, a number or shape (k,), optional
    ///     Required if no number was given for all particles.
    /// masses : array_like, a number or shape (k,), optional
    ///     If omitted and no number was given for all particles, or if `densities` are given,
    ///     density times radius squared.
    /// densities : array_like, a number or shape (k,), optional
    ///     1.0 if no number was given to `World`.
    /// restitutions : array_like, a number or shape (k,), optional
    ///     1.0 if no number was assigned to `world.restitutions`; `world.restitution` is a factor
    ///     of all contacts anyway.
    /// movable : array_like of bool, one or shape (k,), default True
    /// friction : array_like, a number or shape (k,), optional
    ///     0.0 if no number was given for all particles.
    /// angles, angular_velocities : array_like, a number or shape (k,), default 0.0
    /// categories, masks : array_like of int, a number or shape (k,), optional
    ///     1 and all bits if no number was given for all particles.
    /// sensors : array_like of bool, one or shape (k,), default False
    ///
    /// Returns
    /// -------
    /// ndarray of int64, shape (k,), or int
    ///     Their ids, above all ids before; one id for one position. Their rows are the last ones
    ///     of every column.
    ///
    /// Raises
    /// ------
    /// TypeError, ValueError
    ///     As for a new world; then nothing is added.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0)], [(0, 0)], radii=1.0)
    /// >>> world.add([(5, 0), (9, 0)], [(0, 0), (0, 0)], radii=0.5)
    /// array([1, 2])
    /// >>> world.add((0, 5), velocities=(1, 0))
    /// 3
    /// >>> world.radii
    /// array([1. , 0.5, 0.5, 1. ], dtype=float32)
    #[pyo3(signature = (
        positions, velocities, radii=None, *, masses=None, densities=None, restitutions=None,
        movable=None, friction=None, angles=None, angular_velocities=None,
        categories=None, masks=None, sensors=None,
    ))]
    #[expect(clippy::too_many_arguments, reason = "they are Python's keywords")]
    fn add<'py>(
        &self,
        py: Python<'py>,
        positions: &Bound<'py, PyAny>,
        velocities: &Bound<'py, PyAny>,
        radii: Option<&Bound<'py, PyAny>>,
        masses: Option<&Bound<'py, PyAny>>,
        densities: Option<&Bound<'py, PyAny>>,
        restitutions: Option<&Bound<'py, PyAny>>,
        movable: Option<&Bound<'py, PyAny>>,
        friction: Option<&Bound<'py, PyAny>>,
        angles: Option<&Bound<'py, PyAny>>,
        angular_velocities: Option<&Bound<'py, PyAny>>,
        categories: Option<&Bound<'py, PyAny>>,
        masks: Option<&Bound<'py, PyAny>>,
        sensors: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (mut draft, many) = Draft::of_one_or_many(positions, velocities, radii)?;
        let len = many.unwrap_or(1);
        draft.masses = reals("masses", masses, len)?;
        draft.densities = reals("densities", densities, len)?;
        draft.restitutions = reals("restitutions", restitutions, len)?;
        draft.movable = truths("movable", movable, len)?;
        draft.friction = reals("friction", friction, len)?;
        draft.angles = reals("angles", angles, len)?;
        draft.angular_velocities = reals("angular_velocities", angular_velocities, len)?;
        draft.categories = bit_sets("categories", categories, len)?;
        draft.masks = bit_sets("masks", masks, len)?;
        draft.sensors = truths("sensors", sensors, len)?;
        if radii.is_none() && self.state(py)?.world.defaults().radius.is_none() {
            let rule = "add needs radii: no number was given for all particles of this world";
            return Err(PyTypeError::new_err(rule));
        }
        let ids = result_of(self.long(py, |state| state.add(draft, len))?, many.is_none())?;
        if many.is_none() {
            ids.start.into_bound_py_any(py)
        } else {
            Ok(column(py, ids.collect()).into_any())
        }
    }

    /// Remove particles. Their ids are never used again.
    ///
    /// The ids of other particles stay the same; in the columns, the rows after a removed one move
    /// up. Springs and attractors of a removed particle are removed too.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,)
    ///     The particles, each at most once.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an id does not exist or is given twice; then none is removed.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (5, 0), (9, 0)], [(0, 0)] * 3, radii=1.0)
    /// >>> world.remove(1)
    /// >>> world.positions
    /// array([[0., 0.],
    ///        [9., 0.]], dtype=float32)
    /// >>> world.ids
    /// array([0, 2])
    fn remove(&self, py: Python<'_>, ids: &Bound<'_, PyAny>) -> PyResult<()> {
        let ids = Ids::read(ids, "particle")?;
        ids.result_of(self.long(py, |state| state.world.remove(&ids.all))?)
    }

    /// Change some columns of some particles.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,)
    ///     The particles, each at most once.
    /// positions, velocities : array_like, shape (k, 2), or (2,) for one id, optional
    /// radii, masses, restitutions : array_like, a number or shape (k,), optional
    ///     A new radius does not change the mass.
    /// movable : array_like of bool, one or shape (k,), optional
    /// friction, angles, angular_velocities : array_like, a number or shape (k,), optional
    /// categories, masks : array_like of int, a number or shape (k,), optional
    /// sensors : array_like of bool, one or shape (k,), optional
    ///     Omitted columns stay the same.
    ///
    /// Raises
    /// ------
    /// TypeError, ValueError
    ///     As for a new world, or if an id does not exist or is given twice; then nothing
    ///     is changed.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (5, 0)], [(0, 0), (0, 0)], radii=1.0)
    /// >>> world.set([1], velocities=[(2, 0)], masses=3.0)
    /// >>> world.momentum
    /// (6.0, 0.0)
    /// >>> world.set(0, positions=(2, 1))
    #[pyo3(signature = (
        ids, *, positions=None, velocities=None, radii=None, masses=None, restitutions=None,
        movable=None, friction=None, angles=None, angular_velocities=None, categories=None,
        masks=None, sensors=None,
    ))]
    #[expect(clippy::too_many_arguments, reason = "they are Python's keywords")]
    fn set(
        &self,
        py: Python<'_>,
        ids: &Bound<'_, PyAny>,
        positions: Option<&Bound<'_, PyAny>>,
        velocities: Option<&Bound<'_, PyAny>>,
        radii: Option<&Bound<'_, PyAny>>,
        masses: Option<&Bound<'_, PyAny>>,
        restitutions: Option<&Bound<'_, PyAny>>,
        movable: Option<&Bound<'_, PyAny>>,
        friction: Option<&Bound<'_, PyAny>>,
        angles: Option<&Bound<'_, PyAny>>,
        angular_velocities: Option<&Bound<'_, PyAny>>,
        categories: Option<&Bound<'_, PyAny>>,
        masks: Option<&Bound<'_, PyAny>>,
        sensors: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let ids = Ids::read(ids, "particle")?;
        let len = ids.all.len();
        let draft = Draft {
            positions: vectors_of(&ids, "positions", positions)?,
            velocities: vectors_of(&ids, "velocities", velocities)?,
            radii: reals("radii", radii, len)?,
            masses: reals("masses", masses, len)?,
            restitutions: reals("restitutions", restitutions, len)?,
            movable: truths("movable", movable, len)?,
            densities: None,
            friction: reals("friction", friction, len)?,
            angles: reals("angles", angles, len)?,
            angular_velocities: reals("angular_velocities", angular_velocities, len)?,
            categories: bit_sets("categories", categories, len)?,
            masks: bit_sets("masks", masks, len)?,
            sensors: truths("sensors", sensors, len)?,
        };
        ids.result_of(self.long(py, |state| state.write_some(draft, &ids.all))?)
    }

    /// Add given forces on some particles, for the next call of `step`.
    ///
    /// They act during all steps of that call, beside gravity and `forces`, and end with it. Forces
    /// on the same particle add up.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,)
    ///     The particles; one may be given more than once. Immovable ones are not accelerated.
    /// forces : array_like, shape (k, 2), or (2,) for one id
    ///     In units of mass times length per second². A force wakes the particle.
    ///
    /// Raises
    /// ------
    /// TypeError, ValueError
    ///     If an id does not exist, a shape is wrong, or a number is not finite or too large; then
    ///     nothing is changed.
    ///
    /// See Also
    /// --------
    /// World.accelerations : Those of all particles.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (5, 0)], [(0, 0), (0, 0)], radii=1.0, masses=2.0)
    /// >>> world.force(1, (0, 6))
    /// >>> world.step(0.5, steps=2)
    /// >>> world.velocities.tolist()
    /// [[0.0, 0.0], [0.0, 3.0]]
    fn force(
        &self,
        py: Python<'_>,
        ids: &Bound<'_, PyAny>,
        forces: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let ids = Ids::read(ids, "particle")?;
        let forces = vectors_of(&ids, "forces", Some(forces))?.unwrap_or_default();
        ids.result_of(self.long(py, |state| state.world.add_forces(&ids.all, &forces))?)
    }

    /// The ids of all particles, ascending: ndarray of int64, shape (n,), a read-only copy.
    ///
    /// The particle in row i of every column has the id ``ids[i]``. Ids never change and are never
    /// used again. ``id in world`` is True if a particle has the id.
    ///
    /// See Also
    /// --------
    /// rows : The rows of ids.
    /// renumbered : The new ids after particles merged.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (5, 0), (9, 0)], [(0, 0)] * 3, radii=1.0)
    /// >>> world.remove(0)
    /// >>> world.add([(2, 2)], [(0, 0)], radii=1.0)
    /// array([3])
    /// >>> world.ids
    /// array([1, 2, 3])
    #[getter]
    fn ids<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<Id>>> {
        let ids = self.long(py, |state| state.world.ids())?;
        Ok(read_only(column(py, ids)))
    }

    /// Return the rows that particles have in the columns.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,)
    ///     The particles.
    ///
    /// Returns
    /// -------
    /// ndarray of int64, shape (k,), or int
    ///     Their rows, until a particle before them is removed or merges; one row for one id.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If `ids` does not hold integers.
    /// ValueError
    ///     If no particle has an id.
    ///
    /// See Also
    /// --------
    /// ids : The ids of all rows.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (5, 0), (9, 0)], [(0, 0)] * 3, radii=1.0)
    /// >>> world.remove(0)
    /// >>> world.positions[world.rows(2)]
    /// array([9., 0.], dtype=float32)
    fn rows<'py>(&self, py: Python<'py>, ids: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let ids = Ids::read(ids, "particle")?;
        let rows = ids.result_of(self.long(py, |state| state.world.rows_of(&ids.all))?)?;
        if ids.single {
            rows[0].into_bound_py_any(py)
        } else {
            Ok(column(py, rows.into_iter().map(i64::from).collect()).into_any())
        }
    }

    /// Centres: ndarray of float32, shape (n, 2), a read-only copy in units of length.
    ///
    /// Writing into the copy, as in ``world.positions[0] = (1, 2)`` or
    /// ``world.positions += 1``, raises ValueError. Assign a whole column instead,
    /// ``world.positions = world.positions + 1``, or change some particles with
    /// ``world.set([0], positions=[(1, 2)])``. The same holds for every column.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let positions = self.long(py, |state| state.world.positions())?;
        Ok(read_only(table(py, positions)?))
    }

    #[setter]
    fn set_positions(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        self.write_all(py, |len| {
            let positions = vectors("positions", Some(value), len)?;
            Ok(Draft { positions, ..Draft::default() })
        })
    }

    /// Velocities: ndarray of float32, shape (n, 2), a read-only copy in units of length per
    /// second.
    ///
    /// To change them, assign a whole column, ``world.velocities = world.velocities * 2``,
    /// or change some particles with ``world.set([0], velocities=[(7, 7)])``.
    #[getter]
    fn velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let velocities = self.long(py, |state| state.world.velocities())?;
        Ok(read_only(table(py, velocities)?))
    }

    #[setter]
    fn set_velocities(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        self.write_all(py, |len| {
            let velocities = vectors("velocities", Some(value), len)?;
            Ok(Draft { velocities, ..Draft::default() })
        })
    }

    /// Given accelerations in the next call of `step`: ndarray of float32, shape
    /// (n, 2), a read-only copy in units of length per second².
    ///
    /// Assign an array of this shape before each call, or None for none; `force` adds to it. They
    /// act during all steps of the call, beside gravity and `forces`, and are 0 after it. Immovable
    /// particles are not accelerated. The others wake if theirs is not 0, and do not fall asleep in
    /// the call.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the shape is wrong, or a number is not finite or too large.
    ///
    /// See Also
    /// --------
    /// World.force : Forces on some particles.
    ///
    /// Examples
    /// --------
    /// A force towards the x axis:
    ///
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 1)], [(0, 0)], radii=0.1)
    /// >>> for _ in range(157):  # half a period: π / 0.02 steps
    /// ...     world.accelerations = -world.positions * (0, 1)
    /// ...     world.step(0.02)
    /// >>> world.positions.round(1).tolist()
    /// [[0.0, -1.0]]
    #[getter]
    fn accelerations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let given = self.long(py, |state| {
            let mut given = state.world.given_accelerations().to_vec();
            given.resize(state.world.len(), [0.0; 2]);
            given
        })?;
        Ok(read_only(table(py, given)?))
    }

    #[setter]
    fn set_accelerations(&self, py: Python<'_>, value: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let len = self.state(py)?.world.len();
        let given = vectors("accelerations", value, len)?.unwrap_or_else(|| vec![[0.0; 2]; len]);
        self.long(py, |state| state.world.set_accelerations(given))?.map_err(refused)
    }

    /// Radii: ndarray of float32, shape (n,), a read-only copy in units of length.
    ///
    /// To change all, assign an array or one number; to change some, use `set`. Masses stay
    /// the same.
    #[getter]
    fn radii<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let radii = self.long(py, |state| state.world.radii())?;
        Ok(read_only(column(py, radii)))
    }

    #[setter]
    fn set_radii(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        self.write_all(py, |len| {
            let radii = reals("radii", Some(value), len)?;
            Ok(Draft { radii, ..Draft::default() })
        })
    }

    /// Masses: ndarray of float32, shape (n,), a read-only copy.
    ///
    /// To change all, assign an array or one number; to change some, use `set`.
    #[getter]
    fn masses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let masses = self.long(py, |state| state.world.masses())?;
        Ok(read_only(column(py, masses)))
    }

    #[setter]
    fn set_masses(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        self.write_all(py, |len| {
            let masses = reals("masses", Some(value), len)?;
            Ok(Draft { masses, ..Draft::default() })
        })
    }

    /// Coefficients of restitution: ndarray of float32, shape (n,), a read-only copy.
    ///
    /// To change all, assign an array or one number; to change some, use `set`.
    #[getter]
    fn restitutions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let restitutions = self.long(py, |state| state.world.restitutions())?;
        Ok(read_only(column(py, restitutions)))
    }

    #[setter]
    fn set_restitutions(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        self.write_all(py, |len| {
            let restitutions = reals("restitutions", Some(value), len)?;
            Ok(Draft { restitutions, ..Draft::default() })
        })
    }

    /// Which particles are movable: ndarray of bool, shape (n,), a read-only copy.
    ///
    /// The others keep their velocities: a disc that is made immovable while it moves becomes
    /// kinematic.
    ///
    /// To change all, assign an array or one bool; to change some, use `set`.
    #[getter]
    fn movable<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let movable = self.long(py, |state| state.world.movable())?;
        Ok(read_only(column(py, movable)))
    }

    #[setter]
    fn set_movable(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        self.write_all(py, |len| {
            let movable = truths("movable", Some(value), len)?;
            Ok(Draft { movable, ..Draft::default() })
        })
    }

    /// Coefficients of friction: ndarray of float32, shape (n,), a read-only copy.
    ///
    /// To change all, assign an array or one number; to change some, use `set`.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an assigned coefficient is not finite or below 0, or the shape is wrong.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (3, 0)], [(0, 0)] * 2, radii=1.0)
    /// >>> world.friction = 0.5
    /// >>> world.set(1, friction=0.8)
    /// >>> world.friction
    /// array([0.5, 0.8], dtype=float32)
    #[getter]
    fn friction<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let friction = self.long(py, |state| state.world.friction())?;
        Ok(read_only(column(py, friction)))
    }

    #[setter]
    fn set_friction(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        self.write_all(py, |len| {
            let friction = reals("friction", Some(value), len)?;
            Ok(Draft { friction, ..Draft::default() })
        })
    }

    /// Angles: ndarray of float32, shape (n,), a read-only copy in radians, -π to π without π.
    ///
    /// Positive angles are from +x to +y. To change all, assign an array or one number; to
    /// change some, use `set`. Numbers outside the range are wrapped into it.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an assigned angle is not finite, or the shape is wrong.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0)], [(0, 0)], radii=1.0, angular_velocities=0.5)
    /// >>> world.step(0.25, steps=8)
    /// >>> world.angles
    /// array([1.], dtype=float32)
    #[getter]
    fn angles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let angles = self.long(py, |state| state.world.angles())?;
        Ok(read_only(column(py, angles)))
    }

    #[setter]
    fn set_angles(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        self.write_all(py, |len| {
            let angles = reals("angles", Some(value), len)?;
            Ok(Draft { angles, ..Draft::default() })
        })
    }

    /// Angular velocities: ndarray of float32, shape (n,), a read-only copy in radians per second.
    ///
    /// Those of particles of radius 0 are 0. To change all, assign an
    /// array or one number; to change some, use `set`.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an assigned angular velocity is not finite or above 1e18, or the shape is wrong.
    ///
    /// See Also
    /// --------
    /// angles : The angles that follow from them.
    #[getter]
    fn angular_velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let angular_velocities = self.long(py, |state| state.world.angular_velocities())?;
        Ok(read_only(column(py, angular_velocities)))
    }

    #[setter]
    fn set_angular_velocities(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        self.write_all(py, |len| {
            let angular_velocities = reals("angular_velocities", Some(value), len)?;
            Ok(Draft { angular_velocities, ..Draft::default() })
        })
    }

    /// Categories: ndarray of uint32, shape (n,), a read-only copy of bit sets.
    ///
    /// Particles i and j may touch only if ``categories[i] & masks[j]`` and
    /// ``categories[j] & masks[i]``. To change all, assign an array or one number; to change some,
    /// use `set`. The islands of changed particles wake.
    ///
    /// See Also
    /// --------
    /// masks : The categories that each particle may touch.
    ///
    /// Examples
    /// --------
    /// Ghosts pass through each other, and bounce off everything else:
    ///
    /// >>> import jostle
    /// >>> GHOST = 2
    /// >>> world = jostle.World([(0, 0), (3, 0), (9, 0)], [(1, 0), (0, 0), (0, 0)], radii=1.0)
    /// >>> world.set([0, 1], categories=GHOST, masks=~GHOST)
    /// >>> world.step(0.1, steps=90)
    /// >>> world.velocities[:, 0]
    /// array([0., 0., 1.], dtype=float32)
    /// >>> world.categories
    /// array([2, 2, 1], dtype=uint32)
    #[getter]
    fn categories<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<u32>>> {
        self.filter_bits(py, |filter| filter.category)
    }

    #[setter]
    fn set_categories(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        self.write_all(py, |len| {
            let categories = bit_sets("categories", Some(value), len)?;
            Ok(Draft { categories, ..Draft::default() })
        })
    }

    /// Masks: ndarray of uint32, shape (n,), a read-only copy of bit sets of the categories that
    /// each particle may touch, see `categories`.
    ///
    /// To change all, assign an array or one number; to change some, use `set`.
    #[getter]
    fn masks<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<u32>>> {
        self.filter_bits(py, |filter| filter.mask)
    }

    #[setter]
    fn set_masks(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        self.write_all(py, |len| {
            let masks = bit_sets("masks", Some(value), len)?;
            Ok(Draft { masks, ..Draft::default() })
        })
    }

    /// Which particles are sensors: ndarray of bool, shape (n,), a read-only copy.
    ///
    /// A sensor and another particle pass through each other; `contacts` and `events` report that
    /// they touch, without impulses. A disc that passes through a sensor within a step, at any
    /// speed, is found too: it has entered and left. Walls, the container and forces act on sensors
    /// that are movable, as on other particles; one with ``movable=False`` stays where it is put or
    /// moves with its velocity, and reports other particles that are not movable, too. Two sensors
    /// report each other if one is movable. Categories and masks determine what they report. They
    /// never merge.
    ///
    /// To change all, assign an array or one bool; to change some, use `set`.
    ///
    /// See Also
    /// --------
    /// events : The pairs that began and ceased to touch.
    ///
    /// Examples
    /// --------
    /// A fast disc passes through a sensor within one step:
    ///
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0)], [(900, 0)], radii=1.0, track_events=True)
    /// >>> goal = world.add((5, 0), (0, 0), radii=2.0, movable=False, sensors=True)
    /// >>> world.step(1 / 60)
    /// >>> world.events.entered, world.events.left
    /// (array([[0, 1]]), array([[0, 1]]))
    /// >>> world.velocities[0]
    /// array([900.,   0.], dtype=float32)
    #[getter]
    fn sensors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let sensors = self.long(py, |state| state.world.sensors())?;
        Ok(read_only(column(py, sensors)))
    }

    #[setter]
    fn set_sensors(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        self.write_all(py, |len| {
            let sensors = truths("sensors", Some(value), len)?;
            Ok(Draft { sensors, ..Draft::default() })
        })
    }

    /// Acceleration of all movable particles, (x, y), units of length per second squared.
    #[getter]
    fn gravity(&self, py: Python<'_>) -> PyResult<(f64, f64)> {
        Ok(self.rules(py)?.gravity.map(decimal).into())
    }

    #[setter]
    fn set_gravity(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let gravity = point("gravity", value)?;
        self.change_rules(py, |rules| rules.gravity = gravity)
    }

    /// Linear damping, per second.
    #[getter]
    fn drag(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(decimal(self.rules(py)?.drag))
    }

    #[setter]
    fn set_drag(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let drag = number("drag", value)? as f32;
        self.change_rules(py, |rules| rules.drag = drag)
    }

    /// The world's coefficient of restitution, 0 to 1; `restitutions` has those of the particles.
    #[getter]
    fn restitution(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(decimal(self.rules(py)?.restitution))
    }

    #[setter]
    fn set_restitution(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let restitution = number("restitution", value)? as f32;
        self.change_rules(py, |rules| rules.restitution = restitution)
    }

    /// The region of the particles: a Box, Circle, Torus or None.
    #[getter]
    fn container(&self, py: Python<'_>) -> PyResult<Option<Py<PyAny>>> {
        containers::show(py, self.rules(py)?.container)
    }

    #[setter]
    fn set_container(&self, py: Python<'_>, value: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let container = containers::read(value)?;
        self.change_rules(py, |rules| rules.container = container)
    }

    /// Coefficients of restitution of the sides of the container: ndarray of float32, shape (4,), a
    /// read-only copy in the order min x, max x, min y, max y.
    ///
    /// Assign an array or one number, 0 to 1. A `Circle` has one wall; its four are equal.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If one is not between 0 and 1, if the shape is wrong, or if those of a `Circle` differ.
    ///
    /// Examples
    /// --------
    /// An inelastic floor between elastic walls:
    ///
    /// >>> import jostle
    /// >>> world = jostle.World(
    /// ...     [(5, 5)], [(3, -9)], radii=1.0, container=jostle.Box(0, 0, 10, 10),
    /// ...     container_restitution=[1, 1, 0, 1],
    /// ... )
    /// >>> world.step(0.1, steps=15)
    /// >>> world.velocities
    /// array([[-3.,  0.]], dtype=float32)
    #[getter]
    fn container_restitution<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        Ok(read_only(column(py, self.rules(py)?.container_restitution.to_vec())))
    }

    #[setter]
    fn set_container_restitution(&self, py: Python<'_>, value: Given<'_>) -> PyResult<()> {
        let sides = settings::sides(&value)?;
        self.change_rules(py, |rules| {
            rules.container_restitution = sides.unwrap_or(rules.container_restitution);
        })
    }

    /// Walls: ndarray of float32, shape (m, 2, 2), a read-only copy of the ends of line segments in
    /// units of length.
    ///
    /// Assign an array of this shape, or None for no walls. Wall k keeps the velocity and the
    /// coefficients of the previous wall k; additional ones are at rest and have a restitution of 1
    /// and the friction of the particles. All particles wake. Walls that are moved in this way
    /// transfer no momentum, see `wall_velocities`: particles that overlap a wall are pushed out in
    /// several steps, to the side on which their centre is.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the shape is wrong, a coordinate is not finite or above 1e18, the ends of a wall are
    ///     equal, or the container is a `Torus`.
    ///
    /// See Also
    /// --------
    /// jostle.polyline : Walls between consecutive points.
    /// wall_contacts : The walls that particles touched.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World(
    /// ...     [(0, 2)], [(0, -4)], radii=1.0, walls=jostle.polyline([(-3, 0), (0, 0), (3, 0)])
    /// ... )
    /// >>> world.step(0.5)
    /// >>> world.positions, world.wall_contacts.walls  # 4 + the index of the wall
    /// (array([[0., 2.]], dtype=float32), array([4]))
    /// >>> world.walls = None
    /// >>> world.walls.shape
    /// (0, 2, 2)
    #[getter]
    fn walls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        walls::ends(py, &self.all_walls(py)?)
    }

    #[setter]
    fn set_walls(&self, py: Python<'_>, value: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let mut new = walls::read(value)?;
        for (wall, old) in new.iter_mut().zip(self.all_walls(py)?) {
            *wall = Wall { ends: wall.ends, residuals: wall.residuals, ..old };
        }
        self.change_walls(py, new)
    }

    /// Velocities of the walls: ndarray of float32, shape (m, 2), a read-only copy in units of
    /// length per second.
    ///
    /// A wall moves with its velocity in each step, so that `walls` has its new ends, and pushes
    /// particles as a kinematic particle does: pistons, paddles, lifts. Assign an array, one vector
    /// or None for 0. All particles wake.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the shape is wrong, or a component is not finite or above 1e18.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> piston = [((0, -2), (0, 2))]
    /// >>> world = jostle.World(
    /// ...     [(4, 0)], [(0, 0)], radii=1.0, walls=piston, wall_velocities=(2, 0)
    /// ... )
    /// >>> world.step(0.5, steps=4)  # they touch after 1.5 seconds
    /// >>> world.velocities, world.walls[:, 0]
    /// (array([[4., 0.]], dtype=float32), array([[ 4., -2.]], dtype=float32))
    #[getter]
    fn wall_velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        walls::velocities(py, &self.all_walls(py)?)
    }

    #[setter]
    fn set_wall_velocities(
        &self,
        py: Python<'_>,
        value: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let mut all = self.all_walls(py)?;
        walls::set_velocities(&mut all, value)?;
        self.change_walls(py, all)
    }

    /// Coefficients of restitution of the walls: ndarray of float32, shape (m,), a read-only copy.
    ///
    /// Assign an array or one number, 0 to 1.
    #[getter]
    fn wall_restitution<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        Ok(walls::restitution(py, &self.all_walls(py)?))
    }

    #[setter]
    fn set_wall_restitution(&self, py: Python<'_>, value: Given<'_>) -> PyResult<()> {
        let mut all = self.all_walls(py)?;
        walls::set_restitution(&mut all, &value)?;
        self.change_walls(py, all)
    }

    /// Coefficients of friction of the walls: ndarray of float32, shape (m,), a read-only copy.
    ///
    /// NaN stands for the coefficient of the particle. Assign an array or one number, or None for
    /// NaN.
    #[getter]
    fn wall_friction<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        Ok(walls::friction(py, &self.all_walls(py)?))
    }

    #[setter]
    fn set_wall_friction(&self, py: Python<'_>, value: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let mut all = self.all_walls(py)?;
        walls::set_friction(&mut all, value)?;
        self.change_walls(py, all)
    }

    /// The forces: a tuple of `Attractor`, `Gravitation`, `Springs`, `Thermostat`, `ThermalWalls`,
    /// `AndersenThermostat` and `Motor`. Assign any sequence of them. They refer to particles by
    /// id. If a particle is removed, its attractors and springs are removed too, and motors drive
    /// the others. If particles merge, forces refer to the merged particle, and a spring between
    /// two of them is removed.
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        forces::show(py, self.long(py, |state| state.world.forces())?)
    }

    #[setter]
    fn set_forces(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let forces = forces::read(value)?;
        self.long(py, |state| state.world.set_forces(forces))?.map_err(refused)
    }

    /// What happens to particles that touch: "bounce", "merge" or "ignore".
    #[getter]
    fn on_touch(&self, py: Python<'_>) -> PyResult<&'static str> {
        Ok(settings::on_touch_name(self.rules(py)?.on_touch))
    }

    #[setter]
    fn set_on_touch(&self, py: Python<'_>, value: Given<'_>) -> PyResult<()> {
        let on_touch = settings::on_touch(&value)?;
        self.change_rules(py, |rules| rules.on_touch = on_touch)
    }

    /// The new id of each id after the last call of `step`: a read-only ndarray of int64, or None
    /// if no particles merged.
    ///
    /// It has one number for each id that was ever given: ``ids = world.renumbered[ids]`` updates
    /// ids. Particles that merged share the smallest of their ids; all other ids stay the same. -1
    /// stands for an id that no particle has, also if it was removed since. Each call of `step`
    /// replaces the array: read it after every call that may merge particles.
    ///
    /// Raises
    /// ------
    /// MemoryError
    ///     If more than 134217728 ids were given, or there is not enough memory.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World(
    /// ...     [(0, 0), (5, 0), (1, 0), (9, 0)], [(0, 0)] * 4, radii=1.0, on_touch="merge"
    /// ... )
    /// >>> world.step(0.1)
    /// >>> world.ids
    /// array([0, 1, 3])
    /// >>> mine = np.array([2, 3])
    /// >>> world.renumbered[mine]  # 2 is part of 0 now
    /// array([0, 3])
    #[getter]
    fn renumbered<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray1<i64>>>> {
        let ids = self.long(py, |state| state.world.renumbered())?.map_err(refused)?;
        let ids = ids.map(|ids| ids.into_iter().map(|id| id.unwrap_or(-1)).collect());
        Ok(ids.map(|ids| read_only(column(py, ids))))
    }

    /// How pairs are found: "quadtree" or "brute".
    #[getter]
    fn method(&self, py: Python<'_>) -> PyResult<&'static str> {
        Ok(settings::method_name(self.rules(py)?.method))
    }

    #[setter]
    fn set_method(&self, py: Python<'_>, value: Given<'_>) -> PyResult<()> {
        let method = settings::method(&value)?;
        self.change_rules(py, |rules| rules.method = method)
    }

    /// Number of threads that was set; None for one on each core. A call uses at most one on
    /// each core.
    #[getter]
    fn threads(&self, py: Python<'_>) -> PyResult<Option<usize>> {
        Ok(self.rules(py)?.tree.threads)
    }

    #[setter]
    fn set_threads(&self, py: Python<'_>, value: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let threads = settings::threads(value)?;
        self.change_rules(py, |rules| rules.tree.threads = threads)
    }

    /// Particles that a box of the tree may hold before it splits.
    #[getter]
    fn leaf_capacity(&self, py: Python<'_>) -> PyResult<usize> {
        Ok(self.rules(py)?.tree.leaf_capacity)
    }

    #[setter]
    fn set_leaf_capacity(&self, py: Python<'_>, value: Given<'_>) -> PyResult<()> {
        let leaf_capacity = settings::leaf_capacity(&value)?;
        self.change_rules(py, |rules| rules.tree.leaf_capacity = leaf_capacity)
    }

    /// Maximum number of subdivisions of the tree.
    #[getter]
    fn max_depth(&self, py: Python<'_>) -> PyResult<usize> {
        Ok(self.rules(py)?.tree.max_depth)
    }

    #[setter]
    fn set_max_depth(&self, py: Python<'_>, value: Given<'_>) -> PyResult<()> {
        let max_depth = settings::max_depth(&value)?;
        self.change_rules(py, |rules| rules.tree.max_depth = max_depth)
    }

    /// Sub-steps of a step: the number that was set, or as many as the scene needs. Set it to None
    /// for the latter.
    #[getter]
    fn substeps(&self, py: Python<'_>) -> PyResult<usize> {
        Ok(self.state(py)?.world.substeps())
    }

    #[setter]
    fn set_substeps(&self, py: Python<'_>, value: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let substeps = settings::substeps(value)?;
        self.change_rules(py, |rules| rules.substeps = substeps)
    }

    /// Whether resting islands may fall asleep, see `asleep`. If it is set to False, all wake.
    #[getter]
    fn sleeping(&self, py: Python<'_>) -> PyResult<bool> {
        Ok(self.rules(py)?.sleeping)
    }

    #[setter]
    fn set_sleeping(&self, py: Python<'_>, value: Given<'_>) -> PyResult<()> {
        let sleeping = settings::sleeping(&value)?;
        self.change_rules(py, |rules| rules.sleeping = sleeping)
    }

    /// Which particles are asleep: ndarray of bool, shape (n,), a read-only copy.
    ///
    /// An island of particles that touch or nearly touch falls asleep under gravity if each of them
    /// rests on something and has been slow for half a second, and if their motion is steady and
    /// does not grow.
    /// Sleeping particles do not move, and cost almost nothing. `contacts` and `wall_contacts` keep
    /// those of the last step in which they were awake. An island wakes if a moving particle comes
    /// so near that it could touch it in the step, or if one of its particles is changed or removed
    /// (also if `world.positions` is assigned: to move a few, use `world.set`).
    /// All wake if the forces, an immovable particle or a setting other than `method`, `threads`,
    /// `leaf_capacity` and `max_depth` changes, or if an immovable particle is added. If only the
    /// velocities of an immovable particle change, the islands that touch it wake. Nothing falls
    /// asleep if there is a force other than `Thermostat`, or with another `on_touch` than
    /// "bounce". Immovable particles are never asleep, and nothing sleeps on a kinematic one.
    ///
    /// See Also
    /// --------
    /// sleeping : Turns it off.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World(
    /// ...     [(0, 1), (5, 1)], [(0, 0), (2, 0)], radii=1.0, gravity=(0, -9.8), restitution=0.5,
    /// ...     container=jostle.Box(-9, 0, 99, 9),
    /// ... )
    /// >>> world.step(1 / 60, steps=60)
    /// >>> world.asleep
    /// array([ True, False])
    #[getter]
    fn asleep<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let asleep = self.long(py, |state| state.world.asleep())?;
        Ok(read_only(column(py, asleep)))
    }

    /// Return a quadtree of the particles in their current state.
    ///
    /// It is a copy: later steps do not change it. Its queries return rows: ``world.ids[rows]`` are
    /// the ids of these particles, if none was added, removed or merged since. Queries do not
    /// include images beyond the sides of a torus.
    ///
    /// Returns
    /// -------
    /// Quadtree
    ///     Discs of float32, with their categories and masks, and with the world's `leaf_capacity`,
    ///     `max_depth` and `threads`.
    ///
    /// Raises
    /// ------
    /// MemoryError
    ///     If there is not enough memory.
    ///
    /// See Also
    /// --------
    /// Quadtree : All queries.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (3, 0), (9, 0)], [(1, 0)] * 3, radii=1.0)
    /// >>> world.step(1.0)
    /// >>> tree = world.quadtree()
    /// >>> tree.nearest((6.0, 0.0)).ids
    /// array([1])
    /// >>> tree.query_circle((0.0, 0.0), 1.0)
    /// array([0])
    fn quadtree(&self, py: Python<'_>) -> PyResult<PyQuadtree> {
        let tree = self.long(py, |state| state.world.quadtree())?;
        Ok(PyQuadtree::of(tree.map_err(refused)?))
    }

    /// The pairs that touched during the last step: a `WorldContacts` of `pairs` (m, 2) of ids,
    /// ``i < j``, unit `normals` (m, 2) from i to j, `depths` (m,), the penetration at
    /// its end, negative for pairs that had separated, and the sums of the impulses of the step
    /// along the normal and of friction, `normal_impulses` and `friction_impulses` (m,). If
    /// `on_touch` is not "bounce", the pairs that overlap now, without impulses.
    #[getter]
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let touches = self.long(py, |state| state.world.contacts())?;
        results::world_contacts(py, touches.map_err(refused)?)
    }

    /// The particles to which walls or the container gave an impulse during the last step: a
    /// `WallContacts` of `ids` (m,), ascending, `walls` (m,), unit `normals` (m, 2) from the wall
    /// to the particle, `depths` (m,), `normal_impulses` and `friction_impulses` (m,) on the
    /// particle. Divided by the length of the step, impulses are mean forces.
    ///
    /// The walls of the container have the numbers 0 to 3, see `WallContacts`; wall k of `walls`
    /// has the number 4 + k.
    ///
    /// See Also
    /// --------
    /// contacts : The pairs of particles.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> box = jostle.Box(-9, 0, 9, 9)
    /// >>> world = jostle.World(
    /// ...     [(0, 1)], [(0, 0)], radii=1.0, gravity=(0, -10), restitution=0.5, container=box
    /// ... )
    /// >>> world.step(0.01)
    /// >>> world.wall_contacts.walls, (world.wall_contacts.normal_impulses / 0.01).round(2)
    /// (array([2]), array([10.], dtype=float32))
    #[getter]
    fn wall_contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        results::wall_contacts(py, self.long(py, |state| state.world.wall_contacts())?)
    }

    /// The pairs that began and ceased to touch in the last call of `step`: a `WorldEvents` of
    /// `entered`, `stayed` and `left`, each an ndarray of int64, shape (m, 2), of ids ``i < j``,
    /// sorted. They need ``World(..., track_events=True)`` or ``world.track_events = True``.
    ///
    /// All steps and sub-steps of the call count: a pair that began and ceased to touch is in
    /// `entered` and in `left`. A pair in `entered` did not touch at the end of the call before,
    /// and a pair in `left` does not touch at the end of this one, also because a particle was
    /// removed or merged. In the first call all pairs that touch have entered. So a pair
    /// that has entered does not enter again before it has left.
    ///
    /// Particles touch if they collide, if the gap between them is at most the rounding of float32,
    /// or if a resting contact presses them together. Particles that pass through each other,
    /// sensors among them, touch if they overlap at any time of the call. Two that are not movable
    /// touch only if just one is a sensor.
    ///
    /// Raises
    /// ------
    /// RuntimeError
    ///     If `track_events` is False.
    ///
    /// See Also
    /// --------
    /// contacts : The pairs of the last step, with impulses.
    /// collisions : The number of collisions.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World(
    /// ...     [(0, 0), (3, 0), (8, 0)], [(1, 0), (0, 0), (0, 0)], radii=1.0, track_events=True
    /// ... )
    /// >>> world.step(2.0)  # 0 hits 1, which flies on
    /// >>> world.events.entered, world.events.left
    /// (array([[0, 1]]), array([[0, 1]]))
    /// >>> world.step(2.0)  # 1 touches 2 after 4 seconds
    /// >>> entered, stayed, left = world.events
    /// >>> entered, len(stayed), len(left)
    /// (array([[1, 2]]), 0, 0)
    #[getter]
    fn events<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let events = self.long(py, |state| state.world.events())?;
        let rule = "events are not tracked; set world.track_events = True before the step, or make \
                    the world with track_events=True";
        results::world_events(py, events.ok_or_else(|| PyRuntimeError::new_err(rule))?)
    }

    /// Whether `events` are tracked. The motion does not depend on it. If it is turned on, no pair
    /// counts as touching before the next step.
    #[getter]
    fn track_events(&self, py: Python<'_>) -> PyResult<bool> {
        Ok(self.rules(py)?.track_events)
    }

    #[setter]
    fn set_track_events(&self, py: Python<'_>, value: Given<'_>) -> PyResult<()> {
        let track_events = settings::track_events(&value)?;
        self.change_rules(py, |rules| rules.track_events = track_events)
    }

    /// The number of collisions in the last call of `step`: a `WorldCollisions` of `pairs`, those
    /// of two particles, and `walls`, those of a particle and a wall or the container.
    ///
    /// Every impact counts, also several of one pair. Resting contacts do not count.
    ///
    /// See Also
    /// --------
    /// contacts, wall_contacts : Which particles touched, with impulses.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> box = jostle.Box(-4, -1, 4, 1)
    /// >>> world = jostle.World([(-3, 0), (0, 0)], [(1, 0), (0, 0)], radii=1.0, container=box)
    /// >>> world.step(1 / 60, steps=600)  # 10 seconds; a collision each 1, 3, 5, ... seconds
    /// >>> world.collisions
    /// WorldCollisions(pairs=3, walls=2)
    #[getter]
    fn collisions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let collisions = self.state(py)?.world.collisions();
        results::world_collisions(py, collisions)
    }

    /// Sum of mass times velocity, (x, y).
    #[getter]
    fn momentum(&self, py: Python<'_>) -> PyResult<(f64, f64)> {
        Ok(self.long(py, |state| state.world.momentum())?.into())
    }

    /// Sum of ½ m v² + ½ I ω² of the movable particles, with the moment of inertia I = m r²/2.
    #[getter]
    fn kinetic_energy(&self, py: Python<'_>) -> PyResult<f64> {
        self.long(py, |state| state.world.kinetic_energy())
    }

    /// Energy of all movable particles in the fields of gravity (0 at the origin) and of
    /// attractors (harmonic: 0 at the point, inverse square: 0 at infinity), of unbroken
    /// springs (½ stiffness times stretch squared) and of gravitation (0 at infinity, by
    /// Barnes and Hut's method if there are many particles).
    #[getter]
    fn potential_energy(&self, py: Python<'_>) -> PyResult<f64> {
        self.long(py, |state| state.world.potential_energy())
    }

    /// Simulated time in seconds.
    #[getter]
    fn time(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.state(py)?.world.time())
    }

    /// Milliseconds of each stage of the last step: a dict of "bounds", "build", "pairs",
    /// "contacts", "resting", "events", "correction" and "store", and "forces" if there are forces.
    #[getter]
    fn profile<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (times, forces) = {
            let state = self.state(py)?;
            (state.profile, !state.world.forces().is_empty())
        };
        let profile = PyDict::new(py);
        for ((stage, name), time) in Stage::ALL.into_iter().zip(times) {
            if stage != Stage::Forces || forces {
                profile.set_item(name, time.as_secs_f64() * 1e3)?;
            }
        }
        Ok(profile)
    }

    /// The last step in numbers: a `WorldStats` of `nodes`, `leaves` and `depth` of the tree,
    /// `tests`, the number of pairs that were tested, and `unresolved`, the number of particles
    /// that had too many collisions and stood still for the rest of the step.
    #[getter]
    fn stats<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let stats = self.state(py)?.world.stats();
        results::world_stats(py, stats)
    }

    /// Return a 64-bit hash of all particles.
    ///
    /// Returns
    /// -------
    /// int
    ///     The same for the same particles, on every machine.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> worlds = [jostle.World([(0, 0)], [(1, 0)], radii=1.0) for _ in range(2)]
    /// >>> worlds[0].state_hash() == worlds[1].state_hash()
    /// True
    fn state_hash(&self, py: Python<'_>) -> PyResult<u64> {
        self.long(py, |state| state.world.state_hash())
    }

    /// Return the whole state of the world in bytes.
    ///
    /// Returns
    /// -------
    /// bytes
    ///     Particles, settings, forces, the time, and the resting contacts, the same bytes on
    ///     every machine. A world that `restore` makes from them continues with the same bits.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0)], [(1, 0)], radii=1.0)
    /// >>> before = world.snapshot()
    /// >>> world.step(0.5, steps=4)
    /// >>> world.time, jostle.World.restore(before).time
    /// (2.0, 0.0)
    fn snapshot<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = self.long(py, |state| state.world.snapshot())?;
        PyBytes::new_with(py, bytes.len(), |to| {
            py.detach(|| to.copy_from_slice(&bytes));
            Ok(())
        })
    }

    /// Make a world from the bytes of `snapshot`.
    ///
    /// Parameters
    /// ----------
    /// data : bytes, bytearray or memoryview
    ///
    /// Returns
    /// -------
    /// World
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If `data` is not bytes.
    /// ValueError
    ///     If they are not from `snapshot`, or are truncated or damaged.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.scenes.create("gas", n=100)
    /// >>> copy = jostle.World.restore(world.snapshot())
    /// >>> world.step(0.01, steps=50); copy.step(0.01, steps=50)
    /// >>> copy.state_hash() == world.state_hash()
    /// True
    #[classmethod]
    fn restore(_class: &Bound<'_, PyType>, data: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = data.py();
        let bytes = if let Ok(bytes) = data.cast::<PyBytes>() {
            bytes.clone()
        } else if data.is_instance_of::<PyByteArray>() || data.is_instance_of::<PyMemoryView>() {
            py.get_type::<PyBytes>().call1((data,))?.cast_into()?
        } else {
            return Err(type_error("data", "bytes", data));
        };
        let bytes = bytes.as_bytes();
        Ok(Self::of(py.detach(|| World::restore(bytes)).map_err(refused)?))
    }

    /// Write the world into a file.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     An existing file is replaced when the new one is complete; it keeps its
    ///     permissions. If the path is a symbolic link, its target is replaced.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     If the file cannot be written; then an existing one is unchanged.
    ///
    /// Examples
    /// --------
    /// >>> import jostle, os, tempfile
    /// >>> path = os.path.join(tempfile.mkdtemp(), "gas.jostle")
    /// >>> jostle.scenes.create("gas", n=100).save(path)
    /// >>> len(jostle.World.load(path))
    /// 100
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let bytes = self.long(py, |state| state.world.snapshot())?;
        files::replace(py, &path, &bytes)
    }

    /// Read a world from a file that `save` has written.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///
    /// Returns
    /// -------
    /// World
    ///
    /// Raises
    /// ------
    /// OSError
    ///     If the file cannot be read.
    /// ValueError
    ///     If it does not contain a world, or is truncated or damaged; the message names the
    ///     file.
    ///
    /// Examples
    /// --------
    /// >>> import jostle, os, tempfile
    /// >>> path = os.path.join(tempfile.mkdtemp(), "pile.jostle")
    /// >>> jostle.scenes.create("pile", n=50).save(path)
    /// >>> jostle.World.load(path)
    /// <jostle.World of 50 particles after 0.000 s>
    #[classmethod]
    fn load(class: &Bound<'_, PyType>, path: PathBuf) -> PyResult<Self> {
        let py = class.py();
        let bytes = files::read(py, &path)?;
        let world = py.detach(|| World::restore(&bytes));
        Ok(Self::of(world.map_err(|error| in_file(&path, &error))?))
    }

    /// Copies and pickles use snapshots.
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        Ok((py.get_type::<Self>().getattr("restore")?, (self.snapshot(py)?,)))
    }

    fn __contains__(&self, py: Python<'_>, id: &Bound<'_, PyAny>) -> PyResult<bool> {
        let id = one_id(id, "np.isin(ids, world.ids) tests many")?;
        id.map_or(Ok(false), |id| Ok(self.state(py)?.world.contains(id)))
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

    /// Does some of the steps, and returns how many are left.
    fn step_some(&self, py: Python<'_>, dt: f64, left: usize) -> PyResult<usize> {
        let left = detached(py, || PyResult::Ok(self.state.lock()?.step(dt, left)))??;
        py.check_signals()?;
        left.map_err(refused)
    }

    fn len(&self, py: Python<'_>) -> PyResult<usize> {
        Ok(self.state(py)?.world.len())
    }

    fn rules(&self, py: Python<'_>) -> PyResult<WorldSettings> {
        Ok(*self.state(py)?.world.settings())
    }

    fn all_walls(&self, py: Python<'_>) -> PyResult<Vec<Wall>> {
        self.long(py, |state| state.world.walls().to_vec())
    }

    fn filter_bits<'py>(
        &self,
        py: Python<'py>,
        bits: fn(Filter) -> u32,
    ) -> PyResult<Bound<'py, PyArray1<u32>>> {
        let filters = self.long(py, |state| state.world.filters())?;
        Ok(read_only(column(py, filters.into_iter().map(bits).collect())))
    }

    fn change_walls(&self, py: Python<'_>, walls: Vec<Wall>) -> PyResult<()> {
        self.long(py, |state| state.world.set_walls(walls))?.map_err(refused)
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

    /// Replaces whole columns; `read` makes them for the number of particles.
    fn write_all(
        &self,
        py: Python<'_>,
        read: impl FnOnce(usize) -> PyResult<Draft>,
    ) -> PyResult<()> {
        let len = self.len(py)?;
        let draft = read(len)?;
        self.long(py, |state| state.write_all(draft, len))?.map_err(refused)
    }
}

impl State {
    /// Begins a call of `step`.
    fn begin(&mut self, dt: f64) -> jostle::Result<()> {
        self.world.step(dt, 0, &mut |_| ())?;
        self.world.forget_renumbering();
        self.world.begin_record();
        Ok(())
    }

    /// Does some of the steps, and returns how many are left. If one is refused, those before are
    /// done.
    fn step(&mut self, dt: f64, left: usize) -> jostle::Result<usize> {
        let left = self.step_for_a_while(dt, left);
        self.world.end_record()?;
        left
    }

    fn step_for_a_while(&mut self, dt: f64, mut left: usize) -> jostle::Result<usize> {
        let start = Instant::now();
        while left > 0 {
            let mut profile = <[Duration; Stage::ALL.len()]>::default();
            let mut since = Instant::now();
            let watch = &mut |stage: Stage| {
                let now = Instant::now();
                profile[stage as usize] += now - since;
                since = now;
            };
            self.world.step(dt, 1, watch)?;
            self.profile = profile;
            left -= 1;
            if start.elapsed() >= LOOK_UP {
                break;
            }
        }
        if left == 0 {
            self.world.clear_accelerations();
        }
        Ok(left)
    }

    fn write_all(&mut self, draft: Draft, found: usize) -> jostle::Result<()> {
        draft.check()?;
        let expected = self.world.len();
        if found != expected {
            // Another thread has added or removed particles in the meantime.
            return Err(Error::Length { argument: "the new column", found, expected });
        }
        let defaults = draft.defaults(self.world.defaults());
        self.world.edit(|particles| {
            draft.write(particles);
            Ok(())
        })?;
        self.world.set_defaults(defaults)
    }

    fn add(&mut self, draft: Draft, len: usize) -> jostle::Result<Range<Id>> {
        let particles = draft.particles(len, &self.world.defaults())?;
        self.world.add(particles)
    }

    fn write_some(&mut self, draft: Draft, ids: &[Id]) -> jostle::Result<()> {
        draft.check()?;
        let rows = self.world.distinct_rows_of(ids)?;
        self.world.edit_rows(&rows, |particles| {
            draft.write(particles);
            Ok(())
        })
    }
}

/// One pair for each id, or a single pair for one id.
fn vectors_of(
    ids: &Ids,
    name: &'static str,
    value: Option<&Bound<'_, PyAny>>,
) -> PyResult<Option<Vec<[f32; 2]>>> {
    if !ids.single {
        return vectors(name, value, ids.all.len());
    }
    value.map(|value| only_vector(name, value, "id")).transpose()
}

/// An error about a file of a world.
fn in_file(path: &Path, error: &Error) -> PyErr {
    let found = match error {
        Error::Value { value, rule, .. } => format!("{value}; {rule}"),
        other => other.to_string(),
    };
    PyValueError::new_err(format!("{} holds {found}", path.display()))
}
