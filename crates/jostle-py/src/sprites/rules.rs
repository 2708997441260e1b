//! pygame-ce's arithmetic, to the bit: a Rect computes in C ints, an FRect in C floats,
//! except `centerx`, `centery`, `right` and `bottom` of an FRect, which are doubles.
//!
//! A function returns None where C would overflow or where a number is not finite: then
//! only pygame can compute the answer.

/// Which of pygame's two rectangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `pygame.Rect`.
    Int,
    /// `pygame.FRect`.
    Float,
}

/// x, y, width and height as they stand in a rectangle.
#[derive(Clone, Copy, Debug)]
pub enum Rect {
    Int([i32; 4]),
    Float([f32; 4]),
}

/// The sides of a rectangle in order, whatever the signs of its sizes.
#[derive(Clone, Copy, Debug)]
pub struct Edges {
    pub min: [f64; 2],
    pub max: [f64; 2],
}

impl Edges {
    fn new([x, y]: [f64; 2], [right, bottom]: [f64; 2]) -> Self {
        Self { min: [x.min(right), y.min(bottom)], max: [x.max(right), y.max(bottom)] }
    }

    /// Touching is not overlapping.
    pub fn overlap(&self, other: &Self) -> bool {
        let along = |k: usize| self.min[k] < other.max[k] && self.max[k] > other.min[k];
        along(0) && along(1)
    }

    /// The larger of the two gaps along x and along y; negative where both overlap.
    fn gap(&self, other: &Self) -> f64 {
        let along = |k: usize| (self.min[k] - other.max[k]).max(other.min[k] - self.max[k]);
        along(0).max(along(1))
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

/// Differences of places up to here fit into an `int` of C.
const FARTHEST: f64 = 1e9;

/// What C makes an `int` of.
fn int(value: f64) -> Option<i32> {
    let value = value.trunc();
    (value >= f64::from(i32::MIN) && value <= f64::from(i32::MAX)).then_some(value as i32)
}

fn finite(value: f32) -> Option<f32> {
    value.is_finite().then_some(value)
}

fn pair<V>(first: Option<V>, second: Option<V>) -> Option<[V; 2]> {
    Some([first?, second?])
}

impl Rect {
    pub fn kind(&self) -> Kind {
        match self {
            Self::Int(_) => Kind::Int,
            Self::Float(_) => Kind::Float,
        }
    }

    /// All four numbers, exactly.
    pub fn sides(&self) -> [f64; 4] {
        match self {
            Self::Int(sides) => sides.map(f64::from),
            Self::Float(sides) => sides.map(f64::from),
        }
    }

    /// A rectangle of another size in its place; None where the difference of two places
    /// might not fit into an `int` of C.
    pub fn resized(self, w: u16, h: u16) -> Option<Self> {
        let near = self.sides()[..2].iter().all(|side| side.abs() <= FARTHEST);
        near.then_some(match self {
            Self::Int([x, y, ..]) => Self::Int([x, y, w.into(), h.into()]),
            Self::Float([x, y, ..]) => Self::Float([x, y, w.into(), h.into()]),
        })
    }

    /// The rectangle as `Rect(this)` or `FRect(this)` would hold it.
    pub fn as_kind(&self, kind: Kind) -> Option<Self> {
        match (self, kind) {
            (Self::Float(sides), Kind::Int) => {
                let [x, y, w, h] = sides.map(|side| int(f64::from(side)));
                Some(Self::Int([x?, y?, w?, h?]))
            }
            (Self::Int(sides), Kind::Float) => Some(Self::Float(sides.map(|side| side as f32))),
            _ => Some(*self),
        }
    }

    /// Its edges; the inner None stands for a rectangle without area, which meets nothing.
    pub fn edges(&self) -> Option<Option<Edges>> {
        let [x, y, w, h] = self.sides();
        let end = match self {
            Self::Int([x, y, w, h]) => pair(x.checked_add(*w), y.checked_add(*h))?.map(f64::from),
            Self::Float([x, y, w, h]) => pair(finite(x + w), finite(y + h))?.map(f64::from),
        };
        Some((w != 0.0 && h != 0.0).then(|| Edges::new([x, y], end)))
    }

    /// As `collide_rect_ratio` scales it: by `inflate`, with what Python computes.
    pub fn scaled(&self, ratio: f64) -> Option<Self> {
        let more = |side: f64| side * ratio - side;
        match *self {
            Self::Int([x, y, w, h]) => {
                let [more_w, more_h] = pair(int(more(w.into())), int(more(h.into())))?;
                let [x, y] = pair(x.checked_sub(more_w / 2), y.checked_sub(more_h / 2))?;
                let [w, h] = pair(w.checked_add(more_w), h.checked_add(more_h))?;
                Some(Self::Int([x, y, w, h]))
            }
            Self::Float([x, y, w, h]) => {
                let (more_w, more_h) = (more(w.into()) as f32, more(h.into()) as f32);
                let sides = [x - more_w / 2.0, y - more_h / 2.0, w + more_w, h + more_h];
                sides.iter().all(|side| side.is_finite()).then_some(Self::Float(sides))
            }
        }
    }

    /// `centerx` and `centery`. Of an FRect, half the size is a float and the sum a double.
    pub fn center(&self) -> Option<[f64; 2]> {
        match *self {
            Self::Int([x, y, w, h]) => {
                Some(pair(x.checked_add(w / 2), y.checked_add(h / 2))?.map(f64::from))
            }
            Self::Float([x, y, w, h]) => {
                let sum = |start: f32, size: f32| f64::from(start) + f64::from(size / 2.0);
                Some([sum(x, w), sum(y, h)])
            }
        }
    }

    /// From the smaller of `left` and `right` to the larger, and likewise along y. Unlike
    /// [`Rect::edges`], the far edge of an FRect is a double.
    pub fn bounds(&self) -> Option<Edges> {
        let [x, y, w, h] = self.sides();
        let end = match self {
            Self::Int([x, y, w, h]) => pair(x.checked_add(*w), y.checked_add(*h))?.map(f64::from),
            Self::Float(_) => [x + w, y + h],
        };
        Some(Edges::new([x, y], end))
    }

    /// `colliderect`: the kind of the left rectangle decides how both are compared.
    fn collides(&self, other: &Self) -> Option<bool> {
        let pair = (self.edges()?, other.as_kind(self.kind())?.edges()?);
        Some(matches!(pair, (Some(a), Some(b)) if a.overlap(&b)))
    }

    /// Whether two rectangles collide or are at most `reach` apart along each axis; the
    /// same as `Prefilter.__call__` of `jostle.sprites`.
    pub fn within(&self, other: &Self, reach: f64) -> Option<bool> {
        Some(self.bounds()?.gap(&other.bounds()?) <= reach || self.collides(other)?)
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
