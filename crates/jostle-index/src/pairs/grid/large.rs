//! The shapes that are larger than the cells of a grid, each listed in all bands that it may reach.

use std::ops::Range;

use super::layout::{Layout, SLACK};
use super::sizes::half_extent_of;
use crate::geometry::Scalar;
use crate::quadtree::partition::Item;
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_base::sorting;

/// Maximum number of entries of all lists for each shape of the grid: more would need too much
/// memory.
const MAX_ENTRIES: usize = 4;

/// Columns and rows of cells, both ends included.
pub(super) type Cells = [[u32; 2]; 2];

/// The large shapes.
#[derive(Debug, Default)]
pub(super) struct Large<T, const SIZES: usize> {
    /// The shapes, in the order of their rows.
    pub(super) items: Vec<Item<T, SIZES>>,
    /// The cells of the small shapes that each may overlap.
    cells: Vec<Cells>,
    /// The end of the list of each band.
    ends: Vec<u32>,
    /// Indices of shapes, band by band.
    lists: Vec<u32>,
}

impl<T: Scalar, const SIZES: usize> Large<T, SIZES> {
    /// Replaces the shapes of a grid of `len_of_grid` shapes. Returns whether their lists are short enough.
    pub(super) fn fill<'a>(
        &mut self,
        layout: &Layout,
        small: [T; 2],
        len_of_grid: usize,
        pieces: impl Iterator<Item = &'a [Item<T, SIZES>]> + Clone,
    ) -> Result<bool> {
        let Self { items, cells, ends, lists } = self;
        items.clear();
        cells.clear();
        lists.clear();
        let len = pieces.clone().map(<[Item<T, SIZES>]>::len).sum();
        memory::reserve(items, len)?;
        memory::reserve(cells, len)?;
        memory::resize(ends, layout.bands, 0)?;
        let mut total = 0;
        pieces.for_each(|piece| items.extend_from_slice(piece));
        for item in &*items {
            let half_extent = half_extent_of(&item.sizes);
            // The slack is that of cells: the cell of a centre is rounded, here and in `keys`.
            let distance = [0, 1].map(|k| (half_extent[k].to_f64() + small[k].to_f64()) * SLACK);
            let around = layout.around(item.center.map(T::to_f64), distance);
            cells.push(around);
            total += bands_of(layout, &around).len();
            // Known only here, because the sample may have missed the largest shapes. The caller
            // then uses the tree; what has been sorted so far is lost.
            if total > MAX_ENTRIES * len_of_grid {
                return Ok(false);
            }
        }
        memory::resize(lists, total, 0)?;
        let entries = (0..)
            .zip(&*cells)
            .flat_map(|(index, cells)| bands_of(layout, cells).map(move |band| (band, index)));
        sorting::counting_sort(entries, |entry| entry.0, |entry| entry.1, ends, lists);
        Ok(true)
    }

    /// The shapes of a band, and the cells that each may reach.
    pub(super) fn of_band(&self, band: usize) -> impl Iterator<Item = (&Item<T, SIZES>, &Cells)> {
        let start = band.checked_sub(1).map_or(0, |before| self.ends[before]);
        let list = start as usize..self.ends[band] as usize;
        self.lists[list].iter().map(|&index| {
            let index = index as usize;
            (&self.items[index], &self.cells[index])
        })
    }

    /// Allocated bytes, used or not.
    pub(super) fn memory_bytes(&self) -> usize {
        self.items.capacity() * size_of::<Item<T, SIZES>>()
            + self.cells.capacity() * size_of::<Cells>()
            + (self.ends.capacity() + self.lists.capacity()) * size_of::<u32>()
    }
}

/// The bands of some rows of cells.
fn bands_of(layout: &Layout, [_, [first, last]]: &Cells) -> Range<usize> {
    (first >> layout.row_bits) as usize..(last >> layout.row_bits) as usize + 1
}
