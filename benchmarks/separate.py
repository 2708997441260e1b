"""Moving shapes apart beside adjustText, seaborn and D3, and walkers among tiles.

Every rival gets the same centres and sizes. The overlaps that it leaves are counted with
`find_pairs`, because some stop before none is left. A rival is left out after the size at which a
call has taken longer than the patience. D3 runs in node, if that is installed, and is timed there.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from machine import Row, version_of
from numpy.typing import NDArray
from timing import interleaved

import jostle

Floats = NDArray[np.float64]
Move = Callable[[Floats, Floats, Floats], Floats]

COUNTS = (100, 1_000, 10_000)
D3_VERSION = "3.0.0"
NODE = Path(__file__).parents[1] / "out" / "node"

D3 = """
import {forceSimulation, forceCollide} from "d3-force";
import {readFileSync, writeFileSync} from "fs";
const rows = JSON.parse(readFileSync(0));
const nodes = rows.map(([x, y, r]) => ({x, y, r}));
const force = forceCollide(node => node.r).iterations(2);
const start = performance.now();
const simulation = forceSimulation(nodes).force("collide", force).stop();
for (let k = 0; k < 300; ++k) simulation.tick();
const seconds = (performance.now() - start) / 1000;
console.log(JSON.stringify({seconds, centers: nodes.map(node => [node.x, node.y])}));
"""


def scene(name: str, count: int) -> tuple[Floats, Floats, Floats]:
    """Centres, radii and half sizes of a scene; the same for every rival."""
    rng = np.random.default_rng(count)
    halves = np.zeros((count, 2))
    if name == "crowd":  # discs on 60 % of the area that have moved by a tenth of their radius
        side = np.sqrt(count * np.pi / 0.6)
        placed = jostle.separate(rng.uniform(0, side, (count, 2)), 1.0).positions
        moved = np.asarray(placed + rng.uniform(-0.1, 0.1, (count, 2)), np.float64)
        return moved, np.ones(count), halves
    if name == "heap of discs":
        return rng.normal(0, np.sqrt(count), (count, 2)), rng.uniform(1, 10, count), halves
    if name == "heap of labels":
        halves = np.column_stack([rng.uniform(15, 45, count), np.full(count, 6.0)])
        return rng.normal(0, 5 * np.sqrt(count), (count, 2)), np.zeros(count), halves
    values = rng.normal(0, 300, count)  # a swarm
    return np.column_stack([values, np.zeros(count)]), np.full(count, 2.0), halves


def ours(centers: Floats, radii: Floats, halves: Floats, axis: int | None = None) -> Floats:
    """Return the centres of `separate`."""
    return np.asarray(jostle.separate(centers, radii, halves, axis=axis).positions, np.float64)


def adjust_text(centers: Floats, radii: Floats, halves: Floats) -> Floats:
    """Move labels by adjustText, in a plot in which a unit is a pixel."""
    import matplotlib.pyplot as plt
    from adjustText import adjust_text as adjust
    from matplotlib.transforms import Bbox

    figure, axes = plt.subplots(figsize=(60, 60), dpi=100)
    axes.set_position((0, 0, 1, 1))
    axes.set(xlim=(-3000, 3000), ylim=(-3000, 3000))
    texts = [axes.text(x, y, "l", ha="center", va="center") for x, y in centers]
    sizes = dict(zip(texts, 2 * halves, strict=True))
    for text in texts:  # the size of the scene, not that of a font

        def extent(renderer: Any = None, text: Any = text, **_: Any) -> Any:
            x, y = text.get_transform().transform(text.get_position())
            width, height = sizes[text]
            return Bbox.from_bounds(x - width / 2, y - height / 2, width, height)

        text.get_window_extent = extent
    adjust(texts, ax=axes, time_lim=None, expand=(1, 1))
    moved = np.array([text.get_position() for text in texts])
    plt.close(figure)
    return moved


def seaborn_swarm(centers: Floats, radii: Floats, halves: Floats) -> Floats:
    """Place points by seaborn's swarm plot, in a plot in which a unit is a pixel."""
    import matplotlib.pyplot as plt
    import seaborn

    figure, axes = plt.subplots(figsize=(40, 40), dpi=100)
    axes.set_position((0, 0, 1, 1))
    seaborn.swarmplot(
        x=centers[:, 0], size=2 * radii[0] * 72 / 100, ax=axes, linewidth=0, edgecolor="none"
    )
    axes.set(xlim=(-2000, 2000))
    figure.canvas.draw()
    offsets = axes.collections[0].get_offsets()
    pixels = axes.transData.transform(np.asarray(offsets))
    plt.close(figure)
    moved: Floats = pixels - (2000, 2000)
    return moved


def d3_collide(centers: Floats, radii: Floats) -> tuple[float, Floats]:
    """Move discs by 300 ticks of D3's forceCollide; return seconds and centres."""
    rows = np.column_stack([centers, radii]).tolist()
    command = ["node", str(NODE / "d3.mjs")]
    done = subprocess.run(
        command, input=json.dumps(rows), capture_output=True, text=True, check=True
    )
    answer = json.loads(done.stdout)
    return answer["seconds"], np.array(answer["centers"])


def has_d3() -> bool:
    """Whether D3 can be run; installs it with npm the first time."""
    if not (shutil.which("node") and shutil.which("npm")):
        return False
    NODE.mkdir(parents=True, exist_ok=True)
    (NODE / "d3.mjs").write_text(D3, encoding="utf-8")
    if not (NODE / "node_modules" / "d3-force").exists():
        command = ["npm", "install", "--silent", "--prefix", str(NODE), f"d3-force@{D3_VERSION}"]
        return subprocess.run(command, check=False).returncode == 0
    return True


RIVALS: dict[str, dict[str, tuple[str, Move]]] = {
    "heap of labels": {"adjustText": ("adjustText", adjust_text)},
    "swarm": {"seaborn": ("seaborn", seaborn_swarm)},
}


def installed(module: str) -> bool:
    """Whether a module can be imported."""
    try:
        __import__(module)
    except ImportError:
        return False
    return True


def measured(name: str, count: int, rival: str, seconds: float, moved: Floats) -> Row:
    """A row of the results."""
    centers, radii, halves = scene(name, count)
    apart = np.linalg.norm(moved - centers, axis=1).mean()
    return {
        "scene": name,
        "count": count,
        "rival": rival,
        "version": D3_VERSION if rival.startswith("D3") else version_of(rival),
        "median_s": f"{seconds:.4g}",
        "overlaps": len(jostle.find_pairs(moved, radii * 0.999, halves * 0.999)),
        "mean_move": f"{apart:.4g}",
    }


def race(rounds: int, largest: int, patience: float) -> Iterator[list[Row]]:
    """Yield the rows of each scene and size."""
    slow: set[str] = set()
    for name in ("crowd", "heap of discs", "heap of labels", "swarm"):
        for count in (count for count in COUNTS if count <= largest):
            shapes = scene(name, count)
            axis = 1 if name == "swarm" else None
            call = partial(ours, *shapes, axis=axis)
            rows = [measured(name, count, "jostle", interleaved([call], rounds)[0].median, call())]
            for rival, (module, move) in RIVALS.get(name, {}).items():
                if installed(module) and rival not in slow:
                    start = time.perf_counter()
                    moved = move(*shapes)
                    seconds = time.perf_counter() - start
                    rows.append(measured(name, count, rival, seconds, moved))
                    slow |= {rival} if seconds > patience else set()
            if "discs" in name and "D3" not in slow and has_d3():
                seconds, moved = d3_collide(*shapes[:2])
                rows.append(measured(name, count, "D3 forceCollide", seconds, moved))
                slow |= {"D3"} if seconds > patience else set()
            yield rows
    yield from walk(rounds, largest)


def step(space: jostle.Space, ids: NDArray[np.int64], velocities: Floats) -> None:
    """Move all walkers; those at a wall turn."""
    slides = space.move_and_slide(ids, velocities, mask=1)
    velocities[slides.on_wall, 0] *= -1


def walk(rounds: int, largest: int) -> Iterator[list[Row]]:
    """Yield the time of a step of 1,000 walkers among tiles."""
    for count in (count for count in (1_000, 100_000) if count <= largest):
        rng = np.random.default_rng(count)
        side = int(np.sqrt(count / 0.3))
        grid = rng.random((side, side)) < 0.3
        ys, xs = np.nonzero(grid)
        boxes = np.column_stack([xs, ys, xs + 1, ys + 1]) * 16.0
        free = np.column_stack(np.nonzero(~grid)[::-1])
        starts = rng.choice(free, min(1000, len(free)), replace=False) * 16.0 + 8
        space = jostle.Space()
        space.add(boxes=boxes, categories=1)
        ids = space.add(starts, half_sizes=(4, 6), categories=2)
        velocities = np.column_stack([rng.choice([-3.0, 3.0], len(ids)), np.full(len(ids), 0.5)])

        call = partial(step, space, ids, velocities)
        timing = interleaved([call], 10 * rounds)[0]
        yield [
            {
                "scene": "walkers",
                "count": count,
                "rival": "jostle",
                "version": jostle.__version__,
                "median_s": f"{timing.median:.4g}",
                "overlaps": len(space.pairs(mask=3)),
                "mean_move": "",
            }
        ]
