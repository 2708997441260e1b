//! broccoli: a k-d tree with sweep and prune in its nodes, sequential and with rayon.

use broccoli::Tree;
use broccoli::axgeom::Rect;
use broccoli_rayon::prelude::*;

use super::{Find, Pair, bounds, overlap};
use crate::scenes::Shapes;

type Entry = (Rect<f32>, u32);

/// Bounding boxes from the tree, the exact test in its callback.
pub fn find(shapes: &Shapes, threads: usize) -> Find<'_> {
    if threads == 1 {
        return Box::new(|| one_thread(shapes));
    }
    Box::new(|| many_threads(shapes))
}

fn one_thread(shapes: &Shapes) -> Vec<Pair> {
    let mut entries = entries(shapes);
    let mut pairs = Vec::new();
    Tree::new(&mut entries).find_colliding_pairs(|a, b| {
        keep(shapes, *a.unpack_inner(), *b.unpack_inner(), &mut pairs);
    });
    pairs
}

/// Runs on rayon's pool, whose number of threads the caller has set.
fn many_threads(shapes: &Shapes) -> Vec<Pair> {
    let mut entries = entries(shapes);
    let mut tree = Tree::par_new(&mut entries);
    tree.par_find_colliding_pairs_acc_closure(
        Vec::new(),
        |_| Vec::new(),
        |pairs, mut more| pairs.append(&mut more),
        |pairs, a, b| keep(shapes, *a.unpack_inner(), *b.unpack_inner(), pairs),
    )
}

fn entries(shapes: &Shapes) -> Vec<Entry> {
    let entry = |row| {
        let (min, max) = bounds(shapes, row);
        (Rect::new(min[0], max[0], min[1], max[1]), row as u32)
    };
    (0..shapes.len()).map(entry).collect()
}

#[inline]
fn keep(shapes: &Shapes, i: u32, j: u32, pairs: &mut Vec<Pair>) {
    if overlap(shapes, i, j) {
        pairs.push([i.min(j), i.max(j)]);
    }
}
