//! The compared libraries that find all overlapping pairs.
//!
//! Each gets the same columns and returns rows `i < j`, every pair once. The call includes
//! building and converting.

mod broccoli;
mod ours;
mod rstar;
mod uniform_grid;

use crate::machine::version_of;
use crate::scenes::Shapes;

/// A pair of rows, the smaller first.
pub type Pair = [u32; 2];

/// A function that finds all pairs.
pub type Find<'a> = Box<dyn Fn() -> Vec<Pair> + 'a>;

/// A library with its name and version in the results.
pub struct Rival<'a> {
    /// Its name.
    pub name: &'static str,
    /// Its version.
    pub version: String,
    /// The function, for the scene for which it was made.
    pub find: Find<'a>,
    /// Settings that were tuned for this scene.
    pub remark: String,
}

/// All libraries that can use this number of threads, jostle first.
pub fn all(shapes: &Shapes, threads: usize, wanted: impl Fn(&str) -> bool) -> Vec<Rival<'_>> {
    let plain = |name, package, find| Rival {
        name,
        version: version_of(package).to_owned(),
        find,
        remark: String::new(),
    };
    let mut rivals = Vec::new();
    if wanted("jostle") {
        rivals.push(plain("jostle", "jostle", ours::find(shapes, threads)));
    }
    if wanted("grid") {
        rivals.push(uniform_grid::tuned(shapes, threads));
    }
    if wanted("broccoli") {
        rivals.push(plain("broccoli", "broccoli", broccoli::find(shapes, threads)));
    }
    if wanted("rstar, query each") {
        rivals.push(plain("rstar, query each", "rstar", rstar::query_each(shapes, threads)));
    }
    // Its self-intersection has no parallel form.
    if wanted("rstar, tree on tree") && threads == 1 {
        rivals.push(plain("rstar, tree on tree", "rstar", rstar::tree_on_tree(shapes)));
    }
    rivals
}

/// The exact formula, for libraries that test bounding boxes only.
#[inline]
fn overlap(shapes: &Shapes, i: u32, j: u32) -> bool {
    let (i, j) = (i as usize, j as usize);
    let (dx, dy) = (shapes.x[i] - shapes.x[j], shapes.y[i] - shapes.y[j]);
    if shapes.has_boxes() {
        let [w, h] = &shapes.half;
        return dx.abs() < w[i] + w[j] && dy.abs() < h[i] + h[j];
    }
    let reach = shapes.radius[i] + shapes.radius[j];
    dx * dx + dy * dy < reach * reach
}

/// A bounding box (min, max) that contains the shape in spite of rounding.
#[inline]
fn bounds(shapes: &Shapes, row: usize) -> ([f32; 2], [f32; 2]) {
    let (center, reach) = ([shapes.x[row], shapes.y[row]], shapes.reach(row));
    let padded = [0, 1].map(|k| reach[k] + 3e-7 * (center[k].abs() + reach[k]));
    ([0, 1].map(|k| center[k] - padded[k]), [0, 1].map(|k| center[k] + padded[k]))
}
