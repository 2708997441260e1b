//! The neighbours of every shape within a distance, in compressed sparse rows.

use super::region::{Hits, MAX_IDS};
use crate::geometry::Scalar;
use crate::pairs::{self, Found};
use crate::quadtree::Quadtree;
use jostle_base::error::{Error, Result};
use jostle_base::interrupt::{Pulse, Stop};
use jostle_base::memory;
use jostle_base::parallel;
use jostle_base::sorting;

/// Rows sorted between two checks for interruption.
const ROWS: usize = 1 << 10;

/// For each row of a tree, the rows of all shapes whose gap to it is below `distance`, ascending,
/// itself left out. If there is a `mask`, both shapes must have a category in it.
pub fn neighbors<T: Scalar>(
    tree: &Quadtree<T>,
    distance: T,
    mask: Option<u32>,
) -> Result<Hits<u32>> {
    // Each pair becomes two ids, one at either shape.
    let found = pairs::near(tree, None, distance, mask, MAX_IDS / 2);
    let found = found.map_err(|error| match error {
        Error::TooManyPairs { .. } => Error::TooManyIds { limit: MAX_IDS },
        other => other,
    })?;
    neighbors_of_pairs(tree.len(), found, tree.settings().threads)
}

/// The rows of each row with which it is in a pair, ascending.
pub fn neighbors_of_pairs(len: usize, found: Found, threads: Option<usize>) -> Result<Hits<u32>> {
    let Found { pairs, tests } = found;
    let mut pulse = Pulse::current();
    let mut offsets: Vec<usize> = memory::filled(len + 1, 0)?;
    // For each row, the index at which its next neighbour is stored.
    let mut next: Vec<u32> = memory::filled(len + 1, 0)?;
    for pairs in pairs.chunks(ROWS) {
        pulse.check(2 * pairs.len())?;
        for &[i, j] in pairs {
            next[i as usize] += 1;
            next[j as usize] += 1;
        }
    }
    // `next` counts, then holds the place of each row's next neighbour, and ends up at the row's
    // end. So `offsets` is copied before anything is written.
    sorting::prefix_sum(&mut next);
    offsets.iter_mut().zip(&next).for_each(|(offset, &next)| *offset = next as usize);
    let mut ids: Vec<u32> = memory::zeroed(2 * pairs.len())?;
    for pairs in pairs.chunks(ROWS) {
        pulse.check(2 * pairs.len())?;
        for &[i, j] in pairs {
            for [row, other] in [[i, j], [j, i]] {
                ids[next[row as usize] as usize] = other;
                next[row as usize] += 1;
            }
        }
    }
    // Ids are as many bytes as pairs. Without the pairs the sort below needs no more than the
    // result.
    drop(pairs);
    sort_rows(&offsets, &mut ids, parallel::worthwhile(threads, len))?;
    Ok(Hits { offsets, ids, tests })
}

/// Sorts the ids of each row.
fn sort_rows(offsets: &[usize], mut ids: &mut [u32], threads: Option<usize>) -> Result<()> {
    let stop = Stop::current();
    let rows = offsets.len() - 1;
    let mut tasks = memory::with_capacity(rows.div_ceil(ROWS))?;
    for first in (0..rows).step_by(ROWS) {
        let offsets = &offsets[first..=rows.min(first + ROWS)];
        let len = offsets[offsets.len() - 1] - offsets[0];
        tasks.push((offsets, ids.split_off_mut(..len).expect("the sizes add up")));
    }
    parallel::for_each(threads, tasks.into_iter(), |(offsets, ids)| {
        let mut pulse = Pulse::of_task(&stop, offsets[0]);
        for row in offsets.windows(2) {
            // An interruption is reported below.
            let _ = sorting::sort(&mut ids[row[0] - offsets[0]..row[1] - offsets[0]], &mut pulse);
        }
    });
    stop.check()
}
