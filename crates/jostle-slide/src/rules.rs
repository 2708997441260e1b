//! How shapes slide: the rules, the kinds of surfaces, and the part of a motion that is left at one.

use jostle_base::error::{Error, Result};
use jostle_index::geometry::Scalar;

/// Default of [`SlideRules::max_slides`].
pub const DEFAULT_MAX_SLIDES: usize = 4;

/// The largest [`SlideRules::max_slides`]. A shape between two walls at a sharp angle may hit them
/// alternately without end.
pub const MAX_SLIDES: usize = 1000;

/// How shapes slide. By default there are no floors, and all shapes are obstacles from all sides.
#[derive(Clone, Copy, Debug)]
pub struct SlideRules<T> {
    /// The categories of the shapes that are obstacles.
    pub mask: u32,
    /// Maximum number of obstacles that a shape meets in a call; it stops at the last one.
    pub max_slides: usize,
    /// The direction in which floors face, of any length; (0, 0) if there are no floors.
    pub up: [T; 2],
    /// The largest angle between the normal of a floor and `up`, in radians.
    pub floor_angle: f64,
    /// A shape that walks on a floor is put back on a floor at most this far below.
    pub snap: T,
    /// A shape that walks on a floor climbs steps of at most this height.
    pub step_height: T,
    /// Whether the speed along a floor is that of the displacement across `up`.
    pub constant_speed: bool,
    /// Categories of the obstacles that stop shapes only from above.
    pub one_way: u32,
}

impl<T: Scalar> Default for SlideRules<T> {
    fn default() -> Self {
        let (max_slides, floor_angle) = (DEFAULT_MAX_SLIDES, std::f64::consts::FRAC_PI_4);
        Self {
            mask: u32::MAX,
            max_slides,
            up: [T::ZERO; 2],
            floor_angle,
            snap: T::ZERO,
            step_height: T::ZERO,
            constant_speed: false,
            one_way: 0,
        }
    }
}

/// [`SlideRules`] with valid values.
#[derive(Clone, Copy, Debug)]
pub struct CheckedRules<T> {
    pub(crate) mask: u32,
    pub(crate) max_slides: usize,
    /// A unit vector, or (0, 0).
    pub(crate) up: [T; 2],
    /// Cosine of the largest angle between the normal of a floor and `up`.
    pub(crate) floor_cosine: T,
    pub(crate) snap: T,
    pub(crate) step_height: T,
    pub(crate) constant_speed: bool,
    pub(crate) one_way: u32,
}

impl<T: Scalar> SlideRules<T> {
    /// Refuses invalid values.
    pub fn check(&self) -> Result<CheckedRules<T>> {
        let Self { mask, max_slides, up, floor_angle, .. } = *self;
        if max_slides > MAX_SLIDES {
            let rule = format!("it must be at most {MAX_SLIDES}");
            return Err(Error::of("max_slides", max_slides, &rule));
        }
        if !(up[0].is_finite() && up[1].is_finite()) {
            let text = jostle_index::shapes::tuple(&up);
            return Err(Error::of("up", text, "both components must be finite"));
        }
        if !(0.0..=std::f64::consts::FRAC_PI_2).contains(&floor_angle) {
            let rule = "it must be between 0 and pi / 2 radians";
            return Err(Error::of("floor_angle", floor_angle, rule));
        }
        for (name, value) in [("snap", self.snap), ("step_height", self.step_height)] {
            if !(T::ZERO..=T::RADII[1]).contains(&value) {
                let rule = format!("it must be between 0 and {:e}", T::RADII[1].to_f64());
                return Err(Error::of(name, value, &rule));
            }
        }
        let largest = up[0].abs().max(up[1].abs());
        // Divided by the larger component first: the square of a direction such as (0, 1e200) would
        // be infinite.
        let up = if largest > T::ZERO {
            let [x, y] = up.map(|v| v / largest);
            let length = (x * x + y * y).sqrt();
            [x / length, y / length]
        } else {
            [T::ZERO; 2]
        };
        // Angles are compared by their cosines: one product for each hit, and no arc cosine, which
        // systems round in different ways.
        let floor_cosine = T::from_f64(cosine(floor_angle) - COSINE_TOLERANCE);
        let Self { snap, step_height, constant_speed, one_way, .. } = *self;
        Ok(CheckedRules {
            mask,
            max_slides,
            up,
            floor_cosine,
            snap,
            step_height,
            constant_speed,
            one_way,
        })
    }
}

impl<T: Scalar> CheckedRules<T> {
    /// The categories of the shapes that are obstacles.
    pub fn mask(&self) -> u32 {
        self.mask
    }

    /// How far from its path a shape may look for floors.
    pub fn reach(&self) -> T {
        self.snap + self.step_height + self.step_height
    }

    /// Whether there are floors, and rules for shapes that walk on them.
    pub(crate) fn is_walking(&self) -> bool {
        self.up != [T::ZERO; 2] && (self.reach() > T::ZERO || self.constant_speed)
    }

    /// A vector without its component along `up`.
    pub(crate) fn across(&self, v: [T; 2]) -> [T; 2] {
        let along = dot(v, self.up);
        [v[0] - self.up[0] * along, v[1] - self.up[1] * along]
    }

    /// A motion of this length along a floor, to the side to which `v` points.
    pub(crate) fn along_floor(&self, v: [T; 2], normal: [T; 2], length: T) -> [T; 2] {
        let tangent = [-normal[1], normal[0]];
        let side = dot(self.across(v), tangent);
        let length = if side > T::ZERO { length } else { -length };
        if side == T::ZERO { [T::ZERO; 2] } else { tangent.map(|v| v * length) }
    }

    /// The kind of a surface with this normal.
    pub fn kind(&self, normal: [T; 2]) -> Surface {
        let along = dot(normal, self.up);
        if self.up == [T::ZERO; 2] {
            Surface::Wall
        } else if along >= self.floor_cosine {
            Surface::Floor
        } else if along <= -self.floor_cosine {
            Surface::Ceiling
        } else {
            Surface::Wall
        }
    }
}

/// Slopes of exactly the largest angle are floors, whatever the rounding of their normals.
const COSINE_TOLERANCE: f64 = 1e-6;

/// The cosine of an angle between 0 and π/2, by its Taylor series: the same on every machine.
fn cosine(angle: f64) -> f64 {
    let square = angle * angle;
    let mut sum = 1.0;
    // Horner's scheme. The first term that is left out, (π/2)²²/22!, is below 2e-17: less than a
    // rounding.
    for k in (1..=10).rev() {
        let k = f64::from(k);
        sum = 1.0 - square / ((2.0 * k - 1.0) * (2.0 * k)) * sum;
    }
    sum
}

/// The kind of a surface, by the angle between its normal and `up`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// It faces up.
    Floor,
    /// It faces sideways, or there is no `up`.
    Wall,
    /// It faces down.
    Ceiling,
}

#[inline(always)]
pub(crate) fn dot<T: Scalar>(a: [T; 2], b: [T; 2]) -> T {
    a[0] * b[0] + a[1] * b[1]
}

/// The part of a motion `v` that remains when it meets a surface.
///
/// Floors: the downward component is lost, so that a shape does not slide down, and the rest
/// follows the slope. Walls: a shape does not gain height at a slope that is too steep.
pub(crate) fn along_surface<T: Scalar>(
    rules: &CheckedRules<T>,
    v: [T; 2],
    normal: [T; 2],
) -> [T; 2] {
    if dot(v, normal) >= T::ZERO {
        return v;
    }
    let without = |v: [T; 2], n: [T; 2]| {
        let into = dot(v, n).min(T::ZERO);
        [v[0] - n[0] * into, v[1] - n[1] * into]
    };
    match rules.kind(normal) {
        // First the part against `up`, then what points into the slope. In the other order the rest
        // of the fall would become motion down the slope: a shape that stands would creep.
        Surface::Floor => without(without(v, rules.up), normal),
        Surface::Ceiling => without(v, normal),
        Surface::Wall => {
            let slid = without(v, normal);
            let flat = dot(normal, rules.up);
            // Only a wall that leans back can lift a shape that walks into it. Then its slope is
            // ignored, as if it were upright: the component is removed along the horizontal part of
            // the normal.
            if flat <= T::ZERO || dot(slid, rules.up) <= dot(v, rules.up).max(T::ZERO) {
                return slid;
            }
            let [x, y] = [normal[0] - rules.up[0] * flat, normal[1] - rules.up[1] * flat];
            let length = (x * x + y * y).sqrt();
            if length > T::ZERO { without(v, [x / length, y / length]) } else { slid }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_is_the_cosine() {
        for k in 0..=100 {
            let angle = std::f64::consts::FRAC_PI_2 * f64::from(k) / 100.0;
            assert!((cosine(angle) - angle.cos()).abs() < 1e-14, "{angle}");
        }
    }

    fn rules() -> CheckedRules<f64> {
        SlideRules { up: [0.0, -2.0], ..SlideRules::default() }.check().unwrap()
    }

    #[test]
    fn a_floor_stops_what_falls_and_is_climbed() {
        assert_eq!(along_surface(&rules(), [3.0, 2.0], [0.0, -1.0]), [3.0, 0.0]);
        let slope = [-0.6, -0.8];
        let [x, y] = along_surface(&rules(), [1.0, 0.0], slope);
        assert!((x - 0.64).abs() < 1e-12 && (y + 0.48).abs() < 1e-12);
        assert_eq!(along_surface(&rules(), [0.0, 5.0], slope), [0.0, 0.0]);
    }

    #[test]
    fn a_steep_slope_is_not_climbed() {
        let [x, y] = along_surface(&rules(), [1.0, 0.0], [-0.8, -0.6]);
        assert!(x.abs() < 1e-12 && y.abs() < 1e-12);
        assert_eq!(rules().kind([-0.8, -0.6]), Surface::Wall);
        assert_eq!(rules().kind([0.0, 1.0]), Surface::Ceiling);
    }
}
