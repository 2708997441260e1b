//! Square grids whose cells are numbered along a Z-curve (Morton order).

/// Subdivisions that one grid's keys can tell apart.
pub const GRID_LEVELS: u32 = 16;

/// A square grid over some centres, fitted when it was made.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Grid {
    /// Coordinates are multiplied by this power of two before anything else,
    /// so that neither the largest nor the smallest float64 leaves the range.
    prescale: f64,
    origin: [f64; 2],
    side: f64,
}

impl Grid {
    /// The grid whose cells hold all centres between `min` and `max`.
    ///
    /// The side is a power of two and the origin a multiple of an eighth of
    /// it: as the shapes move, the cells stay where they are.
    pub fn around(min: [f64; 2], max: [f64; 2]) -> Self {
        let widest =
            |scale: f64| (max[0] * scale - min[0] * scale).max(max[1] * scale - min[1] * scale);
        let prescale = match widest(0.125) {
            extent if extent > 1e300 => 0.125,
            extent if extent < 1e-280 => 2f64.powi(64),
            _ => 1.0,
        };
        let side = power_of_two_at_least(widest(prescale) * (8.0 / 7.0));
        let step = side / 8.0;
        let origin = [0, 1].map(|axis| (min[axis] * prescale / step).floor() * step);
        Self { prescale, origin, side }
    }

    /// A grid for centres that all coincide.
    pub fn at(center: [f64; 2]) -> Self {
        Self { prescale: 1.0, origin: center, side: 1.0 }
    }

    /// Whether it can tell centres apart; not so if one of them was not a number.
    pub fn is_finite(&self) -> bool {
        self.side.is_finite() && self.origin.iter().all(|v| v.is_finite())
    }

    /// The distance between two coordinates as a part of the side.
    pub fn part(&self, high: f64, low: f64) -> f64 {
        (high * self.prescale - low * self.prescale) / self.side
    }

    /// The Z-order key of a centre: bits of x and y in turn, coarsest first.
    #[inline(always)]
    pub fn key(&self, [x, y]: [f64; 2]) -> u32 {
        self.keys(&[x], &[y])[0]
    }

    /// The keys of some centres, x and y by themselves, which the compiler can compute together.
    #[inline(always)]
    pub fn keys<const COUNT: usize>(&self, x: &[f64; COUNT], y: &[f64; COUNT]) -> [u32; COUNT] {
        let cells = f64::from(1u32 << GRID_LEVELS) / self.side;
        let index = |along: f64, axis: usize| {
            spread(cell_index((along * self.prescale - self.origin[axis]) * cells))
        };
        let mut keys = [0; COUNT];
        for lane in 0..COUNT {
            keys[lane] = index(x[lane], 0) | index(y[lane], 1) << 1;
        }
        keys
    }

    /// The cell of `key` after `level` subdivisions: min x, min y, max x, max y.
    pub fn cell(&self, key: u32, level: u32) -> [f64; 4] {
        let side = self.side / f64::from(1u32 << level);
        let shift = GRID_LEVELS - level;
        let index = [compact(key) >> shift, compact(key >> 1) >> shift];
        let min = [0, 1].map(|axis| self.origin[axis] + f64::from(index[axis]) * side);
        let back = |v: f64| v / self.prescale;
        [back(min[0]), back(min[1]), back(min[0] + side), back(min[1] + side)]
    }
}

/// The whole part of a number, at least 0 and at most the last cell's. Unlike a cast, the
/// compiler can do this for several numbers at once: adding 2⁵² leaves no room for bits
/// behind the point, and puts those before it at the end of the mantissa.
#[inline(always)]
fn cell_index(along: f64) -> u32 {
    const SHIFTER: f64 = (1u64 << 52) as f64;
    const LAST: f64 = ((1u32 << GRID_LEVELS) - 1) as f64;
    let along = if along > 0.0 { along } else { 0.0 };
    let along = if along < LAST { along } else { LAST };
    let rounded = (along + SHIFTER) - SHIFTER;
    let whole = rounded - if rounded > along { 1.0 } else { 0.0 };
    (whole + SHIFTER).to_bits() as u32
}

/// Smallest power of two that is at least `value`, for positive normal values.
fn power_of_two_at_least(value: f64) -> f64 {
    let floor = f64::from_bits(value.to_bits() & 0x7ff0_0000_0000_0000);
    if floor < value { floor * 2.0 } else { floor }
}

/// Moves the low 16 bits to the even places.
#[inline(always)]
fn spread(v: u32) -> u32 {
    let v = (v | v << 8) & 0x00ff_00ff;
    let v = (v | v << 4) & 0x0f0f_0f0f;
    let v = (v | v << 2) & 0x3333_3333;
    (v | v << 1) & 0x5555_5555
}

/// Gathers the even bits, the inverse of [`spread`].
fn compact(v: u32) -> u32 {
    let v = v & 0x5555_5555;
    let v = (v | v >> 1) & 0x3333_3333;
    let v = (v | v >> 2) & 0x0f0f_0f0f;
    let v = (v | v >> 4) & 0x00ff_00ff;
    (v | v >> 8) & 0x0000_ffff
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spreading_and_compacting_are_inverse() {
        for v in [0, 1, 0x8000, 0xffff, 0x1234] {
            assert_eq!(compact(spread(v)), v);
        }
    }

    #[test]
    fn cells_are_whole_parts() {
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
    fn a_cell_holds_the_centres_that_have_its_key() {
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
