//! Sums and the hash of the state.

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::PyWorld;
use crate::arrays::{Given, column, point, table};
use crate::error::refused;
use crate::interrupt::detached;
use crate::keywords::refuse_unknown;

#[pymethods]
impl PyWorld {
    /// Return the sum of mass times velocity of the movable particles.
    ///
    /// Returns
    /// -------
    /// ndarray of float64, shape (2,)
    ///     In units of mass times length per second.
    ///
    /// See Also
    /// --------
    /// angular_momentum : Of the motion around a point.
    fn momentum<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(column(py, self.long(py, |state| state.world.momentum())?.to_vec()))
    }

    /// Return the sum of m (r - a) × v + I ω of the movable particles, with the moment of inertia
    /// I = m r²/2.
    ///
    /// Parameters
    /// ----------
    /// about : array_like, shape (2,), default (0.0, 0.0)
    ///     The point a.
    ///
    /// Returns
    /// -------
    /// float
    ///     Positive for a rotation from +x to +y.
    ///
    /// See Also
    /// --------
    /// momentum : Of the motion along the axes.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(3, 0)], 1.0, velocities=[(0, 2)], angular_velocities=4.0)
    /// >>> world.angular_momentum(), world.angular_momentum(about=(3, 0))
    /// (8.0, 2.0)
    #[pyo3(signature = (about=Given::NOTHING, **unknown), text_signature = "($self, about=(0.0, 0.0))")]
    fn angular_momentum(
        &self,
        py: Python<'_>,
        about: Given<'_>,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<f64> {
        refuse_unknown::<Self>("angular_momentum", unknown)?;
        let about = about.value().map_or(Ok([0.0; 2]), |at| point("about", at))?;
        self.long(py, |state| state.world.angular_momentum(about.map(f64::from)))
    }

    /// Return the temperature of the movable particles with k = 1: the sum of m (v - u)² over 2 (n - 1),
    /// where u is their mean velocity, weighted by mass.
    ///
    /// Rotation is left out. In two dimensions a gas that is at rest as a whole has n - 1 times this
    /// energy of translation.
    ///
    /// Returns
    /// -------
    /// float
    ///     In units of mass times length squared per second squared; NaN for fewer than two
    ///     particles.
    ///
    /// See Also
    /// --------
    /// kinetic_energy : With rotation and the motion as a whole.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (9, 0)], 1.0, velocities=[(5, 0), (7, 0)])
    /// >>> world.temperature()
    /// 1.0
    fn temperature(&self, py: Python<'_>) -> PyResult<f64> {
        self.long(py, |state| state.world.temperature())
    }

    /// Return the sum of ½ m v² + ½ I ω² of the movable particles, with the moment of inertia
    /// I = m r²/2.
    ///
    /// See Also
    /// --------
    /// potential_energy : The energy of gravity and forces.
    /// total_energy : Both.
    fn kinetic_energy(&self, py: Python<'_>) -> PyResult<f64> {
        self.long(py, |state| state.world.kinetic_energy())
    }

    /// Return the energy of all movable particles in the fields of gravity (0 at the origin) and of
    /// attractors (harmonic: 0 at the point, inverse square: 0 at infinity), of unbroken
    /// springs (½ stiffness times stretch squared), of gravitation (0 at infinity, by
    /// Barnes and Hut's method if there are many particles), and of each `PairForce` whose forces
    /// are equal and opposite (0 at its cutoff).
    ///
    /// See Also
    /// --------
    /// kinetic_energy : The energy of motion.
    /// total_energy : Both.
    fn potential_energy(&self, py: Python<'_>) -> PyResult<f64> {
        // After an interruption the result is not used.
        let energy = detached(py, || self.state.lock().map(|all| all.world.potential_energy()));
        energy??.map_err(refused)
    }

    /// Return the sum of `kinetic_energy` and `potential_energy`.
    fn total_energy(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.kinetic_energy(py)? + self.potential_energy(py)?)
    }

    /// Return the sum of the forces on each particle at the present state, without those of contacts.
    ///
    /// It is m (gravity - drag v), and the forces of `forces` that accelerate particles: `Attractor`,
    /// `Gravitation`, `PairForce`, `Flocking`, `Grab` and `Springs`, with their damping; and what is
    /// given for the next call of `step`. Contacts, walls and sides are left out: `last_step` has their
    /// impulses. So are the speed limits of `Flocking`, and thermostats.
    ///
    /// Returns
    /// -------
    /// ndarray of float64, shape (n, 2)
    ///     In units of mass times length per second squared, in the order of `ids`; 0 for immovable
    ///     particles.
    ///
    /// See Also
    /// --------
    /// force_virial : The sum of offset times force over all pairs.
    /// potential_energy : Its negative gradient is the part of the forces that has a potential.
    ///
    /// Notes
    /// -----
    /// Positions are those of float32. Accelerations are computed in float32, as in a step, for all
    /// particles, so the cost is about that of the forces in a sub-step.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> spring = jostle.Springs([(0, 1)], lengths=1.0, stiffness=10.0)
    /// >>> world = jostle.World(
    /// ...     [(0, 0), (3, 0)], 0.1, masses=2.0, gravity=(0, -1), forces=[spring]
    /// ... )
    /// >>> world.net_forces()
    /// array([[ 20.,  -2.],
    ///        [-20.,  -2.]])
    fn net_forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        // After an interruption the result is not used.
        let forces = detached(py, || self.state.lock().map(|all| all.world.net_forces()));
        table(py, forces??.map_err(refused)?)
    }

    /// Return the virial of the forces between pairs at the present state: the sum of offset times
    /// force over all pairs, as `collision_virial` of `last_call` is that of offset times impulse.
    ///
    /// The offset is from one particle of the pair to the nearest image of the other, the force is that
    /// on the other: repulsion is positive. The forces are those of `PairForce`, `Gravitation` and
    /// `Springs`, with their damping. If those of a `PairForce` are not equal and opposite, a pair has
    /// the mean of both. Gravity, `Attractor` and `Flocking` do not act between pairs and are left
    /// out.
    ///
    /// Returns
    /// -------
    /// ndarray of float64, shape (2, 2)
    ///     In units of energy. The first index is the axis of the offset, the second that of the force.
    ///
    /// See Also
    /// --------
    /// net_forces : The forces on each particle.
    /// last_call : The virial of collisions, summed over all steps of a call.
    ///
    /// Notes
    /// -----
    /// The pressure on an area A is (n T + ½ tr W) / A, where T is the temperature and W the mean of the
    /// virial. The mean of collisions is `collision_virial` over `duration`.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> spring = jostle.Springs([(0, 1)], lengths=1.0, stiffness=10.0)
    /// >>> jostle.World([(0, 0), (3, 0)], 0.1, forces=[spring]).force_virial()
    /// array([[-60.,   0.],
    ///        [  0.,   0.]])
    fn force_virial<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let virial = detached(py, || self.state.lock().map(|all| all.world.force_virial()));
        table(py, virial??.map_err(refused)?.to_vec())
    }

    /// Return a 64-bit hash of all particles.
    ///
    /// Returns
    /// -------
    /// int
    ///     The same for the same particles, on every machine.
    ///
    /// See Also
    /// --------
    /// snapshot : The whole state.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> worlds = [jostle.World([(0, 0)], 1.0, velocities=[(1, 0)]) for _ in range(2)]
    /// >>> worlds[0].state_hash() == worlds[1].state_hash()
    /// True
    fn state_hash(&self, py: Python<'_>) -> PyResult<u64> {
        self.long(py, |state| state.world.state_hash())?.map_err(refused)
    }
}
