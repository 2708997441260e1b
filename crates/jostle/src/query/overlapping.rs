//! The shapes that overlap one box or circle.

use crate::geometry::{Cover, Scalar};
use crate::quadtree::Quadtree;

/// Calls `act` with the place of each shape of a tree that overlaps `region`; `least_gap` is that of
/// [`Cover::meets`]. Returns the number of tests.
pub fn each_overlap<T: Scalar>(
    tree: &Quadtree<T>,
    region: &Cover<T>,
    least_gap: T,
    stack: &mut Vec<u32>,
    mut act: impl FnMut(usize),
) -> usize {
    let mut tests = 0;
    stack.clear();
    stack.extend((!tree.is_empty()).then_some(0));
    while let Some(index) = stack.pop() {
        tests += 1;
        if !tree.covers()[index as usize].meets(region, [T::ZERO; 2], least_gap) {
            continue;
        }
        let node = &tree.nodes()[index as usize];
        stack.extend(node.children().map(|child| child as u32));
        if node.is_leaf() {
            let meets = |place: &usize| {
                let shape = Cover::of(&tree.columns().shape(*place));
                shape.meets(region, [T::ZERO; 2], least_gap)
            };
            node.range().filter(meets).for_each(&mut act);
            tests += node.len();
        }
    }
    tests
}
