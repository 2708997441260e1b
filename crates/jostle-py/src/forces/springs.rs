//! `jostle.Springs`.

use jostle_base::memory;
use jostle_index::Each;
use jostle_world::forces::{Spring, Springs};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arguments::arguments;
use super::valid;
use crate::arrays::{Argument, reals};
use crate::error::refused;
use crate::keywords::Keywords;

/// Springs between pairs of particles.
///
/// The force of each spring is stiffness times stretch plus damping times the rate of
/// lengthening. Stiff springs are integrated in parts of a sub-step, whose number is limited;
/// the stiffness is reduced if more would be necessary. Where discs with stiff springs touch
/// anything, the springs are solved together with the contacts: then bodies rest at any stiffness,
/// but their oscillations lose energy. Springs are stiff for a disc if their stiffness in all,
/// divided by its mass and times the square of the sub-step, is more than 1.45. If one of its ends is
/// removed, a spring is removed too.
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
/// IdError
///     When it is assigned to `World.forces`, if no particle has an id.
///
/// See Also
/// --------
/// Attractor : A force towards a point.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> tie = jostle.Springs([(0, 1)], lengths=2.0, stiffness=40.0, damping=4.0)
/// >>> world = jostle.World([(0, 0), (3, 0)], 0.5, masses=1.0, forces=[tie])
/// >>> world.step(0.01, steps=500)
/// >>> world.positions.round(3)
/// array([[0.5, 0. ],
///        [2.5, 0. ]], dtype=float32)
#[pyclass(module = "jostle", name = "Springs", frozen, eq)]
#[derive(PartialEq)]
pub struct PySprings(pub Springs);

#[pymethods]
impl PySprings {
    #[new]
    #[pyo3(
        signature = (*arguments, **keywords),
        text_signature = "(pairs, lengths, stiffness, *, damping=0.0, max_stretch=None)"
    )]
    fn new(arguments: &Bound<'_, PyTuple>, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let names = ["pairs", "lengths", "stiffness"];
        let mut given = Keywords::of_all("Springs()", &names, arguments, keywords)?;
        let [pairs, lengths, stiffness] = given.require(names)?;
        let damping = given.given("damping");
        let max_stretch = given.take_some("max_stretch");
        given.end()?;
        let pairs = Argument::integers("pairs", &pairs)?.id_pairs()?;
        let len = pairs.len();
        let column = |name, value: Option<&Bound<'_, PyAny>>, default| -> PyResult<Each<f32>> {
            Ok(reals(name, value, len)?.unwrap_or(Each::One(default)))
        };
        let lengths = column("lengths", Some(&lengths), 0.0)?;
        let stiffness = column("stiffness", Some(&stiffness), 0.0)?;
        let damping = column("damping", damping.value(), 0.0)?;
        let max_stretch = column("max_stretch", max_stretch.as_ref(), f32::INFINITY)?;
        let spring = |row: usize| Spring {
            pair: pairs[row],
            length: lengths.at(row),
            stiffness: stiffness.at(row),
            damping: damping.at(row),
            max_stretch: max_stretch.at(row),
        };
        Ok(Self(valid(
            Springs(memory::collect((0..len).map(spring)).map_err(refused)?),
            Springs::validate,
        )?))
    }

    fn __len__(&self) -> usize {
        self.0.0.len()
    }

    fn __repr__(&self) -> String {
        format!("<jostle.Springs between {} pairs>", self.0.0.len())
    }
}

impl PySprings {
    fn column<V>(&self, value: fn(&Spring) -> V) -> Vec<V> {
        self.0.0.iter().map(value).collect()
    }
}

arguments! {
    PySprings {
        /// Ids of the ends: read-only ndarray of int64, shape (m, 2).
        pairs: |own| own.column(|spring| spring.pair);
        /// Lengths at rest: read-only ndarray of float32, shape (m,).
        lengths: |own| own.column(|spring| spring.length);
        /// Force per unit of stretch: read-only ndarray of float32, shape (m,).
        stiffness: |own| own.column(|spring| spring.stiffness);
    }
    keywords {
        /// Force per unit of speed: read-only ndarray of float32, shape (m,).
        damping: |own| own.column(|spring| spring.damping);
        /// Stretch beyond which each breaks: read-only ndarray of float32, shape (m,); infinite if it
        /// never breaks.
        max_stretch: |own| own.column(|spring| spring.max_stretch);
    }
}
