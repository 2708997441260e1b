//! `jostle.Gravitation`.

use jostle_world::forces::Gravitation;
use jostle_world::forces::gravitation::DEFAULT_THETA;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arguments::{arguments, plain_arguments};
use super::{real, real_or, valid};
use crate::keywords::Keywords;

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
/// >>> world = jostle.World(
/// ...     [(-2, 0), (2, 0)], .1, velocities=[(0, -.25), (0, .25)], masses=1.0, forces=[pull]
/// ... )
/// >>> world.step(0.1, steps=100)
/// >>> [abs(round(p, 5)) for p in world.momentum().tolist()]
/// [0.0, 0.0]
#[pyclass(module = "jostle", name = "Gravitation", frozen, eq)]
#[derive(PartialEq)]
pub struct PyGravitation(pub Gravitation);

// The default in the signature.
const _: () = assert!(DEFAULT_THETA == 0.5);

#[pymethods]
impl PyGravitation {
    #[new]
    #[pyo3(
        signature = (*arguments, **keywords),
        text_signature = "(G, softening=0.0, theta=0.5)"
    )]
    fn new(arguments: &Bound<'_, PyTuple>, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let names = ["G", "softening", "theta"];
        let mut given = Keywords::of_all("Gravitation()", &names, arguments, keywords)?;
        let [g] = given.require(["G"])?;
        let (softening, theta) = (given.given("softening"), given.given("theta"));
        given.end()?;
        let (g, softening) = (real("G", &g)?, real_or("softening", &softening, 0.0)?);
        let theta = real_or("theta", &theta, DEFAULT_THETA)?;
        Ok(Self(valid(Gravitation { g, softening, theta }, Gravitation::validate)?))
    }
}

arguments! { PyGravitation {
    /// The gravitational constant.
    G: |own| own.0.g;
    /// Distance below which the force is reduced, in units of length.
    softening: |own| own.0.softening;
    /// Diagonal divided by distance below which a box is treated as one body.
    theta: |own| own.0.theta;
}}
plain_arguments!(PyGravitation);
