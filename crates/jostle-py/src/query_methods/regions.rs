//! Queries of all shapes in a rectangle, a disc or a polygon, or at a point.

macro_rules! region_methods {
    ($class:ident, $with_index:ident) => {
        #[pymethods]
        impl $class {
            /// Find the shapes that overlap a rectangle, or each of many.
            ///
            /// Parameters
            /// ----------
            /// rect : array_like, shape (4,) or (k, 4)
            ///     Sides min_x, min_y, max_x, max_y, not width and height. Objects with the attributes
            ///     `left`, `top`, `right` and `bottom`, such as pygame's Rect, or `min_x`, `min_y`,
            ///     `max_x` and `max_y`, such as :class:`jostle.Box` (float32), are accepted, also
            ///     in a list.
            /// mask : int, optional
            ///     Find only shapes with a category in this set of bits.
            /// exclude : int or array_like of int, shape (k,), optional
            ///     An id that is not found, one for all queries or one for each; -1 is none, as is an id
            ///     that nothing has.
            ///
            /// Returns
            /// -------
            /// ndarray of int64, shape (m,), or IdLists
            ///     Ids, ascending; for many rectangles the list of each. A shape that only touches
            ///     a rectangle does not overlap it.
            ///
            /// Raises
            /// ------
            /// ValueError
            ///     If a number is not finite, a minimum is above its maximum, or there are more
            ///     than 134217728 ids.
            ///
            /// See Also
            /// --------
            /// query_circle, query_polygon : Other regions.
            /// query_point : The shapes that contain a point.
            ///
            /// Notes
            /// -----
            /// The ids of a `Quadtree` are row numbers. Queries are converted to its dtype; the result is that
            /// of brute force in this arithmetic. Many queries in one call use all threads. A shape without
            /// categories (0) is found only if no mask is given.
            ///
            /// Examples
            /// --------
            /// >>> import jostle
            /// >>> tree = jostle.Quadtree([(0, 0), (3, 0), (4, 0)], radii=1.0)
            /// >>> tree.query_rect((2.5, -1, 9, 1))
            /// array([1, 2])
            /// >>> found = tree.query_rect([(0, 0, 1, 1), (2.5, -1, 9, 1)])
            /// >>> found[1], found.counts
            /// (array([1, 2]), array([1, 2]))
            #[pyo3(
                signature = (rect=Given::NOTHING, *, mask=None, exclude=None, **unknown),
                text_signature = "($self, rect, *, mask=None, exclude=None)",
            )]
            fn query_rect<'py>(
                &self,
                py: Python<'py>,
                rect: Given<'py>,
                mask: Maybe<'_, 'py>,
                exclude: Maybe<'_, 'py>,
                unknown: Option<&Bound<'_, pyo3::types::PyDict>>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let [rect] = crate::keywords::read::<Self, 1>("query_rect", unknown, [("rect", &rect)])?;
                let (mask, exclude) = (queries::mask(mask)?, queries::excluded(exclude)?);
                $with_index!(self, index => {
                    queries::rect(py, rect, exclude.as_ref(), |rects| index.search(rects, mask))
                })
            }

            /// Find the shapes that overlap a disc, or each of many.
            ///
            /// Parameters
            /// ----------
            /// center : array_like, shape (2,) or (k, 2)
            ///     Centres.
            /// radius : array_like, a number or shape (k,)
            ///     Radii. With one centre and many radii, all discs have that centre.
            /// mask : int, optional
            ///     Find only shapes with a category in this set of bits.
            /// exclude : int or array_like of int, shape (k,), optional
            ///     An id that is not found, one for all queries or one for each; -1 is none, as is an id
            ///     that nothing has.
            ///
            /// Returns
            /// -------
            /// ndarray of int64, shape (m,), or IdLists
            ///     Ids, ascending; for many discs the list of each. A shape that only touches
            ///     a disc does not overlap it.
            ///
            /// Raises
            /// ------
            /// ValueError
            ///     If a number is not finite, a radius is out of range, or there are more than
            ///     134217728 ids.
            ///
            /// See Also
            /// --------
            /// query_rect, query_polygon : Other regions.
            /// nearest : The shapes nearest to a point, with distances.
            ///
            /// Examples
            /// --------
            /// >>> import jostle
            /// >>> tree = jostle.Quadtree([(0, 0), (3, 0), (4, 0)], radii=1.0)
            /// >>> tree.query_circle((1, 0), 1.5)
            /// array([0, 1])
            #[pyo3(
                signature = (center=Given::NOTHING, radius=Given::NOTHING, *, mask=None, exclude=None, **unknown),
                text_signature = "($self, center, radius, *, mask=None, exclude=None)",
            )]
            fn query_circle<'py>(
                &self,
                py: Python<'py>,
                center: Given<'py>,
                radius: Given<'py>,
                mask: Maybe<'_, 'py>,
                exclude: Maybe<'_, 'py>,
                unknown: Option<&Bound<'_, pyo3::types::PyDict>>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let [center, radius] = crate::keywords::read::<Self, 2>("query_circle", unknown, [("center", &center), ("radius", &radius)])?;
                let (mask, exclude) = (queries::mask(mask)?, queries::excluded(exclude)?);
                $with_index!(self, index => {
                    queries::circle(py, center, radius, exclude.as_ref(), |circles| index.search(circles, mask))
                })
            }

            /// Find the shapes that contain a point, or each of many points.
            ///
            /// A circle, a rounded box, a segment or a capsule contains its edge. A rectangle contains
            /// its left and its upper edge, but not the right and the lower, as in pygame, so tiles side
            /// by side share no point. A rectangle of width and height 0 is a circle of radius 0.
            ///
            /// Parameters
            /// ----------
            /// point : array_like, shape (2,) or (k, 2)
            ///     Points.
            /// mask : int, optional
            ///     Find only shapes with a category in this set of bits.
            /// exclude : int or array_like of int, shape (k,), optional
            ///     An id that is not found, one for all queries or one for each; -1 is none, as is an id
            ///     that nothing has.
            ///
            /// Returns
            /// -------
            /// ndarray of int64, shape (m,), or IdLists
            ///     Ids, ascending; for many points the list of each.
            ///
            /// Raises
            /// ------
            /// ValueError
            ///     If a coordinate is not finite, or there are more than 134217728 ids.
            ///
            /// See Also
            /// --------
            /// query_circle : The shapes near a point.
            /// nearest : The shapes nearest to a point.
            ///
            /// Examples
            /// --------
            /// >>> import jostle
            /// >>> tree = jostle.Quadtree(boxes=[(0, 0, 1, 1), (1, 0, 2, 1)])
            /// >>> tree.query_point((1.0, 0.2))
            /// array([1])
            #[pyo3(
                signature = (point=Given::NOTHING, *, mask=None, exclude=None, **unknown),
                text_signature = "($self, point, *, mask=None, exclude=None)",
            )]
            fn query_point<'py>(
                &self,
                py: Python<'py>,
                point: Given<'py>,
                mask: Maybe<'_, 'py>,
                exclude: Maybe<'_, 'py>,
                unknown: Option<&Bound<'_, pyo3::types::PyDict>>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let [point] = crate::keywords::read::<Self, 1>("query_point", unknown, [("point", &point)])?;
                let (mask, exclude) = (queries::mask(mask)?, queries::excluded(exclude)?);
                $with_index!(self, index => {
                    queries::point(py, point, exclude.as_ref(), |points| index.search(points, mask))
                })
            }

            /// Find the shapes that overlap a convex polygon, or each of many.
            ///
            /// Parameters
            /// ----------
            /// vertices : array_like, shape (v, 2) or (k, v, 2)
            ///     Corners in order, clockwise or counterclockwise.
            /// mask : int, optional
            ///     Find only shapes with a category in this set of bits.
            /// exclude : int or array_like of int, shape (k,), optional
            ///     An id that is not found, one for all queries or one for each; -1 is none, as is an id
            ///     that nothing has.
            ///
            /// Returns
            /// -------
            /// ndarray of int64, shape (m,), or IdLists
            ///     Ids, ascending; for many polygons the list of each. A shape that only touches
            ///     a polygon does not overlap it.
            ///
            /// Raises
            /// ------
            /// ValueError
            ///     If a polygon has fewer than three corners, is not convex or has no area, if a
            ///     coordinate is not finite, or there are more than 134217728 ids.
            ///
            /// See Also
            /// --------
            /// query_rect, query_circle : Other regions.
            ///
            /// Examples
            /// --------
            /// >>> import jostle
            /// >>> tree = jostle.Quadtree([(0, 0), (3, 0), (4, 0)], radii=1.0)
            /// >>> tree.query_polygon([(1, 2), (5, 0.5), (5, 2)])
            /// array([2])
            #[pyo3(
                signature = (vertices=Given::NOTHING, *, mask=None, exclude=None, **unknown),
                text_signature = "($self, vertices, *, mask=None, exclude=None)",
            )]
            fn query_polygon<'py>(
                &self,
                py: Python<'py>,
                vertices: Given<'py>,
                mask: Maybe<'_, 'py>,
                exclude: Maybe<'_, 'py>,
                unknown: Option<&Bound<'_, pyo3::types::PyDict>>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let [vertices] = crate::keywords::read::<Self, 1>("query_polygon", unknown, [("vertices", &vertices)])?;
                let (mask, exclude) = (queries::mask(mask)?, queries::excluded(exclude)?);
                $with_index!(self, index => {
                    queries::polygon(py, vertices, exclude.as_ref(), |polygons| index.search(polygons, mask))
                })
            }
        }
    };
}

pub(crate) use region_methods;
