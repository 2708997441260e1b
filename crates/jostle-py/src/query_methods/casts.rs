//! Rays, and moving discs and boxes.

macro_rules! cast_methods {
    ($class:ident, $with_index:ident, $name:literal, $make:literal, $id:literal) => {
        #[pymethods]
        impl $class {
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
            /// See Also
            /// --------
            /// raycast : The first shape alone.
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
            /// See Also
            /// --------
            /// circle_cast : The same for a disc.
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

pub(crate) use cast_methods;
