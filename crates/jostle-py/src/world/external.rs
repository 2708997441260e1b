//! Forces and accelerations that the caller gives.

use jostle_base::memory;
use numpy::PyArray2;
use pyo3::prelude::*;

use super::PyWorld;
use super::edits::vectors_of;
use crate::arrays::{read_only, table};
use crate::error::refused;
use crate::ids::Ids;
use crate::particles::vectors;

#[pymethods]
impl PyWorld {
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
    /// IdError
    ///     If an id does not exist; then nothing is changed.
    /// TypeError, ValueError
    ///     If a shape is wrong, or a number is not finite or too large; then nothing is changed.
    ///
    /// See Also
    /// --------
    /// World.accelerations : Those of all particles.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (5, 0)], 1.0, masses=2.0)
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
    /// >>> world = jostle.World([(0, 1)], 0.1)
    /// >>> for _ in range(157):  # half a period: π / 0.02 steps
    /// ...     world.accelerations = -world.positions * (0, 1)
    /// ...     world.step(0.02)
    /// >>> world.positions.round(1).tolist()
    /// [[0.0, -1.0]]
    #[getter]
    fn accelerations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let external = self.long(py, |state| {
            let mut external = memory::with_capacity(state.world.len())?;
            external.extend_from_slice(state.world.external_accelerations());
            external.resize(state.world.len(), [0.0; 2]);
            Ok(external)
        })?;
        Ok(read_only(table(py, external.map_err(refused)?)?))
    }

    #[setter]
    fn set_accelerations(&self, py: Python<'_>, value: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let len = self.state(py)?.world.len();
        let external = match vectors("accelerations", value, len)? {
            Some(external) => external,
            None => memory::filled(len, [0.0; 2]).map_err(refused)?,
        };
        self.long(py, |state| state.world.set_accelerations(external))?.map_err(refused)
    }
}
