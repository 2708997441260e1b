//! The Python binding: docstrings, signatures and calls of the core. Only `arrays` converts arrays
//! and numbers.

mod allocator;
mod error;
mod interrupt;
mod keywords;
mod lock;
mod files;
mod masked;
mod arrays;
mod settings;
mod shapes;
mod results;
mod queries;
mod query_methods;
mod ids;
mod communicator;
mod find_pairs;
mod separate;
mod quadtree;
mod slide;
mod space;
mod events;
mod sprites;
mod containers;
mod particles;
mod forces;
mod walls;
mod world;
mod scenes;

/// The compiled module of jostle; its contents are in `jostle`.
#[pyo3::pymodule]
mod _core {
    use pyo3::prelude::*;
    use pyo3::types::IntoPyDict;

    use super::scenes::{create, create_part, default_count, describe, galton_board, names, view};

    #[pymodule_export]
    use super::communicator::RankError;
    #[pymodule_export]
    use super::containers::{PyBox, PyCircle};
    #[pymodule_export]
    use super::events::{PyEvents, restore_events};
    #[pymodule_export]
    use super::find_pairs::find_pairs;
    #[pymodule_export]
    use super::forces::{
        PyAndersenThermostat, PyAttractor, PyFlocking, PyGrab, PyGravitation, PyMotor, PyPairForce,
        PyPump, PySprings, PyThermalWalls, PyThermostat,
    };
    #[pymodule_export]
    use super::quadtree::PyQuadtree;
    #[pymodule_export]
    use super::separate::separate;
    #[pymodule_export]
    use super::space::{PySpace, restore_space};
    #[pymodule_export]
    use super::sprites::{sprite_dict, sprite_pairs, sprite_sides};
    #[pymodule_export]
    use super::world::{
        PyWalls, PyWorld, begin_hash, checksum, hash_parts, hash_records, record_fields,
    };

    /// Lets small calls wake other threads. For tests.
    #[pyfunction]
    fn wake_threads_always(always: bool) {
        jostle_base::parallel::wake_always(always);
    }

    /// The vector instructions that searches and steps use on this processor: "AVX-512", "AVX2" or
    /// "baseline", those of every processor of the architecture. Results do not depend on them.
    #[pyfunction]
    fn instructions() -> &'static str {
        match jostle_simd::widest() {
            jostle_simd::Instructions::Avx512 => "AVX-512",
            jostle_simd::Instructions::Avx2 => "AVX2",
            jostle_simd::Instructions::Portable => "baseline",
        }
    }

    /// Abandons the threads of the parent process, which do not exist in a forked process.
    #[pyfunction]
    fn abandon_threads() {
        jostle_base::parallel::abandon_threads();
    }

    /// Adds the version, and the functions of `jostle.scenes`, which renames them.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        // 0.2.0-dev.0 is 0.2.0.dev0 in the metadata of the package.
        let version = env!("CARGO_PKG_VERSION").replace("-dev.", ".dev");
        module.add("__version__", version)?;
        module.add("scene_names", wrap_pyfunction!(names, module)?)?;
        module.add("describe_scene", wrap_pyfunction!(describe, module)?)?;
        module.add("create_scene", wrap_pyfunction!(create, module)?)?;
        module.add("create_scene_part", wrap_pyfunction!(create_part, module)?)?;
        module.add("scene_view", wrap_pyfunction!(view, module)?)?;
        module.add("scene_default_count", wrap_pyfunction!(default_count, module)?)?;
        module.add("scene_galton_board", wrap_pyfunction!(galton_board, module)?)?;
        // Imports NumPy's C API now: during a call, a signal could interrupt the import.
        numpy::PyArray1::<u8>::zeros(module.py(), 0, false);
        abandon_threads_after_fork(module)
    }

    /// Registers [`abandon_threads`] to run in forked processes, except on Windows, which has no
    /// fork.
    fn abandon_threads_after_fork(module: &Bound<'_, PyModule>) -> PyResult<()> {
        let os = module.py().import("os")?;
        if !os.hasattr("register_at_fork")? {
            return Ok(());
        }
        let hook = [("after_in_child", wrap_pyfunction!(abandon_threads, module)?)];
        os.call_method("register_at_fork", (), Some(&hook.into_py_dict(module.py())?))?;
        Ok(())
    }
}
