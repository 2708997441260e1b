//! Islands: sets that are joined pair by pair (disjoint-set union).

/// The set of each of the numbers below a length.
#[derive(Debug, Default)]
pub struct Groups(Vec<u32>);

impl Groups {
    /// Begins with a set for each number below `len`.
    pub fn reset(&mut self, len: usize) {
        self.0.clear();
        self.0.extend(0..len as u32);
    }

    /// The least member of the set of `item`.
    pub fn root(&mut self, item: u32) -> u32 {
        let parents = &mut self.0;
        let mut item = item as usize;
        while parents[item] as usize != item {
            parents[item] = parents[parents[item] as usize];
            item = parents[item] as usize;
        }
        item as u32
    }

    /// Makes the sets of `a` and `b` one.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
