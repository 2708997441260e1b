//! Queries of the walls where they are now, by their ids: regions, nearest ones, casts.

use super::World;
use super::queries::hits_with;
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_index::quadtree::Quadtree;
use jostle_index::query::{self, Hits, Neighbors, Ray, RayHits, RayPath, Region};
use jostle_index::shapes::Each;

impl World {
    /// The walls that overlap each region. If there is a `mask`, only those with a category in it.
    pub fn search_walls<R: Region<f32>>(
        &self,
        regions: &[R],
        mask: Option<u32>,
    ) -> Result<Hits<Id>> {
        let tree = self.boundaries.wall_tree(&self.settings)?;
        hits_with(&self.boundaries.ids, query::search(tree, regions, mask)?)
    }

    /// The `k` walls nearest to each point, not farther than the maximum distance.
    pub fn nearest_walls(
        &self,
        points: &[[f32; 2]],
        wanted: (usize, Each<f32>),
        mask: Option<u32>,
    ) -> Result<Neighbors<f32>> {
        let tree = self.boundaries.wall_tree(&self.settings)?;
        let mut found = query::nearest(tree, points, wanted, mask)?;
        // −1 stands for none.
        let rows = found.ids.iter_mut().filter(|row| **row >= 0);
        rows.for_each(|row| *row = self.boundaries.ids.of(*row as u32));
        Ok(found)
    }

    /// The first wall that each ray hits.
    pub fn first_wall_hits(&self, rays: &[Ray<f32>], mask: Option<u32>) -> Result<RayHits<f32>> {
        let tree = self.boundaries.wall_tree(&self.settings)?;
        query::first_hits_by(rays, &tree.period(), self.settings.tree.threads, |first| {
            self.cast_by_id(tree, mask, first);
        })
    }

    /// All walls that each ray hits, nearest first.
    pub fn all_wall_hits(&self, rays: &[Ray<f32>], mask: Option<u32>) -> Result<RayHits<f32>> {
        let tree = self.boundaries.wall_tree(&self.settings)?;
        query::all_hits_by(rays, &tree.period(), self.settings.tree.threads, |all| {
            self.cast_by_id(tree, mask, all);
        })
    }

    fn cast_by_id(&self, tree: &Quadtree<f32>, mask: Option<u32>, path: &mut impl RayPath<f32>) {
        let (rows, ids) = (tree.rows(), &self.boundaries.ids);
        let id_of = |index: usize| Some(ids.of(rows[index]) as u64);
        self.cast_walls(tree, (mask, &id_of, &|id| ids.row(id as Id)), path);
    }
}
