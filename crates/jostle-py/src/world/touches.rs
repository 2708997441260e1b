//! What touched: contacts, events and collisions.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use super::PyWorld;
use crate::error::refused;
use crate::results;

#[pymethods]
impl PyWorld {
    /// The pairs that touched during the last step, a `WorldContacts`; if `on_touch` is not
    /// "bounce", the pairs that overlap now, without impulses.
    ///
    /// It has `pairs` (m, 2) of ids, ``i < j``, unit `normals` (m, 2) from i to j, and `depths` (m,),
    /// the penetration at the end of the step, negative for pairs that had separated. The sums of
    /// the impulses of the step are `normal_impulses` and `friction_impulses` (m,).
    ///
    /// See Also
    /// --------
    /// wall_contacts : The contacts with walls.
    /// events : The pairs that began and ceased to touch.
    /// Quadtree.contacts : The overlaps of shapes.
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
    /// Wall k of `walls` has the number k; the sides of the container have those of `Side`, which are
    /// negative.
    ///
    /// See Also
    /// --------
    /// contacts : The pairs of particles.
    /// Side : The sides of the container.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> box = jostle.Box(-9, 0, 9, 9)
    /// >>> world = jostle.World([(0, 1)], 1.0, gravity=(0, -10), restitution=0.5, container=box)
    /// >>> world.step(0.01)
    /// >>> world.wall_contacts.walls, (world.wall_contacts.normal_impulses / 0.01).round(2)
    /// (array([-4]), array([10.], dtype=float32))
    #[getter]
    fn wall_contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        results::wall_contacts(
            py,
            self.long(py, |state| state.world.wall_contacts())?.map_err(refused)?,
        )
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
    /// contacts : The pairs of the last step, with impulses.
    /// collisions : The number of collisions.
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
        let events = self.long(py, |state| state.world.events())?.map_err(refused)?;
        let rule = "events are not tracked; set world.track_events = True before the step, or make \
                    the world with track_events=True";
        results::world_events(py, events.ok_or_else(|| PyRuntimeError::new_err(rule))?)
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
    /// >>> world = jostle.World([(-3, 0), (0, 0)], 1.0, velocities=[(1, 0), (0, 0)], container=box)
    /// >>> world.step(1 / 60, steps=600)  # 10 seconds; a collision each 1, 3, 5, ... seconds
    /// >>> world.collisions
    /// WorldCollisions(pairs=3, walls=2)
    #[getter]
    fn collisions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let collisions = self.state(py)?.world.record().collisions();
        results::world_collisions(py, collisions)
    }
}
