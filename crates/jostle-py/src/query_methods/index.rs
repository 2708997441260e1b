//! A tree, a space, a world or its walls as the target of queries.

use std::sync::atomic::{AtomicU64, Ordering};

use jostle_base::memory;
use jostle_index::query::{self, Hits, Neighbors, Ray, RayHits, Region};
use jostle_index::{Each, Quadtree, Scalar};
use jostle_space::Space;

use crate::lock::Shared;
use crate::queries::Answer;

/// The hits of rays.
pub struct Casts<T> {
    /// Ids, distances, points and normals.
    pub hits: RayHits<T>,
    /// The wall or side that is hit; −1 if it is a shape or nothing.
    pub walls: Vec<i64>,
}

impl<T> Casts<T> {
    /// Hits where there are no walls.
    fn of_shapes(hits: RayHits<T>) -> jostle_base::Result<Self> {
        let walls = memory::filled(hits.ids.len(), -1)?;
        Ok(Self { hits, walls })
    }
}

impl Casts<f32> {
    /// Hits of walls alone, whose ids are those of walls.
    pub fn of_walls(hits: RayHits<f32>) -> jostle_base::Result<Self> {
        let walls = memory::copy(&hits.ids)?;
        Ok(Self { hits, walls })
    }
}

impl From<jostle_world::Casts> for Casts<f32> {
    fn from(jostle_world::Casts { hits, walls }: jostle_world::Casts) -> Self {
        Self { hits, walls }
    }
}

/// A tree, a space, a world or its walls as the target of queries.
pub trait Index<T> {
    /// A row of a tree, or an id of the others.
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
    fn first_hits(&self, rays: &[Ray<T>], mask: Option<u32>) -> Answer<Casts<T>>;
    /// All shapes that each ray hits.
    fn all_hits(&self, rays: &[Ray<T>], mask: Option<u32>) -> Answer<Casts<T>>;
}

/// An [`Index`] that finds the neighbours of its own shapes.
pub trait NeighborIndex<T>: Index<T> {
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
    fn count<R>(&self, found: jostle_base::Result<R>, tests: impl Fn(&R) -> u64) -> Answer<R> {
        // Relaxed: a number for statistics; no other memory depends on it.
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

    fn first_hits(&self, rays: &[Ray<T>], mask: Option<u32>) -> Answer<Casts<T>> {
        Ok(self
            .count(query::first_hits(self.tree, rays, mask), |found| found.tests)?
            .and_then(Casts::of_shapes))
    }

    fn all_hits(&self, rays: &[Ray<T>], mask: Option<u32>) -> Answer<Casts<T>> {
        Ok(self
            .count(query::all_hits(self.tree, rays, mask), |found| found.tests)?
            .and_then(Casts::of_shapes))
    }
}

impl<T: Scalar> NeighborIndex<T> for CountedTree<'_, T> {
    fn neighbors(&self, distance: T, mask: Option<u32>) -> Answer<Hits<u32>> {
        self.count(query::neighbors(self.tree, distance, mask), |found| found.tests)
    }
}

impl<T: Scalar> Index<T> for Shared<Space<T>> {
    type Id = jostle_base::Id;

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

    fn first_hits(&self, rays: &[Ray<T>], mask: Option<u32>) -> Answer<Casts<T>> {
        Ok(self.lock()?.first_hits(rays, mask).and_then(Casts::of_shapes))
    }

    fn all_hits(&self, rays: &[Ray<T>], mask: Option<u32>) -> Answer<Casts<T>> {
        Ok(self.lock()?.all_hits(rays, mask).and_then(Casts::of_shapes))
    }
}

impl<T: Scalar> NeighborIndex<T> for Shared<Space<T>> {
    fn neighbors(&self, distance: T, mask: Option<u32>) -> Answer<Hits<Self::Id>> {
        Ok(self.lock()?.neighbors(distance, mask))
    }
}
