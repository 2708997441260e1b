//! The records of the last step and of the last call of `step`: contacts, sums and events.

use jostle_world::TouchEvents;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use super::{PyWorld, State};
use crate::error::refused;
use crate::results;

#[pymethods]
impl PyWorld {
    /// What the last step found: a `LastStep` of `contacts`, the pairs that touched, a
    /// `WorldContacts`; `wall_contacts`, the particles to which walls or the container gave an impulse,
    /// a `WallContacts`; and the numbers `substeps`, `unresolved` and `collapsed`.
    ///
    /// The contacts are listed when it is read. Those of sleeping particles are those of the last step
    /// in which they were awake. If `on_touch` is not "bounce", the pairs are those that overlap now,
    /// without impulses. The numbers are 0 before the first step, and after `restore` and `load`.
    /// Impulses are those of one step: divided by its length they are mean forces. A sum over many
    /// steps is in `last_call`.
    ///
    /// See Also
    /// --------
    /// last_call : Sums over all steps of the last call of `step`.
    /// events : The pairs that began and ceased to touch.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> box = jostle.Box(-9, 0, 9, 9)
    /// >>> world = jostle.World([(0, 1)], 1.0, gravity=(0, -10), restitution=0.5, container=box)
    /// >>> world.step(0.01)
    /// >>> on_floor = world.last_step.wall_contacts
    /// >>> on_floor.walls, (on_floor.normal_impulses / 0.01).round(2)
    /// (array([-4]), array([10.], dtype=float32))
    #[getter]
    fn last_step<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let found = self.long(py, |state| {
            let State { world, .. } = state;
            Ok((world.contacts()?, world.wall_contacts()?, world.stats()))
        })?;
        let (pairs, walls, stats) = found.map_err(refused)?;
        results::last_step(py, pairs, walls, stats)
    }

    /// Sums over the last call of `step`, with all its steps: a `LastCall` of `duration`, `steps`,
    /// `collisions`, `wall_collisions`, `collision_virial`, `wall_impulses` and `side_impulses`.
    ///
    /// Particles that sleep add nothing; ``World(..., sleeping=False)`` keeps all awake.
    ///
    /// See Also
    /// --------
    /// last_step : What touched in the last step.
    ///
    /// Examples
    /// --------
    /// The pressure of a gas in a box, from the impulses of its four sides:
    ///
    /// >>> import jostle, numpy as np
    /// >>> box, rng = jostle.Box(0, 0, 100, 100), np.random.default_rng(1)
    /// >>> at = rng.uniform(5, 95, (400, 2))
    /// >>> gas = jostle.World(at, 0.1, masses=1.0, velocities=rng.normal(size=(400, 2)), container=box)
    /// >>> gas.step(0.1, steps=5000)
    /// >>> call = gas.last_call
    /// >>> pressure = call.side_impulses[:, 0].sum() / (call.duration * 400)
    /// >>> round(float(pressure * box.area / (len(gas) * gas.temperature())), 1)  # that of an ideal gas
    /// 1.0
    #[getter]
    fn last_call<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let state = self.state(py)?;
        let totals = state.world.record().totals().clone();
        results::last_call(py, totals, state.world.walls().len())
    }

    /// The pairs that began and ceased to touch in the last call of `step`: a `WorldEvents` of
    /// `entered`, `stayed` and `exited`, each an ndarray of int64, shape (m, 2), of ids ``i < j``,
    /// sorted. They need ``World(..., track_events=True)`` or ``world.track_events = True``.
    ///
    /// All steps and sub-steps of the call count: a pair that began and ceased to touch is in
    /// `entered` and in `exited`. A pair in `entered` did not touch at the end of the call before,
    /// and a pair in `exited` does not touch at the end of this one, also because a particle was
    /// removed or merged. In the first call all pairs that touch have entered. So a pair
    /// that has entered does not enter again before it has exited.
    ///
    /// Particles touch if they collide, if the gap between them is at most the rounding of float32,
    /// or if a resting contact presses them together. Particles that pass through each other,
    /// sensors among them, touch if they overlap at any time of the call. Two immovable
    /// particles touch only if exactly one of them is a sensor.
    ///
    /// Raises
    /// ------
    /// RuntimeError
    ///     If `track_events` is False.
    ///
    /// See Also
    /// --------
    /// wall_events : The same of particles and walls.
    /// last_step : The pairs of the last step, with impulses.
    /// last_call : The number of collisions.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World(
    /// ...     [(0, 0), (3, 0), (8, 0)], 1.0, velocities=[(1, 0), (0, 0), (0, 0)],
    /// ...     track_events=True,
    /// ... )
    /// >>> world.step(2.0)  # 0 hits 1, which flies on
    /// >>> world.events.entered, world.events.exited
    /// (array([[0, 1]]), array([[0, 1]]))
    /// >>> world.step(2.0)  # 1 touches 2 after 4 seconds
    /// >>> events = world.events
    /// >>> events.entered, len(events.stayed), len(events.exited)
    /// (array([[1, 2]]), 0, 0)
    #[getter]
    fn events<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let [pairs, _] = self.all_events(py)?;
        results::events(py, "WorldEvents", pairs)
    }

    /// The particles and walls that began and ceased to touch in the last call of `step`: a `WallEvents` of
    /// `entered`, `stayed` and `exited`, each an ndarray of int64, shape (m, 2), of the id of a particle and that
    /// of a wall, or the `Side` of a container, sorted. They need ``track_events=True``, as `events` do.
    ///
    /// The steps and sub-steps of the call count as for `events`. A particle touches a wall that is a sensor if
    /// they overlap at any time of the call, also on its way through within one step: then the pair is in
    /// `entered` and in `exited`. It touches any other wall, or a side, if it gets an impulse from it, or if the
    /// gap at the end of the call is at most the rounding of float32. Walls that were removed touch nothing.
    ///
    /// Raises
    /// ------
    /// RuntimeError
    ///     If `track_events` is False.
    ///
    /// See Also
    /// --------
    /// events : The same of two particles.
    /// last_step : The walls of the last step, with impulses.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (0, 2)], 0.5, velocities=[(9, 0), (0, 0)], track_events=True)
    /// >>> goal = world.walls.add(((4, -1), (4, 1)), sensors=True)
    /// >>> world.step(1.0)  # the first particle flies through the goal
    /// >>> world.wall_events.entered, world.wall_events.exited
    /// (array([[0, 0]]), array([[0, 0]]))
    #[getter]
    fn wall_events<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let [_, walls] = self.all_events(py)?;
        results::events(py, "WallEvents", walls)
    }
}

impl PyWorld {
    /// The events of pairs of particles, and of particles and walls.
    fn all_events(&self, py: Python<'_>) -> PyResult<[TouchEvents; 2]> {
        let events = self.long(py, |state| state.world.events())?.map_err(refused)?;
        let rule = "events are not tracked; set world.track_events = True before the step, or make \
                    the world with track_events=True";
        events.ok_or_else(|| PyRuntimeError::new_err(rule))
    }
}
