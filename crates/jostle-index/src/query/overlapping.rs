//! The shapes of a tree that overlap given bounds.

use super::window::Window;
use crate::geometry::{Bounds, Scalar};
use crate::quadtree::Quadtree;
use jostle_simd::{LANES, Simd, Work, first_lanes, for_each_lane};

/// Calls `act` with the index of each shape of a tree that overlaps `region`, whose half sizes are
/// 0. `min_gap` is that of [`Bounds::overlaps`]. Returns the number of tests.
pub fn each_overlap<T: Scalar>(
    tree: &Quadtree<T>,
    region: &Bounds<T>,
    min_gap: T,
    stack: &mut Vec<u32>,
    act: impl FnMut(usize),
) -> usize {
    T::with_widest(Overlapping { tree, region, min_gap, stack, act })
}

struct Overlapping<'a, T, A> {
    tree: &'a Quadtree<T>,
    region: &'a Bounds<T>,
    min_gap: T,
    stack: &'a mut Vec<u32>,
    act: A,
}

impl<T: Scalar, A: FnMut(usize)> Work<T> for Overlapping<'_, T, A> {
    type Out = usize;

    #[inline(always)]
    fn run<S: Simd<T>>(self, simd: S) -> usize {
        let Self { tree, region, min_gap, stack, mut act } = self;
        let window = Window::around(region);
        let overlaps = |bounds: &Bounds<T>| bounds.overlaps(region, [T::ZERO; 2], min_gap);
        let mut tests = 0;
        stack.clear();
        stack.extend((!tree.is_empty()).then_some(0));
        while let Some(index) = stack.pop() {
            tests += 1;
            let bounds = &tree.bounds()[index as usize];
            if !overlaps(bounds) {
                continue;
            }
            let node = &tree.nodes()[index as usize];
            stack.extend(node.children().map(|child| child as u32));
            if !node.is_leaf() {
                continue;
            }
            let (shapes, indices) = (tree.columns(), node.range());
            let round = bounds.radius > T::ZERO;
            for first in indices.clone().step_by(LANES) {
                // Conservative, without filters. The exact test below applies them and `min_gap`.
                let bits = window.lanes(simd, shapes, first, (round, false));
                for_each_lane(bits & first_lanes(indices.end - first), |lane| {
                    if overlaps(&Bounds::of(&shapes.shape(first + lane))) {
                        act(first + lane);
                    }
                });
            }
            tests += node.len();
        }
        tests
    }
}
