//! Steps, and what a world says about the last one in numbers.

use std::time::{Duration, Instant};

use jostle_world::Stage;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::{PyWorld, State};
use crate::arrays::{Given, count, number};
use crate::error::refused;
use crate::interrupt::detached;
use crate::keywords::read;
use crate::results;

/// Interval at which a call of `step` runs signal handlers and lets other threads use the world,
/// between two steps.
const LOOK_UP: Duration = Duration::from_millis(50);

#[pymethods]
impl PyWorld {
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
    ///     If `dt` is not finite and above 0, if too many particles are in one place, if a particle
    ///     would move too far, or if one of its numbers would become infinite or NaN. In the last
    ///     two cases the message names the particle.
    /// KeyboardInterrupt
    ///     After Ctrl-C, within a fraction of a second also during a long step.
    ///
    /// See Also
    /// --------
    /// events : The pairs that began and ceased to touch.
    /// last_step, last_call : What touched in the last step, and sums over the call.
    /// profile : The time of each stage.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0)], 1.0, velocities=[(8, 0)])
    /// >>> world.step(0.25, steps=2)
    /// >>> world.positions
    /// array([[4., 0.]], dtype=float32)
    #[pyo3(signature = (dt=Given::NOTHING, steps=Given::NOTHING, **unknown), text_signature = "($self, dt, steps=1)")]
    fn step(
        &self,
        py: Python<'_>,
        dt: Given<'_>,
        steps: Given<'_>,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        let [dt] = read::<Self, 1>("step", unknown, [("dt", &dt)])?;
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

    /// Simulated time in seconds.
    #[getter]
    fn time(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.state(py)?.world.time())
    }

    /// Milliseconds of each stage of the last step: a dict of "forces", if there are forces,
    /// "bounds", "build", "pairs", "contacts", "resting", "events", "correction" and "store".
    ///
    /// See Also
    /// --------
    /// stats : The work of the last step, in numbers.
    #[getter]
    fn profile<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (times, forces) = {
            let state = self.state(py)?;
            (state.profile, state.world.has_forces())
        };
        let profile = PyDict::new(py);
        for ((stage, name), time) in Stage::ALL.into_iter().zip(times) {
            if stage != Stage::Forces || forces {
                profile.set_item(name, time.as_secs_f64() * 1e3)?;
            }
        }
        Ok(profile)
    }

    /// The size of the tree of the last step: a `Stats` of `nodes`, `leaves`, `depth` and `tests`, the
    /// number of pairs that were tested. All are 0 before the first step, and after `restore` and
    /// `load`.
    ///
    /// See Also
    /// --------
    /// profile : The time of each stage.
    /// last_step : What the last step found.
    #[getter]
    fn stats<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let stats = self.state(py)?.world.stats();
        results::stats(py, stats)
    }
}

impl PyWorld {
    /// Does some of the steps, and returns how many are left.
    fn step_some(&self, py: Python<'_>, dt: f64, left: usize) -> PyResult<usize> {
        let left = detached(py, || PyResult::Ok(self.state.lock()?.step(dt, left)))??;
        py.check_signals()?;
        left.map_err(refused)
    }
}

impl State {
    /// Begins a call of `step`.
    pub(super) fn begin(&mut self, dt: f64) -> jostle_base::Result<()> {
        self.world.step(dt, 0)?;
        self.world.begin_record()
    }

    /// Does some of the steps, and returns how many are left. If one is refused, those before are
    /// done.
    pub(super) fn step(&mut self, dt: f64, left: usize) -> jostle_base::Result<usize> {
        let left = self.step_within_call(dt, left);
        if matches!(left, Ok(0)) {
            self.world.clear_accelerations();
        }
        left
    }

    /// As [`State::step`], but given accelerations act on in the next steps.
    pub(super) fn step_within_call(&mut self, dt: f64, left: usize) -> jostle_base::Result<usize> {
        let left = self.step_for_a_while(dt, left);
        self.world.end_record()?;
        left
    }

    fn step_for_a_while(&mut self, dt: f64, mut left: usize) -> jostle_base::Result<usize> {
        let start = Instant::now();
        while left > 0 {
            let mut profile = <[Duration; Stage::ALL.len()]>::default();
            let mut since = Instant::now();
            let watch = &mut |stage: Stage, _: &jostle_world::World| {
                let now = Instant::now();
                profile[stage as usize] += now - since;
                since = now;
            };
            self.world.step_watched(dt, 1, watch)?;
            self.profile = profile;
            left -= 1;
            if start.elapsed() >= LOOK_UP {
                break;
            }
        }
        Ok(left)
    }
}
