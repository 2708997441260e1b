//! Partition of shapes into blocks by the leading bits of the keys of their centres, the first pass
//! of a sort.
//!
//! Each chunk of the shapes is partitioned by itself, so the threads need no common counters. Items
//! contain the centres, so these need no lookup afterwards.

use std::ops::Range;

use jostle_base::error::Result;
use jostle_base::interrupt::Stop;
use jostle_base::memory;
use jostle_base::parallel;
use jostle_base::sorting::counting_sort;

/// Maximum number of chunks.
const MAX_CHUNKS: usize = 8;

/// Minimum number of shapes in a chunk.
pub(super) const MIN_CHUNK: usize = 1 << 11;

/// Bits of a key.
pub(crate) const KEY_BITS: u32 = u32::BITS;

/// A shape to be sorted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item<T, const SIZES: usize = 0> {
    /// The key of its centre.
    pub key: u32,
    /// Its row.
    pub row: u32,
    /// Its centre.
    pub center: [T; 2],
    /// Its sizes, which are sorted with it.
    pub sizes: [T; SIZES],
}

impl<T: Copy + Default, const SIZES: usize> Default for Item<T, SIZES> {
    fn default() -> Self {
        Self { key: 0, row: 0, center: [T::default(); 2], sizes: [T::default(); SIZES] }
    }
}

impl<T> Item<T> {
    /// The sort key: key, then row.
    #[inline(always)]
    pub(super) fn rank(&self) -> u64 {
        u64::from(self.key) << 32 | u64::from(self.row)
    }
}

/// The shapes to be sorted.
pub(crate) trait Source<T, const SIZES: usize = 0>: Sync {
    /// Number of items.
    fn len(&self) -> usize;
    /// Writes the keys of some items.
    fn keys(&self, range: Range<usize>, keys: &mut [u32]);
    /// The item at `index`, whose key is `key`.
    fn item(&self, index: usize, key: u32) -> Item<T, SIZES>;
}

/// Items partitioned into blocks, chunk by chunk.
#[derive(Debug)]
pub(crate) struct Partition<T, const SIZES: usize = 0> {
    pub(super) keys: Vec<u32>,
    items: Vec<Item<T, SIZES>>,
    /// For each chunk, the end of each block in it.
    ends: Vec<u32>,
    len: usize,
    blocks: usize,
}

impl<T, const SIZES: usize> Default for Partition<T, SIZES> {
    fn default() -> Self {
        Self { keys: Vec::new(), items: Vec::new(), ends: Vec::new(), len: 0, blocks: 0 }
    }
}

impl<T: Copy + Default + Send + Sync, const SIZES: usize> Partition<T, SIZES> {
    /// Makes the items and partitions them by the first `bits` bits of their keys.
    pub(crate) fn fill(
        &mut self,
        threads: Option<usize>,
        source: &impl Source<T, SIZES>,
        bits: u32,
    ) -> Result<()> {
        let stop = Stop::current();
        let (len, blocks) = (source.len(), 1 << bits);
        (self.len, self.blocks) = (len, blocks);
        let Self { keys, items, ends, .. } = self;
        // Every chunk has counters of its own and writes to its own part of `items`, so threads
        // share nothing. The price is that a block is in up to eight pieces, which the next stage
        // gathers in order.
        let chunk = chunk_of(len);
        memory::resize(keys, len, 0)?;
        memory::resize(items, len, Item::default())?;
        memory::resize(ends, len.div_ceil(chunk) * blocks, 0)?;
        let chunks = keys[..len].chunks_mut(chunk).zip(items[..len].chunks_mut(chunk));
        let tasks = chunks.zip(ends.chunks_mut(blocks)).enumerate();
        parallel::for_each(threads, tasks, |(number, ((keys, items), ends))| {
            // Other chunks are not begun. The half-filled items are never read, because of the
            // check below.
            if stop.is_set() {
                return;
            }
            let start = number * chunk;
            source.keys(start..start + keys.len(), keys);
            let block = |&(_, key): &(usize, &u32)| leading(*key, 0, bits);
            let item = |(index, &key): (usize, &u32)| source.item(index, key);
            counting_sort((start..).zip(&*keys), block, item, ends, items);
        });
        stop.check()
    }
}

impl<T, const SIZES: usize> Partition<T, SIZES> {
    /// The items of a block in each chunk, in the order of the source.
    pub(crate) fn pieces(&self, block: usize) -> impl Iterator<Item = &[Item<T, SIZES>]> + Clone {
        let chunks = self.items[..self.len].chunks(chunk_of(self.len));
        chunks.zip(self.ends.chunks(self.blocks)).map(move |(items, ends)| {
            // Blocks of a chunk follow each other, so the end of one is the start of the next.
            let start = if block == 0 { 0 } else { ends[block - 1] };
            &items[start as usize..ends[block] as usize]
        })
    }

    /// Writes the number of items in all blocks before each block, and in all blocks.
    pub(crate) fn find_starts(&self, starts: &mut Vec<u32>) -> Result<()> {
        starts.clear();
        memory::resize(starts, self.blocks + 1, 0)?;
        // The end of a block in a chunk is the number of items of this and all blocks before it.
        for ends in self.ends.chunks(self.blocks) {
            for (start, &end) in starts[1..].iter_mut().zip(ends) {
                *start += end;
            }
        }
        Ok(())
    }

    /// Number of blocks.
    pub(crate) fn blocks(&self) -> usize {
        self.blocks
    }

    /// Allocated bytes, used or not.
    pub(crate) fn memory_bytes(&self) -> usize {
        self.items.capacity() * size_of::<Item<T, SIZES>>()
            + (self.ends.capacity() + self.keys.capacity()) * size_of::<u32>()
    }
}

/// Number of items in a chunk; it depends only on the number of items.
fn chunk_of(len: usize) -> usize {
    // A function of the number of items alone: `pieces` finds the same chunks again, whoever calls
    // it. With at least 2,048 shapes in a chunk, instead of 8,192, two threads build a tree of
    // 17,000 shapes 1.6 instead of 0.4 times as fast as one (docs/benchmarks-notes.md).
    len.div_ceil(MAX_CHUNKS).max(MIN_CHUNK)
}

/// The `bits` bits of a key after its first `skipped` bits.
#[inline(always)]
pub(crate) fn leading(key: u32, skipped: u32, bits: u32) -> usize {
    // A shift by all 32 bits would overflow, so 0 bits are a case of their own.
    if bits == 0 { 0 } else { (key << skipped >> (KEY_BITS - bits)) as usize }
}
