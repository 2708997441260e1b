//! Pairs and contacts within a tree, and between two.

use std::sync::atomic::Ordering;

use jostle_index::Scalar;
use jostle_index::pairs::{self, Overlaps};
use numpy::{Element, PyArray2};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::{PyQuadtree, Tree};
use crate::arrays::{Given, long, table, truth};
use crate::error::{refused, type_error};
use crate::interrupt::detached;
use crate::keywords::refuse_unknown;
use crate::queries::{self, Maybe};
use crate::{results, settings};

#[pymethods]
impl PyQuadtree {
    /// Find every pair of overlapping shapes in this tree, or between it and another.
    ///
    /// Parameters
    /// ----------
    /// other : Quadtree, optional
    ///     A tree of the same dtype. If omitted, the pairs are those within this tree, ``i < j``.
    ///     If `other` is this tree, it is treated as any other tree: each pair comes in both
    ///     orders, and each shape with an area pairs with itself.
    /// sort : bool, default False
    ///     Whether to sort the pairs by the first, then by the second shape. If False, they
    ///     come in the order of this tree, which is the same for every number of threads.
    /// max_pairs : int, default 134217728
    ///     Maximum number of pairs to return; the default corresponds to 2 GiB.
    /// mask : int, optional
    ///     Find only pairs whose shapes both have a category in this set of bits.
    /// distance : float, default 0.0
    ///     Find pairs whose gap is below this, in units of length: each radius is increased by half
    ///     of it. If 0, the shapes must overlap.
    ///
    /// Returns
    /// -------
    /// ndarray of int64, shape (m, 2)
    ///     Row numbers ``i < j`` of each pair, every pair once; with `other`, i is
    ///     a row of this tree and j a row of the other.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If the dtypes of the two trees differ.
    /// ValueError
    ///     If more than `max_pairs` pairs overlap.
    ///
    /// See Also
    /// --------
    /// contacts : The same with normals and depths.
    /// find_pairs : The pairs of arrays, without a tree.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> rocks = jostle.Quadtree([(0, 0), (3, 0), (4, 0)], radii=1.0)
    /// >>> shots = jostle.Quadtree([(0.5, 0), (9, 0)], radii=0.1)
    /// >>> rocks.pairs(shots)
    /// array([[0, 0]])
    #[pyo3(
        signature = (
            other=None, *, sort=Given::NOTHING, max_pairs=Given::NOTHING, mask=None,
            distance=Given::NOTHING, **unknown),
        text_signature = "($self, other=None, *, sort=False, max_pairs=134217728, mask=None, \
                          distance=0.0)"
    )]
    #[expect(clippy::too_many_arguments, reason = "they are Python's keywords")]
    fn pairs<'py>(
        &self,
        py: Python<'py>,
        other: Maybe<'_, 'py>,
        sort: Given<'py>,
        max_pairs: Given<'py>,
        mask: Maybe<'_, 'py>,
        distance: Given<'py>,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Bound<'py, PyArray2<i64>>> {
        refuse_unknown::<Self>("pairs", unknown)?;
        let (mask, distance) = (queries::mask(mask)?, settings::distance(&distance)?);
        let (sort, max_pairs) = (truth("sort", &sort)?, settings::max_pairs(&max_pairs)?);
        let other = other.map(|other| self.partner(other)).transpose()?;
        let found = detached(py, || {
            let other = other.as_ref().map(|other| &other.get().tree);
            let mut found = match (&self.tree, other) {
                (Tree::Single(tree), other) => {
                    let other = other.and_then(Tree::single);
                    pairs::near(tree, other, distance as f32, mask, max_pairs)
                }
                (Tree::Double(tree), other) => {
                    let other = other.and_then(Tree::double);
                    pairs::near(tree, other, distance, mask, max_pairs)
                }
            }?;
            if sort {
                found.sort()?;
            }
            Ok((long(&found.pairs)?, found.tests))
        })?;
        let (pairs, tests) = found.map_err(refused)?;
        // Relaxed: a number for statistics; no other memory depends on it.
        self.tests.store(tests, Ordering::Relaxed);
        table(py, pairs)
    }

    /// Find every pair of overlapping shapes in this tree, or between it and another, and how each
    /// overlaps.
    ///
    /// Parameters
    /// ----------
    /// other : Quadtree, optional
    ///     A tree of the same dtype and period. If omitted, the pairs are those within this tree,
    ///     ``i < j``.
    /// sort : bool, default False
    ///     Whether to sort the contacts by the first, then by the second shape of the pair. If
    ///     False, they come in the order of :meth:`pairs`.
    /// max_pairs : int, default 134217728
    ///     Maximum number of pairs to return. Each takes 80 bytes, in float32 52, and about as
    ///     much during the search; memory is allocated only for the pairs that are found.
    /// mask : int, optional
    ///     Find only pairs whose shapes both have a category in this set of bits.
    ///
    /// Returns
    /// -------
    /// Contacts
    ///     Five arrays:
    ///
    ///     pairs : ndarray of int64, shape (m, 2)
    ///         As from :meth:`pairs`: row numbers i and j.
    ///     normals : ndarray of the tree's dtype, shape (m, 2)
    ///         Unit vectors from i to j. If the cores of the shapes overlap, the axis
    ///         of least penetration; +x for coincident centres.
    ///     depths : ndarray of the tree's dtype, shape (m,)
    ///         Penetration: the distance that j must move along the normal until the two only
    ///         touch.
    ///     points : ndarray of the tree's dtype, shape (m, 2, 2)
    ///         One or two points in the middle of the overlap; NaN for a second one that does not
    ///         exist.
    ///     categories : ndarray of uint32, shape (m, 2)
    ///         The categories of i and j.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If the dtypes of the two trees differ.
    /// ValueError
    ///     If the periods of the two trees differ, or more than `max_pairs` pairs overlap.
    /// MemoryError
    ///     If there is no memory for the contacts.
    ///
    /// See Also
    /// --------
    /// pairs : The pairs alone.
    /// World.last_step : The contacts of particles in the last step, with impulses.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> tree = jostle.Quadtree([(0, 0), (0, 1.5)], radii=1.0)
    /// >>> contacts = tree.contacts()
    /// >>> contacts.pairs, contacts.normals, contacts.depths
    /// (array([[0, 1]]), array([[0., 1.]]), array([0.5]))
    /// >>> walls = jostle.Quadtree(boxes=[(-9, 0.5, 9, 2)])
    /// >>> tree.contacts(walls, sort=True).depths
    /// array([0.5, 1.5])
    #[pyo3(
        signature = (other=None, *, sort=Given::NOTHING, max_pairs=Given::NOTHING, mask=None, **unknown),
        text_signature = "($self, other=None, *, sort=False, max_pairs=134217728, mask=None)"
    )]
    fn contacts<'py>(
        &self,
        py: Python<'py>,
        other: Maybe<'_, 'py>,
        sort: Given<'py>,
        max_pairs: Given<'py>,
        mask: Maybe<'_, 'py>,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        refuse_unknown::<Self>("contacts", unknown)?;
        let filter = (queries::mask(mask)?, truth("sort", &sort)?);
        let max_pairs = settings::max_pairs(&max_pairs)?;
        let other = other.map(|other| self.partner(other)).transpose()?;
        let other = other.as_ref().map(|other| &other.get().tree);
        match &self.tree {
            Tree::Single(tree) => {
                let other = other.and_then(Tree::single);
                self.overlaps(py, || pairs::overlaps(tree, other, filter, max_pairs))
            }
            Tree::Double(tree) => {
                let other = other.and_then(Tree::double);
                self.overlaps(py, || pairs::overlaps(tree, other, filter, max_pairs))
            }
        }
    }
}

impl PyQuadtree {
    /// Runs a search for contacts and converts them.
    fn overlaps<'py, T: Scalar + Element>(
        &self,
        py: Python<'py>,
        search: impl FnOnce() -> jostle_base::Result<Overlaps<T, u32>> + Send,
    ) -> PyResult<Bound<'py, PyAny>> {
        let found = detached(py, search)?.map_err(refused)?;
        // Relaxed: a number for statistics; no other memory depends on it.
        self.tests.store(found.tests, Ordering::Relaxed);
        results::contacts(py, found)
    }

    /// The other tree of a pair, if it computes as this one does.
    fn partner(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<Self>> {
        let Ok(tree) = other.cast::<Self>() else {
            return Err(type_error("other", "a Quadtree", other));
        };
        let (own, found) = (self.tree.dtype(), tree.get().tree.dtype());
        if own == found {
            let (own, found) = (self.sides(), tree.get().sides());
            if own != found {
                return Err(PyValueError::new_err(format!(
                    "other has period={found:?} and this tree period={own:?}; build both with the \
                     same period"
                )));
            }
            return Ok(tree.clone().unbind());
        }
        Err(PyTypeError::new_err(format!(
            "other computes in {found} and this tree in {own}; build both from float32 arrays, or \
             both from float64 arrays (a list counts as float64)"
        )))
    }
}

impl Tree {
    fn single(&self) -> Option<&jostle_index::Quadtree<f32>> {
        if let Self::Single(tree) = self { Some(tree) } else { None }
    }

    fn double(&self) -> Option<&jostle_index::Quadtree<f64>> {
        if let Self::Double(tree) = self { Some(tree) } else { None }
    }
}
