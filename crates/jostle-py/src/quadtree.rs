//! `jostle.Quadtree`.

/// Runs the same expression for either precision.
macro_rules! with_tree {
    ($tree:expr, $name:ident => $do:expr) => {
        match $tree {
            Tree::Single($name) => $do,
            Tree::Double($name) => $do,
        }
    };
}

mod columns;
mod pairs;

use std::sync::atomic::{AtomicU64, Ordering};

use jostle_base::Settings;
use jostle_index::{Period, Scalar};
use jostle_world::Stats;
use numpy::Element;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::{Given, number};
use crate::error::refused;
use crate::interrupt::detached;
use crate::keywords::Keywords;
use crate::queries::{self, Cast, Maybe};
use crate::query_methods::{CountedTree, Index, NeighborIndex, query_methods};
use crate::results;
use crate::settings;
use crate::shapes::{Rows, Shapes};

/// A quadtree over shapes that do not change.
///
/// A shape is every point within `radius` of its core: the axis-aligned box ``center ± half_size``,
/// one of `boxes`, or one of `segments`. A circle has half size 0, a rectangle radius 0. The
/// tree is built once, for any positions; there are no bounds to choose. Several threads may
/// query it at the same time.
///
/// Parameters
/// ----------
/// positions : array_like, shape (n, 2), optional
///     Centres, in any unit of length; required unless `boxes` or `segments` are given.
/// radii : array_like, a number or shape (n,), default 0.0
///     Radii, in the same unit.
/// half_sizes : array_like, a number, shape (2,) or (n, 2), optional
///     Half widths and half heights. If omitted, every shape is a circle.
/// boxes : array_like, shape (n, 4), optional
///     Sides min_x, min_y, max_x, max_y of each shape, in place of `positions` and `half_sizes`.
///     Objects with the attributes `left`, `top`, `right` and `bottom`, such as pygame's Rect,
///     are accepted in a list or a tuple, but not in an array, which NumPy fills with x, y,
///     width and height. The four numbers are compared without rounding:
///     boxes that share an edge never overlap, whereas sides computed as
///     ``center ± half_size`` are rounded. With `radii`, the shapes are rounded boxes.
/// segments : array_like, shape (n, 2, 2), optional
///     Start and end of each shape, in place of `positions` and `half_sizes`: line segments, or
///     capsules with `radii`. Segments that cross overlap; those that share an end, or lie on one
///     line, do not. With a period the ends are at most one period apart along each axis.
/// categories : array_like of int, a number or shape (n,), optional
///     Categories of each shape, as a set of 32 bits; 1 if omitted.
/// masks : array_like of int, a number or shape (n,), optional
///     Categories each shape may pair with, as a set of 32 bits; all of them if
///     omitted. Shapes i and j may pair only if both ``categories[i] & masks[j]`` and
///     ``categories[j] & masks[i]`` are not 0. A negative integer stands for its low 32
///     bits, so ``masks=~SHIP`` is every category except SHIP. For a uint8 or uint16 array, ``~``
///     sets no bits above the 8th or 16th.
/// period : float or (float, float), optional
///     Width and height of a periodic plane, one number for both; 0 or None on an axis that is
///     not periodic. Centres are moved into ``[0, period)``; positions that differ by a multiple of
///     the period are equal in every method, and each shape is found once.
/// leaf_capacity : int, default 96
///     Shapes that a box may hold before it splits into four.
/// max_depth : int, default 4096
///     Maximum number of subdivisions: with 0 there is one box, with 2 there are two levels
///     below it. The default never prevents a split.
/// threads : int, optional
///     Number of threads, at most one for each core, which is the default. Every answer is
///     the same for every number.
///
/// Raises
/// ------
/// TypeError
///     If an argument does not hold numbers, or if not exactly one of `positions`, `boxes`
///     and `segments` is given.
/// ValueError
///     If a shape is wrong, a value is not finite, or a size or a setting is out of range.
///
/// See Also
/// --------
/// find_pairs : The pairs alone, in one call.
/// Space : Shapes that are added, moved and removed.
/// World.pairs : Queries of particles.
///
/// Notes
/// -----
/// Arithmetic is float32 if every given array is float32, otherwise float64; lists of numbers
/// count as float64. A plain number, or a plain pair of half sizes, takes the precision of the
/// given arrays.
///
/// Centres may be anywhere. A radius is 0, or between 1e-18 and 1e18 in float32 and between
/// 1e-150 and 1e150 in float64: squares of other numbers overflow or lose digits. A half size
/// is at most an eighth of the largest number of the type, a box at most twice as wide and
/// high as that.
///
/// References
/// ----------
/// H. Samet, *Foundations of Multidimensional and Metric Data Structures* (2006), chapter 1.4.
/// T. Karras, *Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees*, High
/// Performance Graphics (2012).
///
/// Examples
/// --------
/// >>> import jostle
/// >>> tree = jostle.Quadtree([(0, 0), (3, 0), (4, 0)], radii=1.0)
/// >>> tree.pairs()
/// array([[1, 2]])
/// >>> tree.stats
/// Stats(nodes=1, leaves=1, depth=0, tests=3)
#[pyclass(module = "jostle", name = "Quadtree", frozen)]
pub struct PyQuadtree {
    tree: Tree,
    /// Shapes tested by the last query.
    tests: AtomicU64,
}

/// The core's tree, in the precision of its shapes.
enum Tree {
    Single(jostle_index::Quadtree<f32>),
    Double(jostle_index::Quadtree<f64>),
}

/// [`with_tree!`] with the tree as the [`Index`] of queries.
macro_rules! with_counted_tree {
    ($self:ident, $name:ident => $do:expr) => {
        with_tree!(&$self.tree, tree => {
            let $name = &CountedTree { tree, tests: &$self.tests };
            $do
        })
    };
}

query_methods!(PyQuadtree, with_counted_tree);

impl Tree {
    fn build(shapes: Shapes, settings: Settings, period: Period<f64>) -> jostle_base::Result<Self> {
        Ok(match shapes {
            Shapes::Single(rows) => Self::Single(build(rows, settings, period)?),
            Shapes::Double(rows) => Self::Double(build(rows, settings, period)?),
        })
    }

    fn dtype(&self) -> &'static str {
        match self {
            Self::Single(_) => "float32",
            Self::Double(_) => "float64",
        }
    }
}

fn build<T: Scalar + Element>(
    rows: Rows<T>,
    settings: Settings,
    period: Period<f64>,
) -> jostle_base::Result<jostle_index::Quadtree<T>> {
    jostle_index::Quadtree::new(&rows.checked()?.in_period(settings::period_in(period)?)?, settings)
}

#[pymethods]
impl PyQuadtree {
    #[new]
    #[pyo3(
        signature = (*arguments, **keywords),
        text_signature = "(positions=None, radii=0.0, half_sizes=None, *, boxes=None, \
                          segments=None, categories=None, masks=None, period=None, leaf_capacity=96, \
                          max_depth=4096, threads=None)"
    )]
    fn new<'py>(
        py: Python<'py>,
        arguments: &Bound<'py, PyTuple>,
        keywords: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Self> {
        let names = ["positions", "radii", "half_sizes"];
        let mut given = Keywords::of_all("Quadtree()", &names, arguments, keywords)?;
        let places = given.take_all(["positions", "half_sizes", "boxes", "segments"]);
        let (radii, filters) = (given.given("radii"), given.take_all(["categories", "masks"]));
        let (settings, period) = settings::index(&mut given)?;
        given.end()?;
        let shapes = Shapes::read(
            places.each_ref().map(Option::as_ref),
            &radii,
            filters.each_ref().map(Option::as_ref),
        )?;
        let tree = detached(py, || Tree::build(shapes, settings, period))?.map_err(refused)?;
        Ok(Self { tree, tests: AtomicU64::new(0) })
    }

    /// Return the boxes of the tree.
    ///
    /// Returns
    /// -------
    /// Nodes
    ///     Four arrays:
    ///
    ///     boxes : ndarray of float64, shape (k, 4)
    ///         min_x, min_y, max_x, max_y of each box. It contains the centres of its
    ///         shapes; a shape may extend beyond it. Quarters without shapes
    ///         are omitted, and so are subdivisions that would separate nothing:
    ///         coincident shapes are in one box, whatever their number.
    ///     levels : ndarray of int64, shape (k,)
    ///         Subdivisions above each box.
    ///     counts : ndarray of int64, shape (k,)
    ///         Shapes in each box and its descendants.
    ///     is_leaf : ndarray of bool, shape (k,)
    ///         Whether the box did not split.
    ///
    ///     Parents precede their children; the first box is the root. A tree
    ///     without shapes has no boxes.
    ///
    /// See Also
    /// --------
    /// stats : The number of boxes and their depth.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> tree = jostle.Quadtree([(0, 0), (1, 1), (7, 7)], leaf_capacity=2)
    /// >>> tree.nodes().boxes
    /// array([[0., 0., 8., 8.],
    ///        [0., 0., 4., 4.],
    ///        [4., 4., 8., 8.]])
    fn nodes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let nodes =
            detached(py, || with_tree!(&self.tree, tree => results::NodeColumns::of(tree)))?;
        nodes.map_err(refused)?.result(py)
    }

    /// Size of the tree and number of tests of the last query.
    ///
    /// A `Stats` of four integers: `nodes` (boxes), `leaves` (boxes that did not
    /// split), `depth` (subdivisions above the deepest box) and `tests` (shapes that
    /// the last query tested, against another shape or against the query; 0 before
    /// the first query).
    ///
    /// See Also
    /// --------
    /// nodes : The boxes.
    #[getter]
    fn stats<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        // Relaxed: a number for statistics; no other memory depends on it.
        let tests = self.tests.load(Ordering::Relaxed);
        let boxes = detached(py, || with_tree!(&self.tree, tree => tree.count_boxes()))?;
        let [nodes, leaves, depth] = boxes.map_err(refused)?;
        results::stats(py, Stats { nodes, leaves, depth, tests, ..Stats::default() })
    }

    /// Width and height of the period: a tuple of two floats, 0 on an axis that is not periodic.
    #[getter]
    fn period(&self) -> (f64, f64) {
        self.sides()
    }

    /// The precision of its arithmetic: "float32" or "float64".
    #[getter]
    fn dtype(&self) -> &'static str {
        self.tree.dtype()
    }

    /// The arguments with which pickle and copy build the same tree.
    fn __getnewargs_ex__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyTuple>, Bound<'py, PyDict>)> {
        let (kwargs, settings) = (PyDict::new(py), with_tree!(&self.tree, tree => tree.settings()));
        let has_boxes = with_tree!(&self.tree, tree => tree.columns().has_boxes());
        // All shapes of a tree are given alike.
        let has_segments = with_tree!(&self.tree, tree => tree.columns().has_cores());
        if has_segments {
            kwargs.set_item("segments", self.segments(py)?)?;
        } else if has_boxes {
            kwargs.set_item("boxes", self.boxes(py)?)?;
        } else {
            kwargs.set_item("positions", self.positions(py)?)?;
            if with_tree!(&self.tree, tree => tree.columns().has_half_sizes()) {
                kwargs.set_item("half_sizes", self.half_sizes(py)?)?;
            }
        }
        kwargs.set_item("radii", self.radii(py)?)?;
        if with_tree!(&self.tree, tree => tree.columns().has_filters()) {
            kwargs.set_item("categories", self.categories(py)?)?;
            kwargs.set_item("masks", self.masks(py)?)?;
        }
        kwargs.set_item("period", self.sides())?;
        kwargs.set_item("leaf_capacity", settings.leaf_capacity)?;
        kwargs.set_item("max_depth", settings.max_depth)?;
        kwargs.set_item("threads", settings.threads)?;
        Ok((PyTuple::empty(py), kwargs))
    }

    fn __len__(&self) -> usize {
        with_tree!(&self.tree, tree => tree.len())
    }

    fn __repr__(&self) -> String {
        format!("<jostle.Quadtree of {} shapes, {}>", self.__len__(), self.tree.dtype())
    }
}

impl PyQuadtree {
    /// Width and height of the period; 0 on an axis that is not periodic.
    fn sides(&self) -> (f64, f64) {
        let [x, y] = with_tree!(&self.tree, tree => tree.period().sides().map(Scalar::to_f64));
        (x, y)
    }
}
