"""Draw the pictures of the documents anew, each by the real program.

python docs/pictures.py [NAME ...]
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

PICTURES = Path(__file__).parent / "pictures"

RUNS = {
    "pile": ["pile", "--steps", "400"],
    "clusters": ["clusters", "--steps", "20"],
}
"""Name of a picture: the arguments of `jostle run` that end in it."""


def draw(name: str) -> None:
    """Run the simulator without a display and keep its last picture."""
    with tempfile.TemporaryDirectory() as out:
        command = [sys.executable, "-m", "jostle.cli", "run", *RUNS[name], "--headless"]
        subprocess.run([*command, "--out", out], check=True)
        shutil.copyfile(Path(out) / f"{RUNS[name][0]}.png", PICTURES / f"{name}.png")


def main() -> None:
    """Draw the named pictures, or all."""
    PICTURES.mkdir(exist_ok=True)
    for name in sys.argv[1:] or RUNS:
        draw(name)


if __name__ == "__main__":
    main()
