//! The columns of a tree as arrays.

use jostle_base::memory;
use jostle_index::{Scalar, Shape};
use numpy::Element;
use pyo3::prelude::*;

use super::{PyQuadtree, Tree};
use crate::arrays::{column, segments, table};
use crate::error::refused;
use crate::interrupt::detached;

#[pymethods]
impl PyQuadtree {
    /// Centres, ``(min + max) / 2`` for shapes given as boxes: ndarray of the tree's dtype, shape
    /// (n, 2), a copy. With a period they are in ``[0, period)``.
    #[getter]
    pub(super) fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        with_tree!(&self.tree, tree => table_of(py, tree, |shape| shape.center()))
    }

    /// Radii: ndarray of the tree's dtype, shape (n,), a copy.
    #[getter]
    pub(super) fn radii<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        with_tree!(&self.tree, tree => {
            Ok(column(py, read(py, tree, |shape| shape.radius)?).into_any())
        })
    }

    /// Half widths and half heights: ndarray of the tree's dtype, shape (n, 2), a copy; 0 for
    /// circles, ``(max - min) / 2`` for shapes given as boxes.
    #[getter]
    pub(super) fn half_sizes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        with_tree!(&self.tree, tree => table_of(py, tree, |shape| shape.core_half_size()))
    }

    /// The sides of the shapes without their radii: ndarray of the tree's dtype, shape (n, 4), a copy.
    ///
    /// They are min_x, min_y, max_x, max_y as they were given, or ``center ± half_size``.
    #[getter]
    pub(super) fn boxes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        with_tree!(&self.tree, tree => table_of(py, tree, |shape| shape.sides()))
    }

    /// Start and end of the segments: ndarray of the tree's dtype, shape (n, 2, 2), a copy; NaN for
    /// shapes that are none. With a period their centres are in ``[0, period)``.
    #[getter]
    pub(super) fn segments<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        with_tree!(&self.tree, tree => {
            let ends = read(py, tree, |shape| shape.segment().unwrap_or([[Scalar::NAN; 2]; 2]))?;
            Ok(segments(py, &ends)?.into_any())
        })
    }

    /// Categories: ndarray of uint32, shape (n,), a copy.
    #[getter]
    pub(super) fn categories<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        with_tree!(&self.tree, tree => {
            Ok(column(py, read(py, tree, |shape| shape.category)?).into_any())
        })
    }

    /// Masks: ndarray of uint32, shape (n,), a copy.
    #[getter]
    pub(super) fn masks<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        with_tree!(&self.tree, tree => {
            Ok(column(py, read(py, tree, |shape| shape.mask)?).into_any())
        })
    }
}

/// A value of each shape, in the order of the rows.
fn read<T: Scalar, V: Clone + Default + Send>(
    py: Python<'_>,
    tree: &jostle_index::Quadtree<T>,
    of: impl Fn(Shape<T>) -> V + Send,
) -> PyResult<Vec<V>> {
    detached(py, move || {
        let mut values = memory::filled(tree.len(), V::default())?;
        for (index, &row) in tree.rows().iter().enumerate() {
            values[row as usize] = of(tree.columns().shape(index));
        }
        Ok(values)
    })?
    .map_err(refused)
}

fn table_of<'py, T: Scalar + Element, const W: usize>(
    py: Python<'py>,
    tree: &jostle_index::Quadtree<T>,
    of: impl Fn(Shape<T>) -> [T; W] + Send,
) -> PyResult<Bound<'py, PyAny>>
where
    [T; W]: Default,
{
    Ok(table(py, read(py, tree, of)?)?.into_any())
}
