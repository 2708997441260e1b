//! Conversion of the arguments of queries, each one query or many, and of their results.

use jostle_base::Error;
use jostle_index::query::{Circle, Hits, Neighbors, Point, Polygon, Ray, Rect};
use jostle_index::{Each, Scalar};
use numpy::{Element, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};

use crate::arrays::{Argument, Given, PointLists, column, count, long_ids, number, single_mask};
use crate::error::refused;
use crate::interrupt::detached;
use crate::query_methods::Casts;
use crate::results;

/// An argument of a query.
pub type Asked<'a, 'py> = &'a Bound<'py, PyAny>;

pub use crate::arrays::Maybe;

/// The result of a search; a Python error if it could not start.
pub type Answer<R> = PyResult<jostle_base::Result<R>>;

/// The categories of a query; None for all shapes, also those without categories.
pub fn mask(value: Maybe<'_, '_>) -> PyResult<Option<u32>> {
    value.map(|value| single_mask("mask", value)).transpose()
}

/// The ids that queries do not find; None excludes nothing, and so does an id that nothing has.
pub fn excluded(value: Maybe<'_, '_>) -> PyResult<Option<Each<i64>>> {
    value.map(|value| long_ids("exclude", value, "shape")).transpose()
}

/// The maximum distances of queries, one for all or one for each. `len` returns the number of queries
/// for a number of distances.
fn max_distances<T: Scalar + Element>(
    given: &Given<'_>,
    len: impl FnOnce(Option<usize>) -> Option<usize>,
) -> PyResult<Each<T>> {
    let Some(value) = given.value() else { return Ok(Each::One(T::INFINITY)) };
    let is_list = value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>();
    let is_array = value.cast::<PyUntypedArray>().is_ok_and(|array| array.ndim() > 0);
    if !is_list && !is_array {
        return Ok(Each::One(T::from_f64(number("max_distance", value)?)));
    }
    let distances = Argument::reals("max_distance", value)?;
    match len(distances.rows_if_any()?) {
        Some(len) => distances.real_each(len),
        None => Err(distances.wrong_shape("a number")),
    }
}

/// The result of a call as a Python result. If the argument was a single id or query, an error
/// names no row.
pub fn result_of<V>(result: jostle_base::Result<V>, single: bool) -> PyResult<V> {
    result.map_err(|error| match error {
        Error::Length { argument: argument @ "exclude", found, expected } => {
            let rule = match single {
                true => "it must be one id, as there is one query".to_string(),
                false => format!("it must be one id, or {expected}, one for each query"),
            };
            PyValueError::new_err(format!("{argument} has {found} ids; {rule}"))
        }
        error if single => refused(error.without_row()),
        error => refused(error),
    })
}

/// Makes regions and searches them; returns the ids of `many` regions, or of one.
fn region<'py, R: Send, I: Send + Into<i64>>(
    py: Python<'py>,
    many: bool,
    exclude: Option<&Each<i64>>,
    regions: impl FnOnce() -> jostle_base::Result<Vec<R>> + Send,
    search: impl FnOnce(&[R]) -> Answer<Hits<I>> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    let answer = || -> Answer<Hits<i64>> {
        match regions() {
            Ok(regions) => {
                Ok(search(&regions)?.and_then(results::with_long_ids).and_then(|mut hits| {
                    exclude.map_or(Ok(()), |ids| hits.exclude(ids))?;
                    Ok(hits)
                }))
            }
            Err(error) => Ok(Err(error)),
        }
    };
    let hits = detached(py, answer)??;
    if many {
        results::hits(py, result_of(hits, false)?)
    } else {
        Ok(column(py, result_of(hits, true)?.ids).into_any())
    }
}

/// Whether an argument has many queries, and its values row by row.
fn rows_of<V>(asked: &Each<V>) -> (bool, &[V]) {
    match asked {
        Each::One(one) => (false, std::slice::from_ref(one)),
        Each::Rows(rows) => (true, rows),
    }
}

/// `query_rect`.
pub fn rect<'py, T: Scalar + Element, I: Send + Into<i64>>(
    py: Python<'py>,
    rect: &Bound<'py, PyAny>,
    exclude: Option<&Each<i64>>,
    search: impl FnOnce(&[Rect<T>]) -> Answer<Hits<I>> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    let sides = sides(rect, &SIDES)?;
    let asked: Each<[T; 4]> =
        Argument::reals("rect", sides.as_ref().unwrap_or(rect))?.one_or_rows()?;
    let (many, rects) = rows_of(&asked);
    region(py, many, exclude, || Rect::all(rects), search)
}

/// Attributes with the sides of pygame's Rect, which NumPy would read as x, y, width and
/// height.
pub const SIDES_OF_RECT: [&str; 4] = ["left", "top", "right", "bottom"];

/// [`SIDES_OF_RECT`], and the attributes of `jostle.Box`, which are float32: accepted for queries,
/// but not for shapes.
const SIDES: [[&str; 4]; 2] = [SIDES_OF_RECT, ["min_x", "min_y", "max_x", "max_y"]];

/// The sides of an object that has them as attributes, or of such objects in a list.
pub fn sides<'py>(
    rect: &Bound<'py, PyAny>,
    attributes: &[[&str; 4]],
) -> PyResult<Option<Bound<'py, PyAny>>> {
    if let Some(sides) = sides_of_one(rect, attributes)? {
        return Ok(Some(sides.into_any()));
    }
    if !(rect.is_instance_of::<PyList>() || rect.is_instance_of::<PyTuple>()) {
        return Ok(None);
    }
    let (all, mut any) = (PyList::empty(rect.py()), false);
    for rect in rect.try_iter()? {
        let rect = rect?;
        match sides_of_one(&rect, attributes)? {
            Some(sides) => {
                all.append(sides)?;
                any = true;
            }
            None => all.append(rect)?,
        }
    }
    Ok(any.then(|| all.into_any()))
}

/// The sides of a single rectangle.
pub fn one_rect(name: &'static str, rect: &Bound<'_, PyAny>) -> PyResult<[f32; 4]> {
    let sides = sides(rect, &SIDES)?;
    let rect = Argument::reals(name, sides.as_ref().unwrap_or(rect))?;
    match rect.one_or_rows()? {
        Each::One(sides) => Ok(sides),
        Each::Rows(_) => Err(rect.wrong_shape("(4,)")),
    }
}

fn sides_of_one<'py>(
    rect: &Bound<'py, PyAny>,
    attributes: &[[&str; 4]],
) -> PyResult<Option<Bound<'py, PyTuple>>> {
    if rect.is_exact_instance_of::<PyTuple>() || rect.is_exact_instance_of::<PyList>() {
        return Ok(None);
    }
    for names in attributes {
        if rect.hasattr(names[3])? {
            let sides = names.map(|name| rect.getattr(name));
            let sides = sides.into_iter().collect::<PyResult<Vec<_>>>()?;
            return PyTuple::new(rect.py(), sides).map(Some);
        }
    }
    Ok(None)
}

/// `query_point`.
pub fn point<'py, T: Scalar + Element, I: Send + Into<i64>>(
    py: Python<'py>,
    point: &Bound<'py, PyAny>,
    exclude: Option<&Each<i64>>,
    search: impl FnOnce(&[Point<T>]) -> Answer<Hits<I>> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    let asked: Each<[T; 2]> = Argument::reals("point", point)?.one_or_rows()?;
    let (many, points) = rows_of(&asked);
    region(py, many, exclude, || Point::all(points), search)
}

/// `query_circle`.
pub fn circle<'py, T: Scalar + Element, I: Send + Into<i64>>(
    py: Python<'py>,
    center: &Bound<'py, PyAny>,
    radius: &Bound<'py, PyAny>,
    exclude: Option<&Each<i64>>,
    search: impl FnOnce(&[Circle<T>]) -> Answer<Hits<I>> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    let radius = Argument::reals("radius", radius)?;
    let centers: Each<[T; 2]> = Argument::reals("center", center)?.one_or_rows()?;
    let len = centers.len().map_or_else(|| radius.rows_if_any(), |len| Ok(Some(len)))?;
    let radii = radius.real_each(len.unwrap_or(1))?;
    region(py, len.is_some(), exclude, || Circle::all(&centers, &radii), search)
}

/// `query_polygon`.
pub fn polygon<'py, T: Scalar + Element, I: Send + Into<i64>>(
    py: Python<'py>,
    vertices: &Bound<'py, PyAny>,
    exclude: Option<&Each<i64>>,
    search: impl FnOnce(&[Polygon<T>]) -> Answer<Hits<I>> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    let PointLists { points, many } = Argument::reals("vertices", vertices)?.one_or_more_lists()?;
    let Some((polygons, corners)) = many else {
        // The row in the error is that of a corner, not of a query.
        let polygon = Polygon::new(&points).map_err(refused)?;
        return region(py, false, exclude, || Ok(vec![polygon]), search);
    };
    let polygon = |index: usize| {
        Polygon::new(&points[index * corners..(index + 1) * corners])
            .map_err(|error| of_polygon(index, error))
    };
    region(py, true, exclude, || (0..polygons).map(polygon).collect(), search)
}

/// Adds the index of a polygon to an error about a corner.
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

/// `nearest`; `wanted` is the number of shapes, the maximum distances and the ids that are not found.
pub fn nearest<'py, T: Scalar + Element>(
    py: Python<'py>,
    point: &Bound<'py, PyAny>,
    (k, max_distance, exclude): (&Given<'py>, &Given<'py>, Option<&Each<i64>>),
    search: impl FnOnce(&[[T; 2]], (usize, Each<T>)) -> Answer<Neighbors<T>> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    let k = k.value().map_or(Ok(1), |k| count("k", k, 1))?;
    let asked: Each<[T; 2]> = Argument::reals("point", point)?.one_or_rows()?;
    let max_distance = max_distances(max_distance, |_| asked.len())?;
    let (many, points) = rows_of(&asked);
    let answer = || -> Answer<Neighbors<T>> {
        let Some(ids) = exclude else { return search(points, (k, max_distance)) };
        let found = search(points, (k.saturating_add(1), max_distance))?;
        Ok(found.and_then(|mut found| found.exclude(k, ids).map(|()| found)))
    };
    let found = result_of(detached(py, answer)??, !many)?;
    results::neighbors(py, found, many.then_some((points.len(), k)))
}

/// The rays of a cast.
pub struct Cast<'a, 'py> {
    pub origin: Asked<'a, 'py>,
    pub direction: Asked<'a, 'py>,
    /// The half sizes and the radii of moving shapes.
    pub sizes: (Maybe<'a, 'py>, Maybe<'a, 'py>),
    pub max_distance: &'a Given<'py>,
    pub exclude: Maybe<'a, 'py>,
}

/// `raycast` and the other casts; `all` hits, or the first of each.
pub fn cast<'py, T: Scalar + Element>(
    py: Python<'py>,
    cast: &Cast<'_, 'py>,
    all: bool,
    search: impl FnOnce(&[Ray<T>]) -> Answer<Casts<T>> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    let (half_sizes, radii) = cast.sizes;
    let radii = radii.map(|radii| Argument::reals("radii", radii)).transpose()?;
    let half_sizes = half_sizes.map(|sizes| Argument::reals("half_sizes", sizes)).transpose()?;
    let direction = Argument::reals("direction", cast.direction)?;
    let origins: Each<[T; 2]> = Argument::reals("origin", cast.origin)?.one_or_rows()?;
    let directions: Each<[T; 2]> = direction.one_or_rows()?;
    let radii_len = radii.as_ref().map_or(Ok(None), Argument::rows_if_any)?;
    let sizes_len = half_sizes.as_ref().and_then(Argument::rows_of_pairs);
    let others = origins.len().or(directions.len()).or(radii_len).or(sizes_len);
    let mut len = others;
    let max_distances = max_distances(cast.max_distance, |rows| {
        len = others.or(rows);
        len
    })?;
    if let (Each::Rows(rows), Some(len)) = (&directions, len)
        && rows.len() != len
    {
        return Err(direction.wrong_shape(&format!("(2,) or ({len}, 2)")));
    }
    let rows = len.unwrap_or(1);
    let radii = radii.map_or(Ok(Each::One(T::ZERO)), |radii| radii.real_each(rows))?;
    let half_sizes =
        half_sizes.map_or(Ok(Each::One([T::ZERO; 2])), |sizes| sizes.half_sizes(rows))?;
    let exclude = excluded(cast.exclude)?.unwrap_or(Each::One(-1));
    let rays = || {
        let rays = Ray::of_boxes(&origins, &directions, (&half_sizes, &radii), &max_distances)?;
        Ray::excluding(rays, &exclude)
    };
    let hits = || rays().map_or_else(|error| Ok(Err(error)), |rays| search(&rays));
    let hits = result_of(detached(py, hits)??, len.is_none())?;
    match (len, all) {
        (Some(_), true) => results::ray_hit_lists(py, hits),
        (Some(_), false) | (None, true) => results::ray_hits(py, hits),
        (None, false) => results::ray_hit(py, &hits),
    }
}

/// `neighbors`.
pub fn neighbors<T: Scalar, I: Send + Into<i64>>(
    py: Python<'_>,
    distance: f64,
    search: impl FnOnce(T) -> Answer<Hits<I>> + Send,
) -> PyResult<Bound<'_, PyAny>> {
    let answer = || -> Answer<Hits<i64>> {
        Ok(search(T::from_f64(distance))?.and_then(results::with_long_ids))
    };
    results::hits(py, detached(py, answer)??.map_err(refused)?)
}
