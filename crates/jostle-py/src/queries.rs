//! Questions on their way to the core, and answers on their way back: for whatever
//! can be asked, one question or many at once.

use jostle::query::{Circle, Hits, Neighbors, Point, Polygon, Ray, RayHits, Rect};
use jostle::{Each, Error, Scalar};
use numpy::Element;
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};

use crate::arrays::{Argument, Given, column, count, number};
use crate::error::refused;
use crate::interrupt::detached;
use crate::results;

/// An argument of a question.
pub type Asked<'a, 'py> = &'a Bound<'py, PyAny>;

/// An argument that may be left out or None.
pub type Maybe<'a, 'py> = Option<Asked<'a, 'py>>;

/// What a search finds, or why it refuses; Python's error where it could not begin.
pub type Answer<R> = PyResult<jostle::Result<R>>;

/// The categories that a question is about; None stands for all, and for what has none.
pub fn mask(value: Maybe<'_, '_>) -> PyResult<Option<u32>> {
    let Some(value) = value else { return Ok(None) };
    let mask = Argument::integers("mask", value)?;
    match mask.bits_each(1)? {
        Each::One(mask) => Ok(Some(mask)),
        Each::Rows(_) => Err(mask.wrong_shape("an integer")),
    }
}

/// How far to look.
fn reach<T: Scalar>(max_distance: &Given<'_>) -> PyResult<T> {
    let read = |value| number("max_distance", value);
    Ok(T::from_f64(max_distance.value().map_or(Ok(f64::INFINITY), read)?))
}

/// An error about the only question, or shape, names no row.
pub fn without_row(error: Error) -> Error {
    match error {
        Error::Value { argument, index: Some(_), value, rule } => Error::of(argument, value, &rule),
        other => other,
    }
}

/// Makes questions of rows, asks them, and gives the ids back.
fn region<'py, V: Clone + Sync, R: Send, I: Send + Into<i64>>(
    py: Python<'py>,
    asked: &Each<V>,
    regions: impl FnOnce(&[V]) -> jostle::Result<Vec<R>> + Send,
    ask: impl FnOnce(&[R]) -> Answer<Hits<I>> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    let answer = |rows: &[V]| -> Answer<Hits<i64>> {
        match regions(rows) {
            Ok(regions) => Ok(ask(&regions)?.and_then(results::counted_by_numpy)),
            Err(error) => Ok(Err(error)),
        }
    };
    match asked {
        Each::One(one) => {
            let one = std::slice::from_ref(one);
            let hits = detached(py, || answer(one))??.map_err(without_row).map_err(refused)?;
            Ok(column(py, hits.ids).into_any())
        }
        Each::Rows(rows) => results::hits(py, detached(py, || answer(rows))??.map_err(refused)?),
    }
}

/// `query_rect`.
pub fn rect<'py, T: Scalar + Element, I: Send + Into<i64>>(
    py: Python<'py>,
    rect: &Bound<'py, PyAny>,
    ask: impl FnOnce(&[Rect<T>]) -> Answer<Hits<I>> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    let sides = sides(rect)?;
    let asked: Each<[T; 4]> =
        Argument::reals("rect", sides.as_ref().unwrap_or(rect))?.one_or_rows()?;
    region(py, &asked, Rect::all, ask)
}

/// The sides of a rectangle that knows them, or of a list of such: one like pygame's would be
/// read as x, y, width and height.
fn sides<'py>(rect: &Bound<'py, PyAny>) -> PyResult<Option<Bound<'py, PyAny>>> {
    let names = ["left", "top", "right", "bottom"];
    if rect.hasattr(names[3])? {
        let sides = names.map(|name| rect.getattr(name));
        let sides = sides.into_iter().collect::<PyResult<Vec<_>>>()?;
        return Ok(Some(PyTuple::new(rect.py(), sides)?.into_any()));
    }
    let list = rect.cast::<PyList>().ok().filter(|list| !list.is_empty());
    let Some(list) = list else { return Ok(None) };
    if !list.get_item(0)?.hasattr(names[3])? {
        return Ok(None);
    }
    let all = list.iter().map(|rect| Ok(sides(&rect)?.unwrap_or(rect)));
    Ok(Some(PyList::new(list.py(), all.collect::<PyResult<Vec<_>>>()?)?.into_any()))
}

/// `query_point`.
pub fn point<'py, T: Scalar + Element, I: Send + Into<i64>>(
    py: Python<'py>,
    point: &Bound<'py, PyAny>,
    ask: impl FnOnce(&[Point<T>]) -> Answer<Hits<I>> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    let asked: Each<[T; 2]> = Argument::reals("point", point)?.one_or_rows()?;
    region(py, &asked, Point::all, ask)
}

/// `query_circle`.
pub fn circle<'py, T: Scalar + Element, I: Send + Into<i64>>(
    py: Python<'py>,
    center: &Bound<'py, PyAny>,
    radius: &Bound<'py, PyAny>,
    ask: impl FnOnce(&[Circle<T>]) -> Answer<Hits<I>> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    let radius = Argument::reals("radius", radius)?;
    let centers: Each<[T; 2]> = Argument::reals("center", center)?.one_or_rows()?;
    let asked = side_by_side(centers, radius.rows_if_any()?);
    let radii = radius.real_each(asked.len().unwrap_or(1))?;
    region(py, &asked, |centers| Circle::all(centers, &radii), ask)
}

/// `query_polygon`.
pub fn polygon<'py, T: Scalar + Element, I: Send + Into<i64>>(
    py: Python<'py>,
    vertices: &Bound<'py, PyAny>,
    ask: impl FnOnce(&[Polygon<T>]) -> Answer<Hits<I>> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    let asked: Each<Vec<[T; 2]>> = Argument::reals("vertices", vertices)?.one_or_more_lists()?;
    let many = matches!(asked, Each::Rows(_));
    let polygons = |all: &[Vec<[T; 2]>]| -> jostle::Result<Vec<Polygon<T>>> {
        let polygon = |(index, vertices): (usize, &Vec<[T; 2]>)| {
            let named = |error| if many { of_polygon(index, error) } else { error };
            Polygon::new(vertices).map_err(named)
        };
        all.iter().enumerate().map(polygon).collect()
    };
    match &asked {
        // Its error names a corner, which is not the number of a question.
        Each::One(vertices) => {
            let one = std::slice::from_ref(vertices);
            let polygons = polygons(one).map_err(refused)?;
            let answer =
                || -> Answer<Hits<i64>> { Ok(ask(&polygons)?.and_then(results::counted_by_numpy)) };
            let hits = detached(py, answer)??.map_err(refused)?;
            Ok(column(py, hits.ids).into_any())
        }
        Each::Rows(_) => region(py, &asked, polygons, ask),
    }
}

/// Says which of many polygons an error is about.
fn of_polygon(polygon: usize, error: Error) -> Error {
    match error {
        Error::Value { argument, index: Some(corner), value, rule } => {
            let rule = format!("corner {corner} of the polygon: {rule}");
            Error::at(argument, polygon, value, &rule)
        }
        Error::Value { argument, index: None, value, rule } => {
            Error::at(argument, polygon, value, &rule)
        }
        other => other,
    }
}

/// `nearest`.
pub fn nearest<'py, T: Scalar + Element>(
    py: Python<'py>,
    point: &Bound<'py, PyAny>,
    k: &Given<'py>,
    max_distance: &Given<'py>,
    ask: impl FnOnce(&[[T; 2]], (usize, T)) -> Answer<Neighbors<T>> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    let k = k.value().map_or(Ok(1), |k| count("k", k, 1))?;
    let reach = reach(max_distance)?;
    let asked: Each<[T; 2]> = Argument::reals("point", point)?.one_or_rows()?;
    match &asked {
        Each::One(one) => {
            let found = detached(py, || ask(std::slice::from_ref(one), (k, reach)))??;
            results::neighbors(py, found.map_err(without_row).map_err(refused)?, None)
        }
        Each::Rows(rows) => {
            let found = detached(py, || ask(rows, (k, reach)))??.map_err(refused)?;
            results::neighbors(py, found, Some((rows.len(), k)))
        }
    }
}

/// `raycast`, and `circle_cast` where there is a radius.
pub fn cast<'py, T: Scalar + Element>(
    py: Python<'py>,
    origin: &Bound<'py, PyAny>,
    direction: &Bound<'py, PyAny>,
    radius: Maybe<'_, 'py>,
    max_distance: &Given<'py>,
    ask: impl FnOnce(&[Ray<T>]) -> Answer<RayHits<T>> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    let reach = reach(max_distance)?;
    let radius = radius.map(|radius| Argument::reals("radius", radius)).transpose()?;
    let direction = Argument::reals("direction", direction)?;
    let origins: Each<[T; 2]> = Argument::reals("origin", origin)?.one_or_rows()?;
    let directions: Each<[T; 2]> = direction.one_or_rows()?;
    let rows = match &directions {
        Each::Rows(rows) => Some(rows.len()),
        Each::One(_) => radius.as_ref().map_or(Ok(None), Argument::rows_if_any)?,
    };
    let origins = side_by_side(origins, rows);
    let len = origins.len().unwrap_or(1);
    if let Each::Rows(rows) = &directions
        && rows.len() != len
    {
        return Err(direction.wrong_shape(&format!("(2,) or ({len}, 2)")));
    }
    let radii = radius.map_or(Ok(Each::One(T::ZERO)), |radius| radius.real_each(len))?;
    let hits = |origins: &[[T; 2]]| match Ray::all(origins, &directions, &radii, reach) {
        Ok(rays) => ask(&rays),
        Err(error) => Ok(Err(error)),
    };
    match &origins {
        Each::One(one) => {
            let hits = detached(py, || hits(std::slice::from_ref(one)))??;
            results::ray_hit(py, &hits.map_err(without_row).map_err(refused)?)
        }
        Each::Rows(rows) => results::ray_hits(py, detached(py, || hits(rows))??.map_err(refused)?),
    }
}

/// Repeats a single value where what belongs to it has rows.
fn side_by_side<V: Clone>(values: Each<V>, rows: Option<usize>) -> Each<V> {
    match (values, rows) {
        (Each::One(value), Some(rows)) => Each::Rows(vec![value; rows]),
        (values, _) => values,
    }
}
