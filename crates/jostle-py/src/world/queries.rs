//! The queries of a world.

use jostle_base::Id;
use jostle_index::Each;
use jostle_index::query::{Hits, Neighbors, Ray, Region};
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::{PyWorld, State};
use crate::arrays::{Given, number, table, truth};
use crate::error::refused;
use crate::interrupt::detached;
use crate::keywords::refuse_unknown;
use crate::lock::Shared;
use crate::queries::{self, Answer, Cast, Maybe};
use crate::query_methods::{Casts, Index, NeighborIndex, query_methods};
use crate::{results, settings};

/// A world as the [`Index`] of queries.
macro_rules! with_state {
    ($self:ident, $name:ident => $do:expr) => {{
        let $name = &$self.state;
        $do
    }};
}

query_methods!(PyWorld, with_state);

impl Index<f32> for Shared<State> {
    type Id = Id;

    fn search<R: Region<f32>>(&self, regions: &[R], mask: Option<u32>) -> Answer<Hits<Id>> {
        Ok(self.lock()?.world.search(regions, mask))
    }

    fn nearest(
        &self,
        points: &[[f32; 2]],
        wanted: (usize, Each<f32>),
        mask: Option<u32>,
    ) -> Answer<Neighbors<f32>> {
        Ok(self.lock()?.world.nearest(points, wanted, mask))
    }

    fn first_hits(&self, rays: &[Ray<f32>], mask: Option<u32>) -> Answer<Casts<f32>> {
        Ok(self.lock()?.world.first_hits(rays, mask).map(Casts::from))
    }

    fn all_hits(&self, rays: &[Ray<f32>], mask: Option<u32>) -> Answer<Casts<f32>> {
        Ok(self.lock()?.world.all_hits(rays, mask).map(Casts::from))
    }
}

impl NeighborIndex<f32> for Shared<State> {
    fn neighbors(&self, distance: f32, mask: Option<u32>) -> Answer<Hits<Id>> {
        Ok(self.lock()?.world.neighbors(distance, mask))
    }
}

#[pymethods]
impl PyWorld {
    /// Find every pair of particles that overlap now.
    ///
    /// Parameters
    /// ----------
    /// sort : bool, default False
    ///     Whether to sort the pairs by the first, then by the second id. If False, they come in the
    ///     order of a tree, which is the same for every number of threads.
    /// max_pairs : int, default 134217728
    ///     Maximum number of pairs to return; the default corresponds to 2 GiB.
    /// mask : int, optional
    ///     Find only pairs whose particles both have a category in this set of bits.
    /// distance : float, default 0.0
    ///     Find pairs whose gap is below this, in units of length: each radius is increased by half
    ///     of it. If 0, the particles must overlap.
    ///
    /// Returns
    /// -------
    /// ndarray of int64, shape (m, 2)
    ///     Ids of each pair, the smaller first, every pair once.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If more than `max_pairs` pairs overlap.
    ///
    /// See Also
    /// --------
    /// contacts : The same with normals and depths.
    /// neighbors : The particles near each particle.
    ///
    /// Notes
    /// -----
    /// All queries of a world take the particles where they are now, awake and asleep, in float32, and on
    /// a periodic plane across its sides. They change no particle and no result of a step. The first query
    /// after a step or an edit builds a tree, which takes as long as a `Quadtree` of the same discs;
    /// later ones use it. For `pairs`, `contacts`, `neighbors` and `nodes` it has all particles; for the
    /// other queries only those that are awake, because sleeping islands have trees that stay.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (5, 0), (6, 0)], 1.0)
    /// >>> world.pairs()
    /// array([[1, 2]])
    /// >>> world.remove(0)
    /// >>> pairs = world.pairs()
    /// >>> pairs, world.rows(pairs)
    /// (array([[1, 2]]), array([[0, 1]]))
    #[pyo3(
        signature = (
            *, sort=Given::NOTHING, max_pairs=Given::NOTHING, mask=None, distance=Given::NOTHING, **unknown),
        text_signature = "($self, *, sort=False, max_pairs=134217728, mask=None, distance=0.0)"
    )]
    fn pairs<'py>(
        &self,
        py: Python<'py>,
        sort: Given<'py>,
        max_pairs: Given<'py>,
        mask: Maybe<'_, 'py>,
        distance: Given<'py>,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Bound<'py, PyArray2<Id>>> {
        refuse_unknown::<Self>("pairs", unknown)?;
        let (mask, distance) = (queries::mask(mask)?, settings::distance(&distance)?);
        let (sort, max_pairs) = (truth("sort", &sort)?, settings::max_pairs(&max_pairs)?);
        let pairs = self.question(py, |state| {
            state.world.pairs_within(distance as f32, (mask, sort), max_pairs)
        })?;
        table(py, pairs)
    }

    /// Find every pair of particles that overlap now, and how each overlaps.
    ///
    /// Parameters
    /// ----------
    /// sort : bool, default False
    ///     Whether to sort the contacts by the first, then by the second id of the pair. If False,
    ///     they come in the order of :meth:`pairs`.
    /// max_pairs : int, default 134217728
    ///     Maximum number of pairs to return.
    /// mask : int, optional
    ///     Find only pairs whose particles both have a category in this set of bits.
    ///
    /// Returns
    /// -------
    /// Contacts
    ///     The pairs with their normals, depths, points and categories, as from
    ///     :meth:`Space.contacts`, in float32.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If more than `max_pairs` pairs overlap.
    ///
    /// See Also
    /// --------
    /// last_step : The contacts of the last step, with impulses.
    /// pairs : The pairs alone, and what a query costs.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(9, 0), (0.5, 0)], 1.0, period=10)
    /// >>> contacts = world.contacts()
    /// >>> contacts.pairs, contacts.normals, contacts.depths
    /// (array([[0, 1]]), array([[1., 0.]], dtype=float32), array([0.5], dtype=float32))
    #[pyo3(
        signature = (*, sort=Given::NOTHING, max_pairs=Given::NOTHING, mask=None, **unknown),
        text_signature = "($self, *, sort=False, max_pairs=134217728, mask=None)"
    )]
    fn contacts<'py>(
        &self,
        py: Python<'py>,
        sort: Given<'py>,
        max_pairs: Given<'py>,
        mask: Maybe<'_, 'py>,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        refuse_unknown::<Self>("contacts", unknown)?;
        let filter = (queries::mask(mask)?, truth("sort", &sort)?);
        let max_pairs = settings::max_pairs(&max_pairs)?;
        let found = self.question(py, |state| state.world.overlaps(filter, max_pairs))?;
        results::contacts(py, found)
    }

    /// Return the boxes of the tree of all particles.
    ///
    /// Returns
    /// -------
    /// Nodes
    ///     As from :meth:`Quadtree.nodes`.
    ///
    /// See Also
    /// --------
    /// pairs : What the tree costs.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0), (1, 1), (7, 7)], 0.5, leaf_capacity=2)
    /// >>> world.nodes().counts
    /// array([3, 2, 1])
    fn nodes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let nodes = self.question(py, |state| results::NodeColumns::of(state.world.tree()?))?;
        nodes.result(py)
    }
}

impl PyWorld {
    /// The answer to a question, which may be interrupted.
    fn question<R: Send>(
        &self,
        py: Python<'_>,
        ask: impl FnOnce(&State) -> jostle_base::Result<R> + Send,
    ) -> PyResult<R> {
        let answer = || -> Answer<R> { Ok(ask(&*self.state.lock()?)) };
        detached(py, answer)??.map_err(refused)
    }
}
