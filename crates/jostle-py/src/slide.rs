//! The arguments and the result of `Space.move_and_slide`.

use jostle_index::Scalar;
use jostle_slide::DEFAULT_MAX_SLIDES;
use jostle_slide::SlideRules;
use jostle_space::Space;
use numpy::Element;
use pyo3::prelude::*;

use crate::arrays::{Argument, Given, count, number, single_mask, truth};
use crate::ids::Ids;
use crate::interrupt::detached;
use crate::lock::Shared;
use crate::queries::Maybe;
use crate::results;

/// The keywords of the call.
pub struct Rules<'py> {
    mask: u32,
    up: Option<Argument<'py>>,
    floor_angle: f64,
    snap: f64,
    step_height: f64,
    constant_speed: bool,
    one_way: u32,
    max_slides: usize,
}

/// The keywords as they were given.
pub struct Keywords<'a, 'py> {
    pub mask: Maybe<'a, 'py>,
    pub up: Given<'py>,
    pub floor_angle: Given<'py>,
    pub snap: Given<'py>,
    pub step_height: Given<'py>,
    pub constant_speed: Given<'py>,
    pub one_way: Given<'py>,
    pub max_slides: Given<'py>,
}

impl<'py> Rules<'py> {
    /// Reads the keywords.
    pub fn read(given: &Keywords<'_, 'py>) -> PyResult<Self> {
        let number = |name, given: &Given<'py>, default| {
            given.value().map_or(Ok(default), |value| number(name, value))
        };
        Ok(Self {
            mask: given.mask.map_or(Ok(u32::MAX), |mask| single_mask("mask", mask))?,
            up: given.up.value().map(|up| Argument::reals("up", up)).transpose()?,
            floor_angle: number("floor_angle", &given.floor_angle, std::f64::consts::FRAC_PI_4)?,
            snap: number("snap", &given.snap, 0.0)?,
            step_height: number("step_height", &given.step_height, 0.0)?,
            constant_speed: truth("constant_speed", &given.constant_speed)?,
            one_way: given.one_way.value().map_or(Ok(0), |value| single_mask("one_way", value))?,
            max_slides: given
                .max_slides
                .value()
                .map_or(Ok(DEFAULT_MAX_SLIDES), |value| count("max_slides", value, 1))?,
        })
    }

    fn typed<T: Scalar + Element>(&self) -> PyResult<SlideRules<T>> {
        let up = match &self.up {
            None => [T::ZERO, -T::ONE],
            Some(up) => up.only_pair("direction")?,
        };
        let Self { mask, floor_angle, constant_speed, one_way, max_slides, .. } = *self;
        let [snap, step_height] = [self.snap, self.step_height].map(T::from_f64);
        Ok(SlideRules {
            mask,
            max_slides,
            up,
            floor_angle,
            snap,
            step_height,
            constant_speed,
            one_way,
        })
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
