//! Queries of a space: each tree is queried, and fresh shapes are tested one by one.

use super::space::Space;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::interrupt::Pulse;
use jostle_base::memory;
use jostle_base::sorting;
use jostle_index::geometry::Scalar;
use jostle_index::query::{
    self, Hits, Images, MAX_IDS, Nearest, Neighbors, Ray, RayHits, RayPath, Region, selects,
};
use jostle_index::shapes::Each;

/// With more fresh shapes than this, a tree of them is faster than testing each.
const FEW: usize = 256;

/// Rows converted to ids between two checks for an interruption.
const CHUNK: usize = 1 << 14;

/// Number of tests of fresh shapes in a call that take about as long as building a tree of [`FEW`]
/// shapes.
const FEW_LOOKS: usize = 64 * FEW;

impl<T: Scalar> Space<T> {
    /// The ids of all shapes that each region overlaps, ascending; only those with a category
    /// in `mask`, if there is one.
    pub fn search<R: Region<T>>(&mut self, regions: &[R], mask: Option<u32>) -> Result<Hits<Id>> {
        self.prepare(regions.len())?;
        if self.period.is_none() {
            return self.search_here(regions, mask);
        }
        let images = Images::of(regions, &self.period, self.layers.bounds(&self.slots).as_ref())?;
        images.combine(self.search_here(&images.regions, mask)?)
    }

    /// As [`Space::search`], without the images of a periodic plane.
    fn search_here<R: Region<T>>(&mut self, regions: &[R], mask: Option<u32>) -> Result<Hits<Id>> {
        match self.search_all(regions, mask) {
            Err(Error::TooManyIds { .. }) => {
                // Shapes that have left their layers may have been counted; here there are none.
                // One new tree of all shapes. Its hits are all valid, so a second failure is a real
                // one.
                self.layers.part(&[], &self.slots, self.settings)?;
                self.search_all(regions, mask)
            }
            found => found,
        }
    }

    fn search_all<R: Region<T>>(&self, regions: &[R], mask: Option<u32>) -> Result<Hits<Id>> {
        let layers = self.layers.indices().map(|index| {
            let (tree, slot) = self.layers.layer(index);
            Ok((query::search_here(tree, regions, mask)?, slot))
        });
        let layers = layers.collect::<Result<Vec<_>>>()?;
        let mut fresh: Vec<u32> = memory::with_capacity(self.layers.fresh_listed())?;
        fresh.extend(self.layers.fresh());
        let mut all = Hits::with_capacity(regions.len())?;
        let mut pulse = Pulse::current();
        for (question, region) in regions.iter().enumerate() {
            let start = all.ids.len();
            for (hits, slot) in &layers {
                memory::reserve(&mut all.ids, hits.of(question).len())?;
                for rows in hits.of(question).chunks(CHUNK) {
                    pulse.check(rows.len())?;
                    // `slot` is None for a copy of a shape that has left the layer. The valid copy
                    // is in another one, or fresh.
                    let slots = rows.iter().filter_map(|&row| slot(row));
                    all.ids.extend(slots.map(|slot| self.slots.id(slot)));
                }
            }
            for &slot in &fresh {
                pulse.check(1)?;
                let shape = self.slots.shape(slot);
                if selects(mask, shape.category) && region.overlaps(&shape) {
                    memory::push(&mut all.ids, self.slots.id(slot))?;
                }
            }
            if all.ids.len() > MAX_IDS {
                return Err(Error::TooManyIds { limit: MAX_IDS });
            }
            // Rows of each layer are sorted, but the ids of all layers together are not.
            sorting::sort(&mut all.ids[start..], &mut pulse)?;
            all.offsets.push(all.ids.len());
        }
        all.tests = layers.iter().map(|(hits, _)| hits.tests).sum::<u64>()
            + (fresh.len() * regions.len()) as u64;
        Ok(all)
    }

    /// The `k` shapes nearest to each point and not farther than `max_distance`; at equal distances
    /// the smaller id first. If there is a `mask`, only shapes with a category in it.
    pub fn nearest(
        &mut self,
        points: &[[T; 2]],
        (k, max_distance): (usize, impl Into<Each<T>>),
        mask: Option<u32>,
    ) -> Result<Neighbors<T>> {
        let max_distances = max_distance.into();
        let wanted = (k, &max_distances);
        query::check_nearest(points, wanted)?;
        self.prepare(points.len())?;
        let look = |point, best: &mut Nearest<T>| self.look_around(point, mask, best);
        let shape_of = |id: u64| self.slots.shape(self.slots.slot(id as Id).expect("was found"));
        let distance_of = |point, id| query::distance_in(&self.period, point, &shape_of(id));
        query::nearest_from(points, wanted, self.settings.threads, look, distance_of)
    }

    fn look_around(&self, point: [T; 2], mask: Option<u32>, best: &mut Nearest<T>) {
        // Fresh shapes first: each hit lowers the limit with which the trees are searched.
        for slot in self.layers.fresh() {
            if best.is_over(1) {
                return;
            }
            let shape = self.slots.shape(slot);
            best.tests += 1;
            if selects(mask, shape.category) {
                let distance = query::distance_in(&self.period, point, &shape);
                best.offer(distance, self.slots.id(slot) as u64);
            }
        }
        for number in self.layers.indices() {
            let (tree, slot) = self.layers.layer(number);
            let id_of = |index| slot(tree.rows()[index]).map(|slot| self.slots.id(slot) as u64);
            best.search(tree, point, mask, &id_of);
        }
    }

    /// The first shape that each ray hits; at equal distances that with the smaller id. If there is
    /// a `mask`, only shapes with a category in it.
    pub fn first_hits(&mut self, rays: &[Ray<T>], mask: Option<u32>) -> Result<RayHits<T>> {
        self.prepare(rays.len())?;
        let (period, threads) = (self.period, self.settings.threads);
        query::first_hits_by(rays, &period, threads, |best| self.look_along(mask, best))
    }

    /// All shapes that each ray hits, nearest first. If there is a `mask`, only shapes with a
    /// category in it.
    pub fn all_hits(&mut self, rays: &[Ray<T>], mask: Option<u32>) -> Result<RayHits<T>> {
        self.prepare(rays.len())?;
        let (period, threads) = (self.period, self.settings.threads);
        query::all_hits_by(rays, &period, threads, |all| self.look_along(mask, all))
    }

    fn look_along(&self, mask: Option<u32>, best: &mut impl RayPath<T>) {
        for slot in self.layers.fresh() {
            if best.is_over(1) {
                return;
            }
            let shape = self.slots.shape(slot);
            best.count(1);
            if selects(mask, shape.category) {
                best.offer_in(&self.period, &shape, self.slots.id(slot) as u64);
            }
        }
        for number in self.layers.indices() {
            let (tree, slot) = self.layers.layer(number);
            let id_of = |index| slot(tree.rows()[index]).map(|slot| self.slots.id(slot) as u64);
            best.search(tree, mask, &id_of);
        }
    }

    /// Builds a tree of the fresh shapes if that is faster for this number of queries.
    fn prepare(&mut self, questions: usize) -> Result<()> {
        let fresh = self.layers.fresh_listed();
        // A tree of 256 shapes takes about as long as 64 tests of each. Below that a call tests
        // them one by one, so that a program which moves a shape and asks one question does not
        // build a tree each time.
        if fresh > FEW || fresh.saturating_mul(questions) > FEW_LOOKS {
            self.layers.fold(&self.slots, self.settings)?;
        }
        Ok(())
    }
}
