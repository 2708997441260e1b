"""Films and pictures of arrays of pixels: MP4 with ffmpeg; GIF and PNG with Pillow."""

from __future__ import annotations

import contextlib
import difflib
import os
import re
import subprocess
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from jostle.writing import NewFile

Pixels = NDArray[np.uint8]

PATIENCE = 10.0  # seconds to write the end of a film
GROUND = (16, 20, 26)  # fills a side that is extended

# The colours are marked as BT.709, so that players do not shift them. yuv420p requires even sides.
_MP4_FILTER = (
    "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=0x{:02x}{:02x}{:02x},"
    "scale=out_color_matrix=bt709:out_range=tv"
).format(*GROUND)
_MP4 = [
    "-vf", _MP4_FILTER, "-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "23",
    "-preset", "veryfast", "-colorspace", "bt709", "-color_primaries", "bt709",
    "-color_trc", "bt709", "-movflags", "+faststart", "-f", "mp4",
]  # fmt: skip


@contextlib.contextmanager
def extra(purpose: str) -> Iterator[None]:
    """Say how to install the packages of the extra, if one that is imported here is missing."""
    try:
        yield
    except ModuleNotFoundError as error:
        name = str(error.name).partition(".")[0]
        sentence = f"{purpose} needs the package {name}: pip install 'jostle[record]'"
        raise ModuleNotFoundError(sentence, name=name) from None


def format_of(path: str | os.PathLike[str], formats: Collection[str]) -> str:
    """Return the suffix of a path, in lower case; it must be one of the formats."""
    suffix = Path(path).suffix.lower()
    if suffix not in formats:
        near = difflib.get_close_matches(suffix, formats, 1)
        hint = f"; did you mean {near[0]}?" if near else ""
        listed = ", ".join(formats)
        raise ValueError(f"path is {os.fspath(path)!r}; it must end with one of {listed}{hint}")
    return suffix


class Film:
    """A film of pictures, .mp4 or .gif.

    The file is complete, and replaces an old one, when the film is closed. As a context manager it
    is closed at the end of the block, also after an exception: what there is can be played. A film
    without pictures leaves no file.

    Parameters
    ----------
    path : path-like
        The file, whose suffix is the format.
    size : (int, int)
        Width and height in pixels. In .mp4 odd sides are extended by a pixel.
    rate : float, default 30.0
        Pictures per second. The times of a .gif are whole hundredths of a second.

    Raises
    ------
    ValueError
        If the suffix is another, or a number is out of range.
    ModuleNotFoundError
        If imageio-ffmpeg (.mp4) or Pillow (.gif) is missing.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> from jostle.record import Film
    >>> with Film("fade.gif", (64, 48), rate=20) as film:
    ...     for shade in range(0, 255, 15):
    ...         film.add(np.full((48, 64, 3), shade, np.uint8))
    >>> film.frames
    17
    """

    FORMATS = (".mp4", ".gif")

    def __init__(
        self, path: str | os.PathLike[str], size: tuple[int, int], rate: float = 30.0
    ) -> None:
        suffix = format_of(path, self.FORMATS)
        width, height = size
        if min(width, height) < 1:
            raise ValueError(f"size is {size}; width and height must be at least 1")
        if not 0 < rate < np.inf:
            raise ValueError(f"rate is {rate}; it must be finite and above 0")
        self.frames = 0
        self._shape = height, width, 3
        self._file = NewFile(Path(path))
        try:
            part = self._file.path
            self._sink = _Mp4(part, size, rate) if suffix == ".mp4" else _Gif(part, rate)
        except BaseException:
            self._file.discard()
            raise

    def __enter__(self) -> Film:
        """Return the film."""
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        """Close the film; after an exception, errors of closing are ignored."""
        with contextlib.suppress(OSError) if kind else contextlib.nullcontext():
            self.close()

    def add(self, picture: Pixels) -> None:
        """Append a picture.

        Parameters
        ----------
        picture : ndarray of uint8, shape (height, width, 3)
            Red, green and blue, from 0 to 255; the first row is the upper one.
        """
        self._sink.add(_checked(picture, self._shape))
        self.frames += 1

    def close(self) -> None:
        """Complete the file; after an error (OSError) an old file is as it was."""
        if not self.frames:
            self.discard()
            return
        try:
            self._sink.close()
        except BaseException:
            self.discard()
            raise
        self._file.commit()

    def discard(self) -> None:
        """Stop at once; an old file is as it was."""
        self._sink.stop()
        self._file.discard()


class _Mp4:
    """An ffmpeg process that writes a file."""

    def __init__(self, path: Path, size: tuple[int, int], rate: float) -> None:
        with extra("a film of the format .mp4"):
            import imageio_ffmpeg
        self._path = path
        source = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{size[0]}x{size[1]}"]
        source += ["-r", f"{rate}", "-i", "-"]
        try:
            program = imageio_ffmpeg.get_ffmpeg_exe()
            self._process = subprocess.Popen(
                [program, "-y", "-hide_banner", "-v", "error", *source, *_MP4, str(path)],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                start_new_session=True,  # Ctrl-C is handled by this program, which closes the file
                creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0)
                | getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),
            )
        except (OSError, RuntimeError) as error:  # of imageio if there is no ffmpeg
            raise OSError(f"no ffmpeg can be started: {error}") from error
        with contextlib.suppress(AttributeError, OSError):  # below the priority of a window
            os.setpriority(os.PRIO_PROCESS, self._process.pid, 10)

    def add(self, picture: Pixels) -> None:
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(picture.data)
        except (OSError, ValueError) as error:
            raise OSError(self._message(1.0) or str(error)) from error

    def close(self) -> None:
        try:
            message = self._message(PATIENCE)
        except subprocess.TimeoutExpired:
            raise OSError("the end of the film took too long") from None
        if code := self._process.returncode:
            raise OSError(message or f"ffmpeg ended with code {code}")

    def stop(self) -> None:
        self._process.kill()
        with contextlib.suppress(OSError, ValueError):
            self._process.communicate()

    def _message(self, patience: float) -> str:
        """Wait for the end; return the first line of errors, which the others follow from."""
        said = self._process.communicate(timeout=patience)[1].decode(errors="replace").strip()
        line = re.sub(r"^\[[^]]*\] *", "", said.partition("\n")[0])
        return line.replace(str(self._path), "the file")


class _Gif:
    """An animated picture, of which each frame has a palette, and only what has changed."""

    def __init__(self, path: Path, rate: float) -> None:
        with extra("a film of the format .gif"):
            from PIL import GifImagePlugin, Image, ImageChops
        self._image, self._gif, self._chops = Image, GifImagePlugin, ImageChops
        self._file: BinaryIO = path.open("wb")
        self._rate, self._count = rate, 0
        self._last: Image.Image | None = None

    def add(self, picture: Pixels) -> None:
        frame = self._image.fromarray(picture)
        box = (0, 0, *frame.size)
        if self._last is not None:
            box = self._chops.difference(frame, self._last).getbbox() or (0, 0, 1, 1)
        part = frame.crop(box).quantize(
            method=self._image.Quantize.FASTOCTREE, dither=self._image.Dither.NONE
        )
        if self._last is None:
            self._file.writelines(self._gif.getheader(part, info={"loop": 0})[0])
        begin, end = (round(100 * count / self._rate) for count in (self._count, self._count + 1))
        duration = 10 * max(end - begin, 1)
        options = {"duration": duration, "include_color_table": True}
        self._file.writelines(self._gif.getdata(part, box[:2], **options))
        self._last, self._count = frame, self._count + 1

    def close(self) -> None:
        with self._file:
            self._file.write(b";")

    def stop(self) -> None:
        with contextlib.suppress(OSError):
            self._file.close()


def write_png(path: str | os.PathLike[str], picture: Pixels) -> None:
    """Write a picture as PNG.

    Parameters
    ----------
    path : path-like
        The file.
    picture : ndarray of uint8, shape (height, width, 3)
        Red, green and blue, from 0 to 255; the first row is the upper one.

    Examples
    --------
    >>> from jostle.record import write_png
    >>> write_png("grey.png", np.full((48, 64, 3), 128, np.uint8))
    """
    with extra("a picture"):
        from PIL import Image
    image = Image.fromarray(_checked(picture, (-1, -1, 3)))
    with NewFile(Path(path)) as new, new.path.open("wb") as file:
        image.save(file, "PNG")


def _checked(picture: Pixels, shape: tuple[int, int, int]) -> Pixels:
    """Return a picture as contiguous pixels; -1 is any number of them."""
    array = np.ascontiguousarray(picture)
    fits = array.ndim == 3 and all(
        wanted in (-1, found) for wanted, found in zip(shape, array.shape, strict=True)
    )
    if array.dtype != np.uint8 or not fits or not array.size:
        sides = "(height, width, 3)" if -1 in shape else f"{shape}"
        raise ValueError(
            f"picture has shape {array.shape} and type {array.dtype}; it must be {sides} of uint8"
        )
    return array
