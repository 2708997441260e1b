//! Queries of the nearest shapes of a point, and of the neighbours of every shape.

macro_rules! near_methods {
    ($class:ident, $with_index:ident) => {
        #[pymethods]
        impl $class {
            /// Find the shapes nearest to a point, or to each of many.
            ///
            /// Parameters
            /// ----------
            /// point : array_like, shape (2,) or (n, 2)
            ///     Points.
            /// k : int, default 1
            ///     Number of shapes to find.
            /// max_distance : array_like, a number or shape (n,), default inf
            ///     Ignore shapes farther than this, in units of length.
            /// mask : int, optional
            ///     Find only shapes with a category in this set of bits.
            /// exclude : int or array_like of int, shape (n,), optional
            ///     An id that is not found, one for all points or one for each; -1 is none, as is an id
            ///     that nothing has.
            ///
            /// Returns
            /// -------
            /// Neighbors
            ///     With the fields:
            ///
            ///     ids : ndarray of int64, shape (k,) or (n, k)
            ///         Ids, the smaller first at equal distances; -1 if fewer than k are found; remove
            ///         those before you use them as an index.
            ///     distances : ndarray of float32 or float64, shape (k,) or (n, k)
            ///         Distances to the surfaces, nearest first; 0 inside a shape, infinity if
            ///         fewer than k are found.
            ///
            /// Raises
            /// ------
            /// ValueError
            ///     If a coordinate is not finite, k is less than 1, k times the number of points is
            ///     more than 134217728, or `max_distance` is negative.
            ///
            /// See Also
            /// --------
            /// query_circle : All shapes within a distance.
            /// raycast : The first shape in a direction.
            ///
            /// References
            /// ----------
            /// N. Roussopoulos, S. Kelley and F. Vincent, *Nearest Neighbor Queries*, SIGMOD (1995).
            ///
            /// Examples
            /// --------
            /// >>> import jostle
            /// >>> tree = jostle.Quadtree([(0, 0), (3, 0), (5, 0)], radii=1.0)
            /// >>> tree.nearest((2, 0), k=2)
            /// Neighbors(ids=array([1, 0]), distances=array([0., 1.]))
            /// >>> tree.nearest((2, 0), exclude=1).ids
            /// array([0])
            #[pyo3(
                signature = (point=Given::NOTHING, k=Given::NOTHING, *, max_distance=Given::NOTHING, mask=None, exclude=None, **unknown),
                text_signature = "($self, point, k=1, *, max_distance=math.inf, mask=None, exclude=None)"
            )]
            #[expect(clippy::too_many_arguments, reason = "they are Python's keywords")]
            fn nearest<'py>(
                &self,
                py: Python<'py>,
                point: Given<'py>,
                k: Given<'py>,
                max_distance: Given<'py>,
                mask: Maybe<'_, 'py>,
                exclude: Maybe<'_, 'py>,
                unknown: Option<&Bound<'_, pyo3::types::PyDict>>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let [point] = crate::keywords::read::<Self, 1>("nearest", unknown, [("point", &point)])?;
                let (mask, exclude) = (queries::mask(mask)?, queries::excluded(exclude)?);
                $with_index!(self, index => {
                    let wanted = (&k, &max_distance, exclude.as_ref());
                    queries::nearest(py, point, wanted, |points, wanted| {
                        index.nearest(points, wanted, mask)
                    })
                })
            }
        }
    };
}

macro_rules! neighbor_methods {
    ($class:ident, $with_index:ident) => {
        #[pymethods]
        impl $class {
            /// Find the neighbours of every shape within a distance.
            ///
            /// Parameters
            /// ----------
            /// distance : float
            ///     Shapes are neighbours if the gap between their surfaces is below this, in units of
            ///     length; each radius is increased by half of it.
            /// mask : int, optional
            ///     Find only neighbours of which both have a category in this set of bits.
            ///
            /// Returns
            /// -------
            /// IdLists
            ///     For each shape, in the order of its row, the ids of its neighbours, ascending, itself left
            ///     out. The fields `offsets` and `ids` are compressed sparse rows.
            ///
            /// Raises
            /// ------
            /// ValueError
            ///     If `distance` is negative or out of range, or there are more than 134217728 ids.
            ///
            /// See Also
            /// --------
            /// pairs : All pairs within a distance.
            ///
            /// Examples
            /// --------
            /// >>> import jostle
            /// >>> tree = jostle.Quadtree([(0, 0), (3, 0), (4, 0)])
            /// >>> list(tree.neighbors(3.5))
            /// [array([1]), array([0, 2]), array([1])]
            #[pyo3(
                signature = (distance=Given::NOTHING, *, mask=None, **unknown),
                text_signature = "($self, distance, *, mask=None)",
            )]
            fn neighbors<'py>(
                &self,
                py: Python<'py>,
                distance: Given<'py>,
                mask: Maybe<'_, 'py>,
                unknown: Option<&Bound<'_, pyo3::types::PyDict>>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let [distance] = crate::keywords::read::<Self, 1>("neighbors", unknown, [("distance", &distance)])?;
                let (mask, distance) = (queries::mask(mask)?, number("distance", distance)?);
                $with_index!(self, index => {
                    queries::neighbors(py, distance, |distance| index.neighbors(distance, mask))
                })
            }
        }
    };
}

pub(crate) use {near_methods, neighbor_methods};
