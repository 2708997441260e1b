"""Writing of files: a new file replaces an old one when it is complete.

After an error the old file is as it was, and no part of the new one is left.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import stat
from itertools import count
from pathlib import Path


class NewFile:
    """A file beside `path`, which it replaces at `commit`.

    A symbolic link is followed, and permissions are kept. A pipe or a device is written directly.
    As a context manager it commits, or after an exception discards.
    """

    def __init__(self, path: Path) -> None:
        self._target = Path(os.path.realpath(path))
        is_there = self._target.exists()
        self._is_direct = is_there and not self._target.is_file()
        #: The path to write to.
        self.path = self._target
        try:
            if self._target.is_file() or self._target.is_dir():
                os.close(os.open(self._target, os.O_WRONLY))  # fails if it may not be written
            if not self._is_direct:
                self.path = _create_beside(self._target)
        except OSError as error:
            error.filename = os.fspath(path)
            raise

    def __enter__(self) -> NewFile:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None:
            self.commit()
        else:
            self.discard()

    def commit(self) -> None:
        """Replace the old file by the new one."""
        if self._is_direct:
            return
        try:
            if self._target.exists():
                shutil.copymode(self._target, self.path)
            with self.path.open("rb+") as file:  # some disks report that they are full only here
                os.fsync(file.fileno())
            self.path.replace(self._target)
        except BaseException:
            self.discard()
            raise

    def discard(self) -> None:
        """Remove the new file."""
        if not self._is_direct:
            with contextlib.suppress(OSError):
                self.path.unlink()


def _create_beside(target: Path) -> Path:
    """Create an empty hidden file in the folder of another; return its path."""
    for number in count():
        path = target.with_name(f".jostle.{os.getpid()}.{number}.part")
        with contextlib.suppress(FileExistsError):
            os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
            return path
    raise AssertionError


def write(path: Path, data: bytes) -> None:
    """Write a file."""
    with NewFile(path) as new:
        new.path.write_bytes(data)


def append(path: Path, data: bytes) -> None:
    """Append to a file, which is created if there is none; after an error it is as before."""
    is_there = path.exists()
    with path.open("ab", buffering=0) as file:
        found = os.fstat(file.fileno())
        is_file = stat.S_ISREG(found.st_mode)
        try:
            left = memoryview(data)
            while left:
                left = left[file.write(left) :]
            if is_file:
                os.fsync(file.fileno())
        except BaseException:
            with contextlib.suppress(OSError):
                if is_file:
                    os.ftruncate(file.fileno(), found.st_size)
                if not is_there:
                    path.unlink()
            raise
