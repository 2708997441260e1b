"""Encoding of frames as MP4 and GIF with ffmpeg, and pictures as PNG."""

from __future__ import annotations

import contextlib
import io
import os
import re
import subprocess
import tempfile
from itertools import pairwise
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pygame

from jostle.writing import NewFile, write
from jostle_lab.draw.camera import Size
from jostle_lab.draw.discs import RIM_SHADE
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
