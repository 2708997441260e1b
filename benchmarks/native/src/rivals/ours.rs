//! jostle's core, as a Rust program calls it.

use jostle::{Columns, pairs, settings};

use super::Find;
use crate::scenes::Shapes;

/// [`pairs::find`] with its own choice of method; the columns are copied inside the call.
pub fn find(shapes: &Shapes, threads: usize) -> Find<'_> {
    Box::new(move || {
        let half = shapes.has_boxes().then(|| shapes.half.clone());
        let (x, y, radius) = (shapes.x.clone(), shapes.y.clone(), shapes.radius.clone());
        let columns = Columns::new(x, y, radius, half, None).expect("scenes hold valid shapes");
        let found = pairs::find(&columns, None, Some(threads), settings::DEFAULT_MAX_PAIRS);
        found.expect("fewer pairs than the limit").pairs
    })
}
