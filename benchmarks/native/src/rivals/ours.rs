//! jostle's core, as a Rust program calls it.

use jostle::{Method, pairs, settings};

use super::Find;
use crate::scenes::Shapes;

/// For any number of shapes: what is compared is a tree.
const TREE: Option<Method> = Some(Method::Quadtree);

/// [`pairs::find`] with the tree; the columns are made into rows inside the call. The tree gets
/// new memory each time (not [`pairs::find_with`]), as those of its rivals do.
pub fn find(shapes: &Shapes, threads: usize) -> Find<'_> {
    Box::new(move || {
        let rows = shapes.rows();
        let found = pairs::find(&rows, TREE, Some(threads), settings::DEFAULT_MAX_PAIRS);
        found.expect("fewer pairs than the limit").pairs
    })
}
