//! jostle's core, as a Rust program calls it.

use jostle_base::settings;
use jostle_index::pairs;

use super::Find;
use crate::scenes::Shapes;

/// [`pairs::find`], which chooses the method; the call converts the columns to rows. It gets new memory
/// each time (not [`pairs::find_with`]), as the other libraries do.
pub fn find(shapes: &Shapes, threads: usize) -> Find<'_> {
    Box::new(move || {
        let rows = shapes.rows();
        let found = pairs::find(&rows, None, Some(threads), settings::DEFAULT_MAX_PAIRS);
        found.expect("fewer pairs than the limit").pairs
    })
}
