//! The broad phase: candidate pairs of particles, by the tree or by brute force.

use std::cmp::Ordering;
use std::iter;

use super::settings::WorldSettings;
use crate::particles::Particles;
use jostle_base::error::{Error, Result};
use jostle_base::memory;
use jostle_base::settings::Method;
use jostle_index::pairs::{self, Filters, JoinScratch, SortScratch};
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::{Each, Shapes, fill_filters};

/// Candidate pairs of a step at most. They take 256 MiB, with everything that is stored for each
/// about four GiB.
pub(crate) const MAX_CANDIDATES: usize = 1 << 25;

/// Pairs of indices, a list for each offset: first those in the plane, with offset 0, then those
/// across each seam of a torus. A pair overlaps if the second is moved by the offset.
pub(crate) type Lists = Vec<([f32; 2], Vec<[u32; 2]>)>;

/// Scratch of [`list`].
#[derive(Debug, Default)]
pub(crate) struct ListScratch {
    join: JoinScratch,
    sorting: SortScratch,
}

/// Lists the pairs of shapes that overlap, sorted if that is wanted, in the memory of earlier lists;
/// returns how many were tested.
pub(crate) fn list(
    tree: &Quadtree<f32>,
    settings: &WorldSettings,
    is_sorted: bool,
    scratch: &mut ListScratch,
    lists: &mut Lists,
) -> Result<u64> {
    // Brute force gains from other threads with fewer shapes than a tree.
    let (threads, max) = (settings.tree.threads, MAX_CANDIDATES);
    let ListScratch { join, sorting } = scratch;
    // Within one tree, the other half of the images has the same pairs with exchanged particles.
    let images = iter::once([0.0; 2]).chain(settings.container.period().half_of_images());
    let (mut count, mut tests) = (0, 0);
    for image in images {
        if lists.len() == count {
            memory::push(lists, Default::default())?;
        }
        let (image_of_list, list) = &mut lists[count];
        let (is_within, columns) = (count == 0, tree.columns());
        join.keep(std::mem::take(list));
        let found = match (settings.method, is_within) {
            (Method::Quadtree, true) => pairs::indices_within(tree, max, join),
            (Method::Quadtree, false) => {
                pairs::indices_between(tree, tree, image, Filters::Apply, max, join)
            }
            (Method::Brute, true) => pairs::brute(columns, threads, max),
            (Method::Brute, false) => {
                pairs::brute_between(columns, columns, image, Filters::Apply, max)
            }
        };
        let mut found = found.map_err(|error| match error {
            Error::TooManyPairs { max_pairs } => Error::TooManyCandidates { limit: max_pairs },
            other => other,
        })?;
        // A large circle may overlap its own image. A particle does not collide with itself.
        if !is_within {
            found.pairs.retain(|pair| pair[0] != pair[1]);
        }
        if is_sorted {
            pairs::sort_indices(&mut found.pairs, tree.len(), sorting)?;
        }
        (*image_of_list, *list) = (image, found.pairs);
        (count, tests) = (count + 1, tests + found.tests);
    }
    lists.truncate(count);
    Ok(tests)
}

/// Two particles that overlap and may touch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Overlap {
    pub(crate) indices: [u32; 2],
    /// From the first to the second.
    pub(crate) offset: [f32; 2],
    /// Sum of the radii.
    pub(crate) radius_sum: f32,
}

/// The pairs that overlap where they are now, in the order of a tree, and how many
/// were tested.
pub(crate) fn overlapping(
    all: &Particles,
    settings: &WorldSettings,
) -> Result<(Vec<Overlap>, u64)> {
    let wrap = |&position: &[f32; 2]| settings.container.period().wrap(position);
    let centers = memory::collect(all.positions.iter().map(wrap))?;
    let radii = Each::Rows(memory::copy(&all.radii)?);
    let mut shapes = Shapes::circles(centers, radii)?;
    fill_filters(all.filters.iter().copied(), shapes.columns_mut().filters)?;
    let mut tree = Quadtree::default();
    tree.rebuild(&shapes, settings.tree, &|_, _| Ordering::Equal)?;
    let mut lists = Vec::new();
    let tests = list(&tree, settings, true, &mut ListScratch::default(), &mut lists)?;
    let mut found = Vec::new();
    for (image, pairs) in lists {
        for pair in pairs {
            let indices = pair.map(|index| tree.rows()[index as usize]);
            let [a, b] = indices.map(|index| index as usize);
            if all.may_touch(a, b) {
                let [from, to] = [a, b].map(|index| shapes.centers()[index]);
                let offset = [0, 1].map(|k| to[k] - from[k] + image[k]);
                let radius_sum = all.radii[a] + all.radii[b];
                memory::push(&mut found, Overlap { indices, offset, radius_sum })?;
            }
        }
    }
    Ok((found, tests))
}
