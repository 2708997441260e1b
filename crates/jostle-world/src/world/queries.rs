//! Queries of the particles where they are now: pairs, contacts, regions, nearest ones, casts.
//!
//! Regions, nearest ones and casts search a tree of the particles that are awake, and the trees of sleeping islands.
//! The latter stay from step to step. Pairs, contacts and neighbours need all particles in one tree. The first query
//! after a step or an edit builds the tree that it needs; both drop it. Where nothing sleeps the two trees are one.
//!
//! Rows are in the order of adding, and ids ascend with rows. So what is sorted by rows is sorted by ids, and of two rows
//! the smaller has the smaller id.

use super::World;
use super::bodies::asleep::Asleep;
use super::bodies::ids::Ids;
use super::casts::Casts;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::interrupt::Pulse;
use jostle_base::memory;
use jostle_base::sorting;
use jostle_index::geometry::Bounds;
use jostle_index::pairs::{self, Overlaps};
use jostle_index::period::Period;
use jostle_index::quadtree::Quadtree;
use jostle_index::query::{self, Hits, Images, MAX_IDS, Nearest, Neighbors, Ray, RayPath, Region};
use jostle_index::shapes::Each;

/// A tree of some particles.
struct Part<'a> {
    tree: &'a Quadtree<f32>,
    rows: Rows<'a>,
    /// Number of shapes in the parts before.
    start: usize,
}

/// The row of the particle in each row of a tree.
enum Rows<'a> {
    /// That row.
    Same,
    Listed(&'a [u32]),
    /// Those of a tree of sleeping islands, from an index on.
    Asleep(&'a Asleep, usize),
}

impl Part<'_> {
    /// The row of the particle in a row of the tree; None if the tree of sleeping islands has it, but it is awake.
    fn row(&self, of_tree: u32) -> Option<u32> {
        match self.rows {
            Rows::Same => Some(of_tree),
            Rows::Listed(rows) => Some(rows[of_tree as usize]),
            Rows::Asleep(asleep, first) => asleep.row(first + of_tree as usize),
        }
    }
}

impl World {
    /// The tree of all particles where they are now, with their categories and masks, on a torus with its period. Its
    /// rows are those of the particles.
    pub fn tree(&self) -> Result<&Quadtree<f32>> {
        self.bodies.tree(&self.settings)
    }

    /// Trees that have all particles, each once.
    fn parts(&self) -> Result<Vec<Part<'_>>> {
        let bodies = &self.bodies;
        let mut parts = memory::with_capacity(1 + bodies.asleep.trees().len())?;
        if bodies.has_tree() {
            parts.push(Part { tree: self.tree()?, rows: Rows::Same, start: 0 });
            return Ok(parts);
        }
        let awake = bodies.awake_tree(&self.settings)?;
        parts.push(Part { tree: awake, rows: Rows::Listed(&bodies.awake.rows), start: 0 });
        let mut start = awake.len();
        for (tree, first) in bodies.asleep.trees() {
            parts.push(Part { tree, rows: Rows::Asleep(&bodies.asleep, first), start });
            start += tree.len();
        }
        Ok(parts)
    }

    pub(super) fn period(&self) -> Period<f32> {
        self.settings.container.period()
    }

    fn pair_of_ids(&self, pair: [u32; 2]) -> [Id; 2] {
        pair.map(|row| self.bodies.ids.of(row))
    }

    /// The pairs whose gap is below `distance`, or that overlap if it is 0, the smaller id first; sorted if `sorted`. If
    /// there is a `mask`, both must have a category in it.
    pub fn pairs_within(
        &self,
        distance: f32,
        (mask, sorted): (Option<u32>, bool),
        max_pairs: usize,
    ) -> Result<Vec<[Id; 2]>> {
        let mut found = pairs::near(self.tree()?, None, distance, mask, max_pairs)?;
        if sorted {
            found.sort()?;
        }
        memory::collect(found.pairs.into_iter().map(|pair| self.pair_of_ids(pair)))
    }

    /// The pairs that overlap, as of [`World::pairs_within`], with normals and depths.
    pub fn overlaps(
        &self,
        filter: (Option<u32>, bool),
        max_pairs: usize,
    ) -> Result<Overlaps<f32, Id>> {
        let Overlaps { pairs, normals, depths, points, categories, tests } =
            pairs::overlaps(self.tree()?, None, filter, max_pairs)?;
        let pairs = memory::collect(pairs.into_iter().map(|pair| self.pair_of_ids(pair)))?;
        Ok(Overlaps { pairs, normals, depths, points, categories, tests })
    }

    /// For each particle, in the order of adding, the ids of all whose gap to it is below `distance`, ascending, itself
    /// left out.
    pub fn neighbors(&self, distance: f32, mask: Option<u32>) -> Result<Hits<Id>> {
        hits_with(&self.bodies.ids, query::neighbors(self.tree()?, distance, mask)?)
    }

    /// The particles that overlap each region. If there is a `mask`, only those with a category in it.
    pub fn search<R: Region<f32>>(&self, regions: &[R], mask: Option<u32>) -> Result<Hits<Id>> {
        let parts = self.parts()?;
        let rows = match &parts[..] {
            [Part { tree, rows: Rows::Same, .. }] => query::search(tree, regions, mask),
            parts => match self.search_parts(parts, regions, mask) {
                // Particles of islands that are awake may have been counted twice. In one tree they are not.
                Err(Error::TooManyIds { .. }) => query::search(self.tree()?, regions, mask),
                found => found,
            },
        };
        hits_with(&self.bodies.ids, rows?)
    }

    /// The rows that overlap each region, in the trees of several parts.
    fn search_parts<R: Region<f32>>(
        &self,
        parts: &[Part<'_>],
        regions: &[R],
        mask: Option<u32>,
    ) -> Result<Hits<u32>> {
        let period = self.period();
        if period.is_none() {
            return search_here(parts, regions, mask);
        }
        let bounds = parts.iter().filter_map(|part| part.tree.bounds().first().copied());
        let images = Images::of(regions, &period, bounds.reduce(Bounds::join).as_ref())?;
        images.combine(search_here(parts, &images.regions, mask)?)
    }

    /// The `k` particles nearest to each point, not farther than the maximum distance.
    pub fn nearest(
        &self,
        points: &[[f32; 2]],
        (k, max_distances): (usize, Each<f32>),
        mask: Option<u32>,
    ) -> Result<Neighbors<f32>> {
        let (parts, period, threads) = (self.parts()?, self.period(), self.settings.tree.threads);
        // Ordered by row. The low bits find the shape again.
        let search = |point: [f32; 2], best: &mut Nearest<f32>| {
            for part in &parts {
                let code =
                    |row: u32, index: usize| u64::from(row) << 32 | (part.start + index) as u64;
                let id_of =
                    |index: usize| part.row(part.tree.rows()[index]).map(|row| code(row, index));
                best.search_in(&period, part.tree, point, mask, &id_of);
            }
        };
        let distance_of = |point: [f32; 2], code: u64| {
            let at = code as u32 as usize;
            let part = &parts[parts.partition_point(|part| part.start <= at) - 1];
            query::distance_in(&period, point, &part.tree.columns().shape(at - part.start))
        };
        let wanted = (k, &max_distances);
        let mut found = query::nearest_from(points, wanted, threads, search, distance_of)?;
        // −1 stands for none.
        let codes = found.ids.iter_mut().filter(|code| **code >= 0);
        codes.for_each(|code| *code = self.bodies.ids.of((*code >> 32) as u32));
        Ok(found)
    }

    /// The first that each ray hits of the particles, the walls and the container. If there is a `mask`, only what has a
    /// category in it.
    pub fn first_hits(&self, rays: &[Ray<f32>], mask: Option<u32>) -> Result<Casts> {
        let (period, threads) = (self.period(), self.settings.tree.threads);
        let (parts, walls) = (self.parts()?, self.boundaries.wall_tree(&self.settings)?);
        let hits = query::first_hits_by(rays, &period, threads, |first| {
            self.look_along(&parts, mask, first);
            self.cast_boundaries(walls, mask, first);
        })?;
        Casts::of(hits, |number| self.boundaries.id_of(number))
    }

    /// All that each ray hits, nearest first.
    pub fn all_hits(&self, rays: &[Ray<f32>], mask: Option<u32>) -> Result<Casts> {
        let (period, threads) = (self.period(), self.settings.tree.threads);
        let (parts, walls) = (self.parts()?, self.boundaries.wall_tree(&self.settings)?);
        let hits = query::all_hits_by(rays, &period, threads, |all| {
            self.look_along(&parts, mask, all);
            self.cast_boundaries(walls, mask, all);
        })?;
        Casts::of(hits, |number| self.boundaries.id_of(number))
    }

    fn look_along(&self, parts: &[Part<'_>], mask: Option<u32>, path: &mut impl RayPath<f32>) {
        let period = self.period();
        for part in parts {
            let row_of = |index: usize| part.row(part.tree.rows()[index]);
            let id_of = |index: usize| row_of(index).map(|row| self.bodies.ids.of(row) as u64);
            path.search_in(&period, part.tree, mask, &id_of);
        }
    }
}

/// The rows that overlap each region, ascending, without the images of a periodic plane.
fn search_here<R: Region<f32>>(
    parts: &[Part<'_>],
    regions: &[R],
    mask: Option<u32>,
) -> Result<Hits<u32>> {
    let found = parts.iter().map(|part| query::search_here(part.tree, regions, mask));
    let found = found.collect::<Result<Vec<_>>>()?;
    let mut all = Hits::with_capacity(regions.len())?;
    let mut pulse = Pulse::current();
    for question in 0..regions.len() {
        let start = all.ids.len();
        for (hits, part) in found.iter().zip(parts) {
            let rows = hits.of(question);
            pulse.check(1 + rows.len())?;
            memory::extend(&mut all.ids, rows.iter().filter_map(|&row| part.row(row)))?;
        }
        if all.ids.len() > MAX_IDS {
            return Err(Error::TooManyIds { limit: MAX_IDS });
        }
        sorting::sort(&mut all.ids[start..], &mut pulse)?;
        all.offsets.push(all.ids.len());
    }
    all.tests = found.iter().map(|hits| hits.tests).sum();
    Ok(all)
}

/// Hits with the ids of rows.
pub(super) fn hits_with(of: &Ids, Hits { offsets, ids, tests }: Hits<u32>) -> Result<Hits<Id>> {
    let ids = memory::collect(ids.into_iter().map(|row| of.of(row)))?;
    Ok(Hits { offsets, ids, tests })
}
