//! jostle's core, as a Rust program calls it.

use jostle::{Method, pairs, settings};

use super::Find;
use crate::scenes::Shapes;

/// For any number of shapes, because trees are compared.
const TREE: Option<Method> = Some(Method::Quadtree);

/// [`pairs::find`] with the tree; the call converts the columns to rows. The tree gets new memory
/// each time (not [`pairs::find_with`]), as those of the other libraries.
pub fn find(shapes: &Shapes, threads: usize) -> Find<'_> {
    Box::new(move || {
        let rows = shapes.rows();
        let found = pairs::find(&rows, TREE, Some(threads), settings::DEFAULT_MAX_PAIRS);
        found.expect("fewer pairs than the limit").pairs
    })
}
