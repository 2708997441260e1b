//! Line segments that stop the shapes which move with `Space::move_and_slide`, and no others.

use jostle_base::error::{Error, Result};
use jostle_base::memory;
use jostle_base::settings::Settings;
use jostle_index::geometry::{Bounds, Scalar, middle};
use jostle_index::period::Period;
use jostle_index::quadtree::Quadtree;
use jostle_index::query::each_overlap;
use jostle_index::shapes::{Each, Shapes};

/// The segments with a tree of their bounding boxes.
#[derive(Clone, Debug, Default)]
pub(super) struct Walls<T> {
    original: Vec<[[T; 2]; 2]>,
    /// The ends of the segments, moved so that their middles are in the first period.
    ends: Vec<[[T; 2]; 2]>,
    tree: Quadtree<T>,
}

impl<T: Scalar> Walls<T> {
    /// Refuses ends that are equal or not finite, or so far apart that the square of their distance
    /// may overflow, or farther apart than the period.
    pub(super) fn new(
        original: Vec<[[T; 2]; 2]>,
        period: &Period<T>,
        settings: Settings,
    ) -> Result<Self> {
        let most = T::RADII[1];
        let is_finite = |ends: &[[T; 2]; 2]| ends.iter().flatten().all(|v| v.is_finite());
        let length = |[a, b]: &[[T; 2]; 2], axis: usize| (b[axis] - a[axis]).abs();
        let fits = |ends: &[[T; 2]; 2]| {
            is_finite(ends) && length(ends, 0) <= most && length(ends, 1) <= most
        };
        let told = |[[a, b], [c, d]]: [[T; 2]; 2]| format!("(({a}, {b}), ({c}, {d}))");
        if let Some(index) = original.iter().position(|ends| !fits(ends)) {
            let rule = format!("its ends must be finite, and at most {most:e} apart");
            return Err(Error::at("walls", index, told(original[index]), &rule));
        }
        if let Some(index) = original.iter().position(|[a, b]| a == b) {
            return Err(Error::at("walls", index, told(original[index]), "its ends must differ"));
        }
        let wraps = |axis: usize, ends: &[[T; 2]; 2]| {
            period.is_along(axis) && length(ends, axis) > period.sides()[axis]
        };
        if let Some(index) = original.iter().position(|ends| wraps(0, ends) || wraps(1, ends)) {
            let rule = "along each axis its ends must be at most a period apart";
            return Err(Error::at("walls", index, told(original[index]), rule));
        }
        let ends = memory::collect(original.iter().map(|&ends| in_first_period(ends, period)))?;
        let corners =
            |[a, b]: &[[T; 2]; 2]| [a[0].min(b[0]), a[1].min(b[1]), a[0].max(b[0]), a[1].max(b[1])];
        // The tree has bounding boxes only; the exact test of a segment follows in `jostle_slide`.
        let boxes = memory::collect(ends.iter().map(corners))?;
        let shapes = Shapes::from_boxes(boxes, Each::One(T::ZERO), None)?;
        let mut tree = Quadtree::default();
        tree.fill_unordered(&shapes, settings)?;
        Ok(Self { original, ends, tree })
    }

    /// The segments as they were given.
    pub(super) fn original(&self) -> &[[[T; 2]; 2]] {
        &self.original
    }

    /// Allocated bytes, used or not.
    pub(super) fn memory_bytes(&self) -> usize {
        (self.original.capacity() + self.ends.capacity()) * size_of::<[[T; 2]; 2]>()
            + self.tree.memory_bytes()
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
        // Walls have no categories and stop every shape.
        let region = Bounds { category: u32::MAX, mask: u32::MAX, ..*region };
        each_overlap(&self.tree, &region, -T::INFINITY, stack, |index| {
            let row = self.tree.rows()[index];
            act(row, self.ends[row as usize]);
        });
    }
}

/// A segment with its middle in the first period.
fn in_first_period<T: Scalar>([a, b]: [[T; 2]; 2], period: &Period<T>) -> [[T; 2]; 2] {
    let turns = period.turns([0, 1].map(|axis| middle(a[axis], b[axis])));
    [a, b].map(|end| [end[0] - turns[0], end[1] - turns[1]])
}
