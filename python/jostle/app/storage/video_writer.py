"""Videos and pictures from canvases, for runs without a window."""

from __future__ import annotations

from pathlib import Path
from types import TracebackType

import pygame

from jostle.app.storage.encoder import Encoder, Size


class VideoWriter:
    """A context manager that writes a video, MP4 or GIF, which is playable after exceptions.

    Parameters
    ----------
    path
        The file; an existing one is replaced.
    size
        Width and height of the canvases.
    fps
        Frames per second.
    """

    def __init__(self, path: Path, size: Size, fps: int = 30) -> None:
        self.path = path
        self.frames = 0
        self._encoder = Encoder(path, size, fps)

    def add(self, canvas: pygame.Surface) -> None:
        """Append one frame."""
        self._encoder.add(canvas.get_buffer().raw)
        self.frames += 1

    def __enter__(self) -> VideoWriter:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the file; after an exception, ignore errors and remove an empty file."""
        try:
            self._encoder.close()
        except OSError:
            if kind is None:
                raise
        if kind is not None and not self.frames:
            self.path.unlink(missing_ok=True)


def save_png(canvas: pygame.Surface, path: Path) -> None:
    """Save a canvas as PNG."""
    pygame.image.save(canvas, str(path))
