//! rstar: an R*-tree, loaded in bulk; then a query for each shape, or the tree against itself.

use rayon::prelude::*;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::{Find, Pair, bounds, overlap};
use crate::scenes::Shapes;

type Entry = GeomWithData<Rectangle<[f32; 2]>, u32>;

/// One rectangle query a shape. With more threads the queries run in parallel; loading cannot.
pub fn query_each(shapes: &Shapes, threads: usize) -> Find<'_> {
    Box::new(move || {
        let tree = load(shapes);
        let rows = 0..shapes.len() as u32;
        if threads == 1 {
            return rows.flat_map(|row| behind(shapes, &tree, row)).collect();
        }
        rows.into_par_iter().flat_map_iter(|row| behind(shapes, &tree, row)).collect()
    })
}

/// rstar's own candidate pairs of a tree with itself; each is returned in both orders.
pub fn tree_on_tree(shapes: &Shapes) -> Find<'_> {
    Box::new(|| {
        let tree = load(shapes);
        let candidates = tree.intersection_candidates_with_other_tree(&tree);
        let rows = candidates.map(|(a, b)| [a.data, b.data]);
        rows.filter(|&[i, j]| i < j && overlap(shapes, i, j)).collect()
    })
}

fn load(shapes: &Shapes) -> RTree<Entry> {
    let entry = |row| {
        let (min, max) = bounds(shapes, row);
        GeomWithData::new(Rectangle::from_corners(min, max), row as u32)
    };
    RTree::bulk_load((0..shapes.len()).map(entry).collect())
}

/// The pairs of `row` with later rows.
fn behind<'a>(
    shapes: &'a Shapes,
    tree: &'a RTree<Entry>,
    row: u32,
) -> impl Iterator<Item = Pair> + 'a {
    let (min, max) = bounds(shapes, row as usize);
    let near = tree.locate_in_envelope_intersecting(AABB::from_corners(min, max));
    let others = near.map(|entry| entry.data);
    others.filter(move |&other| row < other && overlap(shapes, row, other)).map(move |j| [row, j])
}
