//! `jostle.scenes`.

use jostle::scenes::{SCENES, find};
use pyo3::prelude::*;

use crate::arrays::{Given, count, decimal};
use crate::error::{refused, type_error};
use crate::world::PyWorld;

/// List the scenes.
///
/// Returns
/// -------
/// list of str
///     Their names.
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

/// Say what there is to see in a scene.
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
/// Examples
/// --------
/// >>> import jostle
/// >>> print(jostle.scenes.describe("billiards"))
/// A cue ball breaks a rack of balls. Follow how the momentum of one spreads over all.
#[pyfunction]
pub fn describe(name: &Bound<'_, PyAny>) -> PyResult<&'static str> {
    Ok(scene(name)?.about)
}

/// Set a scene up.
///
/// Parameters
/// ----------
/// name : str
///     One of `names()`.
/// n : int, optional
///     Number of particles; as many as suit the scene unless given. Sizes follow.
/// seed : int, default 0
///     The same seed gives the same world on every machine.
///
/// Returns
/// -------
/// World
///     In pixels and seconds, y growing downwards, made for steps of 1/60 s.
///
/// Raises
/// ------
/// ValueError
///     If there is no such scene, or `n` or `seed` is out of range.
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
    signature = (name, n=None, seed=Given::NOTHING),
    text_signature = "(name, n=None, seed=0)"
)]
pub fn create(
    py: Python<'_>,
    name: &Bound<'_, PyAny>,
    n: Option<&Bound<'_, PyAny>>,
    seed: Given<'_>,
) -> PyResult<PyWorld> {
    let (scene, n) = (scene(name)?, particles(n)?);
    let seed = seed.value().map_or(Ok(0), |seed| count("seed", seed, 0))?;
    let world = py.detach(|| scene.create(n, seed as u64));
    Ok(PyWorld::of(world.map_err(refused)?))
}

/// Say which part of a scene's world to look at.
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
///     min_x, min_y, max_x, max_y, in pixels.
///
/// Raises
/// ------
/// ValueError
///     If there is no such scene or `n` is out of range.
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

fn scene(name: &Bound<'_, PyAny>) -> PyResult<&'static jostle::scenes::Scene> {
    let Ok(found) = name.extract::<String>() else {
        return Err(type_error("name", "the name of a scene", name));
    };
    find(&found).map_err(refused)
}

fn particles(n: Option<&Bound<'_, PyAny>>) -> PyResult<Option<usize>> {
    n.map(|n| count("n", n, 0)).transpose()
}
