//! The pairs of a space.

use jostle_base::ids::Id;
use jostle_base::interrupt::Pulse;
use jostle_base::sorting;
use jostle_index::Scalar;
use jostle_space::{Events, Wanted, WithCategories};
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::{Either, PySpace, long};
use crate::arrays::{Given, table, truth};
use crate::error::refused;
use crate::events::PyEvents;
use crate::keywords::refuse_unknown;
use crate::queries::{self, Maybe};
use crate::results;
use crate::settings;

#[pymethods]
impl PySpace {
    /// Find the pairs that entered and left since the last update.
    ///
    /// The current state is compared with the state at the last update; the first update
    /// compares with an empty space. A shape that was both added and removed in between has no
    /// effect. The cost depends on the shapes that changed.
    ///
    /// Parameters
    /// ----------
    /// swept : bool, default False
    ///     Whether to find also the pairs that overlap neither at the last update nor now, and
    ///     overlapped on the way: a bullet that passes a small target between two updates. They are
    ///     in `entered` and in `exited`.
    /// max_pairs : int, default 134217728
    ///     Maximum number of overlapping pairs of shapes that changed. If `swept`, also the maximum
    ///     number of pairs for which the bounding boxes of the paths overlap.
    ///
    /// Returns
    /// -------
    /// Events
    ///     Three arrays:
    ///
    ///     entered, stayed, exited : ndarray of int64, shape (m, 2)
    ///         Pairs of ids, the smaller first, sorted. `exited` may contain the ids of removed
    ///         shapes. `stayed` is computed when it is first read.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If there are more than `max_pairs`; then the call has no effect.
    ///
    /// See Also
    /// --------
    /// pairs : All overlapping pairs, without events.
    /// shape_cast : What one shape would meet along a line.
    ///
    /// Notes
    /// -----
    /// If `swept`, the path of a shape is the straight line from its centre at the last update to its
    /// present centre, whatever was set in between. All shapes travel along their paths at constant
    /// velocities in the same time. So two bullets that cross each other's path meet only if they
    /// are at the crossing at the same time. A shape that was added since the last update travels from
    /// where it was added. Removed shapes do not take part. Sizes, categories and masks are the present
    /// ones. With a period the path is the shortest of those to the images of the present centre, so
    /// a shape should move by less than half a period between two updates. To put a shape elsewhere
    /// without a path, remove it and add another one.
    ///
    /// A pair that touches on the way without overlapping is not found, as at rest. A pair that
    /// overlaps at the end has entered, and one that overlapped at the last update has exited, with
    /// `swept` or without.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> ids = space.add([(0, 0), (1, 0), (8, 0)], radii=1.0)
    /// >>> space.update().entered
    /// array([[0, 1]])
    /// >>> space.set(2, positions=(2, 0))
    /// >>> events = space.update()
    /// >>> events.entered, events.stayed
    /// (array([[1, 2]]), array([[0, 1]]))
    ///
    /// A bullet that passes a target:
    ///
    /// >>> bullet, target = space.add([(0, 50), (30, 50)], radii=1.0)
    /// >>> events = space.update()
    /// >>> space.set(bullet, positions=(60, 50))
    /// >>> events = space.update(swept=True)
    /// >>> events.entered, events.exited
    /// (array([[3, 4]]), array([[3, 4]]))
    #[pyo3(
        signature = (*, swept=Given::NOTHING, max_pairs=Given::NOTHING, **unknown),
        text_signature = "($self, *, swept=False, max_pairs=134217728)"
    )]
    fn update(
        slf: &Bound<'_, Self>,
        swept: Given<'_>,
        max_pairs: Given<'_>,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<PyEvents> {
        refuse_unknown::<Self>("update", unknown)?;
        let (swept, max_pairs) = (truth("swept", &swept)?, settings::max_pairs(&max_pairs)?);
        let this = slf.get();
        let events = with_space!(this, space => {
            long(slf.py(), space, |space| {
                if swept { space.update_swept(max_pairs) } else { space.update(max_pairs) }
            })?
            .map_err(refused)
        });
        Ok(PyEvents::of(events?, slf.clone().unbind()))
    }

    /// Find every pair of overlapping shapes.
    ///
    /// Parameters
    /// ----------
    /// sort : bool, default False
    ///     Whether to sort the pairs by the first, then by the second id. If False, their order
    ///     depends on previous calls, but not on the number of threads.
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
    ///     Ids of each pair, the smaller first, every pair once.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If more than `max_pairs` pairs overlap.
    ///
    /// See Also
    /// --------
    /// update : The pairs that entered and left.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> ids = space.add([(0, 0), (3, 0), (4, 0)], radii=1.0)
    /// >>> space.pairs()
    /// array([[1, 2]])
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
        with_space!(self, space => {
            let pairs = long(py, space, |space| {
                let distance = Scalar::from_f64(distance);
                let mut pairs = space.pairs_within(&Wanted { distance, mask, max_pairs })?;
                if sort {
                    sorting::sort(&mut pairs, &mut Pulse::current())?;
                }
                Ok(pairs)
            })?;
            table(py, pairs.map_err(refused)?)
        })
    }

    /// Find every pair of overlapping shapes, and how each overlaps.
    ///
    /// Parameters
    /// ----------
    /// sort : bool, default False
    ///     Whether to sort the contacts by the first, then by the second id of the pair. If False,
    ///     they come in the order of :meth:`pairs`.
    /// max_pairs : int, default 134217728
    ///     Maximum number of pairs to return.
    /// mask : int, optional
    ///     Find only pairs whose shapes both have a category in this set of bits.
    ///
    /// Returns
    /// -------
    /// Contacts
    ///     The pairs with their normals, depths, points and categories.
    ///
    ///     pairs : ndarray of int64, shape (m, 2)
    ///         Ids i and j of each pair, the smaller first, every pair once.
    ///     normals : ndarray of the space's dtype, shape (m, 2)
    ///         Unit vectors from i to j. If the cores of the shapes overlap, the axis
    ///         of least penetration; +x for coincident centres.
    ///     depths : ndarray of the space's dtype, shape (m,)
    ///         Penetration: the distance that j must move along the normal until the two only
    ///         touch.
    ///     points : ndarray of the space's dtype, shape (m, 2, 2)
    ///         One or two points in the middle of the overlap; NaN for a second one that does not
    ///         exist.
    ///     categories : ndarray of uint32, shape (m, 2)
    ///         The categories of i and j.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If more than `max_pairs` pairs overlap.
    ///
    /// See Also
    /// --------
    /// Quadtree.contacts : The same for a tree, or for two.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> ids = space.add([(0, 0), (0, 1.5)], radii=1.0)
    /// >>> contacts = space.contacts()
    /// >>> contacts.pairs, contacts.normals, contacts.depths
    /// (array([[0, 1]]), array([[0., 1.]]), array([0.5]))
    /// >>> contacts.points[:, 0]
    /// array([[0.  , 0.75]])
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
        with_space!(self, space => {
            let found = long(py, space, |space| space.contacts(filter, max_pairs))?;
            results::contacts(py, found.map_err(refused)?)
        })
    }
}

impl PySpace {
    /// The pairs that overlapped at both updates, unless there has been another since.
    pub fn stayed(&self, py: Python<'_>, events: &Events) -> PyResult<Option<WithCategories>> {
        with_space!(self, space => {
            long(py, space, |space| space.stayed_with_categories(events))?.map_err(refused)
        })
    }
}
