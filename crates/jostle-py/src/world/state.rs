//! Queries, sums and the hash of the state.

use pyo3::prelude::*;

use super::PyWorld;
use crate::error::refused;
use crate::interrupt::detached;
use crate::quadtree::PyQuadtree;

#[pymethods]
impl PyWorld {
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

    /// Sum of mass times velocity, (x, y).
    #[getter]
    fn momentum(&self, py: Python<'_>) -> PyResult<(f64, f64)> {
        Ok(self.long(py, |state| state.world.momentum())?.into())
    }

    /// Sum of ½ m v² + ½ I ω² of the movable particles, with the moment of inertia I = m r²/2.
    ///
    /// See Also
    /// --------
    /// potential_energy : The energy of gravity and forces.
    #[getter]
    fn kinetic_energy(&self, py: Python<'_>) -> PyResult<f64> {
        self.long(py, |state| state.world.kinetic_energy())
    }

    /// Energy of all movable particles in the fields of gravity (0 at the origin) and of
    /// attractors (harmonic: 0 at the point, inverse square: 0 at infinity), of unbroken
    /// springs (½ stiffness times stretch squared), of gravitation (0 at infinity, by
    /// Barnes and Hut's method if there are many particles), and of each `PairForce` whose forces
    /// are equal and opposite (0 at its cutoff).
    ///
    /// See Also
    /// --------
    /// kinetic_energy : The energy of motion.
    #[getter]
    fn potential_energy(&self, py: Python<'_>) -> PyResult<f64> {
        // After an interruption the result is not used.
        let energy = detached(py, || self.state.lock().map(|all| all.world.potential_energy()));
        energy??.map_err(refused)
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
    /// >>> worlds = [jostle.World([(0, 0)], [(1, 0)], radii=1.0) for _ in range(2)]
    /// >>> worlds[0].state_hash() == worlds[1].state_hash()
    /// True
    fn state_hash(&self, py: Python<'_>) -> PyResult<u64> {
        self.long(py, |state| state.world.state_hash())?.map_err(refused)
    }
}
