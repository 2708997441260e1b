//! The Python face of jostle: docstrings, signatures and calls. What is computed
//! is computed in the core; `arrays` is the only place that converts.

mod error;
mod arrays;
mod settings;
mod shapes;
mod results;
mod find_pairs;
mod quadtree;

/// The compiled part of jostle; `import jostle` has everything in it.
#[pyo3::pymodule]
mod _core {
    #[pymodule_export]
    use super::find_pairs::find_pairs;
    #[pymodule_export]
    use super::quadtree::PyQuadtree;

    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "Python's name for it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
