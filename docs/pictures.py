"""Draw the pictures of the documents anew, each by the real program.

python docs/pictures.py [NAME ...]
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

PICTURES = Path(__file__).parent / "pictures"

RUNS = {
    "pile": ["pile", "--steps", "400"],
    "clusters": ["clusters", "--steps", "20"],
}
"""Name of a picture: the arguments of `jostle run` that end in it."""

TUNINGS = {"tune-gas": ["gas"]}
"""Beginning of the names of pictures: the arguments of `jostle tune` that draw them."""

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
        elif name in TUNINGS:
            call("tune", *TUNINGS[name], "--out", out)
            for made in sorted(Path(out).glob(f"{name}-*.png")):
                shutil.copyfile(made, PICTURES / made.name)
        else:
            call("run", *RUNS[name], "--headless", "--out", out)
            shutil.copyfile(Path(out) / f"{RUNS[name][0]}.png", PICTURES / f"{name}.png")


def keep_small(drawn: Path, kept: Path) -> None:
    """Keep a picture in as many colours as the eye can tell apart in it."""
    colours = Image.open(drawn).convert("RGB").quantize(128, dither=Image.Dither.NONE)
    colours.save(kept, optimize=True)


def call(*arguments: str) -> None:
    """Run the command."""
    subprocess.run([sys.executable, "-m", "jostle.cli", *arguments], check=True)


def main() -> None:
    """Draw the named pictures, or all."""
    PICTURES.mkdir(exist_ok=True)
    for name in sys.argv[1:] or [*RUNS, *EXAMPLES, *TUNINGS]:
        draw(name)


if __name__ == "__main__":
    main()
