//! Bytes in files: whole ones, or the old ones.

use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

/// Reads a file.
pub fn read(py: Python<'_>, path: &Path) -> PyResult<Vec<u8>> {
    py.detach(|| fs::read(path)).map_err(|error| os_error(py, &error, path))
}

/// Replaces a file, or leaves it as it was: the bytes go into a new file beside it, which
/// then takes its name.
pub fn replace(py: Python<'_>, path: &Path, bytes: &[u8]) -> PyResult<()> {
    let done = py.detach(|| {
        let (mut file, temporary) = create_beside(path)?;
        let written = file.write_all(bytes).and_then(|()| file.sync_all());
        drop(file);
        let renamed = written.and_then(|()| fs::rename(&temporary, path));
        if renamed.is_err() {
            // What went wrong first is what the caller wants to hear of.
            let _ = fs::remove_file(&temporary);
        }
        renamed
    });
    done.map_err(|error| os_error(py, &error, path))
}

/// A new file in the same folder.
fn create_beside(path: &Path) -> io::Result<(fs::File, PathBuf)> {
    let mut number = 0;
    loop {
        let mut name = path.as_os_str().to_owned();
        name.push(format!(".{number}.part"));
        match OpenOptions::new().write(true).create_new(true).open(&name) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => number += 1,
            found => return found.map(|file| (file, name.into())),
        }
    }
}

/// Python's own exception: its class follows from the number of the error.
fn os_error(py: Python<'_>, error: &io::Error, path: &Path) -> PyErr {
    let Some(number) = error.raw_os_error() else {
        return PyOSError::new_err(error.to_string());
    };
    let told = py.import("os").and_then(|os| os.call_method1("strerror", (number,)));
    let told = told.and_then(|text| text.extract()).unwrap_or_else(|_| error.to_string());
    PyOSError::new_err((number, told, path.to_path_buf()))
}
