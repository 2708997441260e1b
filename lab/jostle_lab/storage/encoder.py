"""Encoding of frames as MP4 and GIF with ffmpeg, and pictures as PNG; recording of a session.

During a recording the UI thread submits immutable frames, and never blocks. A worker thread draws
them with its own painter, at the size of the video, and feeds an encoder. When too many are
waiting, or the window is slower than the video, the last frame is repeated, so the video keeps real
time.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import subprocess
import tempfile
from collections.abc import Callable
from concurrent.futures import Future, wait
from dataclasses import replace
from functools import partial
from itertools import pairwise
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pygame

from jostle.writing import NewFile, write
from jostle_lab.draw.camera import Camera, Size
from jostle_lab.draw.palette import (
    DISCS,
    GROUND,
    PANEL_EDGE,
    STAGE,
    TEXT,
    WALL,
    blend,
    level_colour,
)
from jostle_lab.draw.picture import Picture
from jostle_lab.draw.software import RIM_SHADE, SoftwarePainter
from jostle_lab.draw.view_options import ViewOptions
from jostle_lab.simulate.engine import Worker
from jostle_lab.simulate.frame import Frame

PATIENCE = 10.0  # seconds to write the end of a file
FORMATS = (".mp4", ".gif")

# The colours are marked as BT.709, so that players do not shift them. A row or a column of the
# background makes the sides even, which yuv420p requires.
_MP4_FILTER = (
    "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=0x{:02x}{:02x}{:02x},"
    "scale=out_color_matrix=bt709:out_range=tv"
).format(*GROUND)
_MP4 = [
    "-vf", _MP4_FILTER, "-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "23",
    "-preset", "veryfast", "-colorspace", "bt709", "-color_primaries", "bt709",
    "-color_trc", "bt709", "-movflags", "+faststart", "-f", "mp4",
]  # fmt: skip
_GIF = [
    "-filter_complex", "[0:v][1:v]paletteuse=dither=none:diff_mode=rectangle",
    "-loop", "0", "-f", "gif",
]  # fmt: skip


class Encoder:
    """An ffmpeg process that writes one file, .mp4 or .gif.

    The file is complete, and replaces an existing one, when the encoder is closed, which it is at
    the end of a block as a context manager.
    """

    def __init__(self, path: Path, size: Size, fps: int = 30) -> None:
        if path.suffix not in FORMATS:
            raise ValueError(f"{path.name} is neither {' nor '.join(FORMATS)}")
        self.path, self.frames = path, 0
        self._bytes = size[0] * size[1] * 4
        self._file = NewFile(path)
        self._stderr = tempfile.TemporaryFile()  # noqa: SIM115 (it is open as long as ffmpeg is)
        self._folder = tempfile.TemporaryDirectory(prefix="jostle-")
        try:
            command = [imageio_ffmpeg.get_ffmpeg_exe(), *self._arguments(path.suffix, size, fps)]
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=self._stderr,
                start_new_session=True,  # Ctrl-C is handled by this program, which closes the file
                creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0)
                | getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),
            )
            with contextlib.suppress(AttributeError, OSError):  # below the priority of the window
                os.setpriority(os.PRIO_PROCESS, self._process.pid, 10)
        except (OSError, RuntimeError) as error:  # of imageio if there is no ffmpeg
            self._tidy()
            self._file.discard()
            raise OSError(f"no ffmpeg can be started: {error}") from error

    def _arguments(self, suffix: str, size: Size, fps: int) -> list[str]:
        source = ["-f", "rawvideo", "-pix_fmt", "bgr0", "-s", f"{size[0]}x{size[1]}"]
        source += ["-r", str(fps), "-i", "-"]
        if suffix == ".gif":
            palette = Path(self._folder.name) / "palette.png"
            pygame.image.save(gif_palette(), str(palette))
            source += ["-i", str(palette), *_GIF]
        else:
            source += _MP4
        return ["-y", "-hide_banner", "-v", "error", *source, str(self._file.path)]

    def __enter__(self) -> Encoder:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        """Close the file; after an exception, ignore errors and keep no empty file."""
        if kind is not None and not self.frames:
            self.kill()
            return
        try:
            self.close()
        except OSError:
            if kind is None:
                raise

    def draw(self, canvas: pygame.Surface) -> None:
        """Append the contents of a canvas of a painter."""
        self.add(canvas.get_buffer().raw)

    def add(self, picture: bytes) -> None:
        """Append a frame: rows of 4 bytes per pixel, blue first."""
        if len(picture) != self._bytes:
            raise ValueError(f"a frame has {len(picture):,} bytes instead of {self._bytes:,}")
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(picture)
        except (OSError, ValueError) as error:
            raise OSError(self._error_message() or str(error)) from error
        self.frames += 1

    def close(self, patience: float = PATIENCE) -> None:
        """Close the file; raise an OSError with the message of ffmpeg."""
        assert self._process.stdin is not None
        with contextlib.suppress(OSError):
            self._process.stdin.close()
        try:
            code = self._process.wait(patience)
        except subprocess.TimeoutExpired:
            self.kill()
            raise OSError("the end of the video took too long") from None
        message = self._error_message()
        self._tidy()
        if code:
            self._file.discard()
            raise OSError(message or f"ffmpeg ended with code {code}")
        self._file.commit()

    def kill(self) -> None:
        """Stop immediately; an existing file stays."""
        self._process.kill()
        self._process.wait()
        self._tidy()
        self._file.discard()

    def _error_message(self) -> str:
        """Return the first line of ffmpeg's output; the others follow from it."""
        with contextlib.suppress(ValueError, subprocess.TimeoutExpired):
            self._process.wait(1.0)
            self._stderr.seek(0)
            output = self._stderr.read().decode(errors="replace").strip()
            line = re.sub(r"^\[[^]]*\] *", "", output.partition("\n")[0])
            return line.replace(str(self._file.path), str(self.path))
        return ""

    def _tidy(self) -> None:
        self._stderr.close()
        self._folder.cleanup()


def write_png(picture: pygame.Surface, path: Path) -> None:
    """Write a picture as PNG."""
    data = io.BytesIO()  # pygame does not report that a disk is full
    pygame.image.save(picture, data, "picture.png")
    write(path, data.getvalue())


def gif_palette() -> pygame.Surface:
    """Return the 256 colours of every GIF: those of the palette, and blends of them.

    They are known in advance, so frames are read once, and colours do not flicker.
    """
    levels = [level_colour(level, 24) for level in range(0, 25, 3)]
    grounds = [GROUND, STAGE, WALL, PANEL_EDGE]
    colours = [*grounds, *DISCS, *levels]
    colours += [blend(STAGE, disc, share) for share in (0.2, 0.4, 0.6, 0.8) for disc in DISCS]
    colours += [blend(STAGE, level, share) for share in (0.36, 0.7) for level in levels]
    colours += [blend(GROUND, TEXT, share / 16) for share in range(1, 17)]
    colours += [blend(a, b, 0.5) for a, b in pairwise(DISCS)]
    colours += [blend((0, 0, 0), disc, RIM_SHADE) for disc in DISCS]
    unique = list(dict.fromkeys(colours))[:256]
    unique += [GROUND] * (256 - len(unique))
    table = np.array(unique, np.uint8).reshape(16, 16, 3)
    return pygame.surfarray.make_surface(table)


RATES = {".mp4": 30, ".gif": 25}  # frames per second; a GIF has a resolution of 10 ms
MOST_QUEUED = 8  # frames


class Recording:
    """A recording in progress, .mp4 or .gif, of a size in pixels.

    It has a length in seconds, or lasts until it is stopped.
    """

    def __init__(self, path: Path, size: Size, seconds: float | None = None) -> None:
        self.path, self.size = path, size
        self.rate = RATES[path.suffix]
        self.total = None if seconds is None else max(round(seconds * self.rate), 1)
        self.written = self.repeated = 0  # frames so far, and those that repeat the one before
        self.error = ""  # why the recording ended early; empty if it did not
        self.stopped = False
        self._given = self._due = 0  # frames submitted, and frames due
        self._begin: float | None = None
        self._discard = False  # whether the frames that wait are dropped
        self._encoder = Encoder(path, size, self.rate)
        self._painter, self._picture = SoftwarePainter(size), Picture()
        self._pixels = b""  # of the last frame
        self._worker = Worker("jostle-film")
        self._jobs: list[Future[None]] = []  # those that are not done

    # On the UI thread

    def offer(self, frame: Frame, camera: Camera, options: ViewOptions, now: float) -> None:
        """Submit a frame, at a time in seconds, if one is due and not too many are waiting."""
        if self.stopped:
            return
        if self._begin is None:
            self._begin = now
        self._due = int((now - self._begin) * self.rate + 1e-6) + 1
        if self.total is not None:
            self._due = min(self._due, self.total)
        self._jobs = [job for job in self._jobs if not job.done()]
        times = self._due - self._given
        if times > 0 and len(self._jobs) <= MOST_QUEUED:  # one of them is in progress
            self._submit(partial(self._draw, frame, camera.on(self.size), replace(options), times))
        if self._due == self.total:
            self.stop()

    def stop(self) -> None:
        """Accept no more frames; those that wait are still written."""
        if not self.stopped:
            self.stopped = True
            self._submit(partial(self._finish, self._due - self._given))

    def _submit(self, work: Callable[[], None]) -> None:
        self._jobs.append(self._worker.submit(partial(self._try, work)))
        self._given = self._due

    @property
    def done(self) -> bool:
        return self.stopped and all(job.done() for job in self._jobs)

    @property
    def queued(self) -> int:
        """Return the number of frames to be written."""
        return self._given - self.written

    @property
    def seconds(self) -> float:
        """Return the length of the video so far."""
        return self._given / self.rate

    @property
    def progress(self) -> float | None:
        """Return the written fraction, or None if the length is not known."""
        whole = self._given if self.stopped else self.total
        return None if whole is None else self.written / max(whole, 1)

    def close(self, patience: float = PATIENCE) -> None:
        """Stop, and wait for the file; after `patience` seconds waiting frames are dropped."""
        self.stop()
        wait(self._jobs, patience)
        if not self.done:
            self._discard = True
            wait(self._jobs, 2.0)
        if not self.done:
            self._encoder.kill()
        self._worker.close()

    # On the worker thread

    def _try(self, work: Callable[[], None]) -> None:
        """Do a part of the work, unless an error has ended it before."""
        if self.error:
            return
        try:
            work()
        except Exception as error:  # no error may end the UI thread
            self.error = str(error) or type(error).__name__
            self.stopped = True
            self._encoder.kill()

    def _draw(self, frame: Frame, camera: Camera, options: ViewOptions, times: int) -> None:
        """Draw a frame, and write it a number of times."""
        if not self._discard:
            self._picture.draw(self._painter, frame, camera, options)
            self._pixels = self._painter.canvas().get_buffer().raw
            self._write(times)
            self.repeated += times - 1

    def _finish(self, times: int) -> None:
        """Write the last frame until now, and close the file."""
        if self._pixels and not self._discard:
            self._write(times)
            self.repeated += times
        self._encoder.close()

    def _write(self, times: int) -> None:
        for _ in range(times):
            self._encoder.add(self._pixels)
            self.written += 1
