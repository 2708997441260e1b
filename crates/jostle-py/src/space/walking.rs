//! Moving the shapes of a space among obstacles.

use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::{Either, PySpace};
use crate::arrays::Given;
use crate::keywords::read;
use crate::queries::Maybe;
use crate::slide;

#[pymethods]
impl PySpace {
    /// Move shapes by displacements; they slide along the others and never enter them.
    ///
    /// A shape moves until it meets an obstacle, then along the surface of the obstacle, and so
    /// on. The time of impact is computed along the whole path, so nothing passes through an
    /// obstacle at any speed. A shape that touches an obstacle does not overlap it, and the
    /// joints between tiles do not stop it. Discs, boxes and rounded boxes move among discs,
    /// boxes, line segments and those with a radius.
    ///
    /// Parameters
    /// ----------
    /// ids : int or array_like of int, shape (k,)
    ///     The shapes to move, each at most once: circles and boxes, no segments. A shape that was
    ///     given as a box, and that moves, is stored as ``center ± half_size`` from then on.
    /// displacements : array_like, shape (k, 2), or (2,) for one id
    ///     By how much each is to move: its velocity times the duration of a step.
    /// mask : int, optional
    ///     The categories of the shapes that are obstacles, as a set of bits; all if omitted. Shapes
    ///     that may not pair by their own categories and masks are no obstacles either.
    /// up : array_like, shape (2,), default (0, -1)
    ///     The direction in which floors face; y grows downwards on screens. With (0, 0), as seen
    ///     from above, every obstacle is a wall.
    /// floor_angle : float, default pi / 4
    ///     Largest angle between the normal of a floor and `up`, in radians. A shape stands on a
    ///     floor without sliding down, and climbs it; a steeper slope is a wall.
    /// snap : float, default 0
    ///     A shape that walks is put on a floor that is at most this far below it at the end, in
    ///     units of length. So it does not hop downhill or down steps. See Notes.
    /// step_height : float, default 0
    ///     A shape that walks climbs steps of at most this height onto a floor, in units of length,
    ///     where there is room.
    /// constant_speed : bool, default False
    ///     Whether a shape that walks moves along a floor as far as its displacement leads across
    ///     `up`, uphill and downhill. Otherwise its way depends on the slope and on gravity.
    /// one_way : int, default 0
    ///     Categories of the obstacles that stop only shapes that are above them and move down. To be
    ///     above a segment is to be above the line through its ends; one along `up` stops nothing.
    /// max_slides : int, default 4
    ///     Maximum number of obstacles along which a shape slides, at most 1000; it stops at the
    ///     last one.
    ///
    /// Returns
    /// -------
    /// Slides or Slide
    ///     One `Slide` for one id.
    ///
    ///     displacement : ndarray of the space's dtype, shape (k, 2)
    ///         How far each shape has moved.
    ///     remaining : ndarray of the space's dtype, shape (k, 2)
    ///         The displacements that were given, without their components into the obstacles:
    ///         divided by the duration of the step, the velocities for the next step.
    ///     hits : IdLists
    ///         Ids of the obstacles that each shape has met, each once.
    ///     normals : ndarray of the space's dtype, shape (m, 2)
    ///         Unit normal of each hit, towards the shape.
    ///     floor : ndarray of int64, shape (k,)
    ///         Id of the last floor; -1 if there is none.
    ///     platform_velocity : ndarray of the space's dtype, shape (k, 2)
    ///         The displacement of that floor since the last call for the shape; without one, that
    ///         of the floor on which the shape stood before.
    ///     on_floor, on_wall, on_ceiling : ndarray of bool, shape (k,)
    ///         Whether each shape has met one.
    ///     crushed : ndarray of bool, shape (k,)
    ///         Whether obstacles leave the shape no room, so that it overlaps one.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If an argument has the wrong type.
    /// IdError
    ///     If an id does not exist; then nothing moves.
    /// ValueError
    ///     If an id is given twice or belongs to a segment, or a value is not finite or out of range;
    ///     then nothing moves.
    ///
    /// See Also
    /// --------
    /// set : Sets positions, also where other shapes are.
    /// jostle.polyline : Line segments, for slopes and outlines of polygons.
    /// tiles : Merges the tiles of a grid into few boxes.
    ///
    /// Notes
    /// -----
    /// Shapes of one call that may meet move one after another, in the order of `ids`, except that a
    /// floor moves before the shapes that stand on it, the foremost of shapes with the same
    /// displacement first, and shapes whose category `mask` leaves out last. The order of other
    /// shapes has no effect.
    ///
    /// A shape walks if its displacement has no component along `up`, and if it touches something
    /// below at the beginning or meets a floor on its way. To touch means a gap of at most 1/1024 of
    /// its size. So a jump leaves the floor, and what falls is not attracted by one. With `snap`,
    /// `remaining` has no component along `up` after a walk that ends on a floor. A step is climbed
    /// by moving up, on, and down onto a floor; the point that touches the floor is at most
    /// `step_height` above the lowest point of the shape.
    ///
    /// The motions that obstacles have made since the last call for a shape, by :meth:`set` or by
    /// another call, are repeated first, all at the same time: what meets the shape pushes it. A
    /// shape that met a floor in its last call is carried by it: it moves by the same vector, and
    /// other obstacles that move by this vector do not stop it. Several motions between two calls
    /// count as one along a straight line; of motions with calls between them, the last one counts.
    /// A shape that overlaps obstacles after that is moved out of them. Obstacles that it cannot leave
    /// do not stop it.
    ///
    /// A floor that moves in the same call first pushes the shapes that stand on it; one that cannot
    /// move stops the floor. Floors that touch and have the same displacement are one body: each
    /// pushes what stands on any of them, and nothing that does stops them. So no shape moves into
    /// an obstacle. There is one exception: an obstacle may push or carry a shape against another
    /// obstacle and overlap it there. This happens if it was moved before the call, if `mask` leaves
    /// out the category of the shape, or if it is a part of a body. `hits` includes what stops a
    /// shape that is carried or pushed, and what pushes it.
    ///
    /// Examples
    /// --------
    /// A player falls onto a floor and slides along it; then a wall stops it.
    ///
    /// >>> import jostle
    /// >>> space = jostle.Space()
    /// >>> floor, wall = space.add(boxes=[(0, 10, 100, 20), (50, 0, 60, 10)])
    /// >>> player = space.add((10, 5), half_sizes=(2, 4))
    /// >>> slide = space.move_and_slide(player, (8, 5))
    /// >>> slide.on_floor, slide.remaining
    /// (True, array([8., 0.]))
    /// >>> space.get(player).positions.round(6)
    /// array([18.,  6.])
    /// >>> slide = space.move_and_slide(player, (1000, 5))
    /// >>> slide.on_floor, slide.on_wall, space.get(player).positions.round(6)
    /// (True, True, array([48.,  6.]))
    ///
    /// Another one walks up a slope.
    ///
    /// >>> flat, slope = space.add(segments=jostle.polyline([(-40, 50), (0, 50), (40, 20)]))
    /// >>> walker = space.add((-5, 48), radii=2.0)
    /// >>> slide = space.move_and_slide(walker, (25, 1))
    /// >>> slide.on_floor, bool(slide.floor == slope)
    /// (True, True)
    #[pyo3(
        signature = (
            ids=Given::NOTHING, displacements=Given::NOTHING, *, mask=None, up=Given::NOTHING, floor_angle=Given::NOTHING,
            snap=Given::NOTHING, step_height=Given::NOTHING, constant_speed=Given::NOTHING,
            one_way=Given::NOTHING, max_slides=Given::NOTHING, **unknown),
        text_signature = "($self, ids, displacements, *, mask=None, up=(0, -1), \
                          floor_angle=0.7853981633974483, snap=0, step_height=0, \
                          constant_speed=False, one_way=0, max_slides=4)"
    )]
    #[expect(clippy::too_many_arguments, reason = "they are Python's keywords")]
    fn move_and_slide<'py>(
        &self,
        py: Python<'py>,
        ids: Given<'py>,
        displacements: Given<'py>,
        mask: Maybe<'_, 'py>,
        up: Given<'py>,
        floor_angle: Given<'py>,
        snap: Given<'py>,
        step_height: Given<'py>,
        constant_speed: Given<'py>,
        one_way: Given<'py>,
        max_slides: Given<'py>,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let [ids, displacements] = read::<Self, 2>(
            "move_and_slide",
            unknown,
            [("ids", &ids), ("displacements", &displacements)],
        )?;
        let rules = slide::Rules::read(&slide::Keywords {
            mask,
            up,
            floor_angle,
            snap,
            step_height,
            constant_speed,
            one_way,
            max_slides,
        })?;
        with_space!(self, space => rules.run(py, space, ids, displacements))
    }
}
