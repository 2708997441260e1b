//! pygame-ce's arithmetic with the same bits: a Rect uses C ints, an FRect C floats, except for
//! `centerx`, `centery`, `right` and `bottom` of an FRect, which are doubles.
//!
//! Functions return None if C would overflow or if a number is not finite; then only pygame can
//! compute the result.

/// The two types of rectangles of pygame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `pygame.Rect`.
    Int,
    /// `pygame.FRect`.
    Float,
}

/// x, y, width and height of a rectangle.
#[derive(Clone, Copy, Debug)]
pub enum Rect {
    Int([i32; 4]),
    Float([f32; 4]),
}

/// The sides of a rectangle, sorted, for sizes of either sign.
#[derive(Clone, Copy, Debug)]
pub struct Edges {
    pub min: [f64; 2],
    pub max: [f64; 2],
}

impl Edges {
    fn new([x, y]: [f64; 2], [right, bottom]: [f64; 2]) -> Self {
        Self { min: [x.min(right), y.min(bottom)], max: [x.max(right), y.max(bottom)] }
    }

    /// Whether two rectangles overlap. Touching is not overlapping.
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

/// The circle of a sprite, as pygame computes it.
#[derive(Clone, Copy, Debug)]
pub struct Circle {
    pub center: [f64; 2],
    /// May be negative, because pygame squares the sum of two.
    pub radius: f64,
    /// Whether Python's arithmetic with this radius is that of float64.
    pub exact: bool,
}

/// Differences of coordinates up to this fit into a C `int`.
const FARTHEST: f64 = 1e9;

/// A number converted to a C `int`.
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

    /// A rectangle of another size at the same position; None if the difference of two positions
    /// may not fit into a C `int`.
    pub fn resized(self, w: u16, h: u16) -> Option<Self> {
        let near = self.sides()[..2].iter().all(|side| side.abs() <= FARTHEST);
        near.then_some(match self {
            Self::Int([x, y, ..]) => Self::Int([x, y, w.into(), h.into()]),
            Self::Float([x, y, ..]) => Self::Float([x, y, w.into(), h.into()]),
        })
    }

    /// The rectangle converted by `Rect(rect)` or `FRect(rect)`.
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

    /// Its edges; the inner None is a rectangle without area, which collides with nothing.
    pub fn edges(&self) -> Option<Option<Edges>> {
        let [x, y, w, h] = self.sides();
        let end = match self {
            Self::Int([x, y, w, h]) => pair(x.checked_add(*w), y.checked_add(*h))?.map(f64::from),
            Self::Float([x, y, w, h]) => pair(finite(x + w), finite(y + h))?.map(f64::from),
        };
        Some((w != 0.0 && h != 0.0).then(|| Edges::new([x, y], end)))
    }

    /// The rectangle scaled as in `collide_rect_ratio`: by `inflate`, with sizes computed by
    /// Python.
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

    /// From the smaller of `left` and `right` to the larger one, and likewise along y. Unlike in
    /// [`Rect::edges`], `right` and `bottom` of an FRect are doubles.
    pub fn bounds(&self) -> Option<Edges> {
        let [x, y, w, h] = self.sides();
        let end = match self {
            Self::Int([x, y, w, h]) => pair(x.checked_add(*w), y.checked_add(*h))?.map(f64::from),
            Self::Float(_) => [x + w, y + h],
        };
        Some(Edges::new([x, y], end))
    }

    /// `colliderect`: both are compared in the type of the left rectangle.
    fn collides(&self, other: &Self) -> Option<bool> {
        let pair = (self.edges()?, other.as_kind(self.kind())?.edges()?);
        Some(matches!(pair, (Some(a), Some(b)) if a.overlap(&b)))
    }

    /// Whether two rectangles collide or are at most `distance` apart along each axis; the
    /// same as `Prefilter.__call__` of `jostle.sprites`.
    pub fn within(&self, other: &Self, distance: f64) -> Option<bool> {
        Some(self.bounds()?.gap(&other.bounds()?) <= distance || self.collides(other)?)
    }
}

/// Whether two circles collide; None if it depends on rounding.
///
/// pygame computes `distance_squared <= (radius + radius) ** 2` in Python, and a power may be
/// rounded differently from a product.
pub fn circles_collide(a: &Circle, b: &Circle) -> Option<bool> {
    let (dx, dy) = (a.center[0] - b.center[0], a.center[1] - b.center[1]);
    let distance = dx * dx + dy * dy;
    let limit = (a.radius + b.radius) * (a.radius + b.radius);
    let slack = 1e-12 * distance.max(limit);
    let clear = a.exact && b.exact && (distance - limit).abs() > slack && slack > 1e-250;
    clear.then_some(distance < limit)
}
