//! `jostle.scenes`.

use jostle::scenes::{self, SCENES, find};
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::arrays::{Given, count, decimal, number, point, table};
use crate::error::{refused, type_error};
use crate::results;
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

/// Say how many particles suit a scene.
///
/// Parameters
/// ----------
/// name : str
///     One of `names()`.
///
/// Returns
/// -------
/// int
///     What `create` takes where no `n` is given.
///
/// Raises
/// ------
/// ValueError
///     If there is no such scene.
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

/// Set a scene up.
///
/// Parameters
/// ----------
/// name : str
///     One of `names()`.
/// n : int, optional
///     Number of particles; as many as suit the scene unless given. Sizes follow. The
///     beads that walls are strung of, and the pegs of `galton`, come in addition, and
///     first. For `emitters` it is the most drops that there will be.
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

/// Say where the drops of the scene `emitters` come from.
///
/// A world has nothing that makes particles: whoever steps it adds what is due, and takes
/// the oldest drops away where there would be more than `n`.
///
/// Parameters
/// ----------
/// n : int, optional
///     Most drops that there will be, as for `create`.
///
/// Returns
/// -------
/// list of Nozzle
///     Each with position, velocity, width, spread, radii, density and drops_per_second.
///
/// Raises
/// ------
/// ValueError
///     If `n` is out of range.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> nozzles = jostle.scenes.fountains(3000)
/// >>> [nozzle.position for nozzle in nozzles]
/// [(-380.0, -135.0), (0.0, -342.0), (380.0, -135.0)]
#[pyfunction]
#[pyo3(signature = (n=None))]
pub fn fountains<'py>(
    py: Python<'py>,
    n: Option<&Bound<'py, PyAny>>,
) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let nozzles = scenes::fountains(particles(n)?).map_err(refused)?;
    nozzles.iter().map(|nozzle| results::nozzle(py, nozzle)).collect()
}

/// Say where things are on the board of the scene `galton`.
///
/// Parameters
/// ----------
/// n : int, optional
///     Number of balls, as for `create`.
///
/// Returns
/// -------
/// GaltonBoard
///     rows, bin_edges, bin_top, floor and ball_radius.
///
/// Raises
/// ------
/// ValueError
///     If `n` is out of range.
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

/// String beads in a straight line, for a wall of immovable discs.
///
/// They lie so close that what slides along them feels a smooth wall, and nothing gets
/// through between two.
///
/// Parameters
/// ----------
/// start, end : tuple of float
///     Centres of the first bead and the last, x and y.
/// radius : float
///     Of each bead; half the thickness of the wall.
///
/// Returns
/// -------
/// ndarray of float32, shape (k, 2)
///     Their centres, from `start` to `end`, at most 0.4 radii apart. One, if the two are
///     the same.
///
/// Raises
/// ------
/// ValueError
///     If a number is not finite, `radius` is not above 0, or so thin a wall would have
///     more than a million beads.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> beads = jostle.scenes.wall((0, 0), (30, 40), radius=5)
/// >>> beads.shape
/// (26, 2)
/// >>> world = jostle.World(beads, (0, 0), 5, movable=False)
#[pyfunction]
pub fn wall<'py>(
    py: Python<'py>,
    start: &Bound<'py, PyAny>,
    end: &Bound<'py, PyAny>,
    radius: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let (start, end) = (point("start", start)?, point("end", end)?);
    let beads = scenes::wall(start, end, number("radius", radius)? as f32);
    table(py, beads.map_err(refused)?)
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
