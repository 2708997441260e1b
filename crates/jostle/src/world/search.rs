//! Pairs of particles, by whichever method the world uses.

use std::cmp::Ordering;

use super::{MAX_CANDIDATES, Touch, World, WorldSettings};
use crate::error::{Error, Result};
use crate::pairs::{self, SortScratch};
use crate::parallel;
use crate::quadtree::Quadtree;
use crate::settings::Method;
use crate::shapes::{Each, Shapes};

/// Pairs of places, a list for each offset: first those in the plane, with offset 0, then those
/// across each seam of a torus. A pair overlaps if the second is moved by the offset.
pub(super) type Lists = Vec<([f32; 2], Vec<[u32; 2]>)>;

/// Lists the pairs of shapes that overlap, sorted if there is memory to sort them in; returns how
/// many were tested.
pub(super) fn list(
    tree: &Quadtree<f32>,
    settings: &WorldSettings,
    mut sorting: Option<&mut SortScratch>,
    lists: &mut Lists,
) -> Result<u64> {
    // Brute force gains from other threads with fewer shapes than a tree.
    let (threads, max) = (settings.tree.threads, MAX_CANDIDATES);
    let brute = settings.method == Method::Brute;
    lists.clear();
    let mut tests = 0;
    let mut keep = |image, mut found: pairs::Found| {
        tests += found.tests;
        if let Some(sorting) = &mut sorting {
            pairs::sort_places(&mut found.pairs, tree.len(), sorting)?;
        }
        lists.push((image, found.pairs));
        Ok(())
    };
    let refused = |error| match error {
        Error::TooManyPairs { max_pairs } => Error::TooManyCandidates { most: max_pairs },
        other => other,
    };
    let within = if brute {
        pairs::brute(tree.columns(), threads, max)
    } else {
        pairs::places_within(tree, max)
    };
    keep([0.0; 2], within.map_err(refused)?)?;
    for image in settings.container.images() {
        let across = if brute {
            pairs::brute_between(tree.columns(), tree.columns(), image, max)
        } else {
            pairs::places_between(tree, tree, image, max)
        };
        let mut across = across.map_err(refused)?;
        across.pairs.retain(|pair| pair[0] != pair[1]);
        keep(image, across)?;
    }
    Ok(tests)
}

/// Two particles that overlap, at least one of them movable.
#[derive(Clone, Copy, Debug)]
pub(super) struct Overlap {
    pub(super) places: [u32; 2],
    /// From the first to the second.
    offset: [f32; 2],
    /// Sum of the radii.
    reach: f32,
}

impl World {
    /// The pairs that overlap where they are now, in the order of a tree, and how many
    /// were tested.
    pub(super) fn overlapping(&self) -> Result<(Vec<Overlap>, u64)> {
        parallel::among(self.threads(), || self.overlapping_here())
    }

    fn overlapping_here(&self) -> Result<(Vec<Overlap>, u64)> {
        let (all, settings) = (&self.particles, &self.settings);
        let centers: Vec<_> = all.positions.iter().map(|&p| settings.container.wrap(p)).collect();
        let radii = Each::Rows(all.radii.clone());
        let shapes = Shapes { centers, radii, ..Shapes::default() };
        let mut tree = Quadtree::default();
        tree.rebuild(&shapes, settings.tree, &|_, _| Ordering::Equal)?;
        let mut lists = Vec::new();
        let tests = list(&tree, settings, Some(&mut SortScratch::default()), &mut lists)?;
        let mut found = Vec::new();
        for (image, pairs) in lists {
            for pair in pairs {
                let places = pair.map(|place| tree.rows()[place as usize]);
                let [a, b] = places.map(|place| place as usize);
                if all.movable[a] || all.movable[b] {
                    let [from, to] = [a, b].map(|place| shapes.centers[place]);
                    let offset = [0, 1].map(|k| to[k] - from[k] + image[k]);
                    let reach = all.radii[a] + all.radii[b];
                    found.push(Overlap { places, offset, reach });
                }
            }
        }
        Ok((found, tests))
    }

    /// The overlapping pairs by row, as callers see them.
    pub(super) fn overlaps(&self) -> Result<Vec<Touch>> {
        let touch = |Overlap { places, offset, reach }: Overlap| {
            let [i, j] = places.map(|place| self.rows[place as usize]);
            let length = (offset[0] * offset[0] + offset[1] * offset[1]).sqrt();
            let sign = if i < j { 1.0 } else { -1.0 };
            // The normal of coincident centres is +x.
            let normal = if length > 0.0 { offset.map(|v| v * sign / length) } else { [1.0, 0.0] };
            Touch { pair: [i.min(j), i.max(j)], normal, depth: reach - length }
        };
        let mut touches: Vec<Touch> = self.overlapping()?.0.into_iter().map(touch).collect();
        touches.sort_unstable_by_key(|touch| touch.pair);
        Ok(touches)
    }
}
