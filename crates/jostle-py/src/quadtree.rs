//! `jostle.Quadtree`.

use std::sync::atomic::{AtomicU64, Ordering};

use jostle::pairs::{self, Found};
use jostle::{Scalar, Settings, Stats};
use numpy::{Element, PyArray2};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::arrays::{Given, table, truth};
use crate::error::{refused, type_error};
use crate::results;
use crate::settings;
use crate::shapes::{Rows, Shapes};

/// A quadtree over shapes that do not change.
///
/// A shape is a rounded box: every point within `radius` of the axis-aligned box
/// ``center ± half_size``. Circles have no half size, rectangles no radius. The
/// tree is built once, around whatever positions it is given; there are no bounds
/// to choose. Several threads may ask it at the same time.
///
/// Parameters
/// ----------
/// centers : array_like, shape (n, 2)
///     Centres, in any unit of length.
/// radii : array_like, a number or shape (n,), default 0.0
///     Radii, in the same unit.
/// half_sizes : array_like, a number, shape (2,) or (n, 2), optional
///     Half widths and half heights. Left out, every shape is a circle.
/// categories : array_like of int, a number or shape (n,), optional
///     What each shape is, as a set of 32 bits; 1 where left out.
/// masks : array_like of int, a number or shape (n,), optional
///     What each shape may pair with, as a set of 32 bits; all of them where left
///     out. Shapes i and j may pair only if both ``categories[i] & masks[j]`` and
///     ``categories[j] & masks[i]`` have a bit.
/// leaf_capacity : int, default 96
///     Shapes that a box may hold before it splits into four.
/// max_depth : int, default 4096
///     Subdivisions allowed: 0 keeps everything in one box, 2 allows two. The
///     default never stops a split.
/// threads : int, optional
///     How many threads work; one for each core unless given. Every answer is
///     the same for every number.
///
/// Raises
/// ------
/// TypeError
///     If an argument does not hold numbers.
/// ValueError
///     If a shape is wrong, a value is not finite, a size is negative, or a
///     setting is out of range.
///
/// Notes
/// -----
/// Arithmetic is float32 if every array given is float32, else float64. A plain
/// number, or a plain pair of half sizes, takes the precision of the arrays
/// beside it.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> tree = jostle.Quadtree([(0, 0), (3, 0), (4, 0)], radii=1.0)
/// >>> tree.pairs()
/// array([[1, 2]], dtype=uint32)
/// >>> tree.stats
/// Stats(nodes=1, leaves=1, depth=0, tests=3)
#[pyclass(module = "jostle", name = "Quadtree", frozen)]
pub struct PyQuadtree {
    tree: Tree,
    /// Pairs tested by the last call.
    tests: AtomicU64,
}

/// The core's tree, in the precision of its shapes.
enum Tree {
    Single(jostle::Quadtree<f32>),
    Double(jostle::Quadtree<f64>),
}

/// Runs the same expression for either precision.
macro_rules! with_tree {
    ($tree:expr, $name:ident => $do:expr) => {
        match $tree {
            Tree::Single($name) => $do,
            Tree::Double($name) => $do,
        }
    };
}

impl Tree {
    fn build(shapes: Shapes, settings: Settings) -> jostle::Result<Self> {
        Ok(match shapes {
            Shapes::Single(rows) => Self::Single(build(rows, settings)?),
            Shapes::Double(rows) => Self::Double(build(rows, settings)?),
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
) -> jostle::Result<jostle::Quadtree<T>> {
    jostle::Quadtree::new(&rows.checked()?, settings)
}

#[pymethods]
impl PyQuadtree {
    #[new]
    #[pyo3(
        signature = (
            centers, radii=Given::NOTHING, half_sizes=None, *, categories=None, masks=None,
            leaf_capacity=Given::NOTHING, max_depth=Given::NOTHING, threads=None,
        ),
        text_signature = "(centers, radii=0.0, half_sizes=None, *, categories=None, masks=None, \
                          leaf_capacity=96, max_depth=4096, threads=None)"
    )]
    #[expect(clippy::too_many_arguments, reason = "they are Python's keywords")]
    fn new<'py>(
        py: Python<'py>,
        centers: &Bound<'py, PyAny>,
        radii: Given<'py>,
        half_sizes: Option<&Bound<'py, PyAny>>,
        categories: Option<&Bound<'py, PyAny>>,
        masks: Option<&Bound<'py, PyAny>>,
        leaf_capacity: Given<'py>,
        max_depth: Given<'py>,
        threads: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Self> {
        let settings = settings::tree(&leaf_capacity, &max_depth, threads)?;
        let shapes = Shapes::read(centers, &radii, half_sizes, categories, masks)?;
        let tree = py.detach(|| Tree::build(shapes, settings)).map_err(refused)?;
        Ok(Self { tree, tests: AtomicU64::new(0) })
    }

    /// Find every pair of overlapping shapes in this tree, or between it and another.
    ///
    /// Parameters
    /// ----------
    /// other : Quadtree, optional
    ///     A tree of the same dtype. Left out, the pairs are those within this tree.
    /// sort : bool, default False
    ///     Whether to sort the pairs by first, then by second shape. Without, they
    ///     come in the order of this tree, the same for every number of threads.
    /// max_pairs : int, default 134217728
    ///     The most pairs to return; the default is a gibibyte of them.
    ///
    /// Returns
    /// -------
    /// ndarray of uint32, shape (m, 2)
    ///     Row numbers ``i < j`` of each pair, every pair once; with `other`, i is
    ///     a row of this tree and j a row of the other.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If the other tree computes in another precision.
    /// ValueError
    ///     If more than `max_pairs` pairs overlap.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> rocks = jostle.Quadtree([(0, 0), (3, 0), (4, 0)], radii=1.0)
    /// >>> shots = jostle.Quadtree([(0.5, 0), (9, 0)], radii=0.1)
    /// >>> rocks.pairs(shots)
    /// array([[0, 0]], dtype=uint32)
    #[pyo3(
        signature = (other=None, *, sort=Given::NOTHING, max_pairs=Given::NOTHING),
        text_signature = "($self, other=None, *, sort=False, max_pairs=134217728)"
    )]
    fn pairs<'py>(
        &self,
        py: Python<'py>,
        other: Option<&Bound<'py, PyAny>>,
        sort: Given<'py>,
        max_pairs: Given<'py>,
    ) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let (sort, max_pairs) = (truth("sort", &sort)?, settings::max_pairs(&max_pairs)?);
        let other = other.map(|other| self.partner(other)).transpose()?;
        let found = py.detach(|| {
            let mut found = match other {
                None => with_tree!(&self.tree, tree => pairs::within(tree, max_pairs)),
                Some(other) => between(&self.tree, &other.get().tree, max_pairs),
            }?;
            if sort {
                found.sort();
            }
            Ok(found)
        });
        let found = found.map_err(refused)?;
        self.tests.store(found.tests, Ordering::Relaxed);
        table(py, found.pairs)
    }

    /// Find every pair of overlapping shapes, and how each overlaps.
    ///
    /// Parameters
    /// ----------
    /// max_pairs : int, default 134217728
    ///     The most pairs to return.
    ///
    /// Returns
    /// -------
    /// Contacts
    ///     pairs : ndarray of uint32, shape (m, 2)
    ///         As :meth:`pairs` gives them, in the order of the tree.
    ///     normals : ndarray of the tree's dtype, shape (m, 2)
    ///         Unit vectors from i to j. Where the boxes inside the shapes overlap, the
    ///         axis along which the way out is shortest; +x for coincident centres.
    ///     depths : ndarray of the tree's dtype, shape (m,)
    ///         How far j has to move along the normal until the two only touch.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If more than `max_pairs` pairs overlap.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> tree = jostle.Quadtree([(0, 0), (0, 1.5)], radii=1.0)
    /// >>> tree.contacts()
    /// Contacts(pairs=array([[0, 1]], dtype=uint32), normals=array([[0., 1.]]), depths=array([0.5]))
    #[pyo3(
        signature = (*, max_pairs=Given::NOTHING),
        text_signature = "($self, *, max_pairs=134217728)"
    )]
    fn contacts<'py>(&self, py: Python<'py>, max_pairs: Given<'py>) -> PyResult<Bound<'py, PyAny>> {
        let max_pairs = settings::max_pairs(&max_pairs)?;
        with_tree!(&self.tree, tree => {
            let found = py.detach(|| pairs::overlaps(tree, max_pairs)).map_err(refused)?;
            self.tests.store(found.tests, Ordering::Relaxed);
            results::contacts(py, found)
        })
    }

    /// Look at the boxes of the tree.
    ///
    /// Returns
    /// -------
    /// Nodes
    ///     boxes : ndarray of float64, shape (k, 4)
    ///         min_x, min_y, max_x, max_y of each box. It holds the centres of its
    ///         shapes; a shape may reach over its border. Quarters without a shape
    ///         are left out, and so are subdivisions that would part nothing.
    ///     depths : ndarray of uint32, shape (k,)
    ///         Subdivisions above each box.
    ///     counts : ndarray of uint32, shape (k,)
    ///         Shapes in each box and all below it.
    ///     is_leaf : ndarray of bool, shape (k,)
    ///         Whether the box did not split.
    ///
    ///     Parents stand before their children; the first box is the root. A tree
    ///     without shapes has no boxes.
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
        with_tree!(&self.tree, tree => results::nodes(py, tree))
    }

    /// What the tree looks like and how much work its last answer was.
    ///
    /// A `Stats` of four integers: `nodes` (boxes), `leaves` (boxes that did not
    /// split), `depth` (subdivisions above the deepest box) and `tests` (pairs of
    /// shapes tested by the last call of `pairs` or `contacts`; 0 before the first).
    #[getter]
    fn stats<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let tests = self.tests.load(Ordering::Relaxed);
        let stats = with_tree!(&self.tree, tree => Stats {
            nodes: tree.nodes().len(),
            leaves: tree.leaf_count(),
            depth: tree.depth(),
            tests,
        });
        results::stats(py, stats)
    }

    fn __len__(&self) -> usize {
        with_tree!(&self.tree, tree => tree.len())
    }

    fn __repr__(&self) -> String {
        format!("<jostle.Quadtree of {} shapes, {}>", self.__len__(), self.tree.dtype())
    }
}

impl PyQuadtree {
    /// The other tree of a pair, if it computes as this one does.
    fn partner(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<Self>> {
        let Ok(tree) = other.cast::<Self>() else {
            return Err(type_error("other", "a Quadtree", other));
        };
        let (own, found) = (self.tree.dtype(), tree.get().tree.dtype());
        if own == found {
            return Ok(tree.clone().unbind());
        }
        let rule = format!("other is {found} and this tree {own}; build both with the same dtype");
        Err(PyTypeError::new_err(rule))
    }
}

fn between(a: &Tree, b: &Tree, max_pairs: usize) -> jostle::Result<Found> {
    match (a, b) {
        (Tree::Single(a), Tree::Single(b)) => pairs::between(a, b, max_pairs),
        (Tree::Double(a), Tree::Double(b)) => pairs::between(a, b, max_pairs),
        // Refused before.
        _ => Ok(Found::default()),
    }
}
