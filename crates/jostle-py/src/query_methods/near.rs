//! Queries of the nearest shapes of a point, and of the neighbours of every shape.

macro_rules! near_methods {
    ($class:ident, $with_index:ident, $name:literal, $make:literal, $ids:literal, $id:literal) => {
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
            ///
            /// Returns
            /// -------
            /// Neighbors
            ///     Unpacks as ``distances, ids``, in this order, as SciPy's `cKDTree.query`
            #[doc = concat!("    (:meth:`raycast` returns the ", $id, " first).")]
            ///
            #[doc = concat!("    distances : ndarray of the ", $name, "'s dtype, shape (k,) or (n, k)")]
            ///         Distances to the surfaces, nearest first; 0 inside a shape, infinity if
            ///         fewer than k are found.
            ///     ids : ndarray of int64, shape (k,) or (n, k)
            #[doc = concat!("        ", $ids, ", the smaller first at equal distances; -1 if fewer than k are")]
            ///         found; remove those before you use them as an index.
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
            #[doc = concat!(">>> ", $make, "[(0, 0), (3, 0), (5, 0)], radii=1.0)")]
            #[doc = concat!(">>> distances, ids = ", $name, ".nearest((2, 0), k=2)")]
            /// >>> distances, ids
            /// (array([0., 1.]), array([1, 0]))
            #[pyo3(
                signature = (point, k=Given::NOTHING, *, max_distance=Given::NOTHING, mask=None),
                text_signature = "($self, point, k=1, *, max_distance=math.inf, mask=None)"
            )]
            fn nearest<'py>(
                &self,
                py: Python<'py>,
                point: &Bound<'py, PyAny>,
                k: Given<'py>,
                max_distance: Given<'py>,
                mask: Maybe<'_, 'py>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let mask = queries::mask(mask)?;
                $with_index!(self, index => {
                    queries::nearest(py, point, &k, &max_distance, |points, wanted| {
                        index.nearest(points, wanted, mask)
                    })
                })
            }

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
            /// Hits
            #[doc = concat!("    Compressed sparse rows: ``ids[offsets[i]:offsets[i + 1]]`` are the ", $id, "s of the")]
            #[doc = concat!("    neighbours of shape i, ascending, itself left out; i counts the shapes in ascending ", $id, ".")]
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
            #[doc = concat!(">>> ", $make, "[(0, 0), (3, 0), (4, 0)])")]
            #[doc = concat!(">>> ", $name, ".neighbors(3.5).lists()")]
            /// [array([1]), array([0, 2]), array([1])]
            #[pyo3(signature = (distance, *, mask=None))]
            fn neighbors<'py>(
                &self,
                py: Python<'py>,
                distance: &Bound<'py, PyAny>,
                mask: Maybe<'_, 'py>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let (mask, distance) = (queries::mask(mask)?, number("distance", distance)?);
                $with_index!(self, index => {
                    queries::neighbors(py, distance, |distance| index.neighbors(distance, mask))
                })
            }
        }
    };
}

pub(crate) use near_methods;
