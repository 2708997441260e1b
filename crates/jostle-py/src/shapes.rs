//! The shapes of a call: centres, radii, half sizes and filters, copied out of
//! NumPy with one precision for all of them.

use jostle::shapes::{DEFAULT_CATEGORY, DEFAULT_MASK};
use jostle::{Each, Scalar};
use numpy::Element;
use pyo3::prelude::*;

use crate::arrays::{Argument, Given, all_single};

/// Shapes in the precision that their arrays ask for.
pub enum Shapes {
    /// Every array was float32.
    Single(Rows<f32>),
    /// Anything else.
    Double(Rows<f64>),
}

/// Copied and of the right shapes; the values are not yet checked.
pub struct Rows<T> {
    centers: Vec<[T; 2]>,
    radii: Each<T>,
    half_sizes: Option<Each<[T; 2]>>,
    filters: Option<[Each<u32>; 2]>,
}

impl Shapes {
    /// Copies the arguments that `find_pairs` and `Quadtree` share.
    pub fn read<'py>(
        centers: &Bound<'py, PyAny>,
        radii: &Given<'py>,
        half_sizes: Option<&Bound<'py, PyAny>>,
        categories: Option<&Bound<'py, PyAny>>,
        masks: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Self> {
        let centers = Argument::reals("centers", centers)?;
        let radii = radii.value().map(|value| Argument::reals("radii", value)).transpose()?;
        let half_sizes =
            half_sizes.map(|value| Argument::reals("half_sizes", value)).transpose()?;
        // A plain pair of half sizes for all shapes follows the arrays beside it.
        let sizes = half_sizes.as_ref().filter(|sizes| !sizes.is_plain_pair());
        let single = all_single(&[Some(&centers), radii.as_ref(), sizes]);
        let filters = read_filters(categories, masks, centers.pairs_len()?)?;
        Ok(if single {
            Self::Single(Rows::read(&centers, radii.as_ref(), half_sizes.as_ref(), filters)?)
        } else {
            Self::Double(Rows::read(&centers, radii.as_ref(), half_sizes.as_ref(), filters)?)
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
        centers: &Argument<'_>,
        radii: Option<&Argument<'_>>,
        half_sizes: Option<&Argument<'_>>,
        filters: Option<[Each<u32>; 2]>,
    ) -> PyResult<Self> {
        let len = centers.pairs_len()?;
        Ok(Self {
            centers: centers.pairs(len)?,
            radii: match radii {
                None => Each::One(T::ZERO),
                Some(radii) => radii.real_each(len)?,
            },
            half_sizes: half_sizes.map(|sizes| sizes.half_sizes(len)).transpose()?,
            filters,
        })
    }

    /// The core's shapes; needs no Python.
    pub fn checked(self) -> jostle::Result<jostle::Shapes<T>> {
        jostle::Shapes::new(self.centers, self.radii, self.half_sizes, self.filters)
    }
}
