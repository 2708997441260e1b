//! Walls on a torus: each wall is repeated with the period of the torus.
//!
//! The tree contains the images that may touch a disc which begins a step on the torus and stays in
//! its bounds. The position of a disc farther away is moved to the torus first.

use super::{Wall, WallContact, Walls, index_of};
use crate::container::size;
use crate::tolerance::ROUNDING;
use crate::trajectory::{Vector, dot, vector};
use jostle_base::error::{Error, Result};
use jostle_index::period::{NINE_IMAGES, Period, Turns};

/// Maximum distance from the torus of a disc in its bounds, with its radius, as a share of the
/// shorter side: a quarter for the radius, an eighth for the displacement, and a reserve.
const NEAR: f64 = 0.38;

/// A wall that is moved by an offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Image {
    /// The index of the wall.
    pub(super) wall: u32,
    pub(super) offset: Vector,
}

/// A position minus an offset.
#[inline(always)]
pub(super) fn less(position: Vector, offset: Vector) -> Vector {
    vector(|k| position[k] - offset[k])
}

/// Refuses the first wall that does not fit on a torus.
pub(super) fn check_torus(
    period: &Period<f64>,
    walls: &[Wall],
    argument: &'static str,
) -> Result<()> {
    let is_long = |wall: &Wall| {
        let [a, b] = wall.exact_ends();
        period.is_exceeded_by(vector(|k| b[k] - a[k]))
    };
    match walls.iter().position(is_long) {
        None => Ok(()),
        Some(index) => {
            let [[a, b], [c, d]] = walls[index].ends;
            let value = format!("(({a}, {b}), ({c}, {d}))");
            let rule = "in a periodic world a wall may extend over each side once at most";
            Err(Error::at(argument, index, value, rule))
        }
    }
}

/// The offset that moves the middle of a wall to the torus.
pub(super) fn torus_offset([a, b]: [Vector; 2], period: &Period<f64>) -> Vector {
    period.turns(vector(|k| 0.5 * (a[k] + b[k]))).map(|v| -v)
}

/// Calls `act` with the offset of each image, apart from the wall itself, of a wall in a box given
/// by two corners, that a disc on the torus may touch.
pub(super) fn each_image(
    [min, max]: [Vector; 2],
    period: &Period<f64>,
    mut act: impl FnMut(Vector),
) {
    // Moved by k sides, the box [min, max] reaches the torus with its margin if −margin ≤ max + k
    // side and min + k side ≤ side + margin. These are the first and the last k.
    let (sides, margin) = (period.sides(), NEAR * period.shortest());
    let first = [0, 1].map(|k| ((-margin - max[k]) / sides[k]).ceil() as i32);
    let last = [0, 1].map(|k| ((sides[k] + margin - min[k]) / sides[k]).floor() as i32);
    for y in first[1]..=last[1] {
        for x in first[0]..=last[0] {
            if [x, y] != [0, 0] {
                act(period.span([x, y]));
            }
        }
    }
}

/// Calls `act` with the part of a box in each copy of the torus, moved to the torus, and the offset
/// of the copy.
pub(super) fn each_tile(
    [min, max]: [Vector; 2],
    sides: Vector,
    mut act: impl FnMut([Vector; 2], Vector),
) {
    // A box far from the torus is cut where copies of the torus meet, and each part is moved to the
    // torus. Then the tree, which has walls near the torus only, is enough.
    let [first, last] = [min, max].map(|at| [0, 1].map(|k| (at[k] / sides[k]).floor() as i64));
    for y in first[1]..=last[1] {
        for x in first[0]..=last[0] {
            let offset = [x as f64 * sides[0], y as f64 * sides[1]];
            let low = vector(|k| (min[k] - offset[k]).max(0.0));
            let high = vector(|k| (max[k] - offset[k]).min(sides[k]));
            act([low, high], offset);
        }
    }
}

impl Walls {
    /// The contact of a disc and the wall with a number, also of the container; on a torus that with the nearest
    /// image. Of images at the same distance it is that which the disc approaches fastest.
    pub fn nearest_contact(
        &self,
        wall: u32,
        position: Vector,
        velocity: Vector,
        radius: f64,
    ) -> Option<WallContact> {
        if index_of(wall).is_none() {
            return self.container.side(wall).map(|side| side.contact(wall, position, radius));
        }
        let own = |offset| self.contact(wall, less(position, offset), radius);
        let period = self.period();
        if period.is_none() {
            return Some(own([0.0; 2]));
        }
        let sides = period.sides();
        let [a, b] = self.numbered(wall).ends;
        // No image of a wall is farther than one from that whose middle is nearest.
        let tile = |k: usize| ((position[k] - 0.5 * (a[k] + b[k])) / sides[k]).round();
        let offset = |image: &Turns| vector(|k| (tile(k) + f64::from(image[k])) * sides[k]);
        let all = NINE_IMAGES.iter().map(|image| own(offset(image)));
        // Distances within rounding are equal. A disc in the gap between two images could otherwise
        // get the normal of the one that it leaves.
        let least = all.clone().map(|of| of.gap).fold(f64::INFINITY, f64::min);
        let most = least + ROUNDING * size(position, radius);
        let speed = |of: &WallContact| dot(of.normal, velocity);
        let nearest = all.filter(|of| of.gap <= most);
        nearest.min_by(|a, b| speed(a).total_cmp(&speed(b)))
    }
}
