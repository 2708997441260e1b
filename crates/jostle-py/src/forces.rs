//! The forces of a world: `jostle.Attractor`, `jostle.Gravitation`, `jostle.Springs` and the
//! thermostats.

use jostle::forces::{self, Law, Pole, Spring};
use jostle::{Each, Error, Force, Id};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict, PyTuple};

use crate::arrays::{
    Argument, Given, column, count, decimal, long_ids, number, point, read_only, reals, table, word,
};
use crate::error::{refused, type_error, value_error};
use crate::motor::{PyMotor, wall_numbers};
use crate::pair_force::{PyFlocking, PyPairForce};

/// A force towards a point or a particle.
///
/// An attracting particle is not accelerated by those that it attracts. On a torus the
/// force is towards the nearest image of the point.
///
/// Parameters
/// ----------
/// point : array_like, shape (2,), optional
///     The point, in units of length; or give `particle`.
/// strength : float
///     Acceleration per unit of distance ("harmonic"), or G times the attracting
///     mass ("inverse_square"). If negative, the force is repulsive.
/// law : {"harmonic", "inverse_square"}, default "harmonic"
///     Acceleration is strength times distance, as in the article, or strength over
///     distance squared. In the second case the force within a particle's own radius is
///     that inside a homogeneous ball of that radius.
/// particle : int, optional
///     Id of the attracting particle; if it is removed, the attractor is removed.
///
/// Raises
/// ------
/// TypeError
///     If not exactly one of `point` and `particle` is given, or it does not hold numbers.
/// ValueError
///     If a number is not finite, or there is no such law.
///
/// See Also
/// --------
/// Gravitation : Attraction between all particles.
/// World.force : Forces from NumPy.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> pull = jostle.Attractor((0, 0), 4.0)
/// >>> world = jostle.World([(3, 0)], [(0, 0)], radii=1.0, forces=[pull])
/// >>> world.step(0.0078539816, steps=200)  # half a period, π/2 seconds
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

    /// The attracting point, (x, y); None if it is a particle.
    #[getter]
    fn point(&self) -> Option<(f64, f64)> {
        match self.0.pole {
            Pole::Point(point) => Some(point.map(decimal).into()),
            Pole::Particle(_) => None,
        }
    }

    /// Acceleration per unit of distance, or G times the attracting mass.
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

    /// Id of the attracting particle, or None.
    #[getter]
    fn particle(&self) -> Option<Id> {
        match self.0.pole {
            Pole::Point(_) => None,
            Pole::Particle(id) => Some(id),
        }
    }

    #[expect(clippy::type_complexity, reason = "the protocol of pickle")]
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
            Pole::Particle(id) => {
                format!("Attractor(None, {strength:?}, '{law}', particle={id})")
            }
        }
    }
}

/// Gravitation between all particles.
///
/// The acceleration of each is the sum of G m d / (d² + softening²)^(3/2) over all
/// others; on a torus with minimum images. Many particles are summed by the Barnes-Hut
/// method on a quadtree, with an error of about half a percent for the default `theta`; few
/// are summed directly. Momentum is conserved.
///
/// Parameters
/// ----------
/// G : float
///     The gravitational constant.
/// softening : float, default 0.0
///     Distance below which the force is reduced, in units of length.
/// theta : float, default 0.5
///     A box is treated as one body if its diagonal divided by its distance is less; 0 to 1.
///     With 0 every pair is summed.
///
/// Raises
/// ------
/// TypeError
///     If an argument is not a number.
/// ValueError
///     If a number is out of range.
///
/// See Also
/// --------
/// Attractor : A central force without a reaction.
///
/// References
/// ----------
/// J. Barnes and P. Hut, *A hierarchical O(N log N) force-calculation algorithm*, Nature 324
/// (1986).
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

// The default in the signature.
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
    #[expect(non_snake_case, reason = "its usual name")]
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

    /// The gravitational constant.
    #[getter(G)]
    fn g(&self) -> f64 {
        decimal(self.0.g)
    }

    /// Distance below which the force is reduced, in units of length.
    #[getter]
    fn softening(&self) -> f64 {
        decimal(self.0.softening)
    }

    /// Diagonal divided by distance below which a box is treated as one body.
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

/// Springs between pairs of particles.
///
/// The force of each spring is stiffness times stretch plus damping times the rate of
/// lengthening. Stiff springs are integrated in parts of a sub-step, whose number is limited;
/// the stiffness is reduced if more would be necessary. If one of its ends is removed, a spring is
/// removed too.
///
/// Parameters
/// ----------
/// pairs : array_like of int, shape (m, 2)
///     Ids of the two ends of each spring.
/// lengths : array_like, a number or shape (m,)
///     Lengths at rest, in units of length.
/// stiffness : array_like, a number or shape (m,)
///     Force per unit of stretch.
/// damping : array_like, a number or shape (m,), default 0.0
///     Force per unit of speed.
/// max_stretch : array_like, a number or shape (m,), optional
///     Stretch beyond which a spring breaks at the end of a step, in units of length. If
///     omitted, none breaks.
///
/// Raises
/// ------
/// TypeError
///     If an argument has the wrong type.
/// ValueError
///     If a shape is wrong or a number is out of range; the message says which.
///
/// See Also
/// --------
/// Attractor : A force towards a point.
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
        let column = |name, value: Option<&Bound<'_, PyAny>>, default| -> PyResult<Each<f32>> {
            Ok(reals(name, value, len)?.unwrap_or(Each::One(default)))
        };
        let lengths = column("lengths", Some(lengths), 0.0)?;
        let stiffness = column("stiffness", Some(stiffness), 0.0)?;
        let damping = column("damping", damping.value(), 0.0)?;
        let max_stretch = column("max_stretch", max_stretch, f32::INFINITY)?;
        let spring = |row: usize| Spring {
            pair: pairs[row],
            length: lengths.at(row),
            stiffness: stiffness.at(row),
            damping: damping.at(row),
            max_stretch: max_stretch.at(row),
        };
        let springs = forces::Springs((0..len).map(spring).collect());
        springs.validate().map_err(refused)?;
        Ok(Self(springs))
    }

    /// Ids of the ends: read-only ndarray of int64, shape (m, 2).
    #[getter]
    fn pairs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        Ok(read_only(table(py, self.0.0.iter().map(|spring| spring.pair).collect())?))
    }

    /// Lengths at rest: ndarray of float32, shape (m,).
    #[getter]
    fn lengths<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        read_only(column(py, self.0.0.iter().map(|spring| spring.length).collect()))
    }

    /// Force per unit of stretch: ndarray of float32, shape (m,).
    #[getter]
    fn stiffness<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        read_only(column(py, self.0.0.iter().map(|spring| spring.stiffness).collect()))
    }

    /// Force per unit of speed: ndarray of float32, shape (m,).
    #[getter]
    fn damping<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        read_only(column(py, self.0.0.iter().map(|spring| spring.damping).collect()))
    }

    /// Stretch beyond which each breaks: ndarray of float32, shape (m,); infinite if it never
    /// breaks.
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

/// Walls that heat or cool the particles that bounce off them.
///
/// Every bounce off a wall changes a particle's speed s to s + rate (speed - s), as in
/// the article's lesson about gases. A world has at most one `Thermostat`. The speeds do not reach
/// the Maxwell distribution, see `ThermalWalls`.
///
/// Parameters
/// ----------
/// speed : float
///     Target speed in units of length per second, at least 0.
/// rate : float
///     Relative change by one bounce, 0 to 1; with 1 particles leave the walls with `speed`.
///
/// Raises
/// ------
/// TypeError
///     If an argument is not a number.
/// ValueError
///     If a number is out of range.
///
/// See Also
/// --------
/// ThermalWalls : Sides of the container with a temperature.
/// AndersenThermostat : A heat bath for all particles.
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

    /// The target speed.
    #[getter]
    fn speed(&self) -> f64 {
        decimal(self.0.speed)
    }

    /// Relative change by one bounce, 0 to 1.
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

/// Sides of the container, and walls, with a temperature.
///
/// A particle that hits such a wall leaves it with the velocity of a particle that enters through
/// it from a gas in equilibrium: the speed along the normal has the density ∝ v exp(-m v²/2kT), the
/// velocity along the wall is normally distributed with the variance kT/m. A gas between such walls
/// reaches their temperature and the Maxwell distribution; between different temperatures there is
/// a heat flow. The random numbers are functions of `seed`, the particle's state at the impact and
/// the time, so results have the same bits for every number of threads and every order of adding.
///
/// Parameters
/// ----------
/// temperature : float
///     Boltzmann's constant times the temperature, kT, above 0: the mean kinetic energy of a
///     particle, in units of mass times length² per second².
/// sides : array_like of int, shape (k,), optional
///     Numbers of the sides, as in `World.wall_contacts`: 0 to 3 at min x, max x, min y and max y;
///     0 is the wall of a `Circle`, which all four may stand for, too. If omitted, all; none if `walls`
///     is given.
/// seed : int, default 0
///     Seed of the random numbers, below 2³².
/// walls : array_like of int, shape (m,), optional
///     Indices of line segments in `World.walls`, which have the temperature on both sides. At a wall
///     that moves, the velocities are relative to it.
///
/// Raises
/// ------
/// TypeError
///     If an argument has the wrong type.
/// ValueError
///     If a number is out of range, or a side or a wall is given twice. When it is assigned to
///     `World.forces`, also if a wall does not exist, or has a temperature already, or the container does
///     not have a side. A change of `World.container` to one without it is refused, too.
///
/// See Also
/// --------
/// AndersenThermostat : A heat bath for all particles.
/// Thermostat : The article's rule, which does not lead to the Maxwell distribution.
///
/// Notes
/// -----
/// Several of them may have different sides and walls. Angular velocities, and particles that rest on a wall,
/// are not heated: use coefficients of restitution of 1. `World.wall_contacts` includes the change
/// along the normal.
///
/// References
/// ----------
/// R. Tehver, F. Toigo, J. Koplik and J. R. Banavar, *Thermal walls in computer simulations*,
/// Physical Review E 57, R17 (1998).
///
/// Examples
/// --------
/// >>> import jostle
/// >>> hot, cold = jostle.ThermalWalls(4.0, sides=[0]), jostle.ThermalWalls(1.0, sides=[1], seed=1)
/// >>> world = jostle.scenes.create("gas", n=100)
/// >>> world.forces = [hot, cold]
/// >>> world.step(1 / 60, steps=10)
/// >>> hot
/// ThermalWalls(4.0, [0], 0)
///
/// A hot plate in the middle of the box:
///
/// >>> world.walls = [((5, 10), (15, 10))]
/// >>> world.forces = [jostle.ThermalWalls(9.0, walls=[0])]
/// >>> world.step(1 / 60, steps=10)
#[pyclass(module = "jostle", name = "ThermalWalls", frozen, eq)]
#[derive(PartialEq)]
pub struct PyThermalWalls(forces::ThermalWalls);

#[pymethods]
impl PyThermalWalls {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&str, &str, &str) = ("temperature", "sides", "seed");

    #[new]
    #[pyo3(
        signature = (temperature, sides=None, seed=Given::NOTHING, *, walls=None),
        text_signature = "(temperature, sides=None, seed=0, *, walls=None)"
    )]
    fn new(
        temperature: &Bound<'_, PyAny>,
        sides: Option<&Bound<'_, PyAny>>,
        seed: Given<'_>,
        walls: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let temperature = number("temperature", temperature)? as f32;
        let sides = sides.map_or(Ok([walls.is_none(); 4]), self::sides)?;
        let indices = walls.map(|value| long_ids("walls", value, "wall")).transpose()?;
        let walls = wall_numbers(&indices.map_or(Vec::new(), |indices| indices.rows(1)))?;
        let hot = forces::ThermalWalls { temperature, sides, walls, seed: self::seed(&seed)? };
        hot.validate().map_err(refused)?;
        Ok(Self(hot))
    }

    /// Boltzmann's constant times the temperature.
    #[getter]
    fn temperature(&self) -> f64 {
        decimal(self.0.temperature)
    }

    /// The sides of the container that have it: a tuple of int, ascending.
    #[getter]
    fn sides<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.numbers())
    }

    /// The seed of the random numbers.
    #[getter]
    fn seed(&self) -> u32 {
        self.0.seed
    }

    /// The indices of the walls that have it: a tuple of int.
    #[getter]
    fn walls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.0.walls)
    }

    #[expect(clippy::type_complexity, reason = "the protocol of pickle")]
    fn __getnewargs_ex__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<((f64, Bound<'py, PyTuple>, u32), Bound<'py, PyDict>)> {
        let keywords = [("walls", self.walls(py)?)].into_py_dict(py)?;
        Ok(((self.temperature(), self.sides(py)?, self.seed()), keywords))
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        let all = (self.temperature(), self.sides(py)?, self.seed(), self.walls(py)?);
        all.into_pyobject(py)?.hash()
    }

    fn __repr__(&self) -> String {
        let (sides, walls) = (self.numbers(), &self.0.walls);
        let walls = if walls.is_empty() { String::new() } else { format!(", walls={walls:?}") };
        format!("ThermalWalls({:?}, {sides:?}, {}{walls})", self.temperature(), self.seed())
    }
}

impl PyThermalWalls {
    fn numbers(&self) -> Vec<usize> {
        (0..4).filter(|&side| self.0.sides[side]).collect()
    }
}

/// A heat bath that gives each particle a new velocity at random times.
///
/// At the end of each step a particle gets a new velocity with the probability 1 - exp(-rate dt).
/// Each component of it is normally distributed with the variance kT/m. So the particles reach the
/// Maxwell distribution at this temperature (canonical ensemble); momentum and energy are not
/// conserved. The random numbers are functions of `seed`, the particle's state and the time, so
/// results have the same bits for every number of threads and every order of adding.
///
/// Parameters
/// ----------
/// temperature : float
///     Boltzmann's constant times the temperature, kT, above 0: the mean kinetic energy of a
///     particle, in units of mass times length² per second².
/// rate : float
///     Mean number of new velocities of a particle per second, at least 0.
/// seed : int, default 0
///     Seed of the random numbers, below 2³².
///
/// Raises
/// ------
/// TypeError
///     If an argument is not a number.
/// ValueError
///     If a number is out of range.
///
/// See Also
/// --------
/// ThermalWalls : Sides of the container with a temperature.
///
/// Notes
/// -----
/// A world has at most one. Angular velocities and immovable particles are not changed.
///
/// References
/// ----------
/// H. C. Andersen, *Molecular dynamics simulations at constant pressure and/or temperature*,
/// Journal of Chemical Physics 72, 2384 (1980).
///
/// Examples
/// --------
/// >>> import jostle
/// >>> world = jostle.scenes.create("gas", n=1000)
/// >>> world.forces = [jostle.AndersenThermostat(temperature=2.0, rate=5.0)]
/// >>> world.step(1 / 60, steps=300)
/// >>> abs(world.kinetic_energy / 1000 - 2.0) < 0.3
/// True
#[pyclass(module = "jostle", name = "AndersenThermostat", frozen, eq)]
#[derive(PartialEq)]
pub struct PyAndersenThermostat(forces::Andersen);

#[pymethods]
impl PyAndersenThermostat {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&str, &str, &str) = ("temperature", "rate", "seed");

    #[new]
    #[pyo3(
        signature = (temperature, rate, seed=Given::NOTHING),
        text_signature = "(temperature, rate, seed=0)"
    )]
    fn new(
        temperature: &Bound<'_, PyAny>,
        rate: &Bound<'_, PyAny>,
        seed: Given<'_>,
    ) -> PyResult<Self> {
        let temperature = number("temperature", temperature)? as f32;
        let rate = number("rate", rate)? as f32;
        let bath = forces::Andersen { temperature, rate, seed: self::seed(&seed)? };
        bath.validate().map_err(refused)?;
        Ok(Self(bath))
    }

    /// Boltzmann's constant times the temperature.
    #[getter]
    fn temperature(&self) -> f64 {
        decimal(self.0.temperature)
    }

    /// Mean number of new velocities of a particle per second.
    #[getter]
    fn rate(&self) -> f64 {
        decimal(self.0.rate)
    }

    /// The seed of the random numbers.
    #[getter]
    fn seed(&self) -> u32 {
        self.0.seed
    }

    fn __getnewargs__(&self) -> (f64, f64, u32) {
        (self.temperature(), self.rate(), self.seed())
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        self.__getnewargs__().into_pyobject(py)?.hash()
    }

    fn __repr__(&self) -> String {
        format!("AndersenThermostat({:?}, {:?}, {})", self.temperature(), self.rate(), self.seed())
    }
}

/// The sides of the container with the numbers in an array.
fn sides(value: &Bound<'_, PyAny>) -> PyResult<[bool; 4]> {
    let numbers = long_ids("sides", value, "side")?.rows(1);
    let mut sides = [false; 4];
    for (index, number) in numbers.into_iter().enumerate() {
        let side = usize::try_from(number).ok().and_then(|side| sides.get_mut(side));
        match side {
            None => {
                let rule = "the sides of a container are 0 to 3";
                return Err(refused(Error::at("sides", index, number, rule)));
            }
            Some(true) => {
                return Err(refused(Error::at("sides", index, number, "it is given twice")));
            }
            Some(side) => *side = true,
        }
    }
    Ok(sides)
}

/// The seed of random numbers.
fn seed(given: &Given<'_>) -> PyResult<u32> {
    let seed = given.value().map_or(Ok(0), |value| count("seed", value, 0))?;
    u32::try_from(seed).map_err(|_| value_error("seed", seed, "below 4294967296"))
}

fn read_law(given: &Given<'_>) -> PyResult<Law> {
    let rule = "'harmonic' or 'inverse_square'";
    match word("law", given, rule)?.as_deref() {
        None | Some("harmonic") => Ok(Law::Harmonic),
        Some("inverse_square") => Ok(Law::InverseSquare),
        Some(other) => Err(value_error("law", format!("'{other}'"), rule)),
    }
}

/// The id of a particle.
fn id(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Id> {
    let id = count(name, value, 0)?;
    Id::try_from(id).map_err(|_| value_error(name, id, "the id of a particle"))
}

/// The forces of the core for a sequence of Python objects.
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
    } else if let Ok(found) = value.cast::<PyThermalWalls>() {
        Ok(Force::ThermalWalls(found.get().0.clone()))
    } else if let Ok(found) = value.cast::<PyAndersenThermostat>() {
        Ok(Force::Andersen(found.get().0))
    } else if let Ok(found) = value.cast::<PyMotor>() {
        Ok(Force::Motor(found.get().0.clone()))
    } else if let Ok(found) = value.cast::<PyPairForce>() {
        Ok(Force::Pair(found.get().0.clone()))
    } else if let Ok(found) = value.cast::<PyFlocking>() {
        Ok(Force::Flocking(found.get().0))
    } else {
        let rule = "a jostle.Attractor, jostle.Gravitation, jostle.Springs, jostle.Thermostat, \
                    jostle.ThermalWalls, jostle.AndersenThermostat, jostle.Motor, \
                    jostle.PairForce or jostle.Flocking";
        Err(type_error(&format!("forces[{index}]"), rule, value))
    }
}

/// The Python objects for forces of the core.
pub fn show<'py>(py: Python<'py>, forces: Vec<Force>) -> PyResult<Bound<'py, PyTuple>> {
    let one = |force| -> PyResult<Py<PyAny>> {
        Ok(match force {
            Force::Attractor(attractor) => Py::new(py, PyAttractor(attractor))?.into_any(),
            Force::Gravitation(gravitation) => Py::new(py, PyGravitation(gravitation))?.into_any(),
            Force::Springs(springs) => Py::new(py, PySprings(springs))?.into_any(),
            Force::Thermostat(thermostat) => Py::new(py, PyThermostat(thermostat))?.into_any(),
            Force::ThermalWalls(walls) => Py::new(py, PyThermalWalls(walls))?.into_any(),
            Force::Andersen(bath) => Py::new(py, PyAndersenThermostat(bath))?.into_any(),
            Force::Motor(motor) => Py::new(py, PyMotor(motor))?.into_any(),
            Force::Pair(pair) => Py::new(py, PyPairForce(pair))?.into_any(),
            Force::Flocking(flocking) => Py::new(py, PyFlocking(flocking))?.into_any(),
        })
    };
    PyTuple::new(py, forces.into_iter().map(one).collect::<PyResult<Vec<_>>>()?)
}
