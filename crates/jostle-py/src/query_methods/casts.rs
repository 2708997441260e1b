//! Rays, and moving shapes.

macro_rules! cast_methods {
    ($class:ident, $with_index:ident) => {
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
            /// exclude : int or array_like of int, shape (k,), optional
            ///     An id that rays pass, one for all or one for each, such as that of the shape in which a
            ///     ray starts; -1 is none, as is an id
            ///     that nothing has.
            ///
            /// Returns
            /// -------
            /// RayHit or RayHits
            ///     The id, at equal distances the smaller; -1 if no shape is hit, so test it before you use
            ///     it as an index. The distance to the surface; 0 if a ray starts in a shape, infinity if
            ///     nothing is hit. A ray that only touches an edge hits it. The point that is hit, and the
            ///     unit normal there, which points away from the shape. In a `World` the wall that is hit.
            ///
            /// Raises
            /// ------
            /// ValueError
            ///     If a number is not finite, a direction is (0, 0), or `max_distance` is negative.
            ///
            /// See Also
            /// --------
            /// shape_cast : The first shape that a moving shape hits.
            /// nearest : The nearest shape in any direction.
            ///
            /// Notes
            /// -----
            /// In a :class:`World` rays and moving shapes also hit walls and the container, which is solid outside.
            /// Then `id` is -1, and `wall` is the id of the wall or a :class:`Side`. A mask selects walls by their
            /// categories; sides have the category 1. A one-way wall is hit only if all of the moving shape starts
            /// strictly on the left of start → end and moves to the right. Walls that are sensors are not hit. At
            /// equal distances a particle comes first, then a side, then a wall. In queries of `World.walls`, `id`
            /// and `wall` are both the id of the wall; in other classes `wall` is always -1.
            ///
            /// Examples
            /// --------
            /// >>> import jostle
            /// >>> tree = jostle.Quadtree([(0, 0), (3, 0), (5, 0)], radii=1.0)
            /// >>> hit = tree.raycast((-4, 0), (1, 0))
            /// >>> hit.id, hit.distance, hit.point
            /// (0, 3.0, array([-1.,  0.]))
            /// >>> hits = tree.raycast((1.5, 0), [(1, 0), (0, 1), (-1, 0)])
            /// >>> hits.ids, hits.distances
            /// (array([ 1, -1,  0]), array([0.5, inf, 0.5]))
            /// >>> world = jostle.World([(3, 0)], 1.0, container=jostle.Box(-5, -5, 5, 5))
            /// >>> hits = world.raycast((0, 0), [(1, 0), (-1, 0)])
            /// >>> hits.ids, hits.walls, hits.distances
            /// (array([ 0, -1]), array([-1, -2]), array([2., 5.], dtype=float32))
            #[pyo3(
                signature = (origin=Given::NOTHING, direction=Given::NOTHING, *, max_distance=Given::NOTHING, mask=None, exclude=None, **unknown),
                text_signature = "($self, origin, direction, *, max_distance=math.inf, mask=None, exclude=None)"
            )]
            #[expect(clippy::too_many_arguments, reason = "they are Python's keywords")]
            fn raycast<'py>(
                &self,
                py: Python<'py>,
                origin: Given<'py>,
                direction: Given<'py>,
                max_distance: Given<'py>,
                mask: Maybe<'_, 'py>,
                exclude: Maybe<'_, 'py>,
                unknown: Option<&Bound<'_, pyo3::types::PyDict>>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let [origin, direction] = crate::keywords::read::<Self, 2>("raycast", unknown, [("origin", &origin), ("direction", &direction)])?;
                let sizes = (None, None);
                let cast = Cast { origin, direction, sizes, max_distance: &max_distance, exclude };
                self.cast(py, &cast, mask, false)
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
            /// exclude : int or array_like of int, shape (k,), optional
            ///     An id that rays pass, one for all or one for each; -1 is none, as is an id
            ///     that nothing has.
            ///
            /// Returns
            /// -------
            /// RayHits or RayHitLists
            ///     All hits of one ray, each shape once, at equal distances the smaller id first; for
            ///     many rays those of each. In a `World` also walls, and the side at which
            ///     each ray leaves the container.
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
            /// >>> tree = jostle.Quadtree([(0, 0), (3, 0), (5, 0)], radii=1.0)
            /// >>> hits = tree.raycast_all((-4, 0), (1, 0), max_distance=6)
            /// >>> hits.ids, hits.distances
            /// (array([0, 1]), array([3., 6.]))
            #[pyo3(
                signature = (origin=Given::NOTHING, direction=Given::NOTHING, *, max_distance=Given::NOTHING, mask=None, exclude=None, **unknown),
                text_signature = "($self, origin, direction, *, max_distance=math.inf, mask=None, exclude=None)"
            )]
            #[expect(clippy::too_many_arguments, reason = "they are Python's keywords")]
            fn raycast_all<'py>(
                &self,
                py: Python<'py>,
                origin: Given<'py>,
                direction: Given<'py>,
                max_distance: Given<'py>,
                mask: Maybe<'_, 'py>,
                exclude: Maybe<'_, 'py>,
                unknown: Option<&Bound<'_, pyo3::types::PyDict>>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let [origin, direction] = crate::keywords::read::<Self, 2>("raycast_all", unknown, [("origin", &origin), ("direction", &direction)])?;
                let sizes = (None, None);
                let cast = Cast { origin, direction, sizes, max_distance: &max_distance, exclude };
                self.cast(py, &cast, mask, true)
            }

            /// Find the first shape that a moving shape hits, or each of many.
            ///
            /// Parameters
            /// ----------
            /// origin : array_like, shape (2,) or (k, 2)
            ///     Start of the centre of each moving shape.
            /// direction : array_like, shape (2,) or (k, 2)
            ///     Direction of the motion, of any length except 0.
            /// radii : array_like, a number or shape (k,), default 0.0
            ///     Radii, as of other shapes: of discs, or by which boxes extend beyond their cores.
            /// half_sizes : array_like, a number, shape (2,) or (k, 2), optional
            ///     Half widths and half heights of boxes.
            /// max_distance : array_like, a number or shape (k,), default inf
            ///     Maximum distance of each motion, in units of length. With a period it must be given,
            ///     and be at most 1024 periods.
            /// mask : int, optional
            ///     Hit only shapes with a category in this set of bits; other shapes are ignored.
            /// exclude : int or array_like of int, shape (k,), optional
            ///     An id that is passed, one for all or one for each, such as that of the moving shape; -1
            ///     is none.
            ///
            /// Returns
            /// -------
            /// RayHit or RayHits
            ///     The id and the distance of the motion until the hit, as from :meth:`raycast`; the point
            ///     where the surfaces touch, in the middle if sides touch.
            ///
            /// Raises
            /// ------
            /// ValueError
            ///     If a number is not finite, a direction is (0, 0), a size is out of range, or
            ///     `max_distance` is negative.
            ///
            /// See Also
            /// --------
            /// raycast : The same for a point.
            ///
            /// Examples
            /// --------
            /// A disc, and a square:
            ///
            /// >>> import jostle
            /// >>> tree = jostle.Quadtree([(0, 0), (3, 0), (5, 0)], radii=1.0)
            /// >>> tree.shape_cast((-4, 0), (1, 0), radii=0.5).distance
            /// 2.5
            /// >>> hit = tree.shape_cast((-4, 0.5), (1, 0), half_sizes=0.5)
            /// >>> hit.distance, hit.point, hit.normal
            /// (2.5, array([-1.,  0.]), array([-1.,  0.]))
            #[pyo3(
                signature = (
                    origin=Given::NOTHING, direction=Given::NOTHING, *, radii=Given::NOTHING, half_sizes=None,
                    max_distance=Given::NOTHING, mask=None, exclude=None, **unknown),
                text_signature = "($self, origin, direction, *, radii=0.0, half_sizes=None, max_distance=math.inf, mask=None, exclude=None)"
            )]
            #[expect(clippy::too_many_arguments, reason = "they are Python's arguments")]
            fn shape_cast<'py>(
                &self,
                py: Python<'py>,
                origin: Given<'py>,
                direction: Given<'py>,
                radii: Given<'py>,
                half_sizes: Maybe<'_, 'py>,
                max_distance: Given<'py>,
                mask: Maybe<'_, 'py>,
                exclude: Maybe<'_, 'py>,
                unknown: Option<&Bound<'_, pyo3::types::PyDict>>,
            ) -> PyResult<Bound<'py, PyAny>> {
                let [origin, direction] = crate::keywords::read::<Self, 2>("shape_cast", unknown, [("origin", &origin), ("direction", &direction)])?;
                let sizes = (half_sizes, radii.value());
                let cast = Cast { origin, direction, sizes, max_distance: &max_distance, exclude };
                self.cast(py, &cast, mask, false)
            }
        }

        impl $class {
            /// The first shape on each path, or all.
            fn cast<'py>(
                &self,
                py: Python<'py>,
                cast: &Cast<'_, 'py>,
                mask: Maybe<'_, 'py>,
                all: bool,
            ) -> PyResult<Bound<'py, PyAny>> {
                let mask = queries::mask(mask)?;
                $with_index!(self, index => {
                    queries::cast(py, cast, all, |rays| {
                        if all { index.all_hits(rays, mask) } else { index.first_hits(rays, mask) }
                    })
                })
            }
        }
    };
}

pub(crate) use cast_methods;
