//! Free positions for new particles.

use jostle_index::Each;
use jostle_world::{Container, NewDiscs};
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::PyWorld;
use crate::arrays::{Argument, Given, count, number, table};
use crate::containers;
use crate::error::refused;
use crate::forces::read_seed;
use crate::interrupt::detached;
use crate::keywords::read;

#[pymethods]
impl PyWorld {
    /// Return random positions at which new discs touch nothing.
    ///
    /// The discs touch neither each other nor particles, walls or the sides of the container, at their
    /// present places. Sensors, walls among them, do not count; filters make no difference. Nothing is added. The
    /// positions are those of random sequential addition: one after the other, large discs first, each
    /// uniform among the positions that are still free. So discs of one radius fill at most about
    /// 54 % of a region.
    ///
    /// Parameters
    /// ----------
    /// n : int
    ///     Number of discs.
    /// radii : array_like, a number or shape (n,)
    ///     In units of length.
    /// region : Box or Circle, optional
    ///     The discs lie inside of it entirely. If omitted, the container or the period of the world;
    ///     required in a world that has neither.
    /// gap : float, default 0
    ///     Least distance of surfaces from each other, in units of length, also from walls and the
    ///     sides of the container.
    /// seed : int, default 0
    ///     Seed of the random numbers, below 2³². The same seed gives the same positions on every machine.
    ///
    /// Returns
    /// -------
    /// ndarray of float32, shape (n, 2)
    ///     Centres in the order of `radii`.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If an argument has the wrong type.
    /// ValueError
    ///     If there is no room for all discs, with the number that found room; if a radius does not fit
    ///     into the region or the container; if there is no region, or a number is out of range.
    ///
    /// See Also
    /// --------
    /// add : Add particles at the positions.
    /// separate : Move shapes apart, also those that are denser.
    ///
    /// Notes
    /// -----
    /// For each disc up to 100,000 positions are tried. A disc finds room if about one position in
    /// 10,000 is free.
    ///
    /// References
    /// ----------
    /// B. Widom, *Random Sequential Addition of Hard Spheres to a Volume*, Journal of Chemical Physics
    /// 44 (1966).
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World(container=jostle.Box(0, 0, 40, 30))
    /// >>> ids = world.add(world.free_positions(100, 1.0, seed=1), 1.0)
    /// >>> len(world.pairs())
    /// 0
    /// >>> corner = world.free_positions(1, 0.5, region=jostle.Box(0, 0, 20, 20), gap=0.1)
    /// >>> corner.shape
    /// (1, 2)
    #[pyo3(
        signature = (n=Given::NOTHING, radii=Given::NOTHING, *, region=None, gap=Given::NOTHING, seed=Given::NOTHING, **unknown),
        text_signature = "($self, n, radii, *, region=None, gap=0.0, seed=0)"
    )]
    #[expect(clippy::too_many_arguments, reason = "they are Python's keywords")]
    fn free_positions<'py>(
        &self,
        py: Python<'py>,
        n: Given<'py>,
        radii: Given<'py>,
        region: Option<&Bound<'py, PyAny>>,
        gap: Given<'py>,
        seed: Given<'py>,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let [n, radii] =
            read::<Self, 2>("free_positions", unknown, [("n", &n), ("radii", &radii)])?;
        let count = count("n", n, 0)?;
        let radii: Each<f32> = Argument::reals("radii", radii)?.real_each(count)?;
        let (container, _) = containers::read("region", region)?;
        let discs = NewDiscs {
            count,
            radii: &radii,
            region: (container != Container::None).then_some(container),
            gap: gap.value().map_or(Ok(0.0), |gap| number("gap", gap))? as f32,
            seed: read_seed(&seed)?,
        };
        // After an interruption the result is not used.
        let found =
            detached(py, || self.state.lock().map(|state| state.world.free_positions(&discs)));
        table(py, found??.map_err(refused)?)
    }
}
