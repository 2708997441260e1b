"""Instructions of each stage of a step, counted by valgrind's callgrind.

    python benchmarks/stages.py [--count 10000]

Times on a shared machine vary; the number of instructions of the same program with the same
input does not, so compare two versions of the core by it. callgrind supports AVX2 but not AVX-512.
Needs cargo and valgrind; the example `one_step` measures times of
the same stages.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
from pathlib import Path

from machine import Results, slug

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = ROOT / "target/release/examples/one_step"
STAGES = {
    "sort": "quadtree::order::Order::sort",
    "leaves": "quadtree::build::nodes",
    "join": "pairs::join::Join<T>::run",
    "contacts": "contacts::Contacts::collect",
    "resting": "resting::Resting::support",
    "events": "events::Events::fly",
    "correction": "correction::Correction::run",
    "all": "step_once",
}
SCENES = {"gas": 30, "pile": 300}
STEPS = 3


def count(scene: str, particles: int, folder: Path) -> dict[str, float]:
    """Instructions per particle and step of each stage."""
    out = folder / f"callgrind.{scene}"
    arguments = [scene, str(particles), str(SCENES[scene]), str(STEPS)]
    options = [f"--callgrind-out-file={out}", "--toggle-collect=*timed_step*"]
    command = ["valgrind", "--tool=callgrind", *options, str(PROGRAM), *arguments]
    subprocess.run(command, check=True, capture_output=True)
    annotate = ["callgrind_annotate", "--inclusive=yes", "--threshold=100", str(out)]
    listing = subprocess.run(annotate, check=True, capture_output=True, text=True).stdout
    return {stage: total(listing, name) / particles / STEPS for stage, name in STAGES.items()}


def total(listing: str, name: str) -> int:
    """The instructions of a function with everything that it calls; 0 if it is not there."""
    lines = (line for line in listing.splitlines() if name in line)
    counts = (re.match(r"\s*([\d,]+)", line) for line in lines)
    return max((int(found[1].replace(",", "")) for found in counts if found), default=0)


def main() -> None:
    """Build the program, count, print and write the results."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=10_000)
    options = parser.parse_args()
    missing = [tool for tool in ("cargo", "valgrind") if shutil.which(tool) is None]
    if missing:
        sys.exit(f"this needs {' and '.join(missing)}")
    build = ["cargo", "build", "--release", "--package", "jostle", "--example", "one_step"]
    subprocess.run(build, check=True, cwd=ROOT)
    folder = ROOT / "out"
    folder.mkdir(exist_ok=True)
    rows: list[dict[str, object]] = []
    for scene in SCENES:
        print(f"{scene}, {options.count:,} particles: instructions per particle and step")
        for stage, each in count(scene, options.count, folder).items():
            print(f"  {stage:10} {each:10,.0f}")
            rows.append(
                {
                    "scene": scene,
                    "count": options.count,
                    "stage": stage,
                    "instructions": round(each),
                }
            )
    Results(ROOT / f"benchmarks/results/stages-{slug()}.csv").add(rows)


if __name__ == "__main__":
    main()
