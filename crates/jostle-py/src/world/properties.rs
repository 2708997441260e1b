//! Settings and forces as properties.

use std::convert::identity;

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::PyWorld;
use crate::arrays::{Given, column, decimal, number, point, read_only};
use crate::error::refused;
use crate::forces;
use crate::settings;

/// Declares properties that are settings: what Python assigns and reads, where it is in the settings, how it is
/// shown, and how it is read.
macro_rules! properties {
    ($(
        $(#[$doc:meta])*
        $name:ident, $set:ident($value:ty): $shown:ty = $($place:ident).+, $show:expr, $read:expr;
    )*) => {
        #[pymethods]
        impl PyWorld {
            $(
                $(#[$doc])*
                #[getter]
                fn $name(&self, py: Python<'_>) -> PyResult<$shown> {
                    let show = $show;
                    Ok(show(self.rules(py)?.$($place).+))
                }

                #[setter]
                fn $set(&self, py: Python<'_>, value: $value) -> PyResult<()> {
                    let read = $read;
                    let new = read(value)?;
                    self.change_rules(py, |rules| rules.$($place).+ = new)
                }
            )*
        }
    };
}

properties! {
    /// Linear damping, per second.
    drag, set_drag(&Bound<'_, PyAny>): f64
        = drag, decimal, |value| real("drag", value);

    /// What happens to particles that touch: "bounce", "merge" or "ignore".
    on_touch, set_on_touch(Given<'_>): &'static str
        = on_touch, settings::on_touch_name, |value| settings::on_touch(&value);

    /// How pairs are found: "quadtree" or "brute".
    method, set_method(Given<'_>): &'static str
        = method, settings::method_name, |value| settings::method(&value);

    /// Number of threads that was set; None for one on each core. A call uses at most one on
    /// each core.
    threads, set_threads(Option<&Bound<'_, PyAny>>): Option<usize>
        = tree.threads, identity, settings::threads;

    /// Particles that a box of the tree may hold before it splits.
    leaf_capacity, set_leaf_capacity(Given<'_>): usize
        = tree.leaf_capacity, identity, |value| settings::leaf_capacity(&value);

    /// Maximum number of subdivisions of the tree.
    max_depth, set_max_depth(Given<'_>): usize
        = tree.max_depth, identity, |value| settings::max_depth(&value);

    /// Whether resting islands may fall asleep, see `asleep`. If it is set to False, all wake.
    sleeping, set_sleeping(Given<'_>): bool
        = sleeping, identity, |value| settings::sleeping(&value);

    /// Whether `events` are tracked. The motion does not depend on it. If it is turned on, no pair
    /// counts as touching before the next step.
    track_events, set_track_events(Given<'_>): bool
        = track_events, identity, |value| settings::track_events(&value);
}

#[pymethods]
impl PyWorld {
    /// The forces: a tuple of `Attractor`, `Gravitation`, `Springs`, `PairForce`, `Flocking`,
    /// `Grab`, `Thermostat`, `ThermalWalls`,
    /// `AndersenThermostat`, `Motor` and `Pump`. Assign any sequence of them. They refer to particles by
    /// id. If a particle is removed, its attractors and springs are removed too, and motors drive
    /// the others. If particles merge, forces refer to the merged particle, and a spring between
    /// two of them is removed.
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        forces::show(py, self.long(py, |state| state.world.forces())?.map_err(refused)?)
    }

    #[setter]
    fn set_forces(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let forces = forces::read(value)?;
        self.long(py, |state| state.world.set_forces(forces))?.map_err(refused)
    }

    /// Acceleration of all movable particles: ndarray of float64, shape (2,), a read-only copy in units
    /// of length per second squared.
    #[getter]
    fn gravity<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(read_only(column(py, self.rules(py)?.gravity.map(decimal).to_vec())))
    }

    #[setter]
    fn set_gravity(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let gravity = point("gravity", value)?;
        self.change_rules(py, |rules| rules.gravity = gravity)
    }

    /// Sub-steps of a step, or None for as many as the scene needs.
    ///
    /// See Also
    /// --------
    /// last_step : Has the number of sub-steps of the last step.
    /// step : Advances the simulation.
    #[getter]
    fn substeps(&self, py: Python<'_>) -> PyResult<Option<usize>> {
        Ok(self.rules(py)?.substeps)
    }

    #[setter]
    fn set_substeps(&self, py: Python<'_>, value: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let substeps = settings::substeps(value)?;
        self.change_rules(py, |rules| rules.substeps = substeps)
    }
}

fn real(name: &str, value: &Bound<'_, PyAny>) -> PyResult<f32> {
    Ok(number(name, value)? as f32)
}
