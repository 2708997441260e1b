//! Files that are replaced atomically.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;

/// Bytes that are read before the rest of a file.
const HEAD: u64 = 64;

/// Maximum number of symbolic links to follow, as in Linux.
const MOST_LINKS: usize = 40;

/// A path as Python's functions take it: str, bytes or os.PathLike.
pub struct FilePath(pub PathBuf);

impl<'py> FromPyObject<'_, 'py> for FilePath {
    type Error = PyErr;

    fn extract(path: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let decoded = path.py().import("os")?.call_method1("fsdecode", (path,))?;
        decoded.extract().map(Self)
    }
}

/// Reads the whole of a file whose first [`HEAD`] bytes pass `check`, which also gets the size of the
/// file. A pipe or a device may have no end, so it is refused.
pub fn read(
    py: Python<'_>,
    path: &Path,
    check: impl Fn(&[u8], u64) -> PyResult<()>,
) -> PyResult<Vec<u8>> {
    let failed = |error: io::Error| os_error(py, &error, path);
    // Before it is opened: opening a pipe waits for its other end.
    let found = fs::metadata(path).map_err(failed)?;
    if !found.is_file() && !found.is_dir() {
        let text = "it is a pipe or a device, not a file; World.restore reads bytes";
        return Err(PyValueError::new_err(format!("{}: {text}", path.display())));
    }
    let mut file = File::open(path).map_err(failed)?;
    let mut bytes = Vec::new();
    Read::by_ref(&mut file).take(HEAD).read_to_end(&mut bytes).map_err(failed)?;
    check(&bytes, found.len())?;
    py.detach(|| file.read_to_end(&mut bytes)).map_err(failed)?;
    Ok(bytes)
}

/// Replaces the contents of a file; if this fails, the file is unchanged. A symbolic link is
/// followed, and permissions are kept.
pub fn replace(py: Python<'_>, path: &Path, bytes: &[u8]) -> PyResult<()> {
    let done = py.detach(|| {
        let target = follow_links(path)?;
        match fs::metadata(&target) {
            // A pipe or a device cannot be replaced.
            Ok(found) if !found.is_file() => {
                OpenOptions::new().write(true).open(&target)?.write_all(bytes)
            }
            Ok(_) => {
                // Fails if the file is not writable.
                let old = OpenOptions::new().write(true).open(&target)?.metadata()?;
                replace_whole(&target, bytes, Some(&old))
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                replace_whole(&target, bytes, None)
            }
            Err(error) => Err(error),
        }
    });
    done.map_err(|error| os_error(py, &error, path))
}

/// The target of a path, which need not exist.
fn follow_links(path: &Path) -> io::Result<PathBuf> {
    let mut target = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        match fs::read_link(&target) {
            Ok(next) => target = target.parent().unwrap_or(Path::new("")).join(next),
            Err(_) => return Ok(target),
        }
    }
    // The error of the system for a cycle of links.
    fs::metadata(path).map(|_| target)
}

/// Writes a new file in the same folder and renames it to `target`.
fn replace_whole(target: &Path, bytes: &[u8], old: Option<&fs::Metadata>) -> io::Result<()> {
    let (mut file, temporary) = create_beside(target)?;
    let written = old
        .map_or(Ok(()), |old| keep_access(&file, old))
        .and_then(|()| file.write_all(bytes))
        .and_then(|()| file.sync_all());
    drop(file);
    let renamed = written.and_then(|()| fs::rename(&temporary, target));
    if renamed.is_err() {
        // An error here is ignored: the first one is returned.
        let _ = fs::remove_file(&temporary);
    }
    renamed
}

/// Copies the permissions of the old file, and its owner if the system allows this.
fn keep_access(file: &File, old: &fs::Metadata) -> io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        let new = file.metadata()?;
        if (new.uid(), new.gid()) != (old.uid(), old.gid()) {
            let _ = fchown(file, Some(old.uid()), Some(old.gid()));
        }
    }
    file.set_permissions(old.permissions())
}

/// A new file in the same folder.
fn create_beside(target: &Path) -> io::Result<(File, PathBuf)> {
    let process = std::process::id();
    let mut number = 0;
    loop {
        let path = target.with_file_name(format!(".jostle.{process}.{number}.part"));
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => number += 1,
            found => return found.map(|file| (file, path)),
        }
    }
}

/// The OSError for an error; Python derives its subclass from the error number.
fn os_error(py: Python<'_>, error: &io::Error, path: &Path) -> PyErr {
    let Some(number) = error.raw_os_error() else {
        return PyOSError::new_err(error.to_string());
    };
    let text = py.import("os").and_then(|os| os.call_method1("strerror", (number,)));
    let text = text.and_then(|text| text.extract()).unwrap_or_else(|_| error.to_string());
    PyOSError::new_err((number, text, path.to_path_buf()))
}
