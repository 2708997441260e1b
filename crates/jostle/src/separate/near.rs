//! Lists of the pairs that may overlap before a shape has moved by half a margin.
//!
//! L. Verlet, *Computer "Experiments" on Classical Fluids*, Phys. Rev. 159 (1967), for lists with a
//! margin.

use std::ops::Range;

use super::bodies::Bodies;
use crate::error::Result;
use crate::geometry::Scalar;
use crate::memory;
use crate::pairs::{self, JoinScratch};
use crate::parallel::CHUNK;
use crate::quadtree::Quadtree;
use crate::settings::{DEFAULT_MAX_PAIRS, Settings};
use crate::shapes::Shapes;

/// Margin, as a share of the mean extent of the shapes.
const MARGIN: f64 = 0.25;

/// Number of places of a block. Blocks without overlaps are skipped until something near moves.
pub const BLOCK: usize = 32;

/// For each shape the others near it. A pair within one chunk of [`CHUNK`] places is listed for
/// its first shape, another pair for both.
#[derive(Clone, Debug, Default)]
pub struct Near<T> {
    ends: Vec<u32>,
    others: Vec<u32>,
    /// For each block the blocks with shapes listed for its own.
    block_ends: Vec<u32>,
    blocks: Vec<u32>,
    /// For each block the last one for which it was listed.
    listed_for: Vec<u32>,
    /// The centres for which the lists were made.
    pub origins: Vec<[T; 2]>,
    margin: T,
    shapes: Shapes<T>,
    tree: Quadtree<T>,
    scratch: JoinScratch,
}

impl<T: Scalar> Near<T> {
    /// Empty lists for `bodies`.
    pub fn of(bodies: &Bodies<T>, gap: T) -> Result<Self> {
        let [x, y] = bodies.mean_extents;
        let half = T::from_f64(0.5);
        let margin = (x.min(y).max(T::from_f64(0.1) * x.max(y)) + gap) * T::from_f64(MARGIN);
        let wider = (margin + gap) * half;
        let mut shapes = Shapes::default();
        let radii = shapes.radii.rows_mut();
        memory::reserve(radii, bodies.len())?;
        radii.extend(bodies.all.iter().map(|body| body.radius + wider));
        if bodies.all.iter().any(|body| body.half != [T::ZERO; 2]) {
            let halves = shapes.half_sizes.get_or_insert_default().rows_mut();
            memory::reserve(halves, bodies.len())?;
            halves.extend(bodies.all.iter().map(|body| body.half));
        }
        Ok(Self { margin, shapes, ..Self::default() })
    }

    /// The distance from its origin up to which a shape may move; slightly less than half the
    /// margin, because of rounding.
    pub fn reach(&self) -> T {
        self.margin * T::from_f64(0.49)
    }

    /// Makes the lists for the current centres.
    pub fn find(&mut self, bodies: &Bodies<T>, threads: Option<usize>) -> Result<()> {
        self.shapes.centers.clear();
        memory::reserve(&mut self.shapes.centers, bodies.len())?;
        self.shapes.centers.extend(&bodies.centers);
        let settings = Settings { threads, ..Settings::default() };
        self.tree.fill_unordered(&self.shapes, settings)?;
        let mut found =
            pairs::places_within(&self.tree, DEFAULT_MAX_PAIRS, &mut self.scratch)?.pairs;
        let rows = self.tree.rows();
        for pair in &mut found {
            let [i, j] = pair.map(|place| rows[place as usize]);
            *pair = [i.min(j), i.max(j)];
        }
        self.list(&found, bodies)?;
        self.list_blocks(bodies.len())?;
        self.scratch.keep(found);
        self.origins.clear();
        memory::reserve(&mut self.origins, bodies.len())?;
        self.origins.extend(&bodies.centers);
        Ok(())
    }

    /// Counting sort of the pairs by the shapes for which they are listed.
    fn list(&mut self, found: &[[u32; 2]], bodies: &Bodies<T>) -> Result<()> {
        let listed = |[i, j]: [u32; 2]| {
            let fixed = [i, j].map(|place| bodies.all[place as usize].is_fixed());
            let first = fixed != [true; 2];
            (i, j, first, first && chunk(i) != chunk(j))
        };
        self.ends.clear();
        memory::resize(&mut self.ends, bodies.len() + 1, 0)?;
        for &pair in found {
            let (i, j, first, second) = listed(pair);
            self.ends[i as usize + 1] += u32::from(first);
            self.ends[j as usize + 1] += u32::from(second);
        }
        let mut total = 0;
        for end in &mut self.ends {
            total += *end;
            *end = total - *end;
        }
        memory::resize(&mut self.others, total as usize, 0)?;
        for &pair in found {
            let (i, j, first, second) = listed(pair);
            for (own, other, wanted) in [(i, j, first), (j, i, second)] {
                if wanted {
                    let end = &mut self.ends[own as usize + 1];
                    self.others[*end as usize] = other;
                    *end += 1;
                }
            }
        }
        Ok(())
    }

    fn list_blocks(&mut self, len: usize) -> Result<()> {
        let count = len.div_ceil(BLOCK);
        self.listed_for.clear();
        memory::resize(&mut self.listed_for, count, u32::MAX)?;
        self.block_ends.clear();
        memory::resize(&mut self.block_ends, count + 1, 0)?;
        self.blocks.clear();
        for block in 0..count {
            let places = block * BLOCK..len.min((block + 1) * BLOCK);
            let others = self.ends[places.start] as usize..self.ends[places.end] as usize;
            self.listed_for[block] = block as u32;
            memory::push(&mut self.blocks, block as u32)?;
            for &other in &self.others[others] {
                let near = other as usize / BLOCK;
                if std::mem::replace(&mut self.listed_for[near], block as u32) != block as u32 {
                    memory::push(&mut self.blocks, near as u32)?;
                }
            }
            self.block_ends[block + 1] = self.blocks.len() as u32;
        }
        Ok(())
    }

    /// The block and the blocks with shapes that are listed for its own.
    #[inline(always)]
    pub fn of_block(&self, block: usize) -> &[u32] {
        &self.blocks[self.block_ends[block] as usize..self.block_ends[block + 1] as usize]
    }

    /// The places of the shapes listed for the one at `place`.
    #[inline(always)]
    pub fn of_place(&self, place: usize) -> &[u32] {
        &self.others[self.ends[place] as usize..self.ends[place + 1] as usize]
    }
}

fn chunk(place: u32) -> usize {
    place as usize / CHUNK
}

/// The places of a chunk.
pub fn places_of(chunk: usize, len: usize) -> Range<usize> {
    chunk * CHUNK..len.min((chunk + 1) * CHUNK)
}
