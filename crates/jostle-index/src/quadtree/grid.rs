//! Square grids whose cells are numbered in Morton order.

use std::cmp::Ordering;

use jostle_base::morton;

/// Number of subdivisions of a grid: its keys have two bits for each.
pub(super) const GRID_LEVELS: u32 = 16;

/// Grids within grids that separate all different float32 coordinates.
pub(super) const NESTED: usize = 16;

/// A square grid over a set of centres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Grid {
    /// Coordinates are first multiplied by this power of two, so that no float64 overflows or
    /// underflows.
    prescale: f64,
    origin: [f64; 2],
    side: f64,
}

impl Grid {
    /// The grid over all centres between `min` and `max`.
    ///
    /// The side is a power of two and the origin a multiple of an eighth of it, so that the cells
    /// rarely change while the shapes move.
    pub(super) fn around(min: [f64; 2], max: [f64; 2]) -> Self {
        let widest =
            |scale: f64| (max[0] * scale - min[0] * scale).max(max[1] * scale - min[1] * scale);
        // The extent of finite numbers may be infinite: from -1e308 to 1e308. An eighth of it is
        // not. Extents near the smallest number would make the cells of finer grids vanish, so they
        // are multiplied. Powers of two round nothing, except numbers that are far below the size
        // of a cell.
        let prescale = match widest(0.125) {
            extent if extent > 1e300 => 0.125,
            extent if extent < 1e-280 => 2f64.powi(64),
            _ => 1.0,
        };
        // The origin lies up to an eighth of the side below the smallest centre. The other seven
        // eighths have to contain the extent. If the origin were the smallest centre itself, one
        // moving disc at the edge would shift all cells, and with them the tree, in every step.
        let side = power_of_two_at_least(widest(prescale) * (8.0 / 7.0));
        let step = side / 8.0;
        let origin = [0, 1].map(|axis| (min[axis] * prescale / step).floor() * step);
        Self { prescale, origin, side }
    }

    /// The smallest grid over all centres between `min` and `max` of those that contain each other:
    /// squares whose sides are powers of two and whose corners are multiples of their sides, and
    /// squares around the origin. Their Morton orders agree, so the order of two shapes does not
    /// depend on other shapes.
    pub(super) fn nested_around(min: [f64; 2], max: [f64; 2]) -> Self {
        let Self { prescale, side, .. } = Self::around(min, max);
        let [min, max] = [min, max].map(|corner| corner.map(|v| v * prescale));
        // Below this side the corners of a grid are no numbers of their own.
        let farthest = min.iter().chain(&max).fold(0.0f64, |most, v| most.max(v.abs()));
        let mut side = side.max(power_of_two_at_least(farthest) * 2f64.powi(-40)) * 0.5;
        // A square whose corners are multiples of its side lies on one side of both axes. So it can
        // contain only centres on one side.
        if [0, 1].iter().all(|&k| (min[k] < 0.0) == (max[k] < 0.0)) {
            // It ends at the latest where the corner is the origin.
            while side.is_finite() {
                let cell = |v: [f64; 2]| v.map(|v| (v / side).floor());
                // Both corners in one cell: so are all centres between them, because the rounding
                // of `floor` is monotone. The first such side is the smallest one.
                if cell(min) == cell(max) {
                    return Self { prescale, origin: cell(min).map(|v| v * side), side };
                }
                side *= 2.0;
            }
        }
        // A square around the origin contains every smaller one of either kind, so the orders
        // agree. The factor is for a centre at exactly the upper corner. It would be clamped into
        // the last cell, and its order would differ from that in a larger square.
        let half = power_of_two_at_least(farthest * (1.0 + f64::EPSILON));
        Self { prescale, origin: [-half; 2], side: 2.0 * half }
    }

    /// A grid for centres that all coincide.
    pub(super) fn at(center: [f64; 2]) -> Self {
        Self { prescale: 1.0, origin: center, side: 1.0 }
    }

    /// Whether all its numbers are finite; not so if a centre was NaN.
    pub(super) fn is_finite(&self) -> bool {
        self.side.is_finite() && self.origin.iter().all(|v| v.is_finite())
    }

    /// The distance between two coordinates as a fraction of the side.
    pub(super) fn fraction(&self, high: f64, low: f64) -> f64 {
        (high * self.prescale - low * self.prescale) / self.side
    }

    /// The Morton key of a centre.
    #[inline(always)]
    pub(super) fn key(&self, [x, y]: [f64; 2]) -> u32 {
        self.keys(&[x], &[y])[0]
    }

    /// The keys of some centres, given as columns, so that the compiler vectorizes the loop.
    #[inline(always)]
    pub(super) fn keys<const COUNT: usize>(
        &self,
        x: &[f64; COUNT],
        y: &[f64; COUNT],
    ) -> [u32; COUNT] {
        // The side is a power of two, so the factor is exact: the only rounding is that of the
        // difference. Rounding is monotone, so a larger coordinate never has a smaller cell.
        let cells = f64::from(1u32 << GRID_LEVELS) / self.side;
        let index = |along: f64, axis: usize| {
            cell_index((along * self.prescale - self.origin[axis]) * cells)
        };
        let mut keys = [0; COUNT];
        // Arrays and a plain loop: with iterators and closures the compiler makes scalar code.
        // Sixteen centres at a time take 13.5 instead of 17 ns a shape for the tree
        // (docs/benchmarks-notes.md).
        for lane in 0..COUNT {
            keys[lane] = morton::key(index(x[lane], 0), index(y[lane], 1));
        }
        keys
    }

    /// The grid over the cell of a key.
    pub(super) fn inside(&self, key: u32) -> Self {
        let side = self.side / f64::from(1u32 << GRID_LEVELS);
        let index = morton::cell(key);
        let origin = [0, 1].map(|axis| self.origin[axis] + f64::from(index[axis]) * side);
        Self { prescale: self.prescale, origin, side }
    }

    /// The Morton order of two centres by the keys of this grid, of its cells, of their cells and
    /// so on.
    pub(super) fn compare(&self, a: [f64; 2], b: [f64; 2]) -> Ordering {
        let mut grid = *self;
        for _ in 0..NESTED {
            // Each grid continues in the cell of the one before: together they are one very fine
            // grid.
            let keys = [a, b].map(|center| grid.key(center));
            if keys[0] != keys[1] || a == b {
                return keys[0].cmp(&keys[1]);
            }
            grid = grid.inside(keys[0]);
        }
        Ordering::Equal
    }

    /// The cell of `key` after `level` subdivisions: min x, min y, max x, max y.
    pub(super) fn cell(&self, key: u32, level: u32) -> [f64; 4] {
        let side = self.side / f64::from(1u32 << level);
        let shift = GRID_LEVELS - level;
        let index = morton::cell(key).map(|index| index >> shift);
        let min = [0, 1].map(|axis| self.origin[axis] + f64::from(index[axis]) * side);
        let back = |v: f64| v / self.prescale;
        [back(min[0]), back(min[1]), back(min[0] + side), back(min[1] + side)]
    }
}

/// 2⁵²: a number that is added to it is rounded to an integer.
const SHIFTER: f64 = (1u64 << 52) as f64;

/// The nearest integer to a number that is at least 0 and fits. Unlike a cast, the compiler
/// vectorizes this: the integer is in the low bits of the mantissa of the sum.
#[inline(always)]
pub fn nearest_integer(number: f64) -> u32 {
    (number + SHIFTER).to_bits() as u32
}

/// The integer part of a number, clamped to the indices of cells.
#[inline(always)]
fn cell_index(along: f64) -> u32 {
    const LAST: f64 = ((1u32 << GRID_LEVELS) - 1) as f64;
    // The comparison is false for NaN, which becomes 0. So each line is one instruction. `clamp`
    // keeps NaN and takes more.
    let along = if along > 0.0 { along } else { 0.0 };
    let along = if along < LAST { along } else { LAST };
    // The sum has no bits for a fraction, so this rounds to the nearest integer. If it went up, one
    // less is the integer part. There is no instruction for floor with SSE2.
    let rounded = (along + SHIFTER) - SHIFTER;
    nearest_integer(rounded - if rounded > along { 1.0 } else { 0.0 })
}

/// Smallest power of two that is at least `value`, for positive normal values.
fn power_of_two_at_least(value: f64) -> f64 {
    // The exponent without the fraction: the power of two that is at most `value`. No logarithm,
    // because the mathematical libraries of systems round it differently.
    let floor = f64::from_bits(value.to_bits() & 0x7ff0_0000_0000_0000);
    if floor < value { floor * 2.0 } else { floor }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cell_indices_are_truncated_and_clamped() {
        for (along, cell) in [
            (-1.0, 0),
            (0.0, 0),
            (0.999_999, 0),
            (1.0, 1),
            (1.5, 1),
            (2.5, 2),
            (65_534.999, 65_534),
            (65_535.0, 65_535),
            (65_536.0, 65_535),
            (1e300, 65_535),
        ] {
            assert_eq!(cell_index(along), cell, "{along}");
        }
    }

    #[test]
    fn a_cell_contains_the_centres_with_its_key() {
        let grid = Grid::around([-3.0, 10.0], [500.0, 300.0]);
        for center in [[-3.0, 10.0], [500.0, 300.0], [100.25, 299.0]] {
            for level in [0, 1, 7, GRID_LEVELS] {
                let cell = grid.cell(grid.key(center), level);
                assert!(cell[0] <= center[0] && center[0] < cell[2], "{cell:?} {center:?}");
                assert!(cell[1] <= center[1] && center[1] < cell[3], "{cell:?} {center:?}");
            }
        }
    }

    #[test]
    fn nested_grids_separate_float32_at_any_scale() {
        let grid = Grid::around([-1e18; 2], [1e18; 2]);
        for x in [1e-30f32, 1e-3, 1.0, 12_345.678, 1e9, 1e17] {
            let [a, b] = [x, x.next_up()].map(|x| [f64::from(x), 5.0]);
            assert_eq!(
                (grid.compare(a, b), grid.compare(b, a)),
                (Ordering::Less, Ordering::Greater)
            );
            assert_eq!(grid.compare(a, a), Ordering::Equal);
        }
        let inner = grid.inside(grid.key([3.0, 5.0]));
        assert_eq!(inner.cell(0, 0), grid.cell(grid.key([3.0, 5.0]), GRID_LEVELS));
    }

    #[test]
    fn nested_grids_have_one_order() {
        let mut random = 1u64;
        let mut number = |scale: f64| {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (random >> 33) as f64 / f64::from(1u32 << 31) * 2.0 * scale - scale
        };
        for round in 0..2000 {
            let scale = 10f64.powi(round % 9 - 3);
            let centre = [number(100.0), number(100.0)];
            let mut near = || [0, 1].map(|k| (centre[k] + number(scale)) as f32).map(f64::from);
            let (a, b) = (near(), near());
            let grid_of = |more: [f64; 2]| {
                let all = [a, b, more];
                let corner = |pick: fn(f64, f64) -> f64| {
                    [0, 1].map(|k| all.iter().map(|v| v[k]).reduce(pick).unwrap())
                };
                Grid::nested_around(corner(f64::min), corner(f64::max))
            };
            let expected = grid_of(near()).compare(a, b);
            for far in [10.0, 1e3, 1e6] {
                let grid = grid_of([number(far), number(far)].map(|v| f64::from(v as f32)));
                assert_eq!(grid.compare(a, b), expected, "{a:?} {b:?} {grid:?}");
                assert!([a, b].iter().all(|&v| {
                    let [x, y, right, top] = grid.cell(grid.key(v), 0);
                    x <= v[0] && y <= v[1] && v[0] < right && v[1] < top
                }));
            }
        }
    }

    #[test]
    fn grids_fit_the_extremes_of_float64() {
        for [min, max] in [
            [-f64::MAX, f64::MAX],
            [0.0, 5e-324],
            [1.0, 1.0 + f64::EPSILON],
            [1e300, f64::MAX],
            [-1e-300, 1e300],
        ] {
            let grid = Grid::around([min; 2], [max; 2]);
            assert!(grid.key([min; 2]) < grid.key([max; 2]), "{min} {max} {grid:?}");
        }
    }
}
