//! Square cells whose sides are powers of two, for boxes of any size.
//!
//! A box belongs to the level whose cells are at least as long as its longer side, and less than
//! twice as long, so it lies in at most four cells. A cell of a level consists of four of the next
//! finer one.
//!
//! C. Ericson, *Real-Time Collision Detection* (2005), chapter 7.2 (hierarchical grids).

use jostle_index::geometry::Scalar;

/// The exponent of the sides of cells.
pub(crate) type Level = i32;

/// Column and row of a cell in its level.
pub(crate) type Cell = [i64; 2];

/// The level of boxes whose longer side is `side`, which is above 0.
pub(crate) fn level_of(side: f64) -> Level {
    let exponent = (side.to_bits() >> 52) as i32 - 1023;
    // The smallest power of two that is at least the side, from the bits of the number: a logarithm
    // is rounded differently on different systems.
    if side == size_of_cells(exponent) { exponent } else { exponent + 1 }
}

fn size_of_cells(level: Level) -> f64 {
    // Subnormal sizes are not needed: sides are at least as long as the rounding of positions.
    f64::from_bits(((level + 1023).clamp(1, 2046) as u64) << 52)
}

/// The first and the last cell of a level that a box touches. Coordinates beyond
/// [`Scalar::MAX_SIZE`] count as that.
pub(crate) fn range<T: Scalar>(level: Level, min: [T; 2], max: [T; 2]) -> [Cell; 2] {
    let size = size_of_cells(level);
    let index = |at: T| {
        let at = at.max(-T::MAX_SIZE).min(T::MAX_SIZE);
        (at.to_f64() / size).floor() as i64
    };
    [min.map(index), max.map(index)]
}

/// The cell of a coarser level that contains a cell.
pub(crate) fn ancestor(cell: Cell, levels: i32) -> Cell {
    // An arithmetic shift rounds down, also for negative indices, as the division of a cell into
    // four does.
    cell.map(|index| index >> levels.min(63))
}

/// All cells of a range.
pub(crate) fn each([first, last]: [Cell; 2]) -> impl Iterator<Item = Cell> {
    (first[1]..=last[1]).flat_map(move |y| (first[0]..=last[0]).map(move |x| [x, y]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_lies_in_at_most_four_cells() {
        for side in [0.1f64, 0.25, 1.0, 3.0, 1e30] {
            let level = level_of(side);
            assert!(size_of_cells(level) >= side && size_of_cells(level) < 2.0 * side);
            for k in -20..20 {
                let min = [f64::from(k) * 0.3 * side, f64::from(k) * 0.7 * side];
                let max = min.map(|v| v + side);
                let cells = range(level, min, max);
                assert!(each(cells).count() <= 9);
                let coarse = range(level + 3, min, max);
                for cell in each(cells) {
                    let [x, y] = ancestor(cell, 3);
                    assert!(coarse[0][0] <= x && x <= coarse[1][0]);
                    assert!(coarse[0][1] <= y && y <= coarse[1][1]);
                }
            }
        }
    }
}
