//! What rays and moving shapes hit of the walls and of the container.
//!
//! Walls are line segments in a tree, as in a space. The container is solid outside: a ray hits the
//! side at which it leaves. The place of that hit is computed in float64.

use super::World;
use super::settings::WorldSettings;
use crate::container::{Container, Side};
use crate::trajectory::{Vector, dot, vector};
use crate::walls::{Wall, index_of, may_stop, number_of};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_index::geometry::Shape;
use jostle_index::quadtree::Quadtree;
use jostle_index::query::{IdOf, Ray, RayContact, RayHits, RayPath};
use jostle_index::shapes::{DEFAULT_CATEGORY, Each, Filter, Shapes, fill_filters};

/// What rays hit. Walls and sides have the id −1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Casts {
    /// Ids, distances, points and normals.
    pub hits: RayHits<f32>,
    /// The id of the wall or of the side that is hit; −1 if it is a particle or nothing.
    pub walls: Vec<i64>,
}

/// In a search walls and sides have their numbers among all walls above this. So at equal distances particles come
/// first, then sides, then walls.
const FIRST: u64 = 1 << 63;

impl Casts {
    /// The hits of a search by [`World::cast_boundaries`]; `id_of` returns the id of the wall with a number.
    pub(super) fn of(mut hits: RayHits<f32>, id_of: impl Fn(u32) -> i64) -> Result<Self> {
        let wall = |&id: &i64| if id < -1 { id_of((id as u64 - FIRST) as u32) } else { -1 };
        let walls = memory::collect(hits.ids.iter().map(wall))?;
        hits.ids.iter_mut().for_each(|id| *id = (*id).max(-1));
        Ok(Self { hits, walls })
    }
}

/// A tree of the walls where they are now in float32, by row, on a torus with its period.
pub(super) fn tree_of_walls(walls: &[Wall], settings: &WorldSettings) -> Result<Quadtree<f32>> {
    let mut tree = Quadtree::default();
    let ends = memory::collect(walls.iter().map(|wall| wall.ends))?;
    let mut shapes = Shapes::from_segments(&ends, Each::One(0.0), None)?;
    if walls.iter().any(|wall| wall.filter != Filter::default()) {
        fill_filters(walls.iter().map(|wall| wall.filter), shapes.columns_mut().filters)?;
    }
    // Walls fit on a torus with what rounding to float32 has removed.
    let shapes = shapes.wrapped_in(settings.container.period());
    tree.fill_unordered(&shapes, settings.tree)?;
    Ok(tree)
}

impl World {
    /// Finds what a ray hits of the walls in a tree and of the container.
    pub(super) fn cast_boundaries(
        &self,
        walls: &Quadtree<f32>,
        mask: Option<u32>,
        path: &mut impl RayPath<f32>,
    ) {
        let rows = walls.rows();
        let id_of = |index: usize| Some(FIRST + u64::from(number_of(rows[index])));
        let row_of = |id: u64| index_of((id - FIRST) as u32);
        self.cast_walls(walls, (mask, &id_of, &row_of), path);
        if mask.is_none_or(|mask| mask & DEFAULT_CATEGORY != 0)
            && let Some((side, hit)) = Moving::of(path.ray()).hit_side(&self.settings.container)
        {
            path.take(hit.with_id(FIRST + u64::from(side)));
        }
    }

    /// Finds what a ray hits of the walls in a tree, with ids of the caller's choice and their rows.
    pub(super) fn cast_walls(
        &self,
        tree: &Quadtree<f32>,
        (mask, id_of, row_of): (Option<u32>, &IdOf<'_>, &dyn Fn(u64) -> Option<u32>),
        path: &mut impl RayPath<f32>,
    ) {
        WallPath { walls: self.walls(), row_of, path }.search(tree, mask, id_of);
    }
}

/// A path that sensors let through, and walls from one side if it does not come from their left.
struct WallPath<'a, P> {
    walls: &'a [Wall],
    row_of: &'a dyn Fn(u64) -> Option<u32>,
    path: &'a mut P,
}

impl<P: RayPath<f32>> RayPath<f32> for WallPath<'_, P> {
    fn ray(&mut self) -> &mut Ray<f32> {
        self.path.ray()
    }

    fn limit(&self) -> f32 {
        self.path.limit()
    }

    fn offer(&mut self, shape: &Shape<f32>, id: u64) {
        let Some(wall) = (self.row_of)(id).map(|row| &self.walls[row as usize]) else { return };
        // The ends of the shape, not those of the wall: on a torus the ray is moved to the image that is tested.
        let is_stopped = !wall.is_one_way
            || shape.segment().is_some_and(|ends| {
                let Moving { origin, direction, half_size, radius } = Moving::of(self.path.ray());
                let ends = ends.map(|end| end.map(f64::from));
                may_stop(ends, (origin, direction), (half_size, radius))
            });
        if is_stopped && !wall.is_sensor {
            self.path.offer(shape, id);
        }
    }

    fn take(&mut self, hit: RayContact<f32>) {
        self.path.take(hit);
    }

    fn count(&mut self, tests: usize) {
        self.path.count(tests);
    }

    fn is_over(&mut self, work: usize) -> bool {
        self.path.is_over(work)
    }
}

/// A rounded box that moves along a ray.
struct Moving {
    origin: Vector,
    direction: Vector,
    half_size: Vector,
    radius: f64,
}

/// Where it is stopped.
#[derive(Clone, Copy)]
struct Stop {
    distance: f64,
    normal: Vector,
    /// From the centre of the shape to the point where it touches.
    touch: Vector,
}

impl Stop {
    /// The shape overlaps or touches before it moves.
    const AT_ONCE: Self = Self { distance: 0.0, normal: [0.0; 2], touch: [0.0; 2] };

    fn with_id(self, id: u64) -> RayContact<f32> {
        let [normal, touch] = [self.normal, self.touch].map(|pair| pair.map(|v| v as f32));
        RayContact { distance: self.distance as f32, id, normal, touch }
    }
}

impl Moving {
    fn of(ray: &Ray<f32>) -> Self {
        let (half_size, radius) = ray.shape();
        let [origin, direction, half_size] =
            [ray.origin(), ray.direction(), half_size].map(|pair| pair.map(f64::from));
        Self { origin, direction, half_size, radius: f64::from(radius) }
    }

    /// The stop at the container, and the number of the side.
    fn hit_side(&self, container: &Container) -> Option<(u32, Stop)> {
        let mut first = None::<(u32, Stop)>;
        for (number, side) in container.sides() {
            let stop = match side {
                Side::Flat { axis, inward, at } => self.stop_at_flat_side(axis, inward, at),
                Side::Round { center, radius } => Some(self.stop_at_rim(center, radius)),
            };
            // Strictly nearer: of two sides at the same distance that with the smaller number.
            let is_first = |stop: &Stop| first.is_none_or(|(_, of)| stop.distance < of.distance);
            first = stop.filter(is_first).map(|stop| (number, stop)).or(first);
        }
        first
    }

    fn stop_at_flat_side(&self, axis: usize, inward: f64, at: f64) -> Option<Stop> {
        let extent = self.half_size[axis] + self.radius;
        let gap = inward * (self.origin[axis] - at) - extent;
        if gap <= 0.0 {
            return Some(Stop::AT_ONCE);
        }
        let approach = -inward * self.direction[axis];
        let along = |value: f64| vector(|k| if k == axis { value } else { 0.0 });
        (approach > 0.0).then(|| Stop {
            distance: gap / approach,
            normal: along(inward),
            touch: along(-inward * extent),
        })
    }

    /// The first corner of the core that reaches the rim of a round container.
    fn stop_at_rim(&self, center: Vector, outer: f64) -> Stop {
        let bound = outer - self.radius;
        let [hx, hy] = self.half_size;
        let mut first = None::<Stop>;
        for corner in [[-hx, -hy], [hx, -hy], [-hx, hy], [hx, hy]] {
            let (u, m) = (self.direction, vector(|k| self.origin[k] + corner[k] - center[k]));
            if bound <= 0.0 || dot(m, m) >= bound * bound {
                return Stop::AT_ONCE;
            }
            let across = m[0] * u[1] - m[1] * u[0];
            let distance = (bound * bound - across * across).sqrt() - dot(m, u);
            if first.is_none_or(|of| distance < of.distance) {
                let normal = vector(|k| -(m[k] + u[k] * distance) / bound);
                let touch = vector(|k| corner[k] - normal[k] * self.radius);
                first = Some(Stop { distance, normal, touch });
            }
        }
        first.unwrap_or(Stop::AT_ONCE)
    }
}
