//! The implementation of `jostle.pygame`: which sprites of two lists collide by the rules of
//! pygame-ce.
//!
//! `read` reads rectangles and radii from sprites, `rules` repeats pygame's arithmetic on them, and
//! `search` finds the colliding pairs. This module does not import pygame: its two types of
//! rectangles are arguments.

mod read;
mod rules;
mod search;

use numpy::{PyArray1, PyArray2, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::{PyException, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyType};

use crate::arrays::{column, table};
use crate::error::{refused, value_error};
use crate::interrupt::detached;
use read::Reader;
use search::Found;

/// Sorted pairs (m, 2), and which of them are certain; None if all are.
type Answer<'py> = (Bound<'py, PyArray2<u32>>, Option<Bound<'py, PyArray1<bool>>>);

/// Find which sprites collide.
///
/// Parameters
/// ----------
/// left, right : list
///     Sprites. With None for `right`, the pairs i < j within `left`.
/// rule : {"rect", "rects", "circle", "mask", "within"}
///     "rect" is `collide_rect` and its ratio, "circle" `collide_circle` and its ratio;
///     "rects" is "rect" for lists of rectangles instead of sprites. "mask" and "within" give
///     candidate pairs, none of them certain: "mask" masks that may overlap, "within" rectangles
///     that collide or are at most `scale` apart along each axis.
/// scale : float
///     Factor for rectangles or radii, 1.0 for their own size; for "within" the largest gap.
/// types : tuple of type
///     `pygame.Rect` and `pygame.FRect`.
/// radius_of : callable, optional
///     Called for the radius of a sprite that has none.
///
/// Returns
/// -------
/// tuple of ndarray of uint32, shape (m, 2), and ndarray of bool, shape (m,), or None
///     Rows of `left` and of `right`, sorted, and whether each pair is certain, or None if
///     all are. None alone if only pygame can decide.
#[pyfunction]
#[pyo3(signature = (left, right, rule, scale, types, radius_of=None))]
pub fn sprite_pairs<'py>(
    py: Python<'py>,
    left: &Bound<'py, PyList>,
    right: Option<&Bound<'py, PyList>>,
    rule: &str,
    scale: f64,
    types: (Bound<'py, PyType>, Bound<'py, PyType>),
    radius_of: Option<&Bound<'py, PyAny>>,
) -> PyResult<Option<Answer<'py>>> {
    let mut reader = Reader::new(types, scale, radius_of);
    let found = match rule {
        "rect" | "rects" => {
            let read = if rule == "rect" { Reader::rect } else { Reader::rectangle };
            let sides = reader.both(left, right, read);
            let Some((a, b)) = unless_an_exception(py, sides)? else { return Ok(None) };
            detached(py, || search::rects(&a, b.as_deref(), scale))?
        }
        "circle" => {
            let sides = reader.both(left, right, Reader::circle);
            let Some((a, b)) = unless_an_exception(py, sides)? else { return Ok(None) };
            detached(py, || search::circles(&a, b.as_deref()))?
        }
        "mask" => {
            let sides = reader.both(left, right, Reader::mask);
            let Some((a, b)) = unless_an_exception(py, sides)? else { return Ok(None) };
            detached(py, || search::masks(&a, b.as_deref()))?
        }
        "within" => {
            let sides = reader.both(left, right, Reader::rect);
            let Some((a, b)) = unless_an_exception(py, sides)? else { return Ok(None) };
            detached(py, || search::within(&a, b.as_deref(), scale))?
        }
        other => {
            let rules = "'rect', 'rects', 'circle', 'mask' or 'within'";
            return Err(value_error("rule", other, rules));
        }
    };
    match found {
        // pygame decides about sizes and positions out of the range of the core.
        Ok(None) | Err(jostle_base::Error::Value { .. }) => Ok(None),
        Ok(Some(Found { pairs, sure })) => {
            Ok(Some((table(py, pairs)?, sure.map(|sure| column(py, sure)))))
        }
        Err(error) => Err(refused(error)),
    }
}

/// The result of reading sprites; None if an attribute of a sprite raised an Exception, which
/// pygame's own function then raises again. Other exceptions (KeyboardInterrupt, SystemExit) are
/// returned.
fn unless_an_exception<R>(py: Python<'_>, read: PyResult<Option<R>>) -> PyResult<Option<R>> {
    match read {
        Err(error) if error.is_instance_of::<PyException>(py) => Ok(None),
        other => other,
    }
}

/// Read the rects of sprites.
///
/// Parameters
/// ----------
/// sprites : list
///     Sprites.
/// types : tuple of type
///     `pygame.Rect` and `pygame.FRect`.
///
/// Returns
/// -------
/// ndarray of float64, shape (n, 4)
///     x, y, width and height; None if a rect is of another type.
#[pyfunction]
pub fn sprite_sides<'py>(
    py: Python<'py>,
    sprites: &Bound<'py, PyList>,
    types: (Bound<'py, PyType>, Bound<'py, PyType>),
) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
    let rects = Reader::new(types, 1.0, None).both(sprites, None, Reader::rect);
    let Some((rects, _)) = unless_an_exception(py, rects)? else { return Ok(None) };
    table(py, rects.iter().map(rules::Rect::sides).collect()).map(Some)
}

/// Group the second rows of sorted pairs by their first rows.
///
/// Parameters
/// ----------
/// pairs : ndarray of uint32, shape (m, 2)
///     Sorted by first.
/// keys, values : list
///     The objects of the first and of the second rows.
///
/// Returns
/// -------
/// dict of key to list of value
///     The result of `groupcollide` for these pairs.
#[pyfunction]
pub fn sprite_dict<'py>(
    py: Python<'py>,
    pairs: PyReadonlyArray2<'py, u32>,
    keys: &Bound<'py, PyList>,
    values: &Bound<'py, PyList>,
) -> PyResult<Bound<'py, PyDict>> {
    if pairs.shape()[1] != 2 {
        return Err(PyValueError::new_err("pairs must have two columns"));
    }
    let rows: Vec<[u32; 2]> = pairs.as_array().rows().into_iter().map(|r| [r[0], r[1]]).collect();
    let found = PyDict::new(py);
    for run in rows.chunk_by(|a, b| a[0] == b[0]) {
        py.check_signals()?;
        let hits = run.iter().map(|row| values.get_item(row[1] as usize));
        let hits = PyList::new(py, hits.collect::<PyResult<Vec<_>>>()?)?;
        found.set_item(keys.get_item(run[0][0] as usize)?, hits)?;
    }
    Ok(found)
}
