//! Our own uniform grid, with the fastest cell size of each scene, measured before.

use super::Rival;
use crate::grid::{self, CellSize};
use crate::measure::seconds;
use crate::scenes::Shapes;
use crate::simd::Level;

/// Cell sizes to try, as multiples of the size at which a cell contains one shape, or of the
/// diameter of equal discs.
const WIDTHS: [f32; 14] =
    [0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 20.0, 40.0, 80.0, 1e9];
const HEIGHTS: [f32; 11] = [0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 8.0, 16.0, 32.0, 1e9];

/// Maximum number of cells per shape; more only take time and memory.
const MOST_CELLS_EACH: f64 = 16.0;

/// Number of shapes up to which a single cell, which is brute force, may be the fastest.
const MOST_IN_ONE_CELL: usize = 2_000;

/// The grid with the fastest cell size.
pub fn tuned(shapes: &Shapes, threads: usize) -> Rival<'_> {
    let level = Level::best();
    let unit = unit(shapes);
    let cell = best(shapes, unit, level, threads);
    Rival {
        name: "grid",
        version: env!("CARGO_PKG_VERSION").to_owned(),
        find: Box::new(move || grid::pairs(shapes, cell, level, threads)),
        remark: format!("cells {:.2} × {:.2} of {unit:.3}", cell.width / unit, cell.height / unit),
    }
}

/// The diameter of equal discs, or the side of a square with one shape on average.
fn unit(shapes: &Shapes) -> f32 {
    if grid::are_equal_discs(shapes) {
        return 2.0 * shapes.radius[0];
    }
    (area(shapes) / shapes.len() as f64).sqrt() as f32
}

/// Of the box around all centres.
fn area(shapes: &Shapes) -> f64 {
    let extent = |values: &[f32]| {
        let low = values.iter().copied().fold(f32::INFINITY, f32::min);
        f64::from(values.iter().copied().fold(f32::NEG_INFINITY, f32::max) - low)
    };
    extent(&shapes.x) * extent(&shapes.y)
}

/// The fastest: each is tried once, the best few three times more.
fn best(shapes: &Shapes, unit: f32, level: Level, threads: usize) -> CellSize {
    let time = |cell: CellSize| {
        seconds(
            &mut (Box::new(|| drop(grid::pairs(shapes, cell, level, threads))) as Box<dyn FnMut()>),
        )
    };
    let mut tried: Vec<(f64, CellSize)> =
        sizes(shapes, unit).map(|cell| (time(cell), cell)).collect();
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    tried.truncate(6);
    for (least, cell) in &mut tried {
        *least = (0..5).map(|_| time(*cell)).fold(*least, f64::min);
    }
    let quickest = tried.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    quickest.expect("some cell is tried").1
}

fn sizes(shapes: &Shapes, unit: f32) -> impl Iterator<Item = CellSize> {
    let (area, count) = (area(shapes), shapes.len());
    let all = WIDTHS.into_iter().flat_map(move |width| HEIGHTS.map(|height| [width, height]));
    let cells =
        all.map(move |[width, height]| CellSize { width: width * unit, height: height * unit });
    cells.filter(move |cell| {
        let each = area / f64::from(cell.width) / f64::from(cell.height) / count as f64;
        let single = cell.width > 1e8 || cell.height > 1e8;
        each <= MOST_CELLS_EACH && (!single || count <= MOST_IN_ONE_CELL)
    })
}
