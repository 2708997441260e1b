//! Queries in a periodic plane: each region is replaced by those of its images that may overlap a
//! shape, and their answers are combined.

use super::region::{Hits, Region};
use crate::geometry::{Bounds, Scalar};
use crate::period::Period;
use jostle_base::error::Result;
use jostle_base::interrupt::Pulse;
use jostle_base::memory;
use jostle_base::sorting::{self, Bytes};

/// The images of some regions.
pub struct Images<R> {
    /// The regions of one query are adjacent.
    pub regions: Vec<R>,
    /// The end of the regions of each query.
    ends: Vec<usize>,
}

impl<R> Images<R> {
    /// The images of `regions` that may overlap shapes within `bounds`, or anywhere if there are
    /// none. Refuses regions that are too large for the period.
    pub fn of<T: Scalar>(
        regions: &[R],
        period: &Period<T>,
        bounds: Option<&Bounds<T>>,
    ) -> Result<Self>
    where
        R: Region<T>,
    {
        let mut pulse = Pulse::current();
        let mut images = Self {
            regions: memory::with_capacity(regions.len())?,
            ends: memory::with_capacity(regions.len())?,
        };
        for (index, region) in regions.iter().enumerate() {
            pulse.check(16)?;
            region.check_period(index, period)?;
            // Centres of shapes are in the first period. With the region there as well, its images
            // by one period in each direction are all that can overlap.
            let wrapped = region.wrapped(period);
            for shift in period.images() {
                let image = wrapped.moved(shift);
                if bounds.is_none_or(|bounds| image.window().may_touch(bounds)) {
                    memory::push(&mut images.regions, image)?;
                }
            }
            images.ends.push(images.regions.len());
        }
        Ok(images)
    }

    /// The answers of the queries from those of their images; each id once, ascending.
    pub fn combine<I: Bytes>(&self, found: Hits<I>) -> Result<Hits<I>> {
        let mut pulse = Pulse::current();
        let mut all = Hits { tests: found.tests, ..Hits::with_capacity(self.ends.len())? };
        memory::reserve(&mut all.ids, found.ids.len())?;
        let mut first = 0;
        for &end in &self.ends {
            let start = all.ids.len();
            for image in first..end {
                pulse.check(1 + found.of(image).len())?;
                all.ids.extend_from_slice(found.of(image));
            }
            // A shape that is wide, or in a corner, is found by several images of a region.
            if end - first > 1 {
                sorting::sort(&mut all.ids[start..], &mut pulse)?;
                remove_repeated(&mut all.ids, start);
            }
            first = end;
            all.offsets.push(all.ids.len());
        }
        Ok(all)
    }
}

/// Removes repeated values from the sorted end of a list.
fn remove_repeated<I: Copy + PartialEq>(ids: &mut Vec<I>, start: usize) {
    let mut kept = start;
    for index in start..ids.len() {
        if kept == start || ids[index] != ids[kept - 1] {
            ids[kept] = ids[index];
            kept += 1;
        }
    }
    ids.truncate(kept);
}
