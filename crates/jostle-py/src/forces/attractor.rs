//! `jostle.Attractor`.

use jostle_world::forces::{Attractor, Law, Pole};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arguments::{arguments, plain_arguments};
use super::{real, valid};
use crate::arrays::{Given, point, word};
use crate::error::value_error;
use crate::ids::one_id;
use crate::keywords::Keywords;

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
/// IdError
///     When it is assigned to `World.forces`, if no particle has the id.
///
/// See Also
/// --------
/// Gravitation : Attraction between all particles.
/// World.apply_force : Forces from NumPy.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> pull = jostle.Attractor((0, 0), 4.0)
/// >>> world = jostle.World([(3, 0)], 1.0, forces=[pull])
/// >>> world.step(0.0078539816, steps=200)  # half a period, π/2 seconds
/// >>> world.positions.round(3)
/// array([[-3.,  0.]], dtype=float32)
/// >>> jostle.Attractor(particle=0, strength=9.0, law="inverse_square")
/// Attractor(None, 9.0, 'inverse_square', particle=0)
#[pyclass(module = "jostle", name = "Attractor", frozen, eq)]
#[derive(PartialEq)]
pub struct PyAttractor(pub Attractor);

#[pymethods]
impl PyAttractor {
    #[new]
    #[pyo3(
        signature = (*arguments, **keywords),
        text_signature = "(point=None, strength=None, law='harmonic', *, particle=None)"
    )]
    fn new(arguments: &Bound<'_, PyTuple>, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let names = ["point", "strength", "law"];
        let mut given = Keywords::of_all("Attractor()", &names, arguments, keywords)?;
        let [point, strength, particle] = given.take_all(["point", "strength", "particle"]);
        let law = given.given("law");
        given.end()?;
        let pole = match (&point, &particle) {
            (Some(point), None) => Pole::Point(self::point("point", point)?),
            (None, Some(particle)) => Pole::Particle(one_id("particle", particle, "particle")?),
            _ => {
                let rule = "an Attractor needs either a point or a particle";
                return Err(PyTypeError::new_err(rule));
            }
        };
        let Some(strength) = strength else {
            return Err(PyTypeError::new_err("an Attractor needs a strength"));
        };
        let (strength, law) = (real("strength", &strength)?, read_law(&law)?);
        Ok(Self(valid(Attractor { pole, strength, law }, Attractor::validate)?))
    }
}

arguments! {
    PyAttractor {
        /// The attracting point, (x, y); None if it is a particle.
        point: |own| match own.0.pole {
            Pole::Point(point) => Some(point),
            Pole::Particle(_) => None,
        };
        /// Acceleration per unit of distance, or G times the attracting mass.
        strength: |own| own.0.strength;
        /// "harmonic" or "inverse_square".
        law: |own| match own.0.law {
            Law::Harmonic => "harmonic",
            Law::InverseSquare => "inverse_square",
        };
    }
    keywords {
        /// Id of the attracting particle, or None.
        particle: |own| match own.0.pole {
            Pole::Point(_) => None,
            Pole::Particle(id) => Some(id),
        };
    }
}
plain_arguments!(PyAttractor);

fn read_law(given: &Given<'_>) -> PyResult<Law> {
    let rule = "'harmonic' or 'inverse_square'";
    match word("law", given, rule)?.as_deref() {
        None | Some("harmonic") => Ok(Law::Harmonic),
        Some("inverse_square") => Ok(Law::InverseSquare),
        Some(other) => Err(value_error("law", format!("'{other}'"), rule)),
    }
}
