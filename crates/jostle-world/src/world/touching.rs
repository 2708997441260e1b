//! Narrow phase at the end of a step: the pairs that touch then.

use std::cmp::Ordering;

use super::World;
use super::bounds::rounding;
use super::search::{self, ListScratch, Lists};
use crate::motion::exact;
use crate::particles::Particles;
use crate::tolerance::{COARSE, Tolerance, gap, size_of};
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::{Shapes, fill_filters};

/// Scratch.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    shapes: Shapes<f32>,
    tree: Quadtree<f32>,
    listing: ListScratch,
    lists: Lists,
}

impl World {
    /// The pairs of ids that touch now, sorted: those with a small gap, and those that resting
    /// contacts press together.
    pub(crate) fn touching(&mut self) -> Result<Vec<[Id; 2]>> {
        let mut scratch = std::mem::take(&mut self.scratch.touching);
        let found = self.find_touching(&mut scratch);
        self.scratch.touching = scratch;
        let rows = found?;
        let pressed = self.contacts.lasting().filter(|contact| contact.impulse > 0.0);
        let pressed = pressed
            .map(|contact| contact.indices.map(|index| self.bodies.awake.rows[index as usize]));
        let asleep = self.bodies.asleep.contacts().filter(|contact| contact.impulse > 0.0);
        let asleep = asleep.map(|contact| contact.indices);
        let rows = rows.into_iter().chain(pressed).chain(asleep);
        let mut all: Vec<[Id; 2]> = rows.filter_map(|rows| self.known_pair(rows)).collect();
        all.extend(self.halo.protocol().touching_asleep(self));
        all.sort_unstable();
        all.dedup();
        Ok(all)
    }

    /// The pairs of sleeping particles that touched when they were recorded.
    pub(crate) fn known_touches_asleep(&self) -> Vec<[Id; 2]> {
        if !self.record.knows_sleepers || self.bodies.asleep.is_empty() {
            return Vec::new();
        }
        let asleep = self.bodies.asleep();
        let sleeps = |&id: &Id| self.bodies.ids.row(id).is_some_and(|row| asleep[row as usize]);
        let known = self.record.at_end.iter().filter(|pair| pair.iter().any(sleeps));
        known.filter(|pair| pair.iter().all(|&id| self.bodies.contains(id))).copied().collect()
    }

    /// The pairs of rows with a small gap. Sleeping ones are left out if their pairs are known.
    fn find_touching(&self, scratch: &mut Scratch) -> Result<Vec<[u32; 2]>> {
        let is_whole = self.halo.is_whole();
        if self.bodies.asleep.is_empty() || self.record.knows_sleepers || !is_whole {
            let pairs = self.find_touching_of(&self.bodies.awake.particles, scratch)?;
            return Ok(pairs
                .map(|pair| pair.map(|index| self.bodies.awake.rows[index as usize]))
                .collect());
        }
        Ok(self.find_touching_of(&self.bodies.particles(), scratch)?.collect())
    }

    pub(crate) fn find_touching_of<'a>(
        &self,
        all: &'a Particles,
        scratch: &'a mut Scratch,
    ) -> Result<impl Iterator<Item = [u32; 2]> + use<'a>> {
        let container = self.settings.container;
        let Scratch { shapes, tree, listing, lists } = scratch;
        let columns = shapes.columns_mut();
        columns.centers.clear();
        columns
            .centers
            .extend(all.positions.iter().map(|&position| container.period().wrap(position)));
        let radii = columns.radii.rows_mut();
        radii.clear();
        // The circles contain every gap that may count as touching: that is at most `COARSE` of the
        // size.
        radii.extend(all.radii.iter().zip(&all.positions).map(|(&radius, &position)| {
            radius * (1.0 + 2.0 * COARSE as f32) + 2.0 * rounding(position, radius, &container)
        }));
        fill_filters(all.filters.iter().copied(), columns.filters);
        tree.rebuild_unchecked(shapes, self.settings.tree, &|_, _| Ordering::Equal)?;
        search::list(tree, &self.settings, false, listing, lists)?;
        let touch = move |[a, b]: [u32; 2]| {
            let [a, b] = [a, b].map(|index| index as usize);
            if !all.may_touch(a, b) {
                return false;
            }
            let [p, q] = [a, b].map(|at| exact(all.positions[at], all.residuals[at]));
            let contact_distance = f64::from(all.radii[a]) + f64::from(all.radii[b]);
            let [x, y] = container.period().exact().minimum_image([q[0] - p[0], q[1] - p[1]]);
            let [r, s] = [all.radii[a], all.radii[b]];
            // The tolerance is that at the centre of the smaller disc. Of two equal discs the
            // larger tolerance counts, so that their order does not matter.
            let near = |place| Tolerance::of(f64::from(size_of(r, s)), place).rounding();
            let near = match r.total_cmp(&s) {
                Ordering::Less => near(p),
                Ordering::Greater => near(q),
                Ordering::Equal => near(p).max(near(q)),
            };
            gap([x, y], contact_distance).1 <= near
        };
        let (tree, lists) = (&*tree, &*lists);
        let pairs = lists.iter().flat_map(|(_, pairs)| pairs);
        let pairs = pairs.map(|pair| pair.map(|index| tree.rows()[index as usize]));
        Ok(pairs.filter(move |&pair| touch(pair)))
    }
}
