//! `jostle.Box`, `jostle.Circle` and `jostle.Torus`: the containers of a world.

use jostle_world::Container;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::arrays::{decimal, number, point};
use crate::error::refused;

/// Four walls around a rectangle: a container of a `World`.
///
/// It is not a shape. Rectangles for `find_pairs`, `Quadtree` and `Space` are given by arrays.
///
/// Parameters
/// ----------
/// min_x, min_y, max_x, max_y : float
///     Its sides, in units of length; min below max. Stored as float32.
///
/// Raises
/// ------
/// TypeError
///     If an argument is not a number.
/// ValueError
///     If a side is not finite or min is not below max.
///
/// See Also
/// --------
/// Circle, Torus : Other containers.
/// World.walls : Line segments anywhere.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> jostle.Box(0, 0, 800, 500).max_x
/// 800.0
/// >>> jostle.Box(0, 0, 800, 500) == jostle.Box(0.0, 0.0, 800.0, 500.0)
/// True
#[pyclass(module = "jostle", name = "Box", frozen, eq)]
#[derive(PartialEq)]
pub struct PyBox {
    min: [f32; 2],
    max: [f32; 2],
}

#[pymethods]
impl PyBox {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&str, &str, &str, &str) = ("min_x", "min_y", "max_x", "max_y");

    #[new]
    fn new(
        min_x: &Bound<'_, PyAny>,
        min_y: &Bound<'_, PyAny>,
        max_x: &Bound<'_, PyAny>,
        max_y: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let min = [number("min_x", min_x)? as f32, number("min_y", min_y)? as f32];
        let max = [number("max_x", max_x)? as f32, number("max_y", max_y)? as f32];
        Container::Box { min, max }.validate().map_err(refused)?;
        Ok(Self { min, max })
    }

    /// Left side.
    #[getter]
    fn min_x(&self) -> f64 {
        decimal(self.min[0])
    }

    /// Top side where y grows downwards.
    #[getter]
    fn min_y(&self) -> f64 {
        decimal(self.min[1])
    }

    /// Right side.
    #[getter]
    fn max_x(&self) -> f64 {
        decimal(self.max[0])
    }

    /// Bottom side where y grows downwards.
    #[getter]
    fn max_y(&self) -> f64 {
        decimal(self.max[1])
    }

    fn __getnewargs__(&self) -> (f64, f64, f64, f64) {
        (self.min_x(), self.min_y(), self.max_x(), self.max_y())
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        self.__getnewargs__().into_pyobject(py)?.hash()
    }

    fn __repr__(&self) -> String {
        let (min_x, min_y, max_x, max_y) = self.__getnewargs__();
        format!("Box({min_x:?}, {min_y:?}, {max_x:?}, {max_y:?})")
    }
}

/// A circular wall: a container of a `World`.
///
/// It is not a shape. Circles for `find_pairs`, `Quadtree` and `Space` are given by arrays.
///
/// Parameters
/// ----------
/// center : array_like, shape (2,)
///     Its centre, in units of length. Stored as float32.
/// radius : float
///     Its radius, above 0. Stored as float32.
///
/// Raises
/// ------
/// TypeError
///     If an argument does not hold numbers.
/// ValueError
///     If a number is not finite or the radius not above 0.
///
/// See Also
/// --------
/// Box, Torus : Other containers.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> jostle.Circle((400, 250), radius=240).center
/// (400.0, 250.0)
#[pyclass(module = "jostle", name = "Circle", frozen, eq)]
#[derive(PartialEq)]
pub struct PyCircle {
    center: [f32; 2],
    radius: f32,
}

#[pymethods]
impl PyCircle {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&str, &str) = ("center", "radius");

    #[new]
    fn new(center: &Bound<'_, PyAny>, radius: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (center, radius) = (point("center", center)?, number("radius", radius)? as f32);
        Container::Circle { center, radius }.validate().map_err(refused)?;
        Ok(Self { center, radius })
    }

    /// Its centre, (x, y).
    #[getter]
    fn center(&self) -> (f64, f64) {
        self.center.map(decimal).into()
    }

    /// Its radius.
    #[getter]
    fn radius(&self) -> f64 {
        decimal(self.radius)
    }

    fn __getnewargs__(&self) -> ((f64, f64), f64) {
        (self.center(), self.radius())
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        self.__getnewargs__().into_pyobject(py)?.hash()
    }

    fn __repr__(&self) -> String {
        format!("Circle({:?}, {:?})", self.center(), self.radius())
    }
}

/// A periodic rectangle from (0, 0): a particle that leaves on the right enters on the
/// left.
///
/// Parameters
/// ----------
/// width, height : float
///     Its sides, in units of length, above 0. Stored as float32.
///
/// Raises
/// ------
/// TypeError
///     If an argument is not a number.
/// ValueError
///     If a side is not finite and above 0.
///
/// See Also
/// --------
/// Box, Circle : Containers with walls.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> jostle.Torus(800, 500)
/// Torus(800.0, 500.0)
#[pyclass(module = "jostle", name = "Torus", frozen, eq)]
#[derive(PartialEq)]
pub struct PyTorus {
    size: [f32; 2],
}

#[pymethods]
impl PyTorus {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&str, &str) = ("width", "height");

    #[new]
    fn new(width: &Bound<'_, PyAny>, height: &Bound<'_, PyAny>) -> PyResult<Self> {
        let size = [number("width", width)? as f32, number("height", height)? as f32];
        Container::Torus { size }.validate().map_err(refused)?;
        Ok(Self { size })
    }

    /// From left to right.
    #[getter]
    fn width(&self) -> f64 {
        decimal(self.size[0])
    }

    /// From top to bottom.
    #[getter]
    fn height(&self) -> f64 {
        decimal(self.size[1])
    }

    fn __getnewargs__(&self) -> (f64, f64) {
        (self.width(), self.height())
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        self.__getnewargs__().into_pyobject(py)?.hash()
    }

    fn __repr__(&self) -> String {
        format!("Torus({:?}, {:?})", self.width(), self.height())
    }
}

/// The container of the core for a Python object; None is no container.
pub fn read(value: Option<&Bound<'_, PyAny>>) -> PyResult<Container> {
    let Some(value) = value else { return Ok(Container::None) };
    if let Ok(found) = value.cast::<PyBox>() {
        let &PyBox { min, max } = found.get();
        Ok(Container::Box { min, max })
    } else if let Ok(found) = value.cast::<PyCircle>() {
        let &PyCircle { center, radius } = found.get();
        Ok(Container::Circle { center, radius })
    } else if let Ok(found) = value.cast::<PyTorus>() {
        Ok(Container::Torus { size: found.get().size })
    } else {
        let found = value.get_type().name()?;
        let rule = "container must be a jostle.Box, jostle.Circle, jostle.Torus or None";
        Err(PyTypeError::new_err(format!("{rule}, not {found}")))
    }
}

/// The Python object for a container of the core.
pub fn show(py: Python<'_>, container: Container) -> PyResult<Option<Py<PyAny>>> {
    Ok(match container {
        Container::None => None,
        Container::Box { min, max } => Some(Py::new(py, PyBox { min, max })?.into_any()),
        Container::Circle { center, radius } => {
            Some(Py::new(py, PyCircle { center, radius })?.into_any())
        }
        Container::Torus { size } => Some(Py::new(py, PyTorus { size })?.into_any()),
    })
}
