//! Settings and forces as properties.

use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::PyWorld;
use crate::arrays::{Given, decimal, number, point};
use crate::error::refused;
use crate::forces::{self, Forces};
use crate::settings;

#[pymethods]
impl PyWorld {
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

    /// The forces: a tuple of `Attractor`, `Gravitation`, `Springs`, `PairForce`, `Flocking`,
    /// `Thermostat`, `ThermalWalls`,
    /// `AndersenThermostat` and `Motor`. Assign any sequence of them. They refer to particles by
    /// id. If a particle is removed, its attractors and springs are removed too, and motors drive
    /// the others. If particles merge, forces refer to the merged particle, and a spring between
    /// two of them is removed.
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let (forces, kinds) = self.long(py, |state| (state.world.forces(), state.world.kinds()))?;
        forces::show(py, forces, &kinds)
    }

    #[setter]
    fn set_forces(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let forces = Forces::read(value)?;
        self.long(py, |state| forces.assign(&mut state.world))?.map_err(refused)
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
    /// for the latter. With None, a step in which heavy particles press on light ones has more; see
    /// `stats.substeps`.
    ///
    /// See Also
    /// --------
    /// stats : Sub-steps of the last step, among others.
    /// step : Advances the simulation.
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
}
