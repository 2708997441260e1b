//! The columns of the walls of a world as arguments and results.

use jostle_base::{Error, memory};
use jostle_index::Each;
use jostle_world::Wall;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

use crate::arrays::{Argument, Maybe};
use crate::error::refused;
use crate::keywords::Keywords;

/// The ends of a wall.
pub type Segment = [[f32; 2]; 2];

/// The name of a column in errors.
pub type Named = fn(&'static str) -> &'static str;

/// In calls that take columns as arguments.
pub fn as_it_is(column: &'static str) -> &'static str {
    column
}

/// If a world gets the columns as one argument.
fn in_walls(column: &'static str) -> &'static str {
    match column {
        "segments" => "walls['segments']",
        "velocities" => "walls['velocities']",
        "friction" => "walls['friction']",
        "restitution" => "walls['restitution']",
        "sensors" => "walls['sensors']",
        "one_way" => "walls['one_way']",
        "categories" => "walls['categories']",
        "masks" => "walls['masks']",
        other => other,
    }
}

/// The columns that a call is given, those of one wall or of many.
#[derive(Default)]
pub struct Columns {
    pub segments: Option<Vec<Segment>>,
    velocities: Option<Each<[f32; 2]>>,
    friction: Option<Each<f32>>,
    restitution: Option<Each<f32>>,
    sensors: Option<Each<bool>>,
    one_way: Option<Each<bool>>,
    categories: Option<Each<u32>>,
    masks: Option<Each<u32>>,
}

impl Columns {
    /// Those among the keywords of a call, for `len` walls, or for the wall of a single id. `named` has their names in
    /// errors.
    pub fn read(
        keywords: &mut Keywords<'_>,
        (len, single): (usize, bool),
        named: Named,
    ) -> PyResult<Self> {
        let segments = keywords.take_some("segments");
        let segments = segments.map(|value| segments_of(&value, len, single)).transpose()?;
        let vector = |value: Bound<'_, PyAny>| {
            let value = Argument::reals(named("velocities"), &value)?;
            if single { value.only_pair("wall").map(Each::One) } else { value.one_or_pairs(len) }
        };
        let velocities = keywords.take_some("velocities").map(vector).transpose()?;
        // None has a meaning here: the coefficient of the particle.
        let mut surface = |name| {
            let value = keywords.take(name);
            value.map(|value| coefficients(named(name), &value, len)).transpose()
        };
        let (friction, restitution) = (surface("friction")?, surface("restitution")?);
        let mut truth = |name| {
            let value = keywords.take_some(name);
            value.map(|value| Argument::booleans(named(name), &value)?.truth_each(len)).transpose()
        };
        let (sensors, one_way) = (truth("sensors")?, truth("one_way")?);
        let mut bits = |name| {
            let value = keywords.take_some(name);
            value.map(|value| Argument::integers(named(name), &value)?.bits_each(len)).transpose()
        };
        let (categories, masks) = (bits("categories")?, bits("masks")?);
        Ok(Self {
            segments,
            velocities,
            friction,
            restitution,
            sensors,
            one_way,
            categories,
            masks,
        })
    }

    /// A single column of all `len` walls.
    pub fn read_one(name: &str, value: Bound<'_, PyAny>, len: usize) -> PyResult<Self> {
        let only = PyDict::new(value.py());
        only.set_item(name, value)?;
        Self::read(&mut Keywords::of("Walls", Some(&only))?, (len, false), as_it_is)
    }

    /// Writes them into walls.
    pub fn write(&self, walls: &mut [Wall]) {
        fn put<V: Copy>(
            column: &Option<Each<V>>,
            walls: &mut [Wall],
            write: impl Fn(&mut Wall, V),
        ) {
            if let Some(column) = column {
                (0..).zip(walls).for_each(|(row, wall)| write(wall, column.at(row)));
            }
        }
        if let Some(segments) = &self.segments {
            segments.iter().zip(&mut *walls).for_each(|(&ends, wall)| wall.ends = ends);
        }
        let some = |value: f32| Some(value).filter(|value| !value.is_nan());
        put(&self.velocities, walls, |wall, velocity| wall.velocity = velocity);
        put(&self.friction, walls, |wall, value| wall.surface.friction = some(value));
        put(&self.restitution, walls, |wall, value| wall.surface.restitution = some(value));
        put(&self.sensors, walls, |wall, is_sensor| wall.is_sensor = is_sensor);
        put(&self.one_way, walls, |wall, is_one_way| wall.is_one_way = is_one_way);
        put(&self.categories, walls, |wall, bits| wall.filter.category = bits);
        put(&self.masks, walls, |wall, bits| wall.filter.mask = bits);
    }
}

/// The walls of a new world, from an array of shape (m, 2, 2), a dict of columns, or None, and the names of columns in
/// errors.
pub fn read(value: Maybe<'_, '_>) -> PyResult<(Vec<Wall>, Named)> {
    let Some(value) = value else { return Ok((Vec::new(), as_it_is)) };
    let Ok(columns) = value.cast::<PyDict>() else {
        let walls = new(Argument::reals("walls", value)?.segments()?)?;
        return Ok((walls, |column| if column == "segments" { "walls" } else { column }));
    };
    let Some(segments) = columns.get_item("segments")? else {
        return Err(PyTypeError::new_err("walls has no 'segments'"));
    };
    let (ends, single) = one_or_many(in_walls("segments"), &segments)?;
    let mut keywords = Keywords::of("World(walls=)", Some(columns))?;
    let columns = Columns::read(&mut keywords, (ends.len(), single), in_walls)?;
    keywords.end()?;
    let mut walls = new(ends)?;
    columns.write(&mut walls);
    Ok((walls, in_walls))
}

/// Walls between pairs of points, with defaults.
pub fn new(ends: Vec<Segment>) -> PyResult<Vec<Wall>> {
    memory::collect(ends.into_iter().map(Wall::new)).map_err(refused)
}

/// An error of the core about walls, with other names.
pub fn renamed(error: Error, named: Named) -> Error {
    match error {
        Error::Value { argument, index, value, rule } => {
            Error::Value { argument: named(argument), index, value, rule }
        }
        other => other,
    }
}

/// The segments of new walls, and whether the argument is a single one.
pub fn one_or_many(name: &'static str, value: &Bound<'_, PyAny>) -> PyResult<(Vec<Segment>, bool)> {
    let value = Argument::reals(name, value)?;
    let single = value.is_segment();
    Ok((if single { value.only_segment()? } else { value.segments()? }, single))
}

/// The segments of `len` walls, or of a single one.
fn segments_of(value: &Bound<'_, PyAny>, len: usize, single: bool) -> PyResult<Vec<Segment>> {
    let value = Argument::reals("segments", value)?;
    if single {
        return value.only_segment();
    }
    let all = value.segments()?;
    if all.len() == len { Ok(all) } else { Err(value.wrong_shape(&format!("({len}, 2, 2)"))) }
}

/// A coefficient for each of `len` surfaces, NaN for None. The core checks them.
pub fn coefficients(
    name: &'static str,
    value: &Bound<'_, PyAny>,
    len: usize,
) -> PyResult<Each<f32>> {
    let py = value.py();
    if value.is_none() {
        return Ok(Each::One(f32::NAN));
    }
    if !(value.is_instance_of::<PyTuple>() || value.is_instance_of::<PyList>()) {
        return Argument::reals(name, value)?.real_each(len);
    }
    // NumPy would make objects of a list with None.
    let nan = f64::NAN.into_pyobject(py)?.into_any();
    let mut all = value.try_iter()?.collect::<PyResult<Vec<_>>>()?;
    all.iter_mut().filter(|value| value.is_none()).for_each(|value| value.clone_from(&nan));
    Argument::reals(name, PyList::new(py, all)?.as_any())?.real_each(len)
}
