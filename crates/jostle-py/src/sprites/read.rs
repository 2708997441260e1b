//! Reading of rectangles, radii and mask sizes from sprites; each attribute is read once.

use pyo3::exceptions::PyAttributeError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyInt, PyList, PyString, PyType};

use super::rules::{Circle, Kind, Rect};

/// Attributes that a subclass of a rectangle must not override, so that its numbers determine its
/// collisions.
const UNCHANGED: [&str; 18] = [
    "__getattribute__",
    "__getitem__",
    "__len__",
    "bottom",
    "centerx",
    "centery",
    "collidelistall",
    "colliderect",
    "h",
    "height",
    "inflate",
    "left",
    "right",
    "top",
    "w",
    "width",
    "x",
    "y",
];

/// Integers up to this, and their sums, are exact as float64.
const EXACT_INTEGER: f64 = 1e15;

/// Maximum radius, so that squares do not overflow.
const LARGEST_RADIUS: f64 = 1e100;

/// A type of rectangles, and its kind; None if it is neither.
type Known<'py> = (Bound<'py, PyType>, Option<Kind>);

/// Both groups of a query; None for the second if they are the same.
type Sides<V> = (Vec<V>, Option<Vec<V>>);

/// Reads sprites. Every method returns None for objects that only pygame can compare.
pub struct Reader<'a, 'py> {
    rect: Bound<'py, PyType>,
    frect: Bound<'py, PyType>,
    ratio: f64,
    radius_of: Option<&'a Bound<'py, PyAny>>,
    subclasses: Vec<Known<'py>>,
}

impl<'a, 'py> Reader<'a, 'py> {
    pub fn new(
        (rect, frect): (Bound<'py, PyType>, Bound<'py, PyType>),
        ratio: f64,
        radius_of: Option<&'a Bound<'py, PyAny>>,
    ) -> Self {
        Self { rect, frect, ratio, radius_of, subclasses: Vec::new() }
    }

    /// Reads both lists, or one list if both are the same.
    pub fn both<V>(
        &mut self,
        left: &Bound<'py, PyList>,
        right: Option<&Bound<'py, PyList>>,
        read: fn(&mut Self, &Bound<'py, PyAny>) -> PyResult<Option<V>>,
    ) -> PyResult<Option<Sides<V>>> {
        let mut all = |sprites: &Bound<'py, PyList>| -> PyResult<Option<Vec<V>>> {
            let mut all = Vec::with_capacity(sprites.len());
            for sprite in sprites {
                let Some(one) = read(self, &sprite)? else { return Ok(None) };
                all.push(one);
            }
            Ok(Some(all))
        };
        let Some(a) = all(left)? else { return Ok(None) };
        let Some(right) = right else { return Ok(Some((a, None))) };
        Ok(all(right)?.map(|b| (a, Some(b))))
    }

    /// `sprite.rect`.
    pub fn rect(&mut self, sprite: &Bound<'py, PyAny>) -> PyResult<Option<Rect>> {
        let py = sprite.py();
        self.rectangle(&sprite.getattr(intern!(py, "rect"))?)
    }

    /// A rectangle.
    pub fn rectangle(&mut self, rect: &Bound<'py, PyAny>) -> PyResult<Option<Rect>> {
        let py = rect.py();
        let Some(kind) = self.kind(rect)? else { return Ok(None) };
        let names = [intern!(py, "x"), intern!(py, "y"), intern!(py, "w"), intern!(py, "h")];
        Ok(match kind {
            Kind::Int => Some(Rect::Int(sides(rect, names)?)),
            Kind::Float => {
                let sides: [f32; 4] = sides(rect, names)?;
                sides.iter().all(|side| side.is_finite()).then_some(Rect::Float(sides))
            }
        })
    }

    /// Centre of `sprite.rect`, and `sprite.radius`.
    pub fn circle(&mut self, sprite: &Bound<'py, PyAny>) -> PyResult<Option<Circle>> {
        let Some(rect) = self.rect(sprite)? else { return Ok(None) };
        let Some(center) = rect.center() else { return Ok(None) };
        let given = match (sprite.getattr(intern!(sprite.py(), "radius")), self.radius_of) {
            (Err(error), Some(radius_of))
                if error.is_instance_of::<PyAttributeError>(sprite.py()) =>
            {
                radius_of.call1((sprite,))?
            }
            (given, _) => given?,
        };
        let radius = given.extract::<f64>()? * self.ratio;
        let exact = given.is_exact_instance_of::<PyFloat>()
            || (given.is_exact_instance_of::<PyInt>() && radius.abs() < EXACT_INTEGER);
        Ok((radius.abs() <= LARGEST_RADIUS).then_some(Circle { center, radius, exact }))
    }

    /// A rectangle at `sprite.rect` with the size of `sprite.mask`, or of the image from which
    /// pygame makes a mask.
    pub fn mask(&mut self, sprite: &Bound<'py, PyAny>) -> PyResult<Option<Rect>> {
        let py = sprite.py();
        let Some(rect) = self.rect(sprite)? else { return Ok(None) };
        let mask = match sprite.getattr(intern!(py, "mask")) {
            Err(error) if error.is_instance_of::<PyAttributeError>(py) => {
                sprite.getattr(intern!(py, "image"))?
            }
            mask => mask?,
        };
        let (w, h) = mask.call_method0(intern!(py, "get_size"))?.extract::<(u16, u16)>()?;
        Ok(rect.resized(w, h))
    }

    /// The kind of a rectangle.
    fn kind(&mut self, rect: &Bound<'py, PyAny>) -> PyResult<Option<Kind>> {
        let own = rect.get_type_ptr();
        if own == self.rect.as_type_ptr() {
            return Ok(Some(Kind::Int));
        }
        if own == self.frect.as_type_ptr() {
            return Ok(Some(Kind::Float));
        }
        if hides_a_method(rect)? {
            return Ok(None);
        }
        if let Some((_, kind)) =
            self.subclasses.iter().find(|(known, _)| known.as_type_ptr() == own)
        {
            return Ok(*kind);
        }
        let kind = self.kind_of_subclass(&rect.get_type())?;
        self.subclasses.push((rect.get_type(), kind));
        Ok(kind)
    }

    /// A subclass has the kind of its base if it does not override [`UNCHANGED`].
    fn kind_of_subclass(&self, own: &Bound<'py, PyType>) -> PyResult<Option<Kind>> {
        for (base, kind) in [(&self.rect, Kind::Int), (&self.frect, Kind::Float)] {
            if !own.is_subclass(base)? {
                continue;
            }
            for name in UNCHANGED {
                if !own.getattr(name)?.is(&base.getattr(name)?) {
                    return Ok(None);
                }
            }
            return Ok(Some(kind));
        }
        Ok(None)
    }
}

/// Whether an attribute of the instance hides a method of its class.
fn hides_a_method(rect: &Bound<'_, PyAny>) -> PyResult<bool> {
    let Some(own) = rect.getattr_opt(intern!(rect.py(), "__dict__"))? else { return Ok(false) };
    Ok(own.contains("colliderect")? || own.contains("inflate")?)
}

/// Four numbers of a rectangle.
fn sides<'py, V>(rect: &Bound<'py, PyAny>, names: [&Bound<'py, PyString>; 4]) -> PyResult<[V; 4]>
where
    V: for<'a> FromPyObject<'a, 'py, Error = PyErr> + Copy + Default,
{
    let mut sides = [V::default(); 4];
    for (side, name) in sides.iter_mut().zip(names) {
        *side = rect.getattr(name)?.extract()?;
    }
    Ok(sides)
}
