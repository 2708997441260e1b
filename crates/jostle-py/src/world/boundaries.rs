//! The container and the walls as properties.

use jostle_base::memory;
use jostle_world::{Container, Wall};
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::prelude::*;

use super::PyWorld;
use crate::arrays::{column, decimal, read_only};
use crate::containers;
use crate::error::refused;
use crate::walls;

#[pymethods]
impl PyWorld {
    /// The region of the particles: a Box, Circle or None.
    ///
    /// See Also
    /// --------
    /// walls : Line segments.
    /// period : A periodic plane instead.
    ///
    /// Examples
    /// --------
    /// An inelastic floor between walls with the coefficient of the disc:
    ///
    /// >>> import jostle
    /// >>> box = jostle.Box(0, 0, 10, 10, restitution=[None, None, 0, None])
    /// >>> world = jostle.World([(5, 5)], 1.0, velocities=[(3, -9)], container=box)
    /// >>> world.step(0.1, steps=15)
    /// >>> world.velocities
    /// array([[-3.,  0.]], dtype=float32)
    #[getter]
    fn container(&self, py: Python<'_>) -> PyResult<Option<Py<PyAny>>> {
        let rules = self.rules(py)?;
        containers::show(py, rules.container, rules.sides)
    }

    #[setter]
    fn set_container(&self, py: Python<'_>, value: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let (container, sides) = containers::read(value)?;
        if container != Container::None && self.rules(py)?.container.has_period() {
            return Err(containers::both());
        }
        self.change_rules(py, |rules| {
            // None takes a container away, and no period.
            let stays = container == Container::None && rules.container.has_period();
            rules.container = if stays { rules.container } else { container };
            rules.sides = sides;
        })
    }

    /// Width and height of the periodic plane: ndarray of float64, shape (2,), or None.
    ///
    /// A particle that leaves on one side enters on the other; positions are from 0 to the period. A
    /// world has a container or a period.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If there is a container, or a side is not finite and above 0.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(9, 5)], 1.0, velocities=[(3, 0)], period=(10, 10))
    /// >>> world.step(1.0)
    /// >>> world.positions
    /// array([[2., 5.]], dtype=float32)
    #[getter]
    fn period<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        let Container::Torus { size } = self.rules(py)?.container else { return Ok(None) };
        Ok(Some(read_only(column(py, size.map(decimal).to_vec()))))
    }

    #[setter]
    fn set_period(&self, py: Python<'_>, value: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let period = containers::period(value)?;
        let before = self.rules(py)?.container;
        let is_torus = before.has_period() || before == Container::None;
        let container = match period {
            Some(_) if !is_torus => return Err(containers::both()),
            Some(size) => Container::Torus { size },
            None if is_torus => Container::None,
            None => before,
        };
        self.change_rules(py, |rules| rules.container = container)
    }

    /// Walls: ndarray of float32, shape (m, 2, 2), a read-only copy of the ends of line segments in
    /// units of length.
    ///
    /// Assign an array of this shape, or None for no walls. Wall k keeps the velocity and the
    /// coefficients of the previous wall k; additional ones are at rest and have the coefficients of
    /// the particles. All particles wake. Walls that are moved in this way
    /// transfer no momentum, see `wall_velocities`: particles that overlap a wall are pushed out in
    /// several steps, to the side on which their centre is.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the shape is wrong, a coordinate is not finite or above 1e18, the ends of a wall are
    ///     equal, or a wall is longer than a side of the period.
    ///
    /// See Also
    /// --------
    /// jostle.polyline : Walls between consecutive points.
    /// last_step : The walls that particles touched, and more.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World(
    /// ...     [(0, 2)], 1.0, velocities=[(0, -4)],
    /// ...     walls=jostle.polyline([(-3, 0), (0, 0), (3, 0)]),
    /// ... )
    /// >>> world.step(0.5)
    /// >>> world.positions, world.last_step.wall_contacts.walls
    /// (array([[0., 2.]], dtype=float32), array([0]))
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
            // A wall that has not moved keeps its residuals.
            let residuals = if wall.ends == old.ends { old.residuals } else { wall.residuals };
            *wall = Wall { ends: wall.ends, residuals, ..old };
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
    /// >>> world = jostle.World([(4, 0)], 1.0, walls=piston, wall_velocities=(2, 0))
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
    /// NaN stands for the coefficient of the particle. Assign an array or one number, 0 to 1, or None for
    /// NaN.
    #[getter]
    fn wall_restitution<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        Ok(walls::restitution(py, &self.all_walls(py)?))
    }

    #[setter]
    fn set_wall_restitution(
        &self,
        py: Python<'_>,
        value: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let mut all = self.all_walls(py)?;
        walls::set_restitution(&mut all, value)?;
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
