//! The shapes of a band, sorted by counting into its cells.

use std::ops::Range;

use super::layout::Layout;
use crate::geometry::Scalar;
use crate::quadtree::partition::Item;
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_simd::LANES;

/// The shapes of some adjacent rows of cells, with those of the row before.
#[derive(Debug)]
pub(super) struct Band<T, const SIZES: usize> {
    /// The index of the first shape of each cell. One empty cell precedes the first row, and one
    /// follows each row.
    pub(super) starts: Vec<u32>,
    /// The cell of each shape, as an index of `starts`.
    pub(super) cells: Vec<u32>,
    /// Centres, x, with spare rows.
    pub(super) x: Vec<T>,
    /// Centres, y, with spare rows.
    pub(super) y: Vec<T>,
    /// Their sizes, with spare rows.
    pub(super) sizes: [Vec<T>; SIZES],
    /// Rows of the caller, with spare rows.
    pub(super) ids: Vec<u32>,
    /// Number of shapes of the row before.
    pub(super) before: usize,
    len: usize,
}

impl<T, const SIZES: usize> Default for Band<T, SIZES> {
    fn default() -> Self {
        let (starts, cells, ids) = (Vec::new(), Vec::new(), Vec::new());
        let sizes = [const { Vec::new() }; SIZES];
        Self { starts, cells, x: Vec::new(), y: Vec::new(), sizes, ids, before: 0, len: 0 }
    }
}

impl<T: Scalar, const SIZES: usize> Band<T, SIZES> {
    /// Replaces the shapes by `items` of some number of rows and by the last row of the band
    /// before.
    pub(super) fn fill<'a>(
        &mut self,
        layout: &Layout,
        rows: usize,
        last: &Self,
        items: impl Iterator<Item = &'a [Item<T, SIZES>]> + Clone,
    ) -> Result<()> {
        let stride = layout.stride as usize;
        let own = 1 + stride;
        let end = own + rows * stride;
        self.starts.clear();
        memory::resize(&mut self.starts, end + 2, 0)?;
        let count: usize = items.clone().map(<[Item<T, SIZES>]>::len).sum();
        // The last row of the band before comes first in this one. So the three cells above a shape
        // are always in the same columns, and the inner loop knows no borders between bands.
        self.copy_row(layout, last, count)?;
        // Until the sums are formed, `starts[cell + 2]` counts the shapes of `cell`. Then
        // `starts[cell + 1]` is the index of its next shape. The loops are nested, because the
        // compiler does not inline `flatten`.
        for piece in items.clone() {
            for item in piece {
                self.starts[own + layout.cell(item.key) + 2] += 1;
            }
        }
        // Shapes of the copied row have the first indices; their starts are copied, too.
        let mut sum = self.before as u32;
        self.starts[own] = sum;
        for start in &mut self.starts[own + 1..] {
            sum += *start;
            *start = sum;
        }
        let len = self.len;
        let (starts, cells) = (&mut self.starts[..], &mut self.cells[..len]);
        let (x, y, ids) = (&mut self.x[..len], &mut self.y[..len], &mut self.ids[..len]);
        let mut sizes = self.sizes.each_mut().map(|column| &mut column[..len]);
        for piece in items {
            for item in piece {
                let cell = own + layout.cell(item.key);
                let next = &mut starts[cell + 1];
                let index = *next as usize;
                *next += 1;
                [x[index], y[index]] = item.center;
                for (column, size) in sizes.iter_mut().zip(item.sizes) {
                    column[index] = size;
                }
                (ids[index], cells[index]) = (item.row, cell as u32);
            }
        }
        Ok(())
    }

    /// Reserves memory for `count` shapes after those of the last row of the band before, which are
    /// copied.
    fn copy_row(&mut self, layout: &Layout, last: &Self, count: usize) -> Result<()> {
        let row = last.last_row(layout);
        self.before = row.len();
        self.len = row.len() + count;
        // Never shortened: bands have different lengths, and each growth would fill new values with
        // zeros.
        memory::lengthen(&mut self.cells, self.len, 0)?;
        memory::lengthen(&mut self.ids, self.len + LANES, 0)?;
        memory::lengthen(&mut self.x, self.len + LANES, T::ZERO)?;
        memory::lengthen(&mut self.y, self.len + LANES, T::ZERO)?;
        for column in &mut self.sizes {
            memory::lengthen(column, self.len + LANES, T::ZERO)?;
        }
        if row.is_empty() {
            return Ok(());
        }
        for (to, from) in self.sizes.iter_mut().zip(&last.sizes) {
            to[..row.len()].copy_from_slice(&from[row.clone()]);
        }
        self.x[..row.len()].copy_from_slice(&last.x[row.clone()]);
        self.y[..row.len()].copy_from_slice(&last.y[row.clone()]);
        self.ids[..row.len()].copy_from_slice(&last.ids[row.clone()]);
        let stride = layout.stride as usize;
        let starts = &last.starts[1 + layout.rows() * stride..][..stride];
        for (to, &start) in self.starts[1..].iter_mut().zip(starts) {
            *to = start - row.start as u32;
        }
        Ok(())
    }

    /// The indices of the shapes of its last row.
    fn last_row(&self, layout: &Layout) -> Range<usize> {
        let first = 1 + layout.rows() * layout.stride as usize;
        self.starts.get(first).map_or(0, |&start| start as usize)..self.len
    }

    /// Removes all shapes.
    pub(super) fn clear(&mut self) {
        self.starts.clear();
        (self.before, self.len) = (0, 0);
    }

    /// The indices of its shapes, without those of the row before.
    pub(super) fn indices(&self) -> Range<usize> {
        self.before..self.len
    }

    /// Allocated bytes, used or not.
    pub(super) fn memory_bytes(&self) -> usize {
        (self.starts.capacity() + self.cells.capacity() + self.ids.capacity()) * size_of::<u32>()
            + (self.x.capacity() + self.y.capacity()) * size_of::<T>()
            + self.sizes.iter().map(Vec::capacity).sum::<usize>() * size_of::<T>()
    }
}
