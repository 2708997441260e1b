//! Disjoint-set union (union-find), which finds the islands of touching bodies.
//!
//! Path halving: R. E. Tarjan and J. van Leeuwen, *Worst-case Analysis of Set Union Algorithms*,
//! Journal of the ACM 31 (1984).

use crate::error::Result;
use crate::memory;

/// A partition of the integers below a length into disjoint sets.
#[derive(Debug, Default)]
pub struct DisjointSets(Vec<u32>);

impl DisjointSets {
    /// Makes `len` sets, one for each integer below `len`.
    pub fn reset(&mut self, len: usize) -> Result<()> {
        self.0.clear();
        memory::extend(&mut self.0, 0..len as u32)
    }

    /// The smallest member of the set of `item`.
    pub fn root(&mut self, item: u32) -> u32 {
        let parents = &mut self.0;
        let mut item = item as usize;
        while parents[item] as usize != item {
            // Path halving: each second member of the path skips its parent. The next search is
            // half as long, and no second pass over the path is needed. A root is its own parent,
            // so the assignment never passes it.
            parents[item] = parents[parents[item] as usize];
            item = parents[item] as usize;
        }
        item as u32
    }

    /// Merges the sets of `a` and `b`.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        // The smaller root wins, not the larger set. So the root is the smallest member whatever
        // the order in which sets are joined, and an island has the same name on any number of
        // threads and ranks. Path halving alone keeps the searches short (O(log n) amortized).
        self.0[a.max(b) as usize] = a.min(b);
    }
}
