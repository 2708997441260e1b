//! Settings of trees and pair searches: defaults and limits.

use crate::error::{Error, Result};
use crate::saved;

/// Maximum number of shapes in a leaf, unless the leaf is at the maximum depth.
pub const DEFAULT_LEAF_CAPACITY: usize = 96;

/// Maximum number of subdivisions. A split at least halves the cell, and float64 has 2,098
/// powers of two, so no set of finite positions reaches the default.
pub const DEFAULT_MAX_DEPTH: usize = 4096;

/// Maximum number of pairs that a call returns: 1 GiB of them.
pub const DEFAULT_MAX_PAIRS: usize = 1 << 27;

/// Maximum number of threads; a larger number is treated as a mistake.
pub const MAX_THREADS: usize = 1024;

/// The settings of a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Maximum number of shapes in a leaf, at least 1.
    pub leaf_capacity: usize,
    /// Maximum number of subdivisions; with 0 the root is the only node.
    pub max_depth: usize,
    /// Number of threads; `None`: one for each core.
    pub threads: Option<usize>,
}

saved! { struct Settings { leaf_capacity, max_depth, threads } }

impl Default for Settings {
    fn default() -> Self {
        Self { leaf_capacity: DEFAULT_LEAF_CAPACITY, max_depth: DEFAULT_MAX_DEPTH, threads: None }
    }
}

impl Settings {
    /// Refuses settings out of range.
    pub fn validate(&self) -> Result<()> {
        if self.leaf_capacity == 0 {
            return Err(Error::of("leaf_capacity", 0, "it must be at least 1"));
        }
        if self.max_depth > DEFAULT_MAX_DEPTH {
            let rule = format!("it must be at most {DEFAULT_MAX_DEPTH}");
            return Err(Error::of("max_depth", self.max_depth, &rule));
        }
        match self.threads {
            Some(threads) if threads == 0 || threads > MAX_THREADS => {
                let rule = format!("it must be between 1 and {MAX_THREADS}");
                Err(Error::of("threads", threads, &rule))
            }
            _ => Ok(()),
        }
    }
}

/// How candidate pairs are found. Both give the same pairs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// A quadtree finds leaves whose bounds overlap; the shapes of these are tested.
    #[default]
    Quadtree,
    /// Every shape is tested against every other.
    Brute,
}

saved! { enum Method("method") { 0 => Quadtree, 1 => Brute } }
