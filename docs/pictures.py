"""Draw the pictures of the documents anew, each by the real program.

python docs/pictures.py [NAME ...]
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import imageio_ffmpeg
from PIL import Image

from jostle.app.gui.layout import COLUMN, STATISTICS

PICTURES = Path(__file__).parent / "pictures"

RUNS = {
    "pile": ["pile", "--steps", "240"],
    "clusters": ["clusters", "--steps", "150"],
}
"""Name of a picture: the arguments of `jostle run` that end in it."""

TUNINGS = {"tune-gas": ["gas"]}
"""Reference of the names of pictures: the arguments of `jostle tune` that draw them."""

STILLS = [
    *("first-look", "pile", "rules", "race", "heat", "trails", "stars"),
    *("galton", "menu", "why", "walls", "rewind", "settings"),
]
"""Stops of `jostle tour` whose stills are kept, as tour-NAME."""

FILMS = ["springs", "sand", "emitters"]
"""Stops of `jostle tour` whose films are kept, as animations of the scene without the panels."""

TOUR = [f"tour-{stop}" for stop in (*STILLS, *FILMS)]
"""Names of the pictures of both."""

ANIMATION = (
    f"crop=in_w-{COLUMN + STATISTICS}:in_h-36:{COLUMN}:0,"
    "fps=12,scale=480:-1:flags=area,split[a][b];"
    "[a]palettegen=max_colors=48:stats_mode=diff[palette];"
    "[b][palette]paletteuse=dither=none:diff_mode=rectangle"
)
"""What ffmpeg does to a film; the lowest rows hold nothing but a hint."""

EXAMPLES = {
    f"example-{path.stem.replace('_', '-')}": path
    for path in sorted((Path(__file__).parents[1] / "examples").glob("[0-9][0-9]_*.py"))
}
"""Name of a picture: the example that draws it."""


def draw(name: str) -> None:
    """Let the program draw without a display, and keep its pictures."""
    with tempfile.TemporaryDirectory() as out:
        if name in EXAMPLES:
            drawn = Path(out) / "picture.png"
            subprocess.run([sys.executable, EXAMPLES[name], "--picture", drawn], check=True)
            keep_small(drawn, PICTURES / f"{name}.png")
        elif name.startswith("tour-"):
            draw_stop(name.removeprefix("tour-"), Path(out))
        elif name in TUNINGS:
            call("tune", *TUNINGS[name], "--out", out)
            for made in sorted(Path(out).glob(f"{name}-*.png")):
                shutil.copyfile(made, PICTURES / made.name)
        else:
            call("run", *RUNS[name], "--headless", "--out", out)
            shutil.copyfile(Path(out) / f"{RUNS[name][0]}.png", PICTURES / f"{name}.png")


def draw_stop(stop: str, out: Path) -> None:
    """Visit a stop of the tour, and keep its still or its film."""
    if stop in STILLS:
        call("tour", "--only", stop, "--stills", "--out", str(out))
        keep_small(out / f"{stop}.png", PICTURES / f"tour-{stop}.png", colours=256)
    else:
        call("tour", "--only", stop, "--out", str(out))
        film, kept = out / f"{stop}.mp4", PICTURES / f"tour-{stop}.gif"
        ffmpeg = [imageio_ffmpeg.get_ffmpeg_exe(), "-v", "error", "-y", "-i", film]
        subprocess.run([*ffmpeg, "-filter_complex", ANIMATION, kept], check=True)


def keep_small(drawn: Path, kept: Path, colours: int = 128) -> None:
    """Keep a picture in as many colours as the eye can tell apart in it."""
    picture = Image.open(drawn).convert("RGB")
    picture.quantize(colours, dither=Image.Dither.NONE).save(kept, optimize=True)


def call(*arguments: str) -> None:
    """Run the command."""
    subprocess.run([sys.executable, "-m", "jostle.cli", *arguments], check=True)


def main() -> None:
    """Draw the named pictures, or all."""
    PICTURES.mkdir(exist_ok=True)
    for name in sys.argv[1:] or [*RUNS, *EXAMPLES, *TUNINGS, *TOUR]:
        draw(name)


if __name__ == "__main__":
    main()
