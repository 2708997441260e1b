//! The query methods of `Quadtree` and `Space`, with their docstrings, written once.

use std::sync::atomic::{AtomicU64, Ordering};

use jostle::query::{self, Hits, Neighbors, Ray, RayHits, Region};
use jostle::{Each, Quadtree, Scalar, Space};

use crate::lock::Shared;
use crate::queries::Answer;

/// A tree or a space as the target of queries.
pub trait Index<T> {
    /// A row of a tree, or an id of a space.
    type Id;
    /// The shapes that overlap each region.
    fn search<R: Region<T>>(&self, regions: &[R], mask: Option<u32>) -> Answer<Hits<Self::Id>>;
    /// The nearest shapes of each point; `wanted` is their number and the maximum distance.
    fn nearest(
        &self,
        points: &[[T; 2]],
        wanted: (usize, Each<T>),
        mask: Option<u32>,
    ) -> Answer<Neighbors<T>>;
    /// The first shape that each ray hits.
    fn first_hits(&self, rays: &[Ray<T>], mask: Option<u32>) -> Answer<RayHits<T>>;
    /// All shapes that each ray hits.
    fn all_hits(&self, rays: &[Ray<T>], mask: Option<u32>) -> Answer<RayHits<T>>;
    /// The shapes within a distance of each shape.
    fn neighbors(&self, distance: T, mask: Option<u32>) -> Answer<Hits<Self::Id>>;
}

/// A tree, and the number of shapes that its last query tested.
pub struct CountedTree<'a, T> {
    /// The tree.
    pub tree: &'a Quadtree<T>,
    /// Number of tests of the last query.
    pub tests: &'a AtomicU64,
}

impl<T> CountedTree<'_, T> {
    fn count<R>(&self, found: jostle::Result<R>, tests: impl Fn(&R) -> u64) -> Answer<R> {
        self.tests.store(found.as_ref().map_or(0, tests), Ordering::Relaxed);
        Ok(found)
    }
}

impl<T: Scalar> Index<T> for CountedTree<'_, T> {
    type Id = u32;

    fn search<R: Region<T>>(&self, regions: &[R], mask: Option<u32>) -> Answer<Hits<u32>> {
        self.count(query::search(self.tree, regions, mask), |found| found.tests)
    }

    fn nearest(
        &self,
        points: &[[T; 2]],
        wanted: (usize, Each<T>),
        mask: Option<u32>,
    ) -> Answer<Neighbors<T>> {
        self.count(query::nearest(self.tree, points, wanted, mask), |found| found.tests)
    }

    fn first_hits(&self, rays: &[Ray<T>], mask: Option<u32>) -> Answer<RayHits<T>> {
        self.count(query::first_hits(self.tree, rays, mask), |found| found.tests)
    }

    fn all_hits(&self, rays: &[Ray<T>], mask: Option<u32>) -> Answer<RayHits<T>> {
        self.count(query::all_hits(self.tree, rays, mask), |found| found.tests)
    }

    fn neighbors(&self, distance: T, mask: Option<u32>) -> Answer<Hits<u32>> {
        self.count(query::neighbors(self.tree, distance, mask), |found| found.tests)
    }
}

impl<T: Scalar> Index<T> for Shared<Space<T>> {
    type Id = jostle::Id;

    fn search<R: Region<T>>(&self, regions: &[R], mask: Option<u32>) -> Answer<Hits<Self::Id>> {
        Ok(self.lock()?.search(regions, mask))
    }

    fn nearest(
        &self,
        points: &[[T; 2]],
        wanted: (usize, Each<T>),
        mask: Option<u32>,
    ) -> Answer<Neighbors<T>> {
        Ok(self.lock()?.nearest(points, wanted, mask))
    }

    fn first_hits(&self, rays: &[Ray<T>], mask: Option<u32>) -> Answer<RayHits<T>> {
        Ok(self.lock()?.first_hits(rays, mask))
    }

    fn all_hits(&self, rays: &[Ray<T>], mask: Option<u32>) -> Answer<RayHits<T>> {
        Ok(self.lock()?.all_hits(rays, mask))
    }

    fn neighbors(&self, distance: T, mask: Option<u32>) -> Answer<Hits<Self::Id>> {
        Ok(self.lock()?.neighbors(distance, mask))
    }
}

/// Implements the query methods of a class. `$with_index!(self, index => ...)` evaluates an
/// expression with the [`Index`] of an object in either precision. In the docstrings, `$name` is a
/// variable with an object, `$make` the code before the arguments of the shapes, and `$ids` and
/// `$id` are the terms for what identifies shapes.
macro_rules! query_methods {
    ($class:ident, $with_index:ident, $name:literal, $make:literal, $ids:literal, $id:literal) => {
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
            ///
            /// Returns
            /// -------
            /// ndarray of int64, shape (m,), or Hits
            #[doc = concat!("    ", $ids, ", ascending; for many rectangles a `Hits`. A shape that only touches")]
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
            #[doc = concat!("Queries are converted to the ", $name, "'s dtype; the result is that of brute force in this")]
            #[doc = concat!("arithmetic. Many queries in one call use all threads of the ", $name, ". A shape without")]
            /// categories (0) is found only if no mask is given.
            ///
            /// Examples
            /// --------
            /// >>> import jostle
            #[doc = concat!(">>> ", $make, "[(0, 0), (3, 0), (4, 0)], radii=1.0)")]
            #[doc = concat!(">>> ", $name, ".query_rect((2.5, -1, 9, 1))")]
            /// array([1, 2])
            #[doc = concat!(">>> hits = ", $name, ".query_rect([(0, 0, 1, 1), (2.5, -1, 9, 1)])")]
            /// >>> hits.ids[hits.offsets[1]:hits.offsets[2]]
            /// array([1, 2])
            #[pyo3(signature = (rect, *, mask=None))]
            fn query_rect<'py>(
                &self,
                py: Python<'py>,
                rect: &Bound<'py, PyAny>,
                mask: Maybe<'_, 'py>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let mask = queries::mask(mask)?;
                $with_index!(self, index => {
                    queries::rect(py, rect, |rects| index.search(rects, mask))
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
            ///
            /// Returns
            /// -------
            /// ndarray of int64, shape (m,), or Hits
            #[doc = concat!("    ", $ids, ", ascending; for many discs a `Hits`. A shape that only touches")]
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
            #[doc = concat!(">>> ", $make, "[(0, 0), (3, 0), (4, 0)], radii=1.0)")]
            #[doc = concat!(">>> ", $name, ".query_circle((1, 0), 1.5)")]
            /// array([0, 1])
            #[pyo3(signature = (center, radius, *, mask=None))]
            fn query_circle<'py>(
                &self,
                py: Python<'py>,
                center: &Bound<'py, PyAny>,
                radius: &Bound<'py, PyAny>,
                mask: Maybe<'_, 'py>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let mask = queries::mask(mask)?;
                $with_index!(self, index => {
                    queries::circle(py, center, radius, |circles| index.search(circles, mask))
                })
            }

            /// Find the shapes that contain a point, or each of many points.
            ///
            /// A circle or a rounded box contains its edge. A rectangle contains its left and its
            /// upper edge, but not the right and the lower, as in pygame, so tiles side by side
            /// share no point. A rectangle of width and height 0 is a circle of radius 0.
            ///
            /// Parameters
            /// ----------
            /// point : array_like, shape (2,) or (k, 2)
            ///     Points.
            /// mask : int, optional
            ///     Find only shapes with a category in this set of bits.
            ///
            /// Returns
            /// -------
            /// ndarray of int64, shape (m,), or Hits
            #[doc = concat!("    ", $ids, ", ascending; for many points a `Hits`.")]
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
            #[doc = concat!(">>> ", $make, "boxes=[(0, 0, 1, 1), (1, 0, 2, 1)])")]
            #[doc = concat!(">>> ", $name, ".query_point((1.0, 0.2))")]
            /// array([1])
            #[pyo3(signature = (point, *, mask=None))]
            fn query_point<'py>(
                &self,
                py: Python<'py>,
                point: &Bound<'py, PyAny>,
                mask: Maybe<'_, 'py>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let mask = queries::mask(mask)?;
                $with_index!(self, index => {
                    queries::point(py, point, |points| index.search(points, mask))
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
            ///
            /// Returns
            /// -------
            /// ndarray of int64, shape (m,), or Hits
            #[doc = concat!("    ", $ids, ", ascending; for many polygons a `Hits`. A shape that only touches")]
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
            #[doc = concat!(">>> ", $make, "[(0, 0), (3, 0), (4, 0)], radii=1.0)")]
            #[doc = concat!(">>> ", $name, ".query_polygon([(1, 2), (5, 0.5), (5, 2)])")]
            /// array([2])
            #[pyo3(signature = (vertices, *, mask=None))]
            fn query_polygon<'py>(
                &self,
                py: Python<'py>,
                vertices: &Bound<'py, PyAny>,
                mask: Maybe<'_, 'py>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let mask = queries::mask(mask)?;
                $with_index!(self, index => {
                    queries::polygon(py, vertices, |polygons| index.search(polygons, mask))
                })
            }

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

            /// Find the first shape that a ray hits, or each of many rays.
            ///
            /// Parameters
            /// ----------
            /// origin : array_like, shape (2,) or (k, 2)
            ///     Start of each ray.
            /// direction : array_like, shape (2,) or (k, 2)
            ///     Direction of each ray, of any length except 0. One origin may have many
            ///     directions, and many origins one direction.
            /// max_distance : array_like, a number or shape (k,), default inf
            ///     Maximum length of each ray, in units of length. With a period it must be given, and
            ///     be at most 1024 periods.
            /// mask : int, optional
            ///     Hit only shapes with a category in this set of bits; other shapes are ignored.
            ///
            /// Returns
            /// -------
            /// RayHit or RayHits
            #[doc = concat!("    Unpacks as ``", $id, ", distance``, in this order (:meth:`nearest` returns distances")]
            #[doc = concat!("    first); for many rays, arrays of both. At equal distances the smaller ", $id, "; -1 and")]
            #[doc = concat!("    infinity if nothing is hit, so test the ", $id, " before you use it as an index. The")]
            ///     distance is that to the surface, 0 if a ray starts in a shape. A ray that only
            ///     touches an edge hits it. The attribute `normal`, or `normals`, holds unit vectors
            ///     that point away from the shape where it is hit; (0, 0) if a ray starts in it.
            ///
            /// Raises
            /// ------
            /// ValueError
            ///     If a number is not finite, a direction is (0, 0), or `max_distance` is negative.
            ///
            /// See Also
            /// --------
            /// circle_cast : The first shape that a moving disc hits.
            /// nearest : The nearest shape in any direction.
            ///
            /// Examples
            /// --------
            /// >>> import jostle
            #[doc = concat!(">>> ", $make, "[(0, 0), (3, 0), (5, 0)], radii=1.0)")]
            #[doc = concat!(">>> ", $name, ".raycast((-4, 0), (1, 0))")]
            /// RayHit(id=0, distance=3.0)
            #[doc = concat!(">>> ", $name, ".raycast((1.5, 0), [(1, 0), (0, 1), (-1, 0)])")]
            /// RayHits(ids=array([ 1, -1,  0]), distances=array([0.5, inf, 0.5]))
            #[pyo3(
                signature = (origin, direction, *, max_distance=Given::NOTHING, mask=None),
                text_signature = "($self, origin, direction, *, max_distance=math.inf, mask=None)"
            )]
            fn raycast<'py>(
                &self,
                py: Python<'py>,
                origin: &Bound<'py, PyAny>,
                direction: &Bound<'py, PyAny>,
                max_distance: Given<'py>,
                mask: Maybe<'_, 'py>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let (half_size, radius, max_distance) = (None, None, &max_distance);
                let cast = Cast { origin, direction, half_size, radius, max_distance, all: false };
                self.cast(py, &cast, mask)
            }

            /// Find every shape that a ray hits, nearest first, or that each of many rays hits.
            ///
            /// Parameters
            /// ----------
            /// origin : array_like, shape (2,) or (k, 2)
            ///     Start of each ray.
            /// direction : array_like, shape (2,) or (k, 2)
            ///     Direction of each ray, of any length except 0.
            /// max_distance : array_like, a number or shape (k,), default inf
            ///     Maximum length of each ray, in units of length. With a period it must be given, and
            ///     be at most 1024 periods.
            /// mask : int, optional
            ///     Hit only shapes with a category in this set of bits.
            ///
            /// Returns
            /// -------
            /// RayHits or RayHitLists
            #[doc = concat!("    Unpacks as ``", $id, "s, distances``: all hits of one ray, each shape once, at equal")]
            #[doc = concat!("    distances the smaller ", $id, " first. For many rays, ``offsets, ids, distances, normals``.")]
            ///
            /// Raises
            /// ------
            /// ValueError
            ///     If a number is not finite, a direction is (0, 0), `max_distance` is negative, or
            ///     there are more than 134217728 hits.
            ///
            /// Examples
            /// --------
            /// >>> import jostle
            #[doc = concat!(">>> ", $make, "[(0, 0), (3, 0), (5, 0)], radii=1.0)")]
            #[doc = concat!(">>> ids, distances = ", $name, ".raycast_all((-4, 0), (1, 0), max_distance=6)")]
            /// >>> ids, distances
            /// (array([0, 1]), array([3., 6.]))
            #[pyo3(
                signature = (origin, direction, *, max_distance=Given::NOTHING, mask=None),
                text_signature = "($self, origin, direction, *, max_distance=math.inf, mask=None)"
            )]
            fn raycast_all<'py>(
                &self,
                py: Python<'py>,
                origin: &Bound<'py, PyAny>,
                direction: &Bound<'py, PyAny>,
                max_distance: Given<'py>,
                mask: Maybe<'_, 'py>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let (half_size, radius, max_distance) = (None, None, &max_distance);
                let cast = Cast { origin, direction, half_size, radius, max_distance, all: true };
                self.cast(py, &cast, mask)
            }

            /// Find the first shape that a moving box hits, or each of many boxes.
            ///
            /// Parameters
            /// ----------
            /// origin : array_like, shape (2,) or (k, 2)
            ///     Start of the centre of each box.
            /// direction : array_like, shape (2,) or (k, 2)
            ///     Direction of the motion, of any length except 0.
            /// half_size : array_like, a number, shape (2,) or (k, 2)
            ///     Half widths and half heights of the boxes.
            /// radius : array_like, a number or shape (k,), default 0.0
            ///     Distance by which the boxes extend beyond their cores, as for other shapes.
            /// max_distance : array_like, a number or shape (k,), default inf
            ///     Maximum distance of each motion, in units of length. With a period it must be given,
            ///     and be at most 1024 periods.
            /// mask : int, optional
            ///     Hit only shapes with a category in this set of bits; other shapes are ignored.
            ///
            /// Returns
            /// -------
            /// RayHit or RayHits
            #[doc = concat!("    The ", $id, " and the distance of the motion until the hit, as from :meth:`raycast`.")]
            ///
            /// Raises
            /// ------
            /// ValueError
            ///     If a number is not finite, a direction is (0, 0), a size is out of range, or
            ///     `max_distance` is negative.
            ///
            /// Examples
            /// --------
            /// >>> import jostle
            #[doc = concat!(">>> ", $make, "[(0, 0), (3, 0), (5, 0)], radii=1.0)")]
            #[doc = concat!(">>> hit = ", $name, ".box_cast((-4, 0.5), (1, 0), half_size=0.5)")]
            /// >>> hit, hit.normal
            /// (RayHit(id=0, distance=2.5), (-1.0, 0.0))
            #[pyo3(
                signature = (
                    origin, direction, half_size, radius=Given::NOTHING, *,
                    max_distance=Given::NOTHING, mask=None,
                ),
                text_signature = "($self, origin, direction, half_size, radius=0.0, *, max_distance=math.inf, mask=None)"
            )]
            #[expect(clippy::too_many_arguments, reason = "they are Python's arguments")]
            fn box_cast<'py>(
                &self,
                py: Python<'py>,
                origin: &Bound<'py, PyAny>,
                direction: &Bound<'py, PyAny>,
                half_size: &Bound<'py, PyAny>,
                radius: Given<'py>,
                max_distance: Given<'py>,
                mask: Maybe<'_, 'py>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let (half_size, max_distance) = (Some(half_size), &max_distance);
                let radius = radius.value();
                let cast = Cast { origin, direction, half_size, radius, max_distance, all: false };
                self.cast(py, &cast, mask)
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

            /// Find the first shape that a moving disc hits, or each of many discs.
            ///
            /// Parameters
            /// ----------
            /// origin : array_like, shape (2,) or (k, 2)
            ///     Start of the centre of each disc.
            /// direction : array_like, shape (2,) or (k, 2)
            ///     Direction of the motion, of any length except 0.
            /// radius : array_like, a number or shape (k,)
            ///     Radii of the discs.
            /// max_distance : array_like, a number or shape (k,), default inf
            ///     Maximum distance of each motion, in units of length. With a period it must be given,
            ///     and be at most 1024 periods.
            /// mask : int, optional
            ///     Hit only shapes with a category in this set of bits; other shapes are ignored.
            ///
            /// Returns
            /// -------
            /// RayHit or RayHits
            #[doc = concat!("    The ", $id, " and the distance of the motion until the hit, as from :meth:`raycast`.")]
            ///
            /// Raises
            /// ------
            /// ValueError
            ///     If a number is not finite, a direction is (0, 0), a radius is out of range, or
            ///     `max_distance` is negative.
            ///
            /// See Also
            /// --------
            /// raycast : The same for a point.
            ///
            /// Examples
            /// --------
            /// >>> import jostle
            #[doc = concat!(">>> ", $make, "[(0, 0), (3, 0), (5, 0)], radii=1.0)")]
            #[doc = concat!(">>> ", $name, ".circle_cast((-4, 0.5), (1, 0), radius=0.5)")]
            /// RayHit(id=0, distance=2.585786437626905)
            #[pyo3(
                signature = (origin, direction, radius, *, max_distance=Given::NOTHING, mask=None),
                text_signature = "($self, origin, direction, radius, *, max_distance=math.inf, mask=None)"
            )]
            fn circle_cast<'py>(
                &self,
                py: Python<'py>,
                origin: &Bound<'py, PyAny>,
                direction: &Bound<'py, PyAny>,
                radius: &Bound<'py, PyAny>,
                max_distance: Given<'py>,
                mask: Maybe<'_, 'py>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let (half_size, radius, max_distance) = (None, Some(radius), &max_distance);
                let cast = Cast { origin, direction, half_size, radius, max_distance, all: false };
                self.cast(py, &cast, mask)
            }
        }

        impl $class {
            /// The casts of rays, discs and boxes.
            fn cast<'py>(
                &self,
                py: Python<'py>,
                cast: &Cast<'_, 'py>,
                mask: Maybe<'_, 'py>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let (mask, all) = (queries::mask(mask)?, cast.all);
                $with_index!(self, index => {
                    queries::cast(py, cast, |rays| {
                        if all { index.all_hits(rays, mask) } else { index.first_hits(rays, mask) }
                    })
                })
            }
        }
    };
}

pub(crate) use query_methods;
