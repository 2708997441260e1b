//! `jostle.Attractor`, `jostle.Gravitation`, `jostle.Springs`, `jostle.Thermostat`: what
//! accelerates the particles of a world, as values.

use jostle::forces::{self, Law, Pole, Spring};
use jostle::{Each, Force};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict, PyTuple};

use crate::arrays::{
    Argument, Given, column, count, decimal, number, point, read_only, table, word,
};
use crate::error::{refused, type_error, value_error};
use crate::particles::reals;

/// A pull to a point, or to a particle.
///
/// A particle of the world feels nothing of what it attracts. On a torus the nearest
/// image of the point pulls.
///
/// Parameters
/// ----------
/// point : array_like, shape (2,), optional
///     Where to, in units of length; or give `particle`.
/// strength : float
///     Acceleration for each unit of distance ("harmonic"), or G times the mass that
///     pulls ("inverse_square"). Below 0 it pushes.
/// law : {"harmonic", "inverse_square"}, default "harmonic"
///     Acceleration is strength times distance, as in the article, or strength over
///     distance squared; nearer than its own radius a particle is then pulled as by a
///     ball of that radius.
/// particle : int, optional
///     Id of the particle that it follows, and with which it goes.
///
/// Raises
/// ------
/// TypeError
///     If not one of `point` and `particle` is given, or one holds no numbers.
/// ValueError
///     If a number is not finite, or there is no such law.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> pull = jostle.Attractor((0, 0), 4.0)
/// >>> world = jostle.World([(3, 0)], [(0, 0)], radii=1.0, forces=[pull])
/// >>> world.step(0.0078539816, steps=200)  # half a swing, π/2 seconds
/// >>> world.positions.round(3)
/// array([[-3.,  0.]], dtype=float32)
/// >>> jostle.Attractor(particle=0, strength=9.0, law="inverse_square")
/// Attractor(None, 9.0, 'inverse_square', particle=0)
#[pyclass(module = "jostle", name = "Attractor", frozen, eq)]
#[derive(PartialEq)]
pub struct PyAttractor(forces::Attractor);

#[pymethods]
impl PyAttractor {
    #[new]
    #[pyo3(
        signature = (point=None, strength=None, law=Given::NOTHING, *, particle=None),
        text_signature = "(point=None, strength=None, law='harmonic', *, particle=None)"
    )]
    fn new(
        point: Option<&Bound<'_, PyAny>>,
        strength: Option<&Bound<'_, PyAny>>,
        law: Given<'_>,
        particle: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let pole = match (point, particle) {
            (Some(point), None) => Pole::Point(self::point("point", point)?),
            (None, Some(particle)) => Pole::Particle(id("particle", particle)?),
            _ => {
                let rule = "an Attractor needs either a point or a particle";
                return Err(PyTypeError::new_err(rule));
            }
        };
        let Some(strength) = strength else {
            return Err(PyTypeError::new_err("an Attractor needs a strength"));
        };
        let strength = number("strength", strength)? as f32;
        let attractor = forces::Attractor { pole, strength, law: read_law(&law)? };
        attractor.validate().map_err(refused)?;
        Ok(Self(attractor))
    }

    /// Where it pulls to, (x, y); None if it follows a particle.
    #[getter]
    fn point(&self) -> Option<(f64, f64)> {
        match self.0.pole {
            Pole::Point(point) => Some(point.map(decimal).into()),
            Pole::Particle(_) => None,
        }
    }

    /// Acceleration for each unit of distance, or G times the mass that pulls.
    #[getter]
    fn strength(&self) -> f64 {
        decimal(self.0.strength)
    }

    /// "harmonic" or "inverse_square".
    #[getter]
    fn law(&self) -> &'static str {
        match self.0.law {
            Law::Harmonic => "harmonic",
            Law::InverseSquare => "inverse_square",
        }
    }

    /// Id of the particle that it follows, or None. It changes in a world when particles
    /// before this one are removed.
    #[getter]
    fn particle(&self) -> Option<u32> {
        match self.0.pole {
            Pole::Point(_) => None,
            Pole::Particle(row) => Some(row),
        }
    }

    #[expect(clippy::type_complexity, reason = "the shape that pickle wants")]
    fn __getnewargs_ex__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<((Option<(f64, f64)>, f64, &'static str), Bound<'py, PyDict>)> {
        let keywords = [("particle", self.particle())].into_py_dict(py)?;
        Ok(((self.point(), self.strength(), self.law()), keywords))
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        (self.point(), self.strength(), self.law(), self.particle()).into_pyobject(py)?.hash()
    }

    fn __repr__(&self) -> String {
        let (strength, law) = (self.strength(), self.law());
        match self.0.pole {
            Pole::Point(point) => {
                let [x, y] = point.map(decimal);
                format!("Attractor(({x:?}, {y:?}), {strength:?}, '{law}')")
            }
            Pole::Particle(row) => {
                format!("Attractor(None, {strength:?}, '{law}', particle={row})")
            }
        }
    }
}

/// All particles pull each other by their masses.
///
/// The acceleration of each is the sum of G m d / (d² + softening²)^(3/2) over all
/// others; on a torus everything pulls from its nearest image. Many particles are
/// summed up by Barnes and Hut's method on a quadtree, to about half a percent with
/// the default `theta`; few are added one by one. Momentum is kept.
///
/// Parameters
/// ----------
/// G : float
///     The constant of gravitation.
/// softening : float, default 0.0
///     A distance below which the pull weakens.
/// theta : float, default 0.5
///     A box counts as one body where its diagonal over its distance is less; 0 to 1.
///     With 0 every pair is added up.
///
/// Raises
/// ------
/// TypeError
///     If an argument is not a number.
/// ValueError
///     If a number is out of range.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> pull = jostle.Gravitation(1.0)
/// >>> world = jostle.World([(-2, 0), (2, 0)], [(0, -.25), (0, .25)], .1, masses=1.0, forces=[pull])
/// >>> world.step(0.1, steps=100)
/// >>> [abs(round(p, 5)) for p in world.momentum]
/// [0.0, 0.0]
#[pyclass(module = "jostle", name = "Gravitation", frozen, eq)]
#[derive(PartialEq)]
pub struct PyGravitation(forces::Gravitation);

// The signature that Python shows spells it out.
const _: () = assert!(forces::gravitation::DEFAULT_THETA == 0.5);

#[pymethods]
impl PyGravitation {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&str, &str, &str) = ("G", "softening", "theta");

    #[new]
    #[pyo3(
        signature = (G, softening=Given::NOTHING, theta=Given::NOTHING),
        text_signature = "(G, softening=0.0, theta=0.5)"
    )]
    #[expect(non_snake_case, reason = "its name everywhere")]
    fn new(G: &Bound<'_, PyAny>, softening: Given<'_>, theta: Given<'_>) -> PyResult<Self> {
        let g = number("G", G)? as f32;
        let or = |name, given: &Given<'_>, default| {
            given.value().map_or(Ok(default), |value| number(name, value).map(|v| v as f32))
        };
        let softening = or("softening", &softening, 0.0)?;
        let theta = or("theta", &theta, forces::gravitation::DEFAULT_THETA)?;
        let gravitation = forces::Gravitation { g, softening, theta };
        gravitation.validate().map_err(refused)?;
        Ok(Self(gravitation))
    }

    /// The constant of gravitation.
    #[getter(G)]
    fn g(&self) -> f64 {
        decimal(self.0.g)
    }

    /// A distance below which the pull weakens.
    #[getter]
    fn softening(&self) -> f64 {
        decimal(self.0.softening)
    }

    /// Diagonal over distance below which a box counts as one body.
    #[getter]
    fn theta(&self) -> f64 {
        decimal(self.0.theta)
    }

    fn __getnewargs__(&self) -> (f64, f64, f64) {
        (self.g(), self.softening(), self.theta())
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        self.__getnewargs__().into_pyobject(py)?.hash()
    }

    fn __repr__(&self) -> String {
        let (g, softening, theta) = self.__getnewargs__();
        format!("Gravitation({g:?}, {softening:?}, {theta:?})")
    }
}

/// Pairs of particles that are tied together.
///
/// Each spring pulls its ends with stiffness times its stretch, and with damping times
/// the speed at which it gets longer. Stiff ones act in short parts of a sub-step; what
/// is too stiff even for these is softened. A spring goes with either of its ends.
///
/// Parameters
/// ----------
/// pairs : array_like of int, shape (m, 2)
///     Ids of the two ends of each.
/// lengths : array_like, a number or shape (m,)
///     At rest, in units of length.
/// stiffness : array_like, a number or shape (m,)
///     Force for each unit of length.
/// damping : array_like, a number or shape (m,), default 0.0
///     Force for each unit of speed.
/// max_stretch : array_like, a number or shape (m,), optional
///     A spring that is longer than at rest by more than this, in units of length,
///     breaks at the end of a step. Left out, none breaks.
///
/// Raises
/// ------
/// TypeError
///     If an argument does not hold what it should.
/// ValueError
///     If a shape is wrong or a number is out of range; the sentence says which.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> tie = jostle.Springs([(0, 1)], lengths=2.0, stiffness=40.0, damping=4.0)
/// >>> world = jostle.World([(0, 0), (3, 0)], [(0, 0)] * 2, radii=0.5, masses=1.0, forces=[tie])
/// >>> world.step(0.01, steps=500)
/// >>> world.positions.round(3)
/// array([[0.5, 0. ],
///        [2.5, 0. ]], dtype=float32)
#[pyclass(module = "jostle", name = "Springs", frozen, eq)]
#[derive(PartialEq)]
pub struct PySprings(forces::Springs);

#[pymethods]
impl PySprings {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&str, &str, &str, &str, &str) =
        ("pairs", "lengths", "stiffness", "damping", "max_stretch");

    #[new]
    #[pyo3(
        signature = (pairs, lengths, stiffness, damping=Given::NOTHING, max_stretch=None),
        text_signature = "(pairs, lengths, stiffness, damping=0.0, max_stretch=None)"
    )]
    fn new(
        pairs: &Bound<'_, PyAny>,
        lengths: &Bound<'_, PyAny>,
        stiffness: &Bound<'_, PyAny>,
        damping: Given<'_>,
        max_stretch: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let pairs = Argument::integers("pairs", pairs)?.id_pairs()?;
        let len = pairs.len();
        let column = |name, value: Option<&Bound<'_, PyAny>>, default| -> PyResult<Vec<f32>> {
            Ok(reals(name, value, len)?.unwrap_or(Each::One(default)).rows(len))
        };
        let lengths = column("lengths", Some(lengths), 0.0)?;
        let stiffness = column("stiffness", Some(stiffness), 0.0)?;
        let damping = column("damping", damping.value(), 0.0)?;
        let max_stretch = column("max_stretch", max_stretch, f32::INFINITY)?;
        let spring = |row: usize| Spring {
            pair: pairs[row],
            length: lengths[row],
            stiffness: stiffness[row],
            damping: damping[row],
            max_stretch: max_stretch[row],
        };
        let springs = forces::Springs((0..len).map(spring).collect());
        springs.validate().map_err(refused)?;
        Ok(Self(springs))
    }

    /// Ids of the ends: read-only ndarray of uint32, shape (m, 2). They change in a world when
    /// particles before them are removed.
    #[getter]
    fn pairs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        Ok(read_only(table(py, self.0.0.iter().map(|spring| spring.pair).collect())?))
    }

    /// Lengths at rest: ndarray of float32, shape (m,).
    #[getter]
    fn lengths<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        read_only(column(py, self.0.0.iter().map(|spring| spring.length).collect()))
    }

    /// Force for each unit of length: ndarray of float32, shape (m,).
    #[getter]
    fn stiffness<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        read_only(column(py, self.0.0.iter().map(|spring| spring.stiffness).collect()))
    }

    /// Force for each unit of speed: ndarray of float32, shape (m,).
    #[getter]
    fn damping<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        read_only(column(py, self.0.0.iter().map(|spring| spring.damping).collect()))
    }

    /// Stretch beyond which each breaks: ndarray of float32, shape (m,); infinite where
    /// it never does.
    #[getter]
    fn max_stretch<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        read_only(column(py, self.0.0.iter().map(|spring| spring.max_stretch).collect()))
    }

    fn __len__(&self) -> usize {
        self.0.0.len()
    }

    fn __getnewargs__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let columns = [self.lengths(py), self.stiffness(py), self.damping(py)];
        let [lengths, stiffness, damping] = columns;
        (self.pairs(py)?, lengths, stiffness, damping, self.max_stretch(py)).into_pyobject(py)
    }

    fn __repr__(&self) -> String {
        format!("<jostle.Springs between {} pairs>", self.0.0.len())
    }
}

/// Walls that drive what bounces off them towards a speed.
///
/// Every bounce off a wall changes a particle's speed s to s + rate (speed - s), as in
/// the article's lesson about gases. A world has one at most.
///
/// Parameters
/// ----------
/// speed : float
///     In units of length a second, at least 0.
/// rate : float
///     The walls' share, 0 to 1; with 1 everything leaves them at `speed`.
///
/// Raises
/// ------
/// TypeError
///     If an argument is not a number.
/// ValueError
///     If a number is out of range.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> warm = jostle.Thermostat(speed=3.0, rate=0.5)
/// >>> box = jostle.Box(0, 0, 10, 10)
/// >>> world = jostle.World([(5, 5)], [(1, 0)], radii=1.0, container=box, forces=[warm])
/// >>> world.step(0.1, steps=60)  # it bounces off the right wall after four seconds
/// >>> world.velocities
/// array([[-2.,  0.]], dtype=float32)
#[pyclass(module = "jostle", name = "Thermostat", frozen, eq)]
#[derive(PartialEq)]
pub struct PyThermostat(forces::Thermostat);

#[pymethods]
impl PyThermostat {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&str, &str) = ("speed", "rate");

    #[new]
    fn new(speed: &Bound<'_, PyAny>, rate: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (speed, rate) = (number("speed", speed)? as f32, number("rate", rate)? as f32);
        let thermostat = forces::Thermostat { speed, rate };
        thermostat.validate().map_err(refused)?;
        Ok(Self(thermostat))
    }

    /// The speed of the walls.
    #[getter]
    fn speed(&self) -> f64 {
        decimal(self.0.speed)
    }

    /// Their share in a bounce.
    #[getter]
    fn rate(&self) -> f64 {
        decimal(self.0.rate)
    }

    fn __getnewargs__(&self) -> (f64, f64) {
        (self.speed(), self.rate())
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        self.__getnewargs__().into_pyobject(py)?.hash()
    }

    fn __repr__(&self) -> String {
        format!("Thermostat({:?}, {:?})", self.speed(), self.rate())
    }
}

fn read_law(given: &Given<'_>) -> PyResult<Law> {
    let rule = "'harmonic' or 'inverse_square'";
    match word("law", given, rule)?.as_deref() {
        None | Some("harmonic") => Ok(Law::Harmonic),
        Some("inverse_square") => Ok(Law::InverseSquare),
        Some(other) => Err(value_error("law", format!("'{other}'"), rule)),
    }
}

/// The row number of a particle.
fn id(name: &str, value: &Bound<'_, PyAny>) -> PyResult<u32> {
    let row = count(name, value, 0)?;
    u32::try_from(row).map_err(|_| value_error(name, row, "the id of a particle"))
}

/// The core's forces of a sequence of Python ones.
pub fn read(value: &Bound<'_, PyAny>) -> PyResult<Vec<Force>> {
    let rule = "a sequence of forces";
    let items = value.try_iter().map_err(|_| type_error("forces", rule, value))?;
    items.enumerate().map(|(index, item)| read_one(index, &item?)).collect()
}

fn read_one(index: usize, value: &Bound<'_, PyAny>) -> PyResult<Force> {
    if let Ok(found) = value.cast::<PyAttractor>() {
        Ok(Force::Attractor(found.get().0))
    } else if let Ok(found) = value.cast::<PyGravitation>() {
        Ok(Force::Gravitation(found.get().0))
    } else if let Ok(found) = value.cast::<PySprings>() {
        Ok(Force::Springs(found.get().0.clone()))
    } else if let Ok(found) = value.cast::<PyThermostat>() {
        Ok(Force::Thermostat(found.get().0))
    } else {
        let rule = "a jostle.Attractor, jostle.Gravitation, jostle.Springs or jostle.Thermostat";
        Err(type_error(&format!("forces[{index}]"), rule, value))
    }
}

/// The Python forces of core ones.
pub fn show<'py>(py: Python<'py>, forces: Vec<Force>) -> PyResult<Bound<'py, PyTuple>> {
    let one = |force| -> PyResult<Py<PyAny>> {
        Ok(match force {
            Force::Attractor(attractor) => Py::new(py, PyAttractor(attractor))?.into_any(),
            Force::Gravitation(gravitation) => Py::new(py, PyGravitation(gravitation))?.into_any(),
            Force::Springs(springs) => Py::new(py, PySprings(springs))?.into_any(),
            Force::Thermostat(thermostat) => Py::new(py, PyThermostat(thermostat))?.into_any(),
        })
    };
    PyTuple::new(py, forces.into_iter().map(one).collect::<PyResult<Vec<_>>>()?)
}
