//! The container and the walls as properties.

use jostle_base::memory;
use jostle_world::Wall;
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::prelude::*;

use super::PyWorld;
use crate::arrays::{Given, column, read_only};
use crate::containers;
use crate::error::refused;
use crate::settings;
use crate::walls;

#[pymethods]
impl PyWorld {
    /// The region of the particles: a Box, Circle, Torus or None.
    ///
    /// See Also
    /// --------
    /// walls : Line segments.
    /// container_restitution : The coefficients of its sides.
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
    ///     equal, or a wall is longer than a side of a `Torus`.
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
}

impl PyWorld {
    fn all_walls(&self, py: Python<'_>) -> PyResult<Vec<Wall>> {
        self.long(py, |state| memory::copy(state.world.walls()))?.map_err(refused)
    }

    fn change_walls(&self, py: Python<'_>, walls: Vec<Wall>) -> PyResult<()> {
        self.long(py, |state| state.world.set_walls(walls))?.map_err(refused)
    }
}
