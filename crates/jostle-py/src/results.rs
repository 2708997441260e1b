//! Answers of several arrays, as the named tuples of `jostle.results`.

use jostle::Scalar;
use jostle::pairs::Overlaps;
use numpy::Element;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

use crate::arrays::{column, table};

/// `jostle.Contacts`.
pub fn contacts<T: Element>(py: Python<'_>, all: Overlaps<T>) -> PyResult<Bound<'_, PyAny>> {
    static CONTACTS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let fields = (table(py, all.pairs)?, table(py, all.normals)?, column(py, all.depths));
    CONTACTS.import(py, "jostle.results", "Contacts")?.call1(fields)
}

/// `jostle.Nodes`.
pub fn nodes<'py, T: Scalar>(
    py: Python<'py>,
    tree: &jostle::Quadtree<T>,
) -> PyResult<Bound<'py, PyAny>> {
    static NODES: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let all = tree.nodes();
    let fields = (
        table(py, tree.cells())?,
        column(py, all.iter().map(|node| u32::from(node.depth)).collect()),
        column(py, all.iter().map(|node| node.len() as u32).collect()),
        column(py, all.iter().map(jostle::Node::is_leaf).collect()),
    );
    NODES.import(py, "jostle.results", "Nodes")?.call1(fields)
}

/// `jostle.Stats`.
pub fn stats(py: Python<'_>, all: jostle::Stats) -> PyResult<Bound<'_, PyAny>> {
    static STATS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let fields = (all.nodes, all.leaves, all.depth, all.tests);
    STATS.import(py, "jostle.results", "Stats")?.call1(fields)
}
