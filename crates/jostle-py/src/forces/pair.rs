//! `jostle.PairForce`.

use std::sync::Arc;

use jostle_base::Error;
use jostle_base::error::counted;
use jostle_world::forces::{PairForce, PairTable};
use numpy::ndarray::Array3;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arguments::arguments;
use super::{real, real_or};
use crate::arrays::{Argument, Given, decimal};
use crate::error::refused;
use crate::keywords::{Keywords, read};

/// Forces between kinds of particles within a cutoff.
///
/// The force on a particle of kind a by one of kind b is a function of their distance. It is given
/// at m equally spaced distances from 0 to `cutoff`, and linear between. The forces on each other
/// need not be equal and opposite. The constructors `particle_life`, `lennard_jones` and
/// `soft_discs` make well-known tables.
///
/// Parameters
/// ----------
/// table : array_like, shape (K, K, m)
///     ``table[a, b, k]`` is the force on kind a by kind b at the distance ``k * cutoff / (m - 1)``.
///     It is positive if kind a is repelled. K is at most 64, m at least 2.
/// cutoff : float
///     Distance from which there is no force, in units of length. On a torus at most half of each
///     side.
/// damping : float, default 0.0
///     Force that resists a relative speed of 1 along the line between two particles, at distance 0;
///     at the distance d it is ``damping * (1 - d / cutoff)**2``.
///
/// Raises
/// ------
/// TypeError
///     If an argument has the wrong type.
/// ValueError
///     If a shape is wrong or a number is out of range. When it is assigned to `World.forces`, also if
///     the table does not have the kind of a particle, or the cutoff is too large for the torus.
///
/// See Also
/// --------
/// Flocking : Another force between neighbours.
/// Gravitation : A force without a cutoff.
///
/// Notes
/// -----
/// Kinds belong to the particles: `World.kinds` has them, and they are the same for all `PairForce` of
/// a world. Merged particles have the kind of the heaviest. The forces act at the positions in the
/// middle of a sub-step (leapfrog), the damping with the velocities at its beginning. If no other
/// force acts and nothing rests, a step has one sub-step; choose the length of a step for the
/// steepest force, or more `World.substeps`. `World.potential_energy` includes forces that are
/// equal and opposite for all kinds.
///
/// Examples
/// --------
/// Kind 0 follows kind 1, which flees:
///
/// >>> import jostle
/// >>> table = [[[0, 0], [-1, -1]], [[1, 1], [0, 0]]]
/// >>> force = jostle.PairForce(table, cutoff=5.0)
/// >>> world = jostle.World([(0, 0), (2, 0)], 0.1, masses=1.0, kinds=[0, 1], forces=[force])
/// >>> world.step(0.1, steps=10)
/// >>> world.velocities.round(3)
/// array([[1., 0.],
///        [1., 0.]], dtype=float32)
#[pyclass(module = "jostle", name = "PairForce", frozen, eq)]
#[derive(PartialEq)]
pub struct PyPairForce(pub PairForce);

#[pymethods]
impl PyPairForce {
    #[new]
    #[pyo3(
        signature = (*arguments, **keywords),
        text_signature = "(table, cutoff, *, damping=0.0)"
    )]
    fn new(arguments: &Bound<'_, PyTuple>, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let names = ["table", "cutoff"];
        let mut given = Keywords::of_all("PairForce()", &names, arguments, keywords)?;
        let [table, cutoff] = given.require(names)?;
        let damping = given.given("damping");
        given.end()?;
        let (count, values) = Argument::reals("table", &table)?.cube()?;
        let cutoff = real("cutoff", &cutoff)?;
        let damping = real_or("damping", &damping, 0.0)?;
        Self::of(PairTable::new(count, values, cutoff, damping))
    }

    /// Particle life: kinds attract and repel each other, not always mutually.
    ///
    /// Within ``core * cutoff`` all particles repel each other, with the force `strength` at
    /// distance 0. From there to the cutoff, kind a is attracted by kind b with the force
    /// ``matrix[a, b] * strength`` in the middle, which decreases to 0 on both sides.
    ///
    /// Parameters
    /// ----------
    /// matrix : array_like, shape (K, K)
    ///     Attraction of kind a (row) by kind b (column), usually -1 to 1; negative values repel.
    /// cutoff : float
    ///     Distance from which there is no force, in units of length.
    /// core : float, default 0.3
    ///     Share of the cutoff within which all repel each other, between 0 and 1.
    /// strength : float, default 1.0
    ///     Factor of all forces.
    ///
    /// Returns
    /// -------
    /// PairForce
    ///     The force with this table.
    ///
    /// Raises
    /// ------
    /// TypeError, ValueError
    ///     As for `PairForce`.
    ///
    /// See Also
    /// --------
    /// jostle.life : Matrices with interesting results.
    ///
    /// Notes
    /// -----
    /// The forces are not conservative, so the world needs a `drag`.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> force = jostle.PairForce.particle_life([[1, -0.5], [0.5, 1]], cutoff=4.0)
    /// >>> force.table.shape
    /// (2, 2, 21)
    #[staticmethod]
    #[pyo3(
        signature = (matrix=Given::NOTHING, cutoff=Given::NOTHING, core=Given::NOTHING, *, strength=Given::NOTHING, **unknown),
        text_signature = "(matrix, cutoff, core=0.3, *, strength=1.0)"
    )]
    fn particle_life(
        matrix: Given<'_>,
        cutoff: Given<'_>,
        core: Given<'_>,
        strength: Given<'_>,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let [matrix, cutoff] =
            read::<Self, 2>("particle_life", unknown, [("matrix", &matrix), ("cutoff", &cutoff)])?;
        let (count, matrix) = Argument::reals("matrix", matrix)?.square(None)?;
        let cutoff = real("cutoff", cutoff)?;
        let core = real_or("core", &core, 0.3)?;
        let strength = real_or("strength", &strength, 1.0)?;
        Self::of(PairTable::particle_life(count, &matrix, cutoff, core, strength))
    }

    /// The Lennard-Jones force, truncated at the cutoff.
    ///
    /// The potential energy is ``4 * epsilon * ((sigma / d)**12 - (sigma / d)**6)``, shifted to 0 at
    /// the cutoff. Below ``sigma / 2`` the force is that at ``sigma / 2``.
    ///
    /// Parameters
    /// ----------
    /// epsilon : array_like, a number or shape (K, K)
    ///     Depth of the potential, in units of energy, at least 0.
    /// sigma : array_like, a number or shape (K, K)
    ///     Distance at which it is 0, in units of length. The minimum is at ``2**(1/6) * sigma``.
    /// cutoff : float
    ///     Distance from which there is no force, usually 2.5 times the largest sigma.
    ///
    /// Returns
    /// -------
    /// PairForce
    ///     The force with this table.
    ///
    /// Raises
    /// ------
    /// TypeError, ValueError
    ///     As for `PairForce`.
    ///
    /// See Also
    /// --------
    /// World.potential_energy : The sum of these potentials, among others.
    ///
    /// Notes
    /// -----
    /// With sub-steps of ``0.002 * sigma * sqrt(m / epsilon)`` seconds the energy of a fluid varies by
    /// less than 0.1 % of its kinetic energy. Use ``on_touch="ignore"``, so that the particles do not
    /// also collide as discs.
    ///
    /// References
    /// ----------
    /// J. E. Jones, *On the determination of molecular fields II*, Proceedings of the Royal Society A
    /// 106, 463 (1924).
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> force = jostle.PairForce.lennard_jones(epsilon=1.0, sigma=1.0, cutoff=2.5)
    /// >>> apart = [(0, 0), (2 ** (1 / 6), 0)]
    /// >>> world = jostle.World(apart, 0.1, on_touch="ignore", forces=[force])
    /// >>> round(world.potential_energy(), 3)
    /// -0.984
    #[staticmethod]
    #[pyo3(
        signature = (epsilon=Given::NOTHING, sigma=Given::NOTHING, cutoff=Given::NOTHING, **unknown),
        text_signature = "(epsilon, sigma, cutoff)"
    )]
    fn lennard_jones(
        epsilon: Given<'_>,
        sigma: Given<'_>,
        cutoff: Given<'_>,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let [epsilon, sigma, cutoff] = read::<Self, 3>(
            "lennard_jones",
            unknown,
            [("epsilon", &epsilon), ("sigma", &sigma), ("cutoff", &cutoff)],
        )?;
        let squares = Squares::read([("epsilon", epsilon), ("sigma", sigma)])?;
        let (count, [epsilon, sigma]) = (squares.count, &squares.all);
        let cutoff = real("cutoff", cutoff)?;
        let table = PairTable::lennard_jones(count, epsilon, sigma, cutoff);
        Self::of(table.map_err(|error| squares.of_numbers(error)))
    }

    /// Soft discs, which repel each other with a force proportional to their overlap.
    ///
    /// Parameters
    /// ----------
    /// stiffness : array_like, a number or shape (K, K)
    ///     Force per unit of overlap, at least 0.
    /// diameters : array_like, a number or shape (K, K)
    ///     Distance below which two kinds overlap, in units of length. The largest is the cutoff.
    /// damping : float, default 0.0
    ///     As for `PairForce`.
    ///
    /// Returns
    /// -------
    /// PairForce
    ///     The force with this table.
    ///
    /// Raises
    /// ------
    /// TypeError, ValueError
    ///     As for `PairForce`.
    ///
    /// See Also
    /// --------
    /// separate : Moves shapes apart without forces.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> force = jostle.PairForce.soft_discs(stiffness=100.0, diameters=2.0)
    /// >>> world = jostle.World([(0, 0), (1, 0)], 1, on_touch="ignore", forces=[force])
    /// >>> world.potential_energy()
    /// 50.0
    #[staticmethod]
    #[pyo3(
        signature = (stiffness=Given::NOTHING, diameters=Given::NOTHING, *, damping=Given::NOTHING, **unknown),
        text_signature = "(stiffness, diameters, *, damping=0.0)"
    )]
    fn soft_discs(
        stiffness: Given<'_>,
        diameters: Given<'_>,
        damping: Given<'_>,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let [stiffness, diameters] = read::<Self, 2>(
            "soft_discs",
            unknown,
            [("stiffness", &stiffness), ("diameters", &diameters)],
        )?;
        let squares = Squares::read([("stiffness", stiffness), ("diameters", diameters)])?;
        let (count, [stiffness, diameters]) = (squares.count, &squares.all);
        let damping = real_or("damping", &damping, 0.0)?;
        let table = PairTable::soft_discs(count, stiffness, diameters, damping);
        Self::of(table.map_err(|error| squares.of_numbers(error)))
    }

    /// Whether all kinds act on each other with equal and opposite forces, so that momentum is
    /// conserved: bool.
    #[getter]
    fn reciprocal(&self) -> bool {
        self.0.table.is_reciprocal()
    }

    fn __repr__(&self) -> String {
        let table = &self.0.table;
        let (kinds, cutoff) = (counted(table.kinds(), "kind"), decimal(table.cutoff()));
        format!("<jostle.PairForce of {kinds}, cutoff {cutoff:?}>")
    }
}

arguments! {
    PyPairForce {
        /// The forces: read-only ndarray of float32, shape (K, K, m).
        table: |own| {
            let table = &own.0.table;
            let shape = (table.kinds(), table.kinds(), table.points());
            Array3::from_shape_vec(shape, table.values().to_vec()).expect("a table has this shape")
        };
        /// Distance from which there is no force, in units of length.
        cutoff: |own| own.0.table.cutoff();
    }
    keywords {
        /// Force that resists a relative speed of 1 at distance 0.
        damping: |own| own.0.table.damping();
    }
}

impl PyPairForce {
    fn of(table: jostle_base::Result<PairTable>) -> PyResult<Self> {
        Ok(Self(PairForce { table: Arc::new(table.map_err(refused)?) }))
    }
}

/// Two matrices, each of which may be given as one number for all pairs of kinds.
struct Squares {
    /// Number of kinds: the size of a matrix, 1 if both are numbers.
    count: usize,
    all: [Vec<f32>; 2],
    /// The arguments that are given as a number.
    numbers: Vec<&'static str>,
}

impl Squares {
    fn read(arguments: [(&'static str, &Bound<'_, PyAny>); 2]) -> PyResult<Self> {
        let [a, b] = arguments.map(|(name, value)| Argument::reals(name, value));
        let [a, b] = [a?, b?];
        let count = a.side().or(b.side()).unwrap_or(1);
        let all = [a.square(Some(count))?.1, b.square(Some(count))?.1];
        let names = arguments.iter().zip([a, b]);
        let numbers = names.filter(|(_, value)| value.is_scalar()).map(|((name, _), _)| *name);
        Ok(Self { count, all, numbers: numbers.collect() })
    }

    /// An error without an index, if it is about an argument that is a number.
    fn of_numbers(&self, error: Error) -> Error {
        match &error {
            Error::Entry { argument, .. } if self.numbers.contains(argument) => error.without_row(),
            _ => error,
        }
    }
}
