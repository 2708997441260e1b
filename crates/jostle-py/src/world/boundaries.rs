//! The container and the period as properties.

use jostle_world::Container;
use numpy::PyArray1;
use pyo3::prelude::*;

use super::PyWorld;
use crate::arrays::{column, decimal, read_only};
use crate::containers;

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
        let (container, sides) = containers::read("container", value)?;
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
}
