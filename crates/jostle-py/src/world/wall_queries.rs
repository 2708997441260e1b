//! The queries of the walls of a world.

use jostle_base::Id;
use jostle_index::Each;
use jostle_index::query::{Hits, Neighbors, Ray, Region};
use pyo3::prelude::*;

use super::State;
use super::wall_view::PyWalls;
use crate::arrays::Given;
use crate::lock::Shared;
use crate::queries::{self, Answer, Cast, Maybe};
use crate::query_methods::{Casts, Index, cast_methods, near_methods, region_methods};

/// The walls of a world as the [`Index`] of queries.
struct WallIndex<'a>(&'a Shared<State>);

/// The walls as the [`Index`] of queries.
macro_rules! with_walls {
    ($self:ident, $name:ident => $do:expr) => {{
        let $name = &WallIndex(&$self.world().state);
        $do
    }};
}

region_methods!(PyWalls, with_walls);
near_methods!(PyWalls, with_walls);
cast_methods!(PyWalls, with_walls);

impl Index<f32> for WallIndex<'_> {
    type Id = Id;

    fn search<R: Region<f32>>(&self, regions: &[R], mask: Option<u32>) -> Answer<Hits<Id>> {
        Ok(self.0.lock()?.world.search_walls(regions, mask))
    }

    fn nearest(
        &self,
        points: &[[f32; 2]],
        wanted: (usize, Each<f32>),
        mask: Option<u32>,
    ) -> Answer<Neighbors<f32>> {
        Ok(self.0.lock()?.world.nearest_walls(points, wanted, mask))
    }

    fn first_hits(&self, rays: &[Ray<f32>], mask: Option<u32>) -> Answer<Casts<f32>> {
        Ok(self.0.lock()?.world.first_wall_hits(rays, mask).and_then(Casts::of_walls))
    }

    fn all_hits(&self, rays: &[Ray<f32>], mask: Option<u32>) -> Answer<Casts<f32>> {
        Ok(self.0.lock()?.world.all_wall_hits(rays, mask).and_then(Casts::of_walls))
    }
}
