//! The knobs, their defaults and their limits.

use crate::error::{Error, Result};

/// Shapes a leaf may hold before it splits.
pub const DEFAULT_LEAF_CAPACITY: usize = 96;

/// Subdivisions allowed below the root. No set of finite positions needs this
/// many (a split at least halves the cell, and float64 has 2,098 octaves), so
/// the default never binds.
pub const DEFAULT_MAX_DEPTH: usize = 4096;

/// Pairs returned before a call gives up: one gibibyte of them.
pub const DEFAULT_MAX_PAIRS: usize = 1 << 27;

/// More threads than any machine has cores for; a larger number is a slip.
pub const MAX_THREADS: usize = 1024;

/// How a tree is built and how many threads work on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Shapes a leaf may hold before it splits, at least 1.
    pub leaf_capacity: usize,
    /// Subdivisions allowed below the root; 0 keeps everything in the root.
    pub max_depth: usize,
    /// Threads to use; `None` is one for each core.
    pub threads: Option<usize>,
}

impl Default for Settings {
    fn default() -> Self {
        Self { leaf_capacity: DEFAULT_LEAF_CAPACITY, max_depth: DEFAULT_MAX_DEPTH, threads: None }
    }
}

impl Settings {
    /// Refuses settings that no tree can follow.
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
    /// Only leaves that come near each other are tested.
    #[default]
    Quadtree,
    /// Everything is tested against everything.
    Brute,
}
