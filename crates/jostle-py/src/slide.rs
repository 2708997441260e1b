//! The arguments and the result of `Space.move_and_slide`.

use jostle_index::Scalar;
use jostle_slide::DEFAULT_MAX_SLIDES;
use jostle_slide::SlideRules;
use jostle_space::Space;
use numpy::Element;
use pyo3::prelude::*;

use crate::arrays::{Argument, Given, count, number, single_mask};
use crate::ids::Ids;
use crate::interrupt::detached;
use crate::lock::Shared;
use crate::queries::Maybe;
use crate::results;

/// The keywords of the call.
pub struct Rules<'py> {
    mask: u32,
    max_slides: usize,
    up: Option<Argument<'py>>,
    floor_angle: f64,
    one_way: u32,
}

impl<'py> Rules<'py> {
    /// Reads the keywords.
    pub fn read(
        mask: Maybe<'_, 'py>,
        max_slides: &Given<'py>,
        up: &Given<'py>,
        floor_angle: &Given<'py>,
        one_way: &Given<'py>,
    ) -> PyResult<Self> {
        Ok(Self {
            mask: mask.map_or(Ok(u32::MAX), |mask| single_mask("mask", mask))?,
            max_slides: max_slides
                .value()
                .map_or(Ok(DEFAULT_MAX_SLIDES), |value| count("max_slides", value, 1))?,
            up: up.value().map(|up| Argument::reals("up", up)).transpose()?,
            floor_angle: floor_angle
                .value()
                .map_or(Ok(std::f64::consts::FRAC_PI_4), |value| number("floor_angle", value))?,
            one_way: one_way.value().map_or(Ok(0), |value| single_mask("one_way", value))?,
        })
    }

    fn typed<T: Scalar + Element>(&self) -> PyResult<SlideRules<T>> {
        let up = match &self.up {
            None => [T::ZERO, -T::ONE],
            Some(up) => up.only_pair("direction")?,
        };
        let Self { mask, max_slides, floor_angle, one_way, .. } = *self;
        Ok(SlideRules { mask, max_slides, up, floor_angle, one_way })
    }

    /// Moves the shapes of a space.
    pub fn run<T: Scalar + Element>(
        &self,
        py: Python<'py>,
        space: &Shared<Space<T>>,
        ids: &Bound<'py, PyAny>,
        displacements: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let ids = Ids::read(ids, "shape")?;
        let given = Argument::reals("displacements", displacements)?;
        let displacements =
            if ids.single { vec![given.only_pair("id")?] } else { given.pairs(ids.all.len())? };
        let rules = self.typed()?;
        let slides = detached(py, || {
            PyResult::Ok(space.lock()?.move_and_slide(&ids.all, &displacements, &rules))
        })??;
        let slides = ids.result_of(slides)?;
        if ids.single { results::slide(py, slides) } else { results::slides(py, slides) }
    }
}
