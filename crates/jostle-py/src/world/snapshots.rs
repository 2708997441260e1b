//! Snapshots, files and pickles.

use std::path::Path;

use jostle_base::Error;
use jostle_world::ranks;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes, PyMemoryView, PyString, PyType};

use super::PyWorld;
use crate::error::{refused, type_error};
use crate::files::{self, FilePath};

#[pymethods]
impl PyWorld {
    /// Return the whole state of the world in bytes.
    ///
    /// Returns
    /// -------
    /// bytes
    ///     Particles, settings, forces, the time, the resting contacts, and the `attachment`, the same
    ///     bytes on every machine. A world that `restore` makes from them continues with the same bits.
    ///
    /// See Also
    /// --------
    /// restore : Makes a world from the bytes.
    /// save : Writes them into a file.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.World([(0, 0)], 1.0, velocities=[(1, 0)])
    /// >>> before = world.snapshot()
    /// >>> world.step(0.5, steps=4)
    /// >>> world.time, jostle.World.restore(before).time
    /// (2.0, 0.0)
    fn snapshot<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = self.long(py, |state| state.world.snapshot())?.map_err(refused)?;
        PyBytes::new_with(py, bytes.len(), |to| {
            py.detach(|| to.copy_from_slice(&bytes));
            Ok(())
        })
    }

    /// Make a world from the bytes of `snapshot`.
    ///
    /// Parameters
    /// ----------
    /// data : bytes, bytearray or memoryview
    ///     The bytes.
    ///
    /// Returns
    /// -------
    /// World
    ///     A world that continues with the same bits.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If `data` is not bytes.
    /// ValueError
    ///     If they are not from `snapshot`, or are truncated or damaged.
    ///
    /// See Also
    /// --------
    /// snapshot : Returns the bytes.
    ///
    /// Examples
    /// --------
    /// >>> import jostle
    /// >>> world = jostle.scenes.create("gas", n=100)
    /// >>> copy = jostle.World.restore(world.snapshot())
    /// >>> world.step(0.01, steps=50); copy.step(0.01, steps=50)
    /// >>> copy.state_hash() == world.state_hash()
    /// True
    #[classmethod]
    fn restore(_class: &Bound<'_, PyType>, data: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = data.py();
        let bytes = if let Ok(bytes) = data.cast::<PyBytes>() {
            bytes.clone()
        } else if data.is_instance_of::<PyByteArray>() || data.is_instance_of::<PyMemoryView>() {
            py.get_type::<PyBytes>().call1((data,))?.cast_into()?
        } else {
            return Err(type_error("data", "bytes", data));
        };
        let bytes = bytes.as_bytes();
        Ok(Self::of(py.detach(|| ranks::restore(bytes)).map_err(refused)?))
    }

    /// A text that the world keeps and does not read: str, or None, the default. It may be assigned.
    ///
    /// Programs keep their own settings there, as JSON. Snapshots, files, copies and pickles contain
    /// it; the motion and `state_hash` do not depend on it.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If an assigned value is neither str nor None.
    ///
    /// See Also
    /// --------
    /// save : Writes it into a file, with the world.
    ///
    /// Examples
    /// --------
    /// >>> import jostle, json
    /// >>> world = jostle.World([(0, 0)], 1.0, velocities=[(1, 0)])
    /// >>> world.attachment = json.dumps({"zoom": 2.5})
    /// >>> json.loads(jostle.World.restore(world.snapshot()).attachment)
    /// {'zoom': 2.5}
    #[getter]
    fn attachment<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyString>>> {
        let state = self.state(py)?;
        Ok(state.world.attachment().map(|text| PyString::new(py, text)))
    }

    #[setter]
    fn set_attachment(&self, py: Python<'_>, value: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let text = value.map(|value| match value.cast::<PyString>() {
            Ok(text) => Ok(text.to_str()?.to_owned()),
            Err(_) => Err(type_error("attachment", "str or None", value)),
        });
        self.state(py)?.world.set_attachment(text.transpose()?);
        Ok(())
    }

    /// Write the world into a file.
    ///
    /// Parameters
    /// ----------
    /// path : str, bytes or os.PathLike
    ///     An existing file is replaced when the new one is complete; it keeps its
    ///     permissions. If the path is a symbolic link, its target is replaced.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     If the file cannot be written; then an existing one is unchanged.
    ///
    /// See Also
    /// --------
    /// load : Reads the file.
    /// snapshot : The same in memory.
    ///
    /// Examples
    /// --------
    /// >>> import jostle, os, tempfile
    /// >>> path = os.path.join(tempfile.mkdtemp(), "gas.jostle")
    /// >>> jostle.scenes.create("gas", n=100).save(path)
    /// >>> len(jostle.World.load(path))
    /// 100
    fn save(&self, py: Python<'_>, path: FilePath) -> PyResult<()> {
        let bytes = self.long(py, |state| state.world.snapshot())?.map_err(refused)?;
        files::replace(py, &path.0, &bytes)
    }

    /// Read a world from a file that `save` has written.
    ///
    /// Parameters
    /// ----------
    /// path : str, bytes or os.PathLike
    ///     The file.
    ///
    /// Returns
    /// -------
    /// World
    ///     A world that continues with the same bits.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     If the file cannot be read.
    /// ValueError
    ///     If it does not contain a world, or is truncated or damaged; the message names the
    ///     file.
    ///
    /// See Also
    /// --------
    /// save : Writes the file.
    ///
    /// Examples
    /// --------
    /// >>> import jostle, os, tempfile
    /// >>> path = os.path.join(tempfile.mkdtemp(), "pile.jostle")
    /// >>> jostle.scenes.create("pile", n=50).save(path)
    /// >>> jostle.World.load(path)
    /// <jostle.World of 50 particles after 0.000 s>
    #[classmethod]
    fn load(class: &Bound<'_, PyType>, path: FilePath) -> PyResult<Self> {
        let (py, path) = (class.py(), path.0);
        let bytes = files::read(py, &path, |head, size| {
            ranks::check_head(head, size).map_err(|error| in_file(&path, &error))
        })?;
        let world = py.detach(|| ranks::restore(&bytes));
        Ok(Self::of(world.map_err(|error| in_file(&path, &error))?))
    }

    /// Copies and pickles use snapshots.
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        Ok((py.get_type::<Self>().getattr("restore")?, (self.snapshot(py)?,)))
    }
}

/// An error about a file of a world.
fn in_file(path: &Path, error: &Error) -> PyErr {
    let found = match error {
        Error::Value { value, rule, .. } | Error::MissingId { value, rule, .. } => {
            format!("{value}; {rule}")
        }
        other => other.to_string(),
    };
    PyValueError::new_err(format!("{} holds {found}", path.display()))
}
