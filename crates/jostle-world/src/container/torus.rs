//! A torus: periodic positions and minimum images.

use super::Container;
use crate::motion;

/// Maximum number of times that a particle travels around a torus in a step.
pub const MAX_TOURS: f32 = 125.0;

/// A position and its eight nearest images, as numbers of periods along each axis.
pub const NINE_IMAGES: [[i8; 2]; 9] =
    [[-1, -1], [0, -1], [1, -1], [-1, 0], [0, 0], [1, 0], [-1, 1], [0, 1], [1, 1]];

impl Container {
    /// Width and height of a torus; none for other containers.
    #[inline(always)]
    pub fn period(&self) -> Option<[f32; 2]> {
        if let Self::Torus { size } = self { Some(*size) } else { None }
    }

    /// Offsets between a torus and its images, one of each opposite two. They are added to the
    /// second particle of a pair.
    pub fn images(&self) -> impl Iterator<Item = [f32; 2]> + use<> {
        let images = match *self {
            Self::Torus { size: [w, h] } => Some([[-w, 0.0], [0.0, -h], [-w, -h], [-w, h]]),
            _ => None,
        };
        images.into_iter().flatten()
    }

    /// How often a displacement goes around a torus.
    pub fn tours(&self, displacement: f32) -> f32 {
        match self {
            Self::Torus { size } => displacement / size[0].min(size[1]),
            _ => 0.0,
        }
    }

    /// The copy of the torus in which a position is, counted from the one at the origin.
    pub fn tile(&self, position: [f64; 2]) -> [i32; 2] {
        match self {
            Self::Torus { size } => {
                [0, 1].map(|k| (position[k] / f64::from(size[k])).floor() as i32)
            }
            _ => [0; 2],
        }
    }

    /// The offset between the torus and one of its copies.
    pub fn offset(&self, tile: [i32; 2]) -> [f64; 2] {
        match self {
            Self::Torus { size } => [0, 1].map(|k| f64::from(tile[k]) * f64::from(size[k])),
            _ => [0.0; 2],
        }
    }

    /// Maximum displacement for which the bounds of particles at the beginning of a step are made,
    /// unless they merge; so few images of others are in them.
    pub fn max_displacement(&self) -> f32 {
        match self {
            Self::Torus { size } => size[0].min(size[1]) / 8.0,
            _ => f32::INFINITY,
        }
    }

    /// The equivalent position within a torus.
    #[inline]
    pub fn wrap(&self, position: [f32; 2]) -> [f32; 2] {
        let Self::Torus { size } = self else { return position };
        let wrapped = |axis: usize| {
            let (v, side) = (position[axis], size[axis]);
            let v = if v < 0.0 || v >= side { v - (v / side).floor() * side } else { v };
            // Rounding can leave a tiny negative number at the far side.
            if v >= side || v < 0.0 { 0.0 } else { v }
        };
        [wrapped(0), wrapped(1)]
    }

    /// The equivalent position within a torus, in float32, and its residual.
    pub fn wrap_exact(&self, position: [f32; 2], residual: [f32; 2]) -> ([f32; 2], [f32; 2]) {
        let Self::Torus { size } = self else { return (position, residual) };
        let exact = motion::exact(position, residual);
        let mut inside = exact;
        let mut rounded = [0.0; 2];
        for k in [0, 1] {
            let side = f64::from(size[k]);
            inside[k] -= side * (exact[k] / side).floor();
            rounded[k] = inside[k] as f32;
            // A position that rounds to the far side is at the near one.
            if rounded[k] >= size[k] {
                (inside[k], rounded[k]) = (inside[k] - side, 0.0);
            }
        }
        (rounded, motion::residual(inside, rounded))
    }

    /// The minimum image of an offset: the offset to the nearest image. The offset may span several
    /// periods.
    #[inline]
    pub fn minimum_image(&self, offset: [f64; 2]) -> [f64; 2] {
        let Self::Torus { size } = self else { return offset };
        [0, 1].map(|k| {
            let side = f64::from(size[k]);
            offset[k] - side * (offset[k] / side).round()
        })
    }

    /// The difference between the minimum image of an offset and the offset. The offset is computed
    /// only on a torus.
    #[inline(always)]
    pub fn nearest_image(&self, offset: impl FnOnce() -> [f64; 2]) -> [f32; 2] {
        if !matches!(self, Self::Torus { .. }) {
            return [0.0; 2];
        }
        let offset = offset();
        let nearest = self.minimum_image(offset);
        [0, 1].map(|k| (nearest[k] - offset[k]) as f32)
    }

    /// The minimum image of an offset between two positions within the torus, in float32.
    #[inline(always)]
    pub fn minimum_image_within(&self, offset: [f32; 2]) -> [f32; 2] {
        let Self::Torus { size } = self else { return offset };
        minimum_image_within(*size, offset)
    }
}

/// [`Container::minimum_image_within`] for a torus of a size.
#[inline(always)]
pub fn minimum_image_within(size: [f32; 2], offset: [f32; 2]) -> [f32; 2] {
    [0, 1].map(|k| {
        let (side, offset) = (size[k], offset[k]);
        if offset > 0.5 * side {
            offset - side
        } else if offset < -0.5 * side {
            offset + side
        } else {
            offset
        }
    })
}
