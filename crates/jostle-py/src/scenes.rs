//! `jostle.scenes`.

use jostle_scenes::{self as scenes, SCENES, find};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Given, count, decimal};
use crate::error::{refused, type_error};
use crate::keywords::read_of_function;
use crate::results;
use crate::world::PyWorld;

/// List the scenes.
///
/// Returns
/// -------
/// list of str
///     Their names.
///
/// See Also
/// --------
/// create : The world of a scene.
/// describe : A description of a scene.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> "gas" in jostle.scenes.names()
/// True
#[pyfunction]
pub fn names() -> Vec<&'static str> {
    SCENES.iter().map(|scene| scene.name).collect()
}

/// Describe a scene.
///
/// Parameters
/// ----------
/// name : str
///     One of `names()`.
///
/// Returns
/// -------
/// str
///     Two sentences.
///
/// Raises
/// ------
/// ValueError
///     If there is no such scene.
///
/// See Also
/// --------
/// names : All scenes.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> print(jostle.scenes.describe("billiards"))
/// A cue ball with side spin breaks a rack of balls. Its momentum and its spin spread over all
/// balls.
#[pyfunction]
pub fn describe(name: &Bound<'_, PyAny>) -> PyResult<&'static str> {
    Ok(scene(name)?.about)
}

/// Return the default number of particles of a scene.
///
/// Parameters
/// ----------
/// name : str
///     One of `names()`.
///
/// Returns
/// -------
/// int
///     What `create` uses if `n` is omitted.
///
/// Raises
/// ------
/// ValueError
///     If there is no such scene.
///
/// See Also
/// --------
/// create : The world of the scene.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> jostle.scenes.default_count("billiards")
/// 16
#[pyfunction]
pub fn default_count(name: &Bound<'_, PyAny>) -> PyResult<usize> {
    Ok(scene(name)?.default_count)
}

/// Make the world of a scene.
///
/// Parameters
/// ----------
/// name : str
///     One of `names()`.
/// n : int, optional
///     Number of particles; by default a suitable number for the scene. Sizes depend on it.
///     The discs of walls and the pegs of `galton` come in addition, and first.
/// seed : int, default 0
///     The same seed gives the same world on every machine.
///
/// Returns
/// -------
/// World
///     In pixels and seconds, y grows downwards, for steps of 1/60 s.
///
/// Raises
/// ------
/// ValueError
///     If there is no such scene, or `n` or `seed` is out of range.
///
/// See Also
/// --------
/// view : The part of it to display.
/// default_count : The default number of particles.
/// describe : A description.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> world = jostle.scenes.create("pile", n=100)
/// >>> world.step(1 / 60)
/// >>> len(world)
/// 100
#[pyfunction]
#[pyo3(
    signature = (name=Given::NOTHING, n=None, seed=Given::NOTHING, **unknown),
    text_signature = "(name, n=None, seed=0)"
)]
pub fn create(
    py: Python<'_>,
    name: Given<'_>,
    n: Option<&Bound<'_, PyAny>>,
    seed: Given<'_>,
    unknown: Option<&Bound<'_, PyDict>>,
) -> PyResult<PyWorld> {
    let [name] = read_of_function("create_scene", unknown, [("name", &name)])?;
    let (scene, n) = (scene(name)?, particles(n)?);
    let seed = seed.value().map_or(Ok(0), |seed| count("seed", seed, 0))?;
    let world = py.detach(|| scene.create(n, seed as u64));
    Ok(PyWorld::of(world.map_err(refused)?))
}

/// Make the particles of one of several ranks. For `jostle.mpi`.
#[pyfunction]
pub fn create_part(
    py: Python<'_>,
    name: &Bound<'_, PyAny>,
    n: Option<&Bound<'_, PyAny>>,
    seed: &Bound<'_, PyAny>,
    rank: usize,
    size: usize,
) -> PyResult<PyWorld> {
    let (scene, n) = (scene(name)?, particles(n)?);
    let seed = count("seed", seed, 0)?;
    let world = py.detach(|| scene.create_part(n, seed as u64, [rank, size]));
    Ok(PyWorld::of(world.map_err(refused)?))
}

/// Return the part of a scene's world to display.
///
/// Parameters
/// ----------
/// name : str
///     One of `names()`.
/// n : int, optional
///     Number of particles, as for `create`.
///
/// Returns
/// -------
/// tuple of float
///     Sides min_x, min_y, max_x, max_y, in pixels.
///
/// Raises
/// ------
/// ValueError
///     If there is no such scene or `n` is out of range.
///
/// See Also
/// --------
/// create : The world of the scene.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> jostle.scenes.view("article")
/// (0.0, 0.0, 800.0, 500.0)
#[pyfunction]
#[pyo3(signature = (name, n=None))]
pub fn view(
    name: &Bound<'_, PyAny>,
    n: Option<&Bound<'_, PyAny>>,
) -> PyResult<(f64, f64, f64, f64)> {
    let view = scene(name)?.view(particles(n)?).map_err(refused)?;
    Ok(view.map(decimal).into())
}

/// Return the geometry of the board in the scene `galton`.
///
/// Parameters
/// ----------
/// n : int, optional
///     Number of balls, as for `create`.
///
/// Returns
/// -------
/// GaltonBoard
///     With rows, bin_edges, bin_top, floor and ball_radius.
///
/// Raises
/// ------
/// ValueError
///     If `n` is out of range.
///
/// See Also
/// --------
/// create : The world of the scene.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> board = jostle.scenes.galton_board(400)
/// >>> board.rows, len(board.bin_edges)
/// (10, 12)
#[pyfunction]
#[pyo3(signature = (n=None))]
pub fn galton_board<'py>(
    py: Python<'py>,
    n: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    results::galton_board(py, scenes::galton_board(particles(n)?).map_err(refused)?)
}

fn scene(name: &Bound<'_, PyAny>) -> PyResult<&'static jostle_scenes::Scene> {
    let Ok(found) = name.extract::<String>() else {
        return Err(type_error("name", "the name of a scene", name));
    };
    find(&found).map_err(refused)
}

fn particles(n: Option<&Bound<'_, PyAny>>) -> PyResult<Option<usize>> {
    n.map(|n| count("n", n, 0)).transpose()
}
