//! `jostle.Box` and `jostle.Circle`: the containers of a world.

use jostle_base::Error;
use jostle_index::Each;
use jostle_world::{Container, Sides, Surface};
use numpy::PyArray1;
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::{Argument, Given, column, decimal, number, point, read_only, table};
use crate::error::refused;
use crate::keywords::Keywords;
use crate::walls;

/// Four walls around a rectangle: a container of a `World`.
///
/// It is not a shape. Rectangles for `find_pairs`, `Quadtree` and `Space` are given by arrays.
///
/// Parameters
/// ----------
/// min_x, min_y, max_x, max_y : float
///     Its sides, in units of length; min below max. Stored as float32.
/// restitution, friction : array_like, a number or shape (4,), optional
///     Coefficients of the sides at min x, max x, min y and max y. A contact
///     has the square root of the product with that of the particle; None, for all or for one side,
///     is that of the particle.
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
/// Circle : Another container.
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
    sides: Sides,
}

#[pymethods]
impl PyBox {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&str, &str, &str, &str) = ("min_x", "min_y", "max_x", "max_y");

    #[new]
    #[pyo3(
        signature = (*arguments, **keywords),
        text_signature = "(min_x, min_y, max_x, max_y, *, restitution=None, friction=None)"
    )]
    fn new(arguments: &Bound<'_, PyTuple>, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let names = ["min_x", "min_y", "max_x", "max_y"];
        let mut given = Keywords::of_all("Box()", &names, arguments, keywords)?;
        let [min_x, min_y, max_x, max_y] = given.require(names)?;
        let [restitution, friction] = given.take_all(["restitution", "friction"]);
        given.end()?;
        let min = [number("min_x", &min_x)? as f32, number("min_y", &min_y)? as f32];
        let max = [number("max_x", &max_x)? as f32, number("max_y", &max_y)? as f32];
        valid(Container::Box { min, max })?;
        let sides = sides(restitution.as_ref(), friction.as_ref())?;
        sides.validate(false).map_err(refused)?;
        Ok(Self { min, max, sides })
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

    /// Left, top, right and bottom where y grows downwards: ndarray of float64, shape (4,), in the order
    /// min x, min y, max x, max y, as the rows of `Space.bounds`.
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let (min_x, min_y, max_x, max_y) = self.numbers();
        read_only(column(py, vec![min_x, min_y, max_x, max_y]))
    }

    /// Its area.
    #[getter]
    fn area(&self) -> f64 {
        let (min_x, min_y, max_x, max_y) = self.numbers();
        (max_x - min_x) * (max_y - min_y)
    }

    fn __getnewargs_ex__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Again<'py, (f64, f64, f64, f64)>> {
        Ok((self.numbers(), keywords(py, &self.sides)?))
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        (self.numbers(), self.restitution(), self.friction()).into_pyobject(py)?.hash()
    }

    fn __repr__(&self) -> String {
        let (min_x, min_y, max_x, max_y) = self.numbers();
        format!("Box({min_x:?}, {min_y:?}, {max_x:?}, {max_y:?}{})", text(&self.sides))
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
/// restitution, friction : float, optional
///     Coefficients of its side. A contact has the square root of the product with that of the
///     particle; None is that of the particle.
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
/// Box : Another container.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> jostle.Circle((400, 250), radius=240, restitution=0.5)
/// Circle((400.0, 250.0), 240.0, restitution=0.5)
#[pyclass(module = "jostle", name = "Circle", frozen, eq)]
#[derive(PartialEq)]
pub struct PyCircle {
    center: [f32; 2],
    radius: f32,
    sides: Sides,
}

#[pymethods]
impl PyCircle {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&str, &str) = ("center", "radius");

    #[new]
    #[pyo3(
        signature = (*arguments, **keywords),
        text_signature = "(center, radius, *, restitution=None, friction=None)"
    )]
    fn new(arguments: &Bound<'_, PyTuple>, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let names = ["center", "radius"];
        let mut given = Keywords::of_all("Circle()", &names, arguments, keywords)?;
        let [center, radius] = given.require(names)?;
        let [restitution, friction] = given.take_all(["restitution", "friction"]);
        given.end()?;
        let (center, radius) = (point("center", &center)?, number("radius", &radius)? as f32);
        valid(Container::Circle { center, radius })?;
        let sides = sides(restitution.as_ref(), friction.as_ref())?;
        sides.validate(true).map_err(refused)?;
        Ok(Self { center, radius, sides })
    }

    /// Its centre: ndarray of float64, shape (2,).
    #[getter]
    fn center<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        read_only(column(py, self.center.map(decimal).to_vec()))
    }

    /// Its radius.
    #[getter]
    fn radius(&self) -> f64 {
        decimal(self.radius)
    }

    /// The rectangle around it: ndarray of float64, shape (4,), in the order min x, min y, max x, max y.
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let ([x, y], r) = (self.center.map(decimal), self.radius());
        read_only(column(py, vec![x - r, y - r, x + r, y + r]))
    }

    /// Its area.
    #[getter]
    fn area(&self) -> f64 {
        std::f64::consts::PI * self.radius() * self.radius()
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<Again<'py, ((f64, f64), f64)>> {
        Ok(((self.place(), self.radius()), keywords(py, &self.sides)?))
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        (self.place(), self.radius(), self.restitution(), self.friction()).into_pyobject(py)?.hash()
    }

    fn __repr__(&self) -> String {
        format!("Circle({:?}, {:?}{})", self.place(), self.radius(), text(&self.sides))
    }
}

/// Refuses a container that is not finite or encloses no area, with its class.
fn valid(container: Container) -> PyResult<()> {
    container.validate().map_err(|error| match error {
        Error::Value { value, rule, .. } => PyValueError::new_err(format!("{value}: {rule}")),
        other => refused(other),
    })
}

/// What a box and a circle have alike.
macro_rules! region {
    ($class:ty) => {
        #[pymethods]
        impl $class {
            /// Coefficient of restitution of its sides: a number, four numbers if they differ, or None for that of the
            /// particle.
            #[getter]
            fn restitution(&self) -> Shown {
                restitution(&self.sides)
            }

            /// Coefficient of friction of its sides: a number, four numbers if they differ, or None for that of the
            /// particle.
            #[getter]
            fn friction(&self) -> Shown {
                friction(&self.sides)
            }

            /// Whether points lie inside or on the sides.
            ///
            /// Parameters
            /// ----------
            /// points : array_like, shape (k, 2), or (2,) for one point
            ///     In units of length.
            ///
            /// Returns
            /// -------
            /// ndarray of bool, shape (k,), or bool
            ///     For each point, or for the only one.
            ///
            /// See Also
            /// --------
            /// clip : Moves points inside.
            fn contains<'py>(&self, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
                contains(self, points)
            }

            /// Return the nearest places inside.
            ///
            /// Parameters
            /// ----------
            /// points : array_like, shape (k, 2), or (2,) for one point
            ///     In units of length.
            /// margin : float, default 0.0
            ///     The distance from the sides that is kept, as the radius of discs. If there is not so much
            ///     room, the place is in the middle.
            ///
            /// Returns
            /// -------
            /// ndarray of float64, shape (k, 2), or (2,) for one point
            ///     The points that are inside already are as they were.
            ///
            /// See Also
            /// --------
            /// contains : Whether points are inside.
            #[pyo3(signature = (points, margin=Given::NOTHING), text_signature = "($self, points, margin=0.0)")]
            fn clip<'py>(
                &self,
                points: &Bound<'py, PyAny>,
                margin: Given<'py>,
            ) -> PyResult<Bound<'py, PyAny>> {
                clip(self, points, &margin)
            }
        }
    };
}
region!(PyBox);
region!(PyCircle);

/// The arguments with which a container is made again, by position and by keyword.
type Again<'py, P> = (P, Bound<'py, PyDict>);

/// The shape of a container.
trait Region {
    /// The container of the core.
    fn container(&self) -> Container;

    /// The nearest place that is at least `margin` inside.
    fn clipped(&self, point: [f64; 2], margin: f64) -> [f64; 2];

    fn contains(&self, point: [f64; 2]) -> bool;
}

impl Region for PyBox {
    fn container(&self) -> Container {
        Container::Box { min: self.min, max: self.max }
    }

    fn clipped(&self, point: [f64; 2], margin: f64) -> [f64; 2] {
        [0, 1].map(|k| {
            let [min, max] = [f64::from(self.min[k]) + margin, f64::from(self.max[k]) - margin];
            if min > max { 0.5 * (min + max) } else { point[k].clamp(min, max) }
        })
    }

    fn contains(&self, point: [f64; 2]) -> bool {
        (0..2).all(|k| (f64::from(self.min[k])..=f64::from(self.max[k])).contains(&point[k]))
    }
}

impl Region for PyCircle {
    fn container(&self) -> Container {
        Container::Circle { center: self.center, radius: self.radius }
    }

    fn clipped(&self, point: [f64; 2], margin: f64) -> [f64; 2] {
        let offset = self.offset(point);
        let (distance, most) = (
            (offset[0] * offset[0] + offset[1] * offset[1]).sqrt(),
            f64::from(self.radius) - margin,
        );
        if distance <= most {
            return point;
        }
        let share = most.max(0.0) / distance;
        [0, 1].map(|k| f64::from(self.center[k]) + share * offset[k])
    }

    fn contains(&self, point: [f64; 2]) -> bool {
        let [x, y] = self.offset(point);
        x * x + y * y <= f64::from(self.radius) * f64::from(self.radius)
    }
}

impl PyBox {
    fn numbers(&self) -> (f64, f64, f64, f64) {
        (self.min_x(), self.min_y(), self.max_x(), self.max_y())
    }
}

impl PyCircle {
    fn place(&self) -> (f64, f64) {
        self.center.map(decimal).into()
    }

    fn offset(&self, point: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| point[k] - f64::from(self.center[k]))
    }
}

/// Whether each point is inside; a bool for a single point.
fn contains<'py>(region: &impl Region, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let py = points.py();
    let points: Each<[f64; 2]> = Argument::reals("points", points)?.one_or_rows()?;
    match points {
        Each::One(point) => region.contains(point).into_bound_py_any(py),
        Each::Rows(all) => {
            Ok(column(py, all.into_iter().map(|point| region.contains(point)).collect()).into_any())
        }
    }
}

/// The points, moved to at least `margin` inside.
fn clip<'py>(
    region: &impl Region,
    points: &Bound<'py, PyAny>,
    margin: &Given<'py>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = points.py();
    let margin = margin.value().map_or(Ok(0.0), |value| number("margin", value))?;
    if !(margin >= 0.0 && margin.is_finite()) {
        return Err(refused(Error::of("margin", margin, "it must be finite and at least 0")));
    }
    let points: Each<[f64; 2]> = Argument::reals("points", points)?.one_or_rows()?;
    match points {
        Each::One(point) => Ok(column(py, region.clipped(point, margin).to_vec()).into_any()),
        Each::Rows(all) => {
            let all = all.into_iter().map(|point| region.clipped(point, margin)).collect();
            Ok(table(py, all)?.into_any())
        }
    }
}

/// A coefficient for each side, from a number or four; None, or NaN, is that of the particle.
fn of_sides(name: &'static str, value: Option<&Bound<'_, PyAny>>) -> PyResult<[Option<f32>; 4]> {
    let Some(value) = value else { return Ok([None; 4]) };
    let each = walls::coefficients(name, value, 4)?;
    let some = |side: usize| Some(each.at(side)).filter(|value| !value.is_nan());
    Ok([0, 1, 2, 3].map(some))
}

/// The coefficients of the sides of a container.
fn sides(
    restitution: Option<&Bound<'_, PyAny>>,
    friction: Option<&Bound<'_, PyAny>>,
) -> PyResult<Sides> {
    let restitution = of_sides("restitution", restitution)?;
    let friction = of_sides("friction", friction)?;
    let surface = |k: usize| Surface { restitution: restitution[k], friction: friction[k] };
    Ok(Sides([0, 1, 2, 3].map(surface)))
}

/// What Python sees of a coefficient of the sides: None, a number, or four of these.
#[derive(IntoPyObject)]
enum Shown {
    One(Option<f64>),
    Four((Option<f64>, Option<f64>, Option<f64>, Option<f64>)),
}

impl Shown {
    fn of(sides: &Sides, of: impl Fn(&Surface) -> Option<f32>) -> Self {
        let [a, b, c, d] = sides.0.map(|side| of(&side).map(decimal));
        if [b, c, d] == [a; 3] { Self::One(a) } else { Self::Four((a, b, c, d)) }
    }

    /// As a keyword in the text of a container; nothing for None.
    fn keyword(&self, name: &str) -> String {
        let plain = |one: &Option<f64>| one.map_or("None".into(), |one| format!("{one:?}"));
        match self {
            Self::One(None) => String::new(),
            Self::One(one) => format!(", {name}={}", plain(one)),
            Self::Four((a, b, c, d)) => {
                let [a, b, c, d] = [a, b, c, d].map(plain);
                format!(", {name}=({a}, {b}, {c}, {d})")
            }
        }
    }
}

fn restitution(sides: &Sides) -> Shown {
    Shown::of(sides, |side| side.restitution)
}

fn friction(sides: &Sides) -> Shown {
    Shown::of(sides, |side| side.friction)
}

/// The keywords with which a container is made again.
fn keywords<'py>(py: Python<'py>, sides: &Sides) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    all.set_item("restitution", restitution(sides))?;
    all.set_item("friction", friction(sides))?;
    Ok(all)
}

/// The keywords as text.
fn text(sides: &Sides) -> String {
    restitution(sides).keyword("restitution") + &friction(sides).keyword("friction")
}

/// The region of the core for a Python object, and its sides; None is no region.
pub fn read(name: &str, value: Option<&Bound<'_, PyAny>>) -> PyResult<(Container, Sides)> {
    let Some(value) = value else { return Ok(Default::default()) };
    if let Ok(found) = value.cast::<PyBox>() {
        Ok((found.get().container(), found.get().sides))
    } else if let Ok(found) = value.cast::<PyCircle>() {
        Ok((found.get().container(), found.get().sides))
    } else {
        let found = value.get_type().name()?;
        let rule = "must be a jostle.Box, jostle.Circle or None";
        Err(PyTypeError::new_err(format!("{name} {rule}, not {found}")))
    }
}

/// The Python object for a container of the core.
pub fn show(py: Python<'_>, container: Container, sides: Sides) -> PyResult<Option<Py<PyAny>>> {
    Ok(match container {
        Container::None | Container::Torus { .. } => None,
        Container::Box { min, max } => Some(Py::new(py, PyBox { min, max, sides })?.into_any()),
        Container::Circle { center, radius } => {
            Some(Py::new(py, PyCircle { center, radius, sides })?.into_any())
        }
    })
}

/// The period of a world: a number for both axes, or a pair.
pub fn period(value: Option<&Bound<'_, PyAny>>) -> PyResult<Option<[f32; 2]>> {
    let Some(value) = value else { return Ok(None) };
    let size = match Argument::reals("period", value)?.half_sizes::<f32>(1)? {
        Each::One(size) => size,
        Each::Rows(_) => {
            return Err(Argument::reals("period", value)?.wrong_shape("a number or (2,)"));
        }
    };
    if !size.iter().all(|side| *side > 0.0 && side.is_finite()) {
        let [width, height] = size;
        let rule = "both sides must be finite and above 0";
        return Err(refused(Error::of("period", format!("({width}, {height})"), rule)));
    }
    Ok(Some(size))
}

/// The error for a world with a container and a period.
pub fn both() -> PyErr {
    let value = "given";
    refused(Error::of("period", value, "a world has a container or a period, not both"))
}
