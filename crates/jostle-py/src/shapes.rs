//! Shapes as arguments: centres, boxes or segments, radii, half sizes and filters, copied in one precision.

use jostle_index::shapes::{DEFAULT_CATEGORY, DEFAULT_MASK};
use jostle_index::{Each, Scalar};
use numpy::Element;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::arrays::{Argument, Given, all_single};
use crate::queries::{Maybe, SIDES_OF_RECT, sides};

/// Shapes in the precision of their arrays.
pub enum Shapes {
    /// All arrays are float32.
    Single(Rows<f32>),
    /// Otherwise.
    Double(Rows<f64>),
}

/// Copied arrays with checked shapes; the values are not checked yet.
pub struct Rows<T> {
    positions: Positions<T>,
    radii: Each<T>,
    half_sizes: Option<Each<[T; 2]>>,
    filters: Option<[Each<u32>; 2]>,
}

/// The positions of shapes, one row each.
pub enum Positions<T> {
    /// Their centres.
    Centers(Vec<[T; 2]>),
    /// min x, min y, max x, max y.
    Boxes(Vec<[T; 4]>),
    /// Start and end.
    Segments(Vec<[[T; 2]; 2]>),
}

/// The argument with the positions of shapes: centres, boxes or segments.
pub enum Where<'py> {
    Centers(Argument<'py>),
    Boxes(Argument<'py>),
    Segments(Argument<'py>),
}

impl<'py> Where<'py> {
    /// Reads the given argument. Refuses several and none.
    pub fn read([positions, half_sizes, boxes, segments]: [Maybe<'_, 'py>; 4]) -> PyResult<Self> {
        let (names, given) = (["positions", "boxes", "segments"], [positions, boxes, segments]);
        let mut all = names.into_iter().zip(given).filter_map(|(name, value)| value.map(|_| name));
        let (first, second) = (all.next(), all.next());
        let message = match (first, second) {
            (None, _) => {
                "positions, boxes or segments must be given: positions of shape (n, 2), boxes of shape \
                 (n, 4), which are min_x, min_y, max_x, max_y, or segments of shape (n, 2, 2)"
                    .to_string()
            }
            (Some(first), Some(second)) => format!(
                "{first} and {second} are both given; {second} take the place of {first}, so leave out \
                 {first}"
            ),
            (Some(first), None) if half_sizes.is_some() && positions.is_none() => format!(
                "half_sizes and {first} are both given; {first} take the place of half_sizes, so leave \
                 out half_sizes"
            ),
            _ => String::new(),
        };
        if !message.is_empty() {
            return Err(PyTypeError::new_err(message));
        }
        if let Some(boxes) = boxes {
            let sides = sides(boxes, &[SIDES_OF_RECT])?;
            let boxes = Argument::reals("boxes", sides.as_ref().unwrap_or(boxes))?;
            return Ok(Self::Boxes(boxes));
        }
        if let Some(segments) = segments {
            return Ok(Self::Segments(Argument::reals("segments", segments)?));
        }
        Self::centers(positions.expect("one of the three is given"))
    }

    fn centers(value: &Bound<'py, PyAny>) -> PyResult<Self> {
        let centers = Argument::reals("positions", value)?;
        if centers.is_like_boxes() {
            let expected = "(n, 2); rectangles are given as boxes=, with min_x, min_y, max_x, \
                            max_y of each, or as pygame's Rects";
            return Err(centers.wrong_shape(expected));
        }
        Ok(Self::Centers(centers))
    }

    fn argument(&self) -> &Argument<'py> {
        match self {
            Self::Centers(argument) | Self::Boxes(argument) | Self::Segments(argument) => argument,
        }
    }

    fn len(&self) -> PyResult<usize> {
        match self {
            Self::Centers(centers) => centers.pairs_len(),
            Self::Boxes(boxes) => boxes.boxes_len(),
            Self::Segments(segments) => segments.segments_len(),
        }
    }

    /// `len` of them.
    pub fn rows<T: Scalar + Element>(&self, len: usize) -> PyResult<Positions<T>> {
        Ok(match self {
            Self::Centers(centers) => Positions::Centers(centers.pairs(len)?),
            Self::Boxes(boxes) => Positions::Boxes(boxes.boxes(len)?),
            Self::Segments(segments) => Positions::Segments(segments.segments_of(len)?),
        })
    }

    /// One position without a number, or many with their number.
    pub fn one_or_rows<T: Scalar + Element>(&self) -> PyResult<(Positions<T>, Option<usize>)> {
        fn with_len<V: Copy>(each: Each<V>) -> (Vec<V>, Option<usize>) {
            let len = each.len();
            (each.rows(1), len)
        }
        Ok(match self {
            Self::Centers(centers) => {
                let (centers, len) = with_len(centers.one_or_rows()?);
                (Positions::Centers(centers), len)
            }
            Self::Boxes(boxes) => {
                let (boxes, len) = with_len(boxes.one_or_rows()?);
                (Positions::Boxes(boxes), len)
            }
            Self::Segments(segments) => {
                let (segments, len) = with_len(segments.one_or_segments()?);
                (Positions::Segments(segments), len)
            }
        })
    }

    /// As [`Self::rows`], for a single shape.
    pub fn only<T: Scalar + Element>(&self) -> PyResult<Positions<T>> {
        match self.one_or_rows()? {
            (one, None) => Ok(one),
            (Positions::Centers(_), _) => {
                Err(self.argument().wrong_shape("(2,), as there is one id"))
            }
            (Positions::Boxes(_), _) => {
                Err(self.argument().wrong_shape("(4,), as there is one id"))
            }
            (Positions::Segments(_), _) => {
                Err(self.argument().wrong_shape("(2, 2), as there is one id"))
            }
        }
    }
}

impl<T: Scalar> Positions<T> {
    /// The shapes of the core, with checked values; without the GIL.
    pub fn shapes(
        self,
        radii: Each<T>,
        half_sizes: Option<Each<[T; 2]>>,
        filters: Option<[Each<u32>; 2]>,
    ) -> jostle_base::Result<jostle_index::Shapes<T>> {
        match self {
            Self::Centers(centers) => {
                jostle_index::Shapes::new(centers, radii, half_sizes, filters)
            }
            Self::Boxes(boxes) => jostle_index::Shapes::from_boxes(boxes, radii, filters),
            Self::Segments(all) => jostle_index::Shapes::from_segments(&all, radii, filters),
        }
    }
}

impl Shapes {
    /// Copies the arguments that `find_pairs` and `Quadtree` share.
    pub fn read<'py>(
        [positions, half_sizes, boxes, segments]: [Maybe<'_, 'py>; 4],
        radii: &Given<'py>,
        [categories, masks]: [Maybe<'_, 'py>; 2],
    ) -> PyResult<Self> {
        let positions = Where::read([positions, half_sizes, boxes, segments])?;
        let radii = radii.value().map(|value| Argument::reals("radii", value)).transpose()?;
        let half_sizes =
            half_sizes.map(|value| Argument::reals("half_sizes", value)).transpose()?;
        // A plain pair of half sizes for all shapes does not determine the precision.
        let sizes = half_sizes.as_ref().filter(|sizes| !sizes.is_plain_pair());
        let single = all_single(&[Some(positions.argument()), radii.as_ref(), sizes]);
        let filters = read_filters(categories, masks, positions.len()?)?;
        Ok(if single {
            Self::Single(Rows::read(&positions, radii.as_ref(), half_sizes.as_ref(), filters)?)
        } else {
            Self::Double(Rows::read(&positions, radii.as_ref(), half_sizes.as_ref(), filters)?)
        })
    }
}

fn read_filters(
    categories: Option<&Bound<'_, PyAny>>,
    masks: Option<&Bound<'_, PyAny>>,
    len: usize,
) -> PyResult<Option<[Each<u32>; 2]>> {
    if categories.is_none() && masks.is_none() {
        return Ok(None);
    }
    let read = |name, value: Option<&Bound<'_, PyAny>>, default| match value {
        None => Ok(Each::One(default)),
        Some(value) => Argument::integers(name, value)?.bits_each(len),
    };
    Ok(Some([
        read("categories", categories, DEFAULT_CATEGORY)?,
        read("masks", masks, DEFAULT_MASK)?,
    ]))
}

impl<T: Scalar + Element> Rows<T> {
    fn read(
        positions: &Where<'_>,
        radii: Option<&Argument<'_>>,
        half_sizes: Option<&Argument<'_>>,
        filters: Option<[Each<u32>; 2]>,
    ) -> PyResult<Self> {
        let len = positions.len()?;
        Ok(Self {
            positions: positions.rows(len)?,
            radii: match radii {
                None => Each::One(T::ZERO),
                Some(radii) => radii.real_each(len)?,
            },
            half_sizes: half_sizes.map(|sizes| sizes.half_sizes(len)).transpose()?,
            filters,
        })
    }

    /// Number of shapes.
    pub fn len(&self) -> usize {
        match &self.positions {
            Positions::Centers(centers) => centers.len(),
            Positions::Boxes(boxes) => boxes.len(),
            Positions::Segments(segments) => segments.len(),
        }
    }

    /// The shapes of the core, with checked values; without the GIL.
    pub fn checked(self) -> jostle_base::Result<jostle_index::Shapes<T>> {
        self.positions.shapes(self.radii, self.half_sizes, self.filters)
    }
}
