//! pygame-ce's arithmetic, to the bit: C ints for a Rect, C floats for an FRect.
//!
//! Every number of either is exact as a float64. A function answers None where C would
//! overflow or meet what is no number: then only pygame can say what comes out.

/// Which of pygame's two rectangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `pygame.Rect`, of 32-bit integers.
    Int,
    /// `pygame.FRect`, of float32.
    Float,
}

/// x, y, width and height as they stand in a rectangle.
#[derive(Clone, Copy, Debug)]
pub struct Rect {
    pub kind: Kind,
    pub sides: [f64; 4],
}

/// The sides of a rectangle in order, whatever the signs of its sizes.
#[derive(Clone, Copy, Debug)]
pub struct Edges {
    pub min: [f64; 2],
    pub max: [f64; 2],
}

impl Edges {
    /// Touching is not overlapping.
    pub fn overlap(&self, other: &Self) -> bool {
        let along = |k: usize| self.min[k] < other.max[k] && self.max[k] > other.min[k];
        along(0) && along(1)
    }
}

/// A circle as pygame makes one of a sprite.
#[derive(Clone, Copy, Debug)]
pub struct Circle {
    pub center: [f64; 2],
    /// May be negative: pygame squares the sum of two.
    pub radius: f64,
    /// Whether Python computes with this radius as with a float64.
    pub exact: bool,
}

/// An `int` of C.
fn int(value: f64) -> Option<f64> {
    (value >= f64::from(i32::MIN) && value <= f64::from(i32::MAX)).then_some(value)
}

/// A `float` of C.
fn float(value: f64) -> Option<f64> {
    let value = value as f32;
    value.is_finite().then_some(f64::from(value))
}

impl Kind {
    /// A number that this kind of rectangle is given: cut off or rounded.
    fn take(self, value: f64) -> Option<f64> {
        match self {
            Self::Int => int(value.trunc()),
            Self::Float => float(value),
        }
    }

    /// A sum in its arithmetic. The sum of two float32 in float64, rounded to float32,
    /// is that of float32.
    fn add(self, a: f64, b: f64) -> Option<f64> {
        match self {
            Self::Int => int(a + b),
            Self::Float => float(a + b),
        }
    }

    /// Half of a number in its arithmetic.
    fn half(self, value: f64) -> f64 {
        match self {
            Self::Int => (value / 2.0).trunc(),
            Self::Float => f64::from(value as f32 / 2.0),
        }
    }
}

impl Rect {
    /// The rectangle as `Rect(this)` or `FRect(this)` would hold it.
    pub fn as_kind(&self, kind: Kind) -> Option<Self> {
        if kind == self.kind {
            return Some(*self);
        }
        let [x, y, w, h] = self.sides.map(|side| kind.take(side));
        Some(Self { kind, sides: [x?, y?, w?, h?] })
    }

    /// Its edges; the inner None stands for a rectangle without area, which meets nothing.
    pub fn edges(&self) -> Option<Option<Edges>> {
        let [x, y, w, h] = self.sides;
        let (right, bottom) = (self.kind.add(x, w)?, self.kind.add(y, h)?);
        let edges =
            Edges { min: [x.min(right), y.min(bottom)], max: [x.max(right), y.max(bottom)] };
        Some((w != 0.0 && h != 0.0).then_some(edges))
    }

    /// As `collide_rect_ratio` scales it: by `inflate`, with what Python computes.
    pub fn scaled(&self, ratio: f64) -> Option<Self> {
        let kind = self.kind;
        let [x, y, w, h] = self.sides;
        let (more_w, more_h) = (kind.take(w * ratio - w)?, kind.take(h * ratio - h)?);
        let sides = [
            kind.add(x, -kind.half(more_w))?,
            kind.add(y, -kind.half(more_h))?,
            kind.add(w, more_w)?,
            kind.add(h, more_h)?,
        ];
        Some(Self { kind, sides })
    }

    /// `centerx` and `centery`.
    pub fn center(&self) -> Option<[f64; 2]> {
        let [x, y, w, h] = self.sides;
        let kind = self.kind;
        Some([kind.add(x, kind.half(w))?, kind.add(y, kind.half(h))?])
    }
}

/// Whether two circles meet; None where rounding decides.
///
/// pygame asks Python for `distance_squared <= (radius + radius) ** 2`, and a power may be
/// rounded otherwise than a product.
pub fn circles_meet(a: &Circle, b: &Circle) -> Option<bool> {
    let (dx, dy) = (a.center[0] - b.center[0], a.center[1] - b.center[1]);
    let distance = dx * dx + dy * dy;
    let reach = (a.radius + b.radius) * (a.radius + b.radius);
    let slack = 1e-12 * distance.max(reach);
    let clear = a.exact && b.exact && (distance - reach).abs() > slack && slack > 1e-250;
    clear.then_some(distance < reach)
}
