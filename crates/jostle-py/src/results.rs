//! Results of several arrays, as classes of `jostle.results`.

use jostle_base::interrupt::Pulse;
use jostle_base::memory;
use jostle_index::pairs::Overlaps;
use jostle_index::query::{Hits, Neighbors};
use jostle_index::{Scalar, Shape};
use jostle_scenes::GaltonBoard;
use jostle_space::Slides;
use jostle_world::{Particles, Spin, Surface, Totals, Touch, TouchEvents, Wall, WallTouch};
use numpy::{Element, PyArrayMethods};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyTuple;

use crate::arrays::{Widen, column, decimal, long, matrix, segments, table};
use crate::error::refused;
use crate::interrupt::detached;
use crate::query_methods::Casts;

/// `jostle.Contacts`.
pub fn contacts<T, I>(py: Python<'_>, all: Overlaps<T, I>) -> PyResult<Bound<'_, PyAny>>
where
    T: Element,
    [I; 2]: Widen<Long = [i64; 2]> + Sync,
{
    static CONTACTS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let pairs = detached(py, || long(&all.pairs))?.map_err(refused)?;
    let len = all.points.len();
    let fields = (
        table(py, pairs)?,
        table(py, all.normals)?,
        column(py, all.depths),
        table(py, all.points.into_flattened())?.reshape([len, 2, 2])?,
        table(py, all.categories)?,
    );
    CONTACTS.import(py, "jostle.results", "Contacts")?.call1(fields)
}

/// `jostle.WorldContacts`.
pub fn world_contacts(py: Python<'_>, all: Vec<Touch>) -> PyResult<Bound<'_, PyAny>> {
    static CONTACTS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let pairs = detached(py, || long(&memory::collect(all.iter().map(|touch| touch.pair))?))?;
    let fields = (
        table(py, pairs.map_err(refused)?)?,
        table(py, listed(all.iter().map(|touch| touch.normal))?)?,
        column(py, listed(all.iter().map(|touch| touch.depth))?),
        column(py, listed(all.iter().map(|touch| touch.normal_impulse))?),
        column(py, listed(all.iter().map(|touch| touch.friction_impulse))?),
        table(py, listed(all.iter().map(|touch| touch.categories))?)?,
    );
    CONTACTS.import(py, "jostle.results", "WorldContacts")?.call1(fields)
}

/// All values of an iterator.
fn listed<V>(values: impl ExactSizeIterator<Item = V>) -> PyResult<Vec<V>> {
    memory::collect(values).map_err(refused)
}

/// `jostle.WallContacts`.
pub fn wall_contacts(py: Python<'_>, all: Vec<WallTouch>) -> PyResult<Bound<'_, PyAny>> {
    static CONTACTS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let fields = (
        column(py, listed(all.iter().map(|touch| touch.id))?),
        column(py, listed(all.iter().map(|touch| touch.wall))?),
        table(py, listed(all.iter().map(|touch| touch.normal))?)?,
        column(py, listed(all.iter().map(|touch| touch.depth))?),
        column(py, listed(all.iter().map(|touch| touch.normal_impulse))?),
        column(py, listed(all.iter().map(|touch| touch.friction_impulse))?),
        table(py, listed(all.iter().map(|touch| touch.categories))?)?,
    );
    CONTACTS.import(py, "jostle.results", "WallContacts")?.call1(fields)
}

/// `jostle.Particles`, or `jostle.Particle` of a `single` one.
pub fn world_particles(py: Python<'_>, all: Particles, single: bool) -> PyResult<Bound<'_, PyAny>> {
    static CLASSES: [PyOnceLock<Py<PyAny>>; 2] = [PyOnceLock::new(), PyOnceLock::new()];
    let rows = 0..all.len();
    let spins = listed(rows.clone().map(|row| all.spin(row)))?;
    let filters = listed(rows.clone().map(|row| all.filter(row)))?;
    let sensors = listed(rows.clone().map(|row| all.is_sensor(row)))?;
    let kinds = listed(rows.map(|row| all.kind(row)))?;
    let fields = [
        field(py, all.positions, single)?,
        field(py, all.velocities, single)?,
        field(py, all.radii, single)?,
        field(py, all.masses, single)?,
        field(py, all.restitution, single)?,
        field(py, all.movable, single)?,
        field(py, listed(spins.iter().map(|spin| spin.friction))?, single)?,
        field(py, listed(spins.iter().map(Spin::rounded_angle))?, single)?,
        field(py, listed(spins.iter().map(|spin| spin.velocity))?, single)?,
        field(py, listed(filters.iter().map(|filter| filter.category))?, single)?,
        field(py, listed(filters.iter().map(|filter| filter.mask))?, single)?,
        field(py, sensors, single)?,
        field(py, kinds, single)?,
    ];
    let class = if single { "Particle" } else { "Particles" };
    let class = CLASSES[usize::from(single)].import(py, "jostle.results", class)?;
    class.call1(PyTuple::new(py, fields)?)
}

/// The value of a `single` particle, or the values of some.
fn field<V: Value>(py: Python<'_>, mut all: Vec<V>, single: bool) -> PyResult<Bound<'_, PyAny>> {
    if single { all.swap_remove(0).one(py) } else { V::array(py, all) }
}

/// A value of a particle.
trait Value: Sized {
    fn one(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>>;
    fn array(py: Python<'_>, all: Vec<Self>) -> PyResult<Bound<'_, PyAny>>;
}

impl Value for [f32; 2] {
    fn one(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        Ok(column(py, self.to_vec()).into_any())
    }

    fn array(py: Python<'_>, all: Vec<Self>) -> PyResult<Bound<'_, PyAny>> {
        Ok(table(py, all)?.into_any())
    }
}

macro_rules! value {
    ($type:ty, $one:expr) => {
        impl Value for $type {
            fn one(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
                $one(self).into_bound_py_any(py)
            }

            fn array(py: Python<'_>, all: Vec<Self>) -> PyResult<Bound<'_, PyAny>> {
                Ok(column(py, all).into_any())
            }
        }
    };
}
value!(f32, decimal);
value!(u8, u8::from);
value!(u32, u32::from);
value!(bool, bool::from);

/// `jostle.WallColumns`, or `jostle.Wall` of a `single` one.
pub fn walls<'py>(py: Python<'py>, all: &[Wall], single: bool) -> PyResult<Bound<'py, PyAny>> {
    static CLASSES: [PyOnceLock<Py<PyAny>>; 2] = [PyOnceLock::new(), PyOnceLock::new()];
    let ends = segments(py, &listed(all.iter().map(|wall| wall.ends))?)?.into_any();
    let surface = |of: fn(&Surface) -> Option<f32>| {
        listed(all.iter().map(|wall| of(&wall.surface).unwrap_or(f32::NAN)))
    };
    let fields = [
        if single { ends.get_item(0)? } else { ends },
        field(py, listed(all.iter().map(|wall| wall.velocity))?, single)?,
        field(py, surface(|of| of.friction)?, single)?,
        field(py, surface(|of| of.restitution)?, single)?,
        field(py, listed(all.iter().map(|wall| wall.is_sensor))?, single)?,
        field(py, listed(all.iter().map(|wall| wall.is_one_way))?, single)?,
        field(py, listed(all.iter().map(|wall| wall.filter.category))?, single)?,
        field(py, listed(all.iter().map(|wall| wall.filter.mask))?, single)?,
    ];
    let class = if single { "Wall" } else { "WallColumns" };
    let class = CLASSES[usize::from(single)].import(py, "jostle.results", class)?;
    class.call1(PyTuple::new(py, fields)?)
}

/// `jostle.Shapes`, or `jostle.Shape` of a `single` one.
pub fn shapes<'py, T: Element + Scalar>(
    py: Python<'py>,
    all: &[Shape<T>],
    single: bool,
) -> PyResult<Bound<'py, PyAny>> {
    static CLASSES: [PyOnceLock<Py<PyAny>>; 2] = [PyOnceLock::new(), PyOnceLock::new()];
    fn rows<'py, T: Element, const W: usize>(
        py: Python<'py>,
        rows: Vec<[T; W]>,
        single: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let table = table(py, rows)?.into_any();
        if single { table.get_item(0) } else { Ok(table) }
    }
    let radii = column(py, all.iter().map(|shape| shape.radius).collect()).into_any();
    let ends = all.iter().map(|shape| shape.segment().unwrap_or([[T::NAN; 2]; 2]));
    let ends = segments(py, &ends.collect::<Vec<_>>())?.into_any();
    let fields = [
        rows(py, all.iter().map(Shape::center).collect(), single)?,
        if single { radii.get_item(0)?.call_method0("item")? } else { radii },
        rows(py, all.iter().map(Shape::core_half_size).collect(), single)?,
        rows(py, all.iter().map(Shape::sides).collect(), single)?,
        if single { ends.get_item(0)? } else { ends },
        field(py, all.iter().map(|shape| shape.category).collect(), single)?,
        field(py, all.iter().map(|shape| shape.mask).collect(), single)?,
    ];
    let class = if single { "Shape" } else { "Shapes" };
    let class = CLASSES[usize::from(single)].import(py, "jostle.results", class)?;
    class.call1(PyTuple::new(py, fields)?)
}

/// `jostle.WorldEvents` or `jostle.WallEvents`.
pub fn events<'py>(py: Python<'py>, class: &str, all: TouchEvents) -> PyResult<Bound<'py, PyAny>> {
    let TouchEvents { entered, stayed, left, categories: [of_entered, of_stayed, of_left] } = all;
    let pairs = (table(py, entered)?, table(py, stayed)?, table(py, left)?);
    let categories = (table(py, of_entered)?, table(py, of_stayed)?, table(py, of_left)?);
    let fields = (pairs.0, pairs.1, pairs.2, categories.0, categories.1, categories.2);
    py.import("jostle.results")?.getattr(class)?.call1(fields)
}

/// `jostle.LastStep`.
pub fn last_step(
    py: Python<'_>,
    pairs: Vec<Touch>,
    walls: Vec<WallTouch>,
    all: jostle_world::Stats,
) -> PyResult<Bound<'_, PyAny>> {
    static STEP: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let touched = (world_contacts(py, pairs)?, wall_contacts(py, walls)?);
    let fields = (touched.0, touched.1, all.substeps, all.unresolved, all.collapsed);
    STEP.import(py, "jostle.results", "LastStep")?.call1(fields)
}

/// `jostle.LastCall` of a world with so many walls.
pub fn last_call(py: Python<'_>, all: Totals, walls: usize) -> PyResult<Bound<'_, PyAny>> {
    static CALL: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let Totals { duration, steps, collisions, virial, sides, walls: mut of_walls } = all;
    memory::resize(&mut of_walls, walls, [0.0; 2]).map_err(refused)?;
    let fields = (
        duration,
        steps,
        collisions.pairs,
        collisions.walls,
        table(py, virial.to_vec())?,
        table(py, of_walls)?,
        table(py, sides.to_vec())?,
    );
    CALL.import(py, "jostle.results", "LastCall")?.call1(fields)
}

/// The columns of `jostle.Nodes`.
pub struct NodeColumns {
    boxes: Vec<[f64; 4]>,
    levels: Vec<i64>,
    counts: Vec<i64>,
    is_leaf: Vec<bool>,
}

impl NodeColumns {
    /// Those of a tree. It is called without the GIL.
    pub fn of<T: Scalar>(tree: &jostle_index::Quadtree<T>) -> jostle_base::Result<Self> {
        let all = tree.boxes()?;
        Ok(Self {
            boxes: memory::collect(all.iter().map(|one| one.bounds))?,
            levels: memory::collect(all.iter().map(|one| one.depth as i64))?,
            counts: memory::collect(all.iter().map(|one| one.count as i64))?,
            is_leaf: memory::collect(all.iter().map(|one| one.is_leaf))?,
        })
    }

    /// `jostle.Nodes`.
    pub fn result(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        static NODES: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        let Self { boxes, levels, counts, is_leaf } = self;
        let fields =
            (table(py, boxes)?, column(py, levels), column(py, counts), column(py, is_leaf));
        NODES.import(py, "jostle.results", "Nodes")?.call1(fields)
    }
}

/// `jostle.Stats`.
pub fn stats(py: Python<'_>, all: jostle_world::Stats) -> PyResult<Bound<'_, PyAny>> {
    static STATS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let fields = (all.nodes, all.leaves, all.depth, all.tests);
    STATS.import(py, "jostle.results", "Stats")?.call1(fields)
}

/// Hits with 64-bit ids in place of others. It is called without the GIL.
pub fn with_long_ids<I: Into<i64>>(all: Hits<I>) -> jostle_base::Result<Hits<i64>> {
    let Hits { offsets, ids, tests } = all;
    if size_of::<I>() == size_of::<i64>() {
        // Converted in place.
        return Ok(Hits { offsets, ids: ids.into_iter().map(Into::into).collect(), tests });
    }
    let mut long = memory::with_capacity(ids.len())?;
    let mut pulse = Pulse::current();
    for id in ids {
        pulse.check(1)?;
        long.push(id.into());
    }
    Ok(Hits { offsets, ids: long, tests })
}

/// `jostle.IdLists`.
pub fn hits(py: Python<'_>, all: Hits<i64>) -> PyResult<Bound<'_, PyAny>> {
    static LISTS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let offsets = all.offsets.into_iter().map(|offset| offset as i64).collect();
    LISTS.import(py, "jostle.results", "IdLists")?.call1((column(py, all.ids), column(py, offsets)))
}

/// `jostle.Neighbors`; `shape` is that of the arrays for many points.
pub fn neighbors<T: Element>(
    py: Python<'_>,
    all: Neighbors<T>,
    shape: Option<(usize, usize)>,
) -> PyResult<Bound<'_, PyAny>> {
    static NEIGHBORS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let class = NEIGHBORS.import(py, "jostle.results", "Neighbors")?;
    match shape {
        None => class.call1((column(py, all.ids), column(py, all.distances))),
        Some(shape) => {
            class.call1((matrix(py, all.ids, shape)?, matrix(py, all.distances, shape)?))
        }
    }
}

/// `jostle.RayHit`.
pub fn ray_hit<'py, T: Element + Scalar>(
    py: Python<'py>,
    Casts { hits: all, walls }: &Casts<T>,
) -> PyResult<Bound<'py, PyAny>> {
    static RAY_HIT: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let [point, normal] = [all.points[0], all.normals[0]].map(|pair| column(py, pair.to_vec()));
    let fields = (all.ids[0], all.distances[0].to_f64(), point, normal, walls[0]);
    RAY_HIT.import(py, "jostle.results", "RayHit")?.call1(fields)
}

/// `jostle.RayHits`.
pub fn ray_hits<T: Element>(py: Python<'_>, all: Casts<T>) -> PyResult<Bound<'_, PyAny>> {
    static RAY_HITS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let Casts { hits: all, walls } = all;
    let (ids, distances) = (column(py, all.ids), column(py, all.distances));
    let (points, normals) = (table(py, all.points)?, table(py, all.normals)?);
    let fields = (ids, distances, points, normals, column(py, walls));
    RAY_HITS.import(py, "jostle.results", "RayHits")?.call1(fields)
}

/// `jostle.RayHitLists`.
pub fn ray_hit_lists<T: Element>(py: Python<'_>, all: Casts<T>) -> PyResult<Bound<'_, PyAny>> {
    static LISTS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let Casts { hits: all, walls } = all;
    let offsets = all.offsets.into_iter().map(|offset| offset as i64).collect();
    let (ids, distances) = (column(py, all.ids), column(py, all.distances));
    let (points, normals) = (table(py, all.points)?, table(py, all.normals)?);
    let fields = (ids, distances, points, normals, column(py, walls), column(py, offsets));
    LISTS.import(py, "jostle.results", "RayHitLists")?.call1(fields)
}

/// `jostle.Separated`.
pub fn separated<T: Element>(
    py: Python<'_>,
    all: jostle_separate::Separated<T>,
) -> PyResult<Bound<'_, PyAny>> {
    static SEPARATED: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let fields = (table(py, all.centers)?, all.rounds, all.overlaps);
    SEPARATED.import(py, "jostle.results", "Separated")?.call1(fields)
}

/// `jostle.Slides`.
pub fn slides<T: Element>(py: Python<'_>, all: Slides<T>) -> PyResult<Bound<'_, PyAny>> {
    static SLIDES: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let met = Hits { offsets: all.offsets, ids: all.ids, tests: 0 };
    let fields = (
        table(py, all.displacement)?,
        table(py, all.remaining)?,
        hits(py, met)?,
        table(py, all.normals)?,
        column(py, all.floor),
        table(py, all.platform_velocity)?,
        column(py, all.on_floor),
        column(py, all.on_wall),
        column(py, all.on_ceiling),
        column(py, all.crushed),
    );
    SLIDES.import(py, "jostle.results", "Slides")?.call1(fields)
}

/// `jostle.Slide`.
pub fn slide<T: Element + Copy>(py: Python<'_>, all: Slides<T>) -> PyResult<Bound<'_, PyAny>> {
    static SLIDE: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let fields = (
        column(py, all.displacement[0].to_vec()),
        column(py, all.remaining[0].to_vec()),
        column(py, all.ids),
        table(py, all.normals)?,
        all.floor[0],
        column(py, all.platform_velocity[0].to_vec()),
        all.on_floor[0],
        all.on_wall[0],
        all.on_ceiling[0],
        all.crushed[0],
    );
    SLIDE.import(py, "jostle.results", "Slide")?.call1(fields)
}

/// `jostle.scenes.GaltonBoard`.
pub fn galton_board(py: Python<'_>, all: GaltonBoard) -> PyResult<Bound<'_, PyAny>> {
    static GALTON_BOARD: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let GaltonBoard { rows, bin_edges, bin_top, floor, ball_radius } = all;
    let [bin_top, floor, ball_radius] = [bin_top, floor, ball_radius].map(decimal);
    let fields = (rows, column(py, bin_edges), bin_top, floor, ball_radius);
    GALTON_BOARD.import(py, "jostle.results", "GaltonBoard")?.call1(fields)
}
