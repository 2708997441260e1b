"""MP4 and PNG files from canvases."""

from __future__ import annotations

from collections.abc import Generator
from pathlib import Path
from types import TracebackType

import imageio_ffmpeg
import pygame

Size = tuple[int, int]

# The colours of a screen are BT.709; told so, players do not shift them.
_COLOUR_SPACE = [
    "-vf", "scale=out_color_matrix=bt709:out_range=tv",
    "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709",
]  # fmt: skip
_QUALITY = ["-crf", "23", "-preset", "veryfast", "-movflags", "+faststart"]


class Recorder:
    """A film in the making (H.264, yuv420p): a context manager, playable however it ends.

    Parameters
    ----------
    path
        The MP4 file; an existing one is replaced.
    size
        Width and height of the canvases, both even, as yuv420p wants.
    fps
        Frames a second.
    """

    def __init__(self, path: Path, size: Size, fps: int = 30) -> None:
        if size[0] % 2 or size[1] % 2:
            raise ValueError(f"a film needs an even width and height, not {size[0]}×{size[1]}")
        self.path = path
        self._film: Generator[None, object, None] = imageio_ffmpeg.write_frames(
            str(path),
            size,
            pix_fmt_in="bgr0",  # the canvas as it lies in memory
            pix_fmt_out="yuv420p",
            fps=fps,
            codec="libx264",
            quality=None,
            macro_block_size=2,
            output_params=[*_QUALITY, *_COLOUR_SPACE],
        )
        try:
            self._film.send(None)
        except RuntimeError as error:  # imageio's word for a platform without an ffmpeg
            raise OSError(str(error)) from error

    def add(self, canvas: pygame.Surface) -> None:
        """Append one frame."""
        self._film.send(canvas.get_buffer().raw)

    def __enter__(self) -> Recorder:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._film.close()


def save_png(canvas: pygame.Surface, path: Path) -> None:
    """Save one canvas as a picture."""
    pygame.image.save(canvas, str(path))
