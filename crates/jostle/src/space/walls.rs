//! Line segments that stop the shapes which move with [`Space::move_and_slide`], and no others.

use super::Space;
use crate::error::{Error, Result};
use crate::geometry::{Bounds, Scalar};
use crate::memory;
use crate::quadtree::Quadtree;
use crate::query::each_overlap;
use crate::settings::Settings;
use crate::shapes::{Each, Shapes};

/// The segments with a tree of their bounding boxes.
#[derive(Clone, Debug, Default)]
pub(super) struct Walls<T> {
    ends: Vec<[[T; 2]; 2]>,
    tree: Quadtree<T>,
}

impl<T: Scalar> Walls<T> {
    /// Refuses ends that are not finite, or so far apart that the square of their distance may
    /// overflow.
    pub(super) fn new(ends: Vec<[[T; 2]; 2]>, settings: Settings) -> Result<Self> {
        let most = T::RADII[1];
        let is_finite = |ends: &[[T; 2]; 2]| ends.iter().flatten().all(|v| v.is_finite());
        let length = |[a, b]: &[[T; 2]; 2], axis: usize| (b[axis] - a[axis]).abs();
        let fits = |ends: &[[T; 2]; 2]| {
            is_finite(ends) && length(ends, 0) <= most && length(ends, 1) <= most
        };
        if let Some(index) = ends.iter().position(|ends| !fits(ends)) {
            let [[a, b], [c, d]] = ends[index];
            let rule = format!("its ends must be finite, and at most {most:e} apart");
            return Err(Error::at("walls", index, format!("(({a}, {b}), ({c}, {d}))"), &rule));
        }
        let corners =
            |[a, b]: &[[T; 2]; 2]| [a[0].min(b[0]), a[1].min(b[1]), a[0].max(b[0]), a[1].max(b[1])];
        let boxes = memory::collect(ends.iter().map(corners))?;
        let shapes = Shapes::from_boxes(boxes, Each::One(T::ZERO), None)?;
        let mut tree = Quadtree::default();
        tree.fill_unordered(&shapes, settings)?;
        Ok(Self { ends, tree })
    }

    pub(super) fn memory_bytes(&self) -> usize {
        self.ends.capacity() * size_of::<[[T; 2]; 2]>() + self.tree.memory_bytes()
    }

    /// Calls `act` with the index and the ends of each segment whose bounding box overlaps or
    /// touches a region.
    pub(super) fn each_near(
        &self,
        region: &Bounds<T>,
        stack: &mut Vec<u32>,
        mut act: impl FnMut(u32, [[T; 2]; 2]),
    ) {
        if self.ends.is_empty() {
            return;
        }
        let region = Bounds { category: u32::MAX, mask: u32::MAX, ..*region };
        each_overlap(&self.tree, &region, -T::INFINITY, stack, |place| {
            let row = self.tree.rows()[place];
            act(row, self.ends[row as usize]);
        });
    }
}

impl<T: Scalar> Space<T> {
    /// The line segments, which have two ends each.
    pub fn walls(&self) -> &[[[T; 2]; 2]] {
        &self.walls.ends
    }

    /// Replaces the line segments. Refuses what no segment can be; then nothing changes.
    pub fn set_walls(&mut self, ends: Vec<[[T; 2]; 2]>) -> Result<()> {
        self.walls = Walls::new(ends, self.settings)?;
        Ok(())
    }
}
