//! Forces, impulses and accelerations that the caller gives.

use jostle_base::memory;
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::PyWorld;
use super::edits::vectors_of;
use crate::arrays::{Given, read_only, table};
use crate::error::refused;
use crate::ids::Ids;
use crate::keywords::read;
use crate::particles::one_or_vectors;

#[pymethods]
impl PyWorld {
    /// Add given forces on some particles, for the next call of `step`.
    ///
    /// They act during all steps of that call, beside gravity and `forces`, and end with it. Forces on
    /// the same particle add up. They are kept by snapshots and files. A force F at a point also has
    /// the torque r × F, where r is the offset of the point from the centre now, so the angular
    /// acceleration is r × F/I with the moment of inertia I = m r²/2. Force and torque stay the same
    /// while the particle moves and turns. If particles merge, their forces and torques add up.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,)
    ///     The particles; one may be given more than once. Immovable ones, also those that move with a
    ///     velocity of their own, are neither accelerated nor turned.
    /// forces : array_like, shape (k, 2), or (2,) for one id or as one for all
    ///     In units of mass times length per second². A force wakes the particle.
    /// points : array_like, shape (k, 2), or (2,) for one id or as one for all, optional
    ///     Where each acts, in units of length, the centres if omitted; on a periodic plane the nearest
    ///     image. It need not be inside the disc. Particles of radius 0 do not begin to rotate.
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
    /// apply_impulse : Impulses, which act at once.
    /// net_forces : The sum of all forces, these included.
    /// accelerations : Those of all particles.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (5, 0)], 1.0, masses=2.0)
    /// >>> world.apply_force(1, (0, 6))
    /// >>> world.step(0.5, steps=2)
    /// >>> world.velocities.tolist()
    /// [[0.0, 0.0], [0.0, 3.0]]
    ///
    /// Two opposite forces at the ends of a diameter only turn the disc:
    ///
    /// >>> world.apply_force([0, 0], [(0, 1), (0, -1)], points=[(1, 0), (-1, 0)])
    /// >>> world.step(0.5, steps=2)
    /// >>> world.velocities[0].tolist(), world.angular_velocities[0].item()
    /// ([0.0, 0.0], 2.0)
    #[pyo3(signature = (ids=Given::NOTHING, forces=Given::NOTHING, points=None, **unknown), text_signature = "($self, ids, forces, points=None)")]
    fn apply_force(
        &self,
        py: Python<'_>,
        ids: Given<'_>,
        forces: Given<'_>,
        points: Option<&Bound<'_, PyAny>>,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        let [ids, forces] =
            read::<Self, 2>("apply_force", unknown, [("ids", &ids), ("forces", &forces)])?;
        let ids = Ids::read(ids, "particle")?;
        let forces = vectors_of(&ids, "forces", Some(forces))?.unwrap_or_default();
        let points = vectors_of(&ids, "points", points)?;
        ids.result_of(
            self.long(py, |state| state.world.add_forces(&ids.all, &forces, points.as_deref()))?,
        )
    }

    /// Give impulses to some particles, at once.
    ///
    /// An impulse P changes the velocity by P/m, and, if it acts at a point, the angular velocity by
    /// r × P/I, where r is the offset of the point from the centre and I = m r²/2 the moment of
    /// inertia. Impulses on the same particle add up, and their sum is rounded once.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,)
    ///     The particles; one may be given more than once. Immovable ones do not change.
    /// impulses : array_like, shape (k, 2), or (2,) for one id or as one for all
    ///     In units of mass times length per second. An impulse wakes the particle.
    /// points : array_like, shape (k, 2), or (2,) for one id or as one for all, optional
    ///     Where each acts, in units of length, the centres if omitted; on a periodic plane the nearest
    ///     image. It need not be inside the disc. Particles of radius 0 do not begin to rotate.
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
    /// apply_force : Forces during the next call of `step`.
    /// momentum : Their sum is added to it.
    ///
    /// Examples
    /// --------
    /// A disc is hit at its right end, from below:
    ///
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (5, 0)], 1.0, masses=2.0)
    /// >>> world.apply_impulse(1, (0, 6), points=(6, 0))
    /// >>> world.velocities.tolist(), world.angular_velocities.tolist()
    /// ([[0.0, 0.0], [0.0, 3.0]], [0.0, 6.0])
    #[pyo3(signature = (ids=Given::NOTHING, impulses=Given::NOTHING, points=None, **unknown), text_signature = "($self, ids, impulses, points=None)")]
    fn apply_impulse(
        &self,
        py: Python<'_>,
        ids: Given<'_>,
        impulses: Given<'_>,
        points: Option<&Bound<'_, PyAny>>,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        let [ids, impulses] =
            read::<Self, 2>("apply_impulse", unknown, [("ids", &ids), ("impulses", &impulses)])?;
        let ids = Ids::read(ids, "particle")?;
        let impulses = vectors_of(&ids, "impulses", Some(impulses))?.unwrap_or_default();
        let points = vectors_of(&ids, "points", points)?;
        ids.result_of(
            self.long(py, |state| {
                state.world.apply_impulses(&ids.all, &impulses, points.as_deref())
            })?,
        )
    }

    /// Given accelerations in the next call of `step`: ndarray of float32, shape
    /// (n, 2), a read-only copy in units of length per second².
    ///
    /// Assign an array of this shape, or one vector for all, before each call, or None for none. It
    /// replaces what `apply_force` has given before, torques included; `apply_force` adds to it. They
    /// act during all steps of the call, beside gravity and `forces`, and are 0 after it. Immovable
    /// particles are not accelerated. The others wake if theirs is not 0, and do not fall asleep in the
    /// call.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the shape is wrong, or a number is not finite or too large.
    ///
    /// See Also
    /// --------
    /// apply_force : Forces on some particles.
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
            external.extend(state.world.external_accelerations());
            external.resize(state.world.len(), [0.0; 2]);
            Ok(external)
        })?;
        Ok(read_only(table(py, external.map_err(refused)?)?))
    }

    #[setter]
    fn set_accelerations(&self, py: Python<'_>, value: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let len = self.state(py)?.world.len();
        let external = match one_or_vectors("accelerations", value, len)? {
            Some(external) => external,
            None => memory::filled(len, [0.0; 2]).map_err(refused)?,
        };
        self.long(py, |state| state.world.set_accelerations(external))?.map_err(refused)
    }
}
