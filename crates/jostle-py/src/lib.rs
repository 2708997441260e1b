//! The Python face of jostle: docstrings, signatures and calls. What is computed
//! is computed in the core; `arrays` is the only place that converts.

mod error;
mod arrays;
mod settings;
mod shapes;
mod results;
mod find_pairs;
mod quadtree;
mod containers;
mod particles;
mod world;
mod scenes;

/// The compiled part of jostle; `import jostle` has everything in it.
#[pyo3::pymodule]
mod _core {
    use pyo3::prelude::*;

    use super::scenes::{create, describe, names, view};

    #[pymodule_export]
    use super::containers::{PyBox, PyCircle, PyTorus};
    #[pymodule_export]
    use super::find_pairs::find_pairs;
    #[pymodule_export]
    use super::quadtree::PyQuadtree;
    #[pymodule_export]
    use super::world::PyWorld;

    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "Python's name for it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");

    /// Behind `jostle.scenes`, which gives them their names.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("scene_names", wrap_pyfunction!(names, module)?)?;
        module.add("describe_scene", wrap_pyfunction!(describe, module)?)?;
        module.add("create_scene", wrap_pyfunction!(create, module)?)?;
        module.add("scene_view", wrap_pyfunction!(view, module)?)
    }
}
