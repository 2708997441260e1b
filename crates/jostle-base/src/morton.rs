//! Morton order (Z-order): keys whose bits are those of two coordinates in turn.
//!
//! G. M. Morton, *A computer oriented geodetic data base and a new technique in file
//! sequencing*, IBM (1966).

/// The key of a cell: bit 2k is bit k of `x`, bit 2k + 1 is bit k of `y`. Both are below 2^16.
#[inline(always)]
pub fn key(x: u32, y: u32) -> u32 {
    spread(x) | spread(y) << 1
}

/// As [`key`], of coordinates of 32 bits.
#[inline(always)]
pub fn wide_key(x: u32, y: u32) -> u64 {
    // The high halves decide first, so the order is the Morton order of all 32 bits.
    let low = key(x & 0xffff, y & 0xffff);
    u64::from(key(x >> 16, y >> 16)) << 32 | u64::from(low)
}

/// The coordinates of the cell with a key, the inverse of [`key`].
pub fn cell(key: u32) -> [u32; 2] {
    [compact(key), compact(key >> 1)]
}

/// Moves bit k of the low 16 bits to bit 2k.
#[inline(always)]
fn spread(v: u32) -> u32 {
    // Each line halves the groups of adjacent bits and moves the upper half of each to its place.
    // After four lines the groups are single bits, with a gap after each for a bit of the other
    // coordinate.
    let v = (v | v << 8) & 0x00ff_00ff;
    let v = (v | v << 4) & 0x0f0f_0f0f;
    let v = (v | v << 2) & 0x3333_3333;
    (v | v << 1) & 0x5555_5555
}

/// Moves bit 2k to bit k, the inverse of [`spread`].
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
    fn keys_and_cells_are_inverse() {
        for v in [0, 1, 0x8000, 0xffff, 0x1234] {
            assert_eq!(cell(key(v, v >> 1)), [v, v >> 1]);
        }
    }

    #[test]
    fn the_bits_of_wide_keys_are_those_of_the_coordinates_in_turn() {
        for [x, y] in [[0, 0], [1, 0], [0x8000_0000, 0x1234_5678], [u32::MAX, 0x0001_8001]] {
            let bit = |number: u32, at: u64| u64::from(number >> at & 1);
            let bits = (0..32).map(|at| bit(x, at) << (2 * at) | bit(y, at) << (2 * at + 1));
            assert_eq!(wide_key(x, y), bits.sum());
        }
    }
}
