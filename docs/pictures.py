"""Draw the pictures of the documents again, with the library, the examples and the simulator.

python docs/pictures.py [NAME ...]
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import imageio_ffmpeg
import pygame
from drawings import DRAWINGS
from PIL import Image
from tour.stops import STOPS, Stop
from tour.tour import no_display, visit

from jostle import life
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.picture import Picture
from jostle_lab.draw.software import SoftwarePainter
from jostle_lab.draw.view_options import ViewOptions
from jostle_lab.gui.style import COLUMN, STATISTICS
from jostle_lab.schema import Settings
from jostle_lab.simulate.start import start
from jostle_lab.tune import picture
from jostle_lab.tune.measure import measure

PICTURES = Path(__file__).parent / "pictures"

TUNINGS = {"tune-gas": "gas"}
"""Names of maps of leaf capacity and depth: their scenes."""

FILMS = {
    "springs": (480, 300, 0, 92),
    "sand": (190, 368, 145, 58),
    "emitters": (480, 300, 0, 98),
}
"""Stops of the tour whose films are kept, as animations: width, height, left and top of the
part of the scene that they show, if the scene is 480 pixels wide."""

TOUR = {f"tour-{stop.name}": stop for stop in STOPS}
"""Name of a picture: the stop that it shows, with scripted input in a window."""

ANIMATION = (
    f"crop=in_w-{COLUMN + STATISTICS}:in_h-36:{COLUMN}:0,scale=480:-1:flags=area,crop={{}},"
    "fps=8,split[a][b];"
    "[a]palettegen=max_colors=24:stats_mode=diff[palette];"
    "[b][palette]paletteuse=dither=none:diff_mode=rectangle"
)
"""The filter of ffmpeg for a film. Panels and the lowest rows, which have a hint, are cut off."""

EXAMPLES = {
    f"example-{path.stem.replace('_', '-')}": path
    for path in sorted((Path(__file__).parents[1] / "examples").glob("[0-9][0-9]_*.py"))
}
"""Name of a picture: the example that draws it."""


LIVES = {f"life-{matrix}": matrix for matrix in life.MATRICES}
"""Name of a picture: the matrix of particle life that it shows."""

NAMES = [*DRAWINGS, *EXAMPLES, *LIVES, *TUNINGS, *TOUR]
"""All pictures that this program draws."""


def draw(name: str) -> None:
    """Draw a picture without a display."""
    with tempfile.TemporaryDirectory() as out:
        if name in DRAWINGS:
            drawn = Path(out) / "picture.png"
            DRAWINGS[name](drawn)
            keep_small(drawn, PICTURES / f"{name}.png")
        elif name in EXAMPLES:
            drawn = Path(out) / "picture.png"
            subprocess.run([sys.executable, EXAMPLES[name], "--picture", drawn], check=True)
            keep_small(drawn, PICTURES / f"{name}.png")
        elif name in LIVES:
            draw_life(LIVES[name], Path(out) / "life.png")
            keep_small(Path(out) / "life.png", PICTURES / f"{name}.png", colours=64)
        elif name in TOUR:
            draw_stop(TOUR[name], Path(out))
        elif name in TUNINGS:
            picture.draw([measure(TUNINGS[name], 10_000, rounds=31)], PICTURES / f"{name}.png")
        else:
            raise SystemExit(f"there is no picture {name!r}; there are {', '.join(NAMES)}")


def draw_stop(stop: Stop, out: Path) -> None:
    """Run a stop of the tour, and save its still or its film."""
    with no_display():
        visited = visit(stop, out, film=stop.name in FILMS)
    if visited.film is None:
        keep_small(visited.still, PICTURES / f"tour-{stop.name}.png", colours=256)
    else:
        ffmpeg = [imageio_ffmpeg.get_ffmpeg_exe(), "-v", "error", "-y", "-i", visited.film]
        animation = ANIMATION.format(":".join(map(str, FILMS[stop.name])))
        kept = PICTURES / f"tour-{stop.name}.gif"
        subprocess.run([*ffmpeg, "-filter_complex", animation, kept], check=True)


def draw_life(matrix: str, path: Path) -> None:
    """Draw 2,000 particles after half a minute."""
    simulation, size = start(Settings("life", n=2_000, matrix=matrix)), (360, 360)
    for _ in range(1_800):
        simulation.step()
    painter = SoftwarePainter(size)
    Picture().draw(painter, simulation.frame(), Camera(size, simulation.view), ViewOptions())
    pygame.image.save(painter.canvas(), path)


def keep_small(drawn: Path, kept: Path, colours: int = 128) -> None:
    """Save a picture with a palette of a number of colours."""
    picture = Image.open(drawn).convert("RGB")
    picture.quantize(colours, dither=Image.Dither.NONE).save(kept, optimize=True)


def main() -> None:
    """Draw the named pictures, or all."""
    PICTURES.mkdir(exist_ok=True)
    for name in sys.argv[1:] or NAMES:
        draw(name)


if __name__ == "__main__":
    main()
