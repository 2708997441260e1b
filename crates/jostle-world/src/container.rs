//! The container: sides around the particles, or a torus. What depends on its shape is here: gaps and
//! normals, the nearest position inside, times of impact. Elsewhere only the checks of forces and of
//! sides at a temperature match its variants. A torus has no sides but a [`Period`].

use crate::particles::FARTHEST;
use crate::surface::MAX_SIDES;
use crate::tolerance::ROUNDING;
use crate::trajectory::{Impact, Limits, Piece, Vector, dot, flat_impact, round_impact, vector};
use jostle_base::error::{Error, Result};
use jostle_base::saved;
use jostle_index::period::Period;

/// Maximum number of times that a particle travels around a torus in a step.
pub const MAX_TOURS: f32 = 125.0;

/// The id of the side at min x of a box. Below it come those at max x, min y and max y, and that of a circle.
pub const FIRST_SIDE: i64 = -2;

/// Number of sides with a public id: those of a box, and the rim of a round container.
pub const KNOWN_SIDES: usize = MAX_SIDES + 1;

/// Their public names.
pub const SIDE_NAMES: [&str; KNOWN_SIDES] = ["MIN_X", "MAX_X", "MIN_Y", "MAX_Y", "RIM"];

/// The region that contains the particles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Container {
    /// The plane, without walls.
    #[default]
    None,
    /// Four walls around a rectangle.
    Box {
        /// Lower corner.
        min: [f32; 2],
        /// Upper corner.
        max: [f32; 2],
    },
    /// One round wall.
    Circle {
        /// Its centre.
        center: [f32; 2],
        /// Its radius.
        radius: f32,
    },
    /// A periodic rectangle from (0, 0) to `size`.
    Torus {
        /// Width and height.
        size: [f32; 2],
    },
}

saved! {
    enum Container("container") {
        0 => None, 1 => Box { min, max }, 2 => Circle { center, radius }, 3 => Torus { size }
    }
}

/// A wall near a disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallContact {
    /// The number of the wall.
    pub wall: u32,
    /// Unit vector from the wall to the centre.
    pub normal: Vector,
    /// Distance from surface to surface; negative if they overlap.
    pub gap: f64,
    /// Whether it is an end of the wall.
    pub is_end: bool,
}

/// The shape of a side of a container.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Side {
    /// A line at a right angle to an axis.
    Flat {
        /// 0 for a line x = `at`, 1 for y = `at`.
        axis: usize,
        /// 1 if the inside is where the coordinate is larger, else −1.
        inward: f64,
        /// The coordinate of the line.
        at: f64,
    },
    /// A circle around the particles.
    Round {
        /// Its centre.
        center: Vector,
        /// Its radius.
        radius: f64,
    },
}

/// A rectangle in which discs touch no side of a box.
pub struct Inner {
    low: [f32; 2],
    high: [f32; 2],
}

impl Inner {
    /// Whether it contains a disc.
    #[inline(always)]
    pub fn contains(&self, position: [f32; 2], radius: f32) -> bool {
        let along =
            |k: usize| (self.low[k] + radius < position[k]) & (position[k] < self.high[k] - radius);
        along(0) & along(1)
    }
}

impl Container {
    /// Whether it is a torus.
    pub fn has_period(&self) -> bool {
        matches!(self, Self::Torus { .. })
    }

    /// Whether it has sides.
    pub fn has_sides(&self) -> bool {
        // Loops over all discs ask this, so no side is computed for it.
        match self {
            Self::None | Self::Torus { .. } => false,
            Self::Box { .. } | Self::Circle { .. } => true,
        }
    }

    /// Its sides with their numbers: min x, max x, min y and max y of a box, the circle.
    #[inline(always)]
    pub fn sides(&self) -> impl Iterator<Item = (u32, Side)> + use<> {
        (0..).zip(self.all_sides()).filter_map(|(number, side)| Some((number, side?)))
    }

    /// The public id of the side with a number. Ids of walls are above −1, which is none.
    pub fn side_id(&self, number: u32) -> i64 {
        let sides_before = if matches!(self, Self::Circle { .. }) { 4 } else { i64::from(number) };
        FIRST_SIDE - sides_before
    }

    /// The side with a number, if it has one.
    pub fn side(&self, number: u32) -> Option<Side> {
        self.all_sides().get(number as usize).copied().flatten()
    }

    #[inline(always)]
    fn all_sides(&self) -> [Option<Side>; MAX_SIDES] {
        match self {
            Self::None | Self::Torus { .. } => [None; MAX_SIDES],
            Self::Box { min, max } => {
                let flat = |axis: usize, inward: f64, corner: &[f32; 2]| {
                    Some(Side::Flat { axis, inward, at: f64::from(corner[axis]) })
                };
                [flat(0, 1.0, min), flat(0, -1.0, max), flat(1, 1.0, min), flat(1, -1.0, max)]
            }
            Self::Circle { center, radius } => {
                let (center, radius) = (center.map(f64::from), f64::from(*radius));
                [Some(Side::Round { center, radius }), None, None, None]
            }
        }
    }

    /// The period of a torus; none for other containers.
    #[inline(always)]
    pub fn period(&self) -> Period<f32> {
        Period::unchecked(match self {
            Self::None | Self::Box { .. } | Self::Circle { .. } => [0.0; 2],
            Self::Torus { size } => *size,
        })
    }

    /// An eighth of the shorter side of a torus, so that few images of others are in bounds; infinite
    /// for other containers. The first bounds of particles that do not merge allow for a displacement
    /// of at most this, and a step in which particles merge has so many parts that none moves
    /// farther in one.
    pub fn max_reach(&self) -> f32 {
        self.period().shortest() / 8.0
    }

    /// The area inside; None for the plane.
    pub fn area(&self) -> Option<f64> {
        let product = |a: f32, b: f32| f64::from(a) * f64::from(b);
        match self {
            Self::None => None,
            Self::Box { min, max } => Some(product(max[0] - min[0], max[1] - min[1])),
            Self::Circle { radius, .. } => Some(core::f64::consts::PI * product(*radius, *radius)),
            Self::Torus { size } => Some(product(size[0], size[1])),
        }
    }

    /// Refuses walls that are not finite or enclose no area.
    pub fn validate(&self) -> Result<()> {
        let reasonable = |v: &f32| v.abs() <= FARTHEST;
        match self {
            Self::None => Ok(()),
            Self::Box { min, max } => {
                let ordered = min[0] < max[0] && min[1] < max[1];
                if ordered && min.iter().chain(max).all(reasonable) {
                    return Ok(());
                }
                let value = format!("Box({}, {}, {}, {})", min[0], min[1], max[0], max[1]);
                Err(Error::of("container", value, "its corners must be finite and min below max"))
            }
            Self::Circle { center, radius } => {
                if *radius > 0.0 && reasonable(radius) && center.iter().all(reasonable) {
                    return Ok(());
                }
                let value = format!("Circle(({}, {}), {radius})", center[0], center[1]);
                let rule = "its centre must be finite and its radius finite and above 0";
                Err(Error::of("container", value, rule))
            }
            Self::Torus { size } => {
                if size.iter().all(|&s| s > 0.0 && s <= FARTHEST) {
                    return Ok(());
                }
                let value = format!("({}, {})", size[0], size[1]);
                Err(Error::of("container", value, "its sides must be finite and above 0"))
            }
        }
    }

    /// Refuses the first radius that does not fit in.
    pub fn check_fit(&self, radii: &[f32]) -> Result<()> {
        let (largest, rule) = match self {
            Self::None => return Ok(()),
            Self::Box { min, max } => {
                // A disc may be as wide as the box; then it cannot move along that side.
                let side = (max[0] - min[0]).min(max[1] - min[1]);
                (side / 2.0, "it must fit between the walls")
            }
            Self::Circle { radius, .. } => (*radius, "it must fit into the round container"),
            // So two particles touch across at most one periodic boundary on each axis.
            Self::Torus { .. } => (
                self.period().shortest() / 4.0,
                "it may be at most a quarter of the shorter side of the period",
            ),
        };
        match radii.iter().position(|&r| r > largest) {
            Some(index) => {
                let rule = format!("{rule} (at most {largest})");
                Err(Error::at("radii", index, radii[index], &rule))
            }
            None => Ok(()),
        }
    }

    /// The nearest position inside the container.
    #[inline(always)]
    pub fn clamp(&self, position: [f32; 2], radius: f32) -> [f32; 2] {
        // A test in float32, with a margin for rounding, is nearly always sufficient.
        if self.inner().contains(position, radius) {
            return position;
        }
        self.clamp_rounded(position, radius)
    }

    /// A region in which particles are certainly inside the container.
    #[inline(always)]
    pub fn inner(&self) -> Inner {
        let Self::Box { min, max } = self else {
            return Inner { low: [f32::INFINITY; 2], high: [f32::NEG_INFINITY; 2] };
        };
        // A relative margin covers the rounding of position ± radius in float32.
        let margin = |k: usize| 1e-6 * (min[k].abs() + max[k].abs());
        Inner { low: [0, 1].map(|k| min[k] + margin(k)), high: [0, 1].map(|k| max[k] - margin(k)) }
    }

    #[inline(never)]
    fn clamp_rounded(&self, position: [f32; 2], radius: f32) -> [f32; 2] {
        match self {
            Self::Box { min, max } => {
                // Rounded inwards, so that position ± radius is inside the box.
                let within = |axis: usize| {
                    let (at, contact_distance) = (f64::from(position[axis]), f64::from(radius));
                    let (low, high) = (
                        f64::from(min[axis]) + contact_distance,
                        f64::from(max[axis]) - contact_distance,
                    );
                    if low <= at && at <= high {
                        return position[axis];
                    }
                    let (low, high) = (up(low), down(high));
                    // For a particle as wide as the box, rounding may exchange the two.
                    if low > high { (low + high) / 2.0 } else { position[axis].clamp(low, high) }
                };
                [within(0), within(1)]
            }
            Self::Circle { center, radius: wall } => {
                let contact_distance = (f64::from(*wall) - f64::from(radius)).max(0.0);
                let offset = |p: [f32; 2]| [0, 1].map(|k| f64::from(p[k]) - f64::from(center[k]));
                let length = |v: [f64; 2]| (v[0] * v[0] + v[1] * v[1]).sqrt();
                let out = offset(position);
                if length(out) <= contact_distance {
                    return position;
                }
                // Rounding may leave the result a little outside: shrink until it is in.
                let mut scale = contact_distance / length(out);
                for turn in 0.. {
                    let moved = [0, 1].map(|k| (f64::from(center[k]) + out[k] * scale) as f32);
                    if length(offset(moved)) <= contact_distance || scale < 1e-9 {
                        return moved;
                    }
                    // The steps are tiny, so that a disc at the wall stays at the wall.
                    scale *= 1.0 - shrink(turn);
                }
                *center
            }
            Self::None | Self::Torus { .. } => position,
        }
    }

    /// Nearest position at which a disc is inside the container, in float64.
    pub fn clamp_exactly(&self, position: Vector, radius: f64) -> Vector {
        match self {
            Self::Box { min, max } => vector(|k| {
                let (low, high) = (f64::from(min[k]) + radius, f64::from(max[k]) - radius);
                if low > high { 0.5 * (low + high) } else { position[k].clamp(low, high) }
            }),
            Self::Circle { center, radius: outer } => {
                let center = center.map(f64::from);
                let out = vector(|k| position[k] - center[k]);
                let most = (f64::from(*outer) - radius).max(0.0);
                // At the centre the scale is infinite, and the position stays.
                let scale = most / dot(out, out).sqrt();
                if scale < 1.0 { vector(|k| center[k] + out[k] * scale) } else { position }
            }
            Self::None | Self::Torus { .. } => position,
        }
    }

    /// Whether a disc that moves by at most `far` along each axis certainly touches no wall. It may
    /// be false for a disc in a round container.
    #[inline(always)]
    pub fn is_far(&self, position: [f64; 2], radius: f64, far: [f64; 2]) -> bool {
        let Self::Box { min, max } = self else { return !self.has_sides() };
        // The reserve covers the rounding of the positions, in float32 of the largest number
        // involved.
        let far = far.map(|v| radius + v + ROUNDING * size(position, radius));
        let is_between = |k: usize| {
            let [min, max] = [min[k], max[k]].map(f64::from);
            position[k] - min > far[k] && max - position[k] > far[k]
        };
        is_between(0) && is_between(1)
    }

    /// Whether a disc may be less than `far` from a wall along an axis; true for a disc in a round
    /// container, and where a number overflows.
    #[inline(always)]
    pub fn is_near_side(&self, position: [f32; 2], far: [f32; 2]) -> bool {
        let Self::Box { min, max } = self else { return self.has_sides() };
        // As a negation of being far, so that NaN counts as near and is tested exactly.
        let near = |k: usize| !((position[k] - min[k] > far[k]) & (max[k] - position[k] > far[k]));
        near(0) | near(1)
    }

    /// The first impact of a disc on a side, and the number of the side; `limits` has those at the side
    /// with a number.
    #[inline(always)]
    pub fn impact(
        &self,
        piece: &Piece,
        radius: f64,
        gravity: Vector,
        limits: impl Fn(u32) -> Limits,
    ) -> Option<(Impact, u32)> {
        let mut first = None::<(Impact, u32)>;
        for (number, side) in self.sides() {
            let impact = side.impact(piece, radius, gravity, &limits(number));
            let is_first =
                |impact: &Impact| first.is_none_or(|(before, _)| impact.time < before.time);
            // Strictly earlier: of two sides at the same time that with the smaller number.
            first = impact.filter(is_first).map(|impact| (impact, number)).or(first);
        }
        first
    }
}

impl Side {
    /// Radius of the curve on which the centre of a disc slides along it; infinite if it is flat.
    pub fn curve(&self, radius: f32) -> f32 {
        match self {
            Self::Flat { .. } => f32::INFINITY,
            Self::Round { radius: outer, .. } => (*outer - f64::from(radius)) as f32,
        }
    }

    /// The contact with a disc, for the wall with a number.
    #[inline(always)]
    pub fn contact(&self, wall: u32, position: Vector, radius: f64) -> WallContact {
        let (normal, gap) = match *self {
            Self::Flat { axis, inward, at } => {
                let [low, high] = [position[axis] - radius - at, at - radius - position[axis]];
                let normal = vector(|k| if k == axis { inward } else { 0.0 });
                (normal, if inward > 0.0 { low } else { high })
            }
            Self::Round { center, radius: outer } => {
                let inward = vector(|k| center[k] - position[k]);
                let length = dot(inward, inward).sqrt();
                // At the centre any direction is right. It must be the same on every machine.
                let normal = if length > 0.0 { inward.map(|v| v / length) } else { [1.0, 0.0] };
                (normal, outer - radius - length)
            }
        };
        WallContact { wall, normal, gap, is_end: false }
    }

    /// The first impact of a disc.
    #[inline(always)]
    fn impact(
        &self,
        piece: &Piece,
        radius: f64,
        gravity: Vector,
        limits: &Limits,
    ) -> Option<Impact> {
        match *self {
            Self::Flat { axis, inward, at } => {
                // Signs are chosen so that a gap above 0 is inside, for both sides of an axis.
                let gap = inward * (piece.position[axis] - at) - radius;
                let speed = inward * piece.velocity[axis];
                let pull = if piece.falls { -inward * gravity[axis] } else { 0.0 };
                flat_impact(gap, speed, pull, piece.time, limits)
            }
            Self::Round { center, radius: outer } => {
                let q = vector(|k| piece.position[k] - center[k]);
                // The centre moves inside of a smaller circle; a disc as wide as the container
                // stays at its centre.
                let contact_distance = (outer - radius).max(0.0);
                let acceleration = if piece.falls { gravity } else { [0.0; 2] };
                let velocity = piece.velocity;
                round_impact(q, velocity, acceleration, contact_distance, piece.time, limits)
            }
        }
    }
}

/// The largest number in the computation of a surface that is `contact_distance` from a centre at
/// `position`.
#[inline(always)]
pub fn size(position: [f64; 2], contact_distance: f64) -> f64 {
    position[0].abs() + position[1].abs() + contact_distance
}

/// Relative step by which a position is moved towards the centre until it is inside. A few
/// tiny steps are nearly always enough. Far from the origin, where float32 is coarse, the step
/// doubles up to a half, so that there are at most about 60 iterations.
fn shrink(turn: u32) -> f64 {
    const TINY_TURNS: u32 = 8;
    let doublings = turn.saturating_sub(TINY_TURNS).min(23);
    (1e-7 * f64::from(1u32 << doublings)).min(0.5)
}

/// The largest float32 that is not above `value`.
fn down(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) > value { near.next_down() } else { near }
}

/// The smallest float32 that is not below `value`.
fn up(value: f64) -> f32 {
    -down(-value)
}
