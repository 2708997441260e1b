//! The walls of a world as arrays.

use jostle_base::memory;
use jostle_index::Each;
use jostle_world::Wall;
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::prelude::*;

use crate::arrays::{Argument, column, read_only, reals, segments, table};
use crate::error::refused;

/// Walls with the coefficients of the particles, from an array of shape (m, 2, 2) or None.
pub fn read(value: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<Wall>> {
    let Some(value) = value else { return Ok(Vec::new()) };
    let ends = Argument::reals("walls", value)?.segments()?;
    memory::collect(ends.into_iter().map(Wall::new)).map_err(refused)
}

/// Sets the velocities: one vector for all walls or one for each; None is 0.
pub fn set_velocities(walls: &mut [Wall], value: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
    let given = value.map(|value| Argument::reals("wall_velocities", value)).transpose()?;
    let each = given.map_or(Ok(Each::One([0.0; 2])), |given| given.one_or_pairs(walls.len()))?;
    (0..).zip(walls).for_each(|(row, wall)| wall.velocity = each.at(row));
    Ok(())
}

/// Sets the coefficients of restitution: one number for all walls or one for each; None, or NaN for
/// one wall, is that of the particle.
pub fn set_restitution(walls: &mut [Wall], value: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
    let each = coefficients("wall_restitution", value, walls.len())?;
    (0..).zip(walls).for_each(|(row, wall)| wall.surface.restitution = each(row));
    Ok(())
}

/// As [`set_restitution`], for coefficients of friction.
pub fn set_friction(walls: &mut [Wall], value: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
    let each = coefficients("wall_friction", value, walls.len())?;
    (0..).zip(walls).for_each(|(row, wall)| wall.surface.friction = each(row));
    Ok(())
}

/// A coefficient for each of `len` surfaces. The core checks them.
pub fn coefficients(
    name: &'static str,
    value: Option<&Bound<'_, PyAny>>,
    len: usize,
) -> PyResult<impl Fn(usize) -> Option<f32> + use<>> {
    let each = reals::<f32>(name, value, len)?;
    Ok(move |row: usize| each.as_ref().map(|each| each.at(row)).filter(|v| !v.is_nan()))
}

/// The ends of walls, shape (m, 2, 2).
pub fn ends<'py>(py: Python<'py>, walls: &[Wall]) -> PyResult<Bound<'py, PyArray3<f32>>> {
    let ends: Vec<_> = walls.iter().map(|wall| wall.ends).collect();
    Ok(read_only(segments(py, &ends)?))
}

/// Their velocities.
pub fn velocities<'py>(py: Python<'py>, walls: &[Wall]) -> PyResult<Bound<'py, PyArray2<f32>>> {
    Ok(read_only(table(py, walls.iter().map(|wall| wall.velocity).collect())?))
}

/// Their coefficients of restitution; NaN for that of the particle.
pub fn restitution<'py>(py: Python<'py>, walls: &[Wall]) -> Bound<'py, PyArray1<f32>> {
    read_only(column(py, shown(walls, |wall| wall.surface.restitution)))
}

/// Their coefficients of friction; NaN for that of the particle.
pub fn friction<'py>(py: Python<'py>, walls: &[Wall]) -> Bound<'py, PyArray1<f32>> {
    read_only(column(py, shown(walls, |wall| wall.surface.friction)))
}

fn shown(walls: &[Wall], of: impl Fn(&Wall) -> Option<f32>) -> Vec<f32> {
    walls.iter().map(|wall| of(wall).unwrap_or(f32::NAN)).collect()
}
