"""The pictures of docs/quadtree.md and docs/article.md, drawn from the library.

    python docs/pictures.py quadtree-cells

The discs are those of the first code block of the page, so that text and picture agree.
"""

from __future__ import annotations

import doctest
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

import jostle
from jostle_lab.article import Simulation

DOCS = Path(__file__).parent

# The colours of the examples and of the simulator.
GROUND, LINE, SOFT, TEXT = "#10141a", "#46536a", "#8e9aab", "#dce3ec"
BLUE, TEAL, YELLOW, ORANGE, RED = "#4f6d9e", "#6fb0a2", "#e2c67c", "#e09b6a", "#c9686a"
TITLE = 0.4  # height of the line below the panels, in inches
CAPTION: dict[str, Any] = {"color": TEXT, "size": 11, "ha": "center", "va": "center"}
LEAVES = [BLUE, TEAL, YELLOW, ORANGE, RED, "#8f7fb8", "#a7c58c"]

Panel = Callable[[Axes], None]
Numbers = NDArray[Any]


def first_block(page: str) -> dict[str, Any]:
    """Run the first code block of a page and return its names."""
    text = (DOCS / page).read_text(encoding="utf-8")
    block = re.search(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    assert block is not None
    names: dict[str, Any] = {}
    for example in doctest.DocTestParser().get_examples(block[1]):
        exec(example.source, names)
    return names


def picture(path: Path, panels: Sequence[Panel], titles: Sequence[str], aspect: float = 1) -> None:
    """Draw panels side by side with a title below each; `aspect` is width over height."""
    mpl.use("Agg")
    width = 11 / len(panels)
    height = width / aspect + TITLE
    figure: Figure
    figure, axes = plt.subplots(
        1, len(panels), figsize=(11, height), dpi=100, facecolor=GROUND, squeeze=False
    )
    figure.subplots_adjust(0.01, TITLE / height, 0.99, 0.985, 0.025)
    for place, panel, title in zip(axes[0], panels, titles, strict=True):
        place.set_aspect("equal")
        place.axis("off")
        panel(place)
        box = place.get_position()
        figure.text((box.x0 + box.x1) / 2, 0.5 * TITLE / height, title, **CAPTION)
    figure.savefig(path, dpi=100, facecolor=GROUND)
    plt.close(figure)


def draw_discs(
    axes: Axes, centers: Numbers, radii: Numbers, colors: Any, dots: float = 3.5
) -> None:
    """Draw discs with dots of a size at their centres."""
    place: dict[str, Any] = {"offset_transform": axes.transData, "units": "xy"}
    sizes = 2 * radii, 2 * radii, 0 * radii
    style: dict[str, Any] = {"edgecolors": GROUND, "linewidths": 0.6, "alpha": 0.85, "zorder": 2}
    axes.add_collection(
        EllipseCollection(*sizes, offsets=centers, facecolors=colors, **style, **place)
    )
    axes.scatter(*centers.T, s=dots, color=GROUND, zorder=3, linewidths=0)


def draw_boxes(axes: Axes, boxes: Numbers, color: str = LINE, **style: Any) -> None:
    """Draw rectangles (min_x, min_y, max_x, max_y)."""
    for min_x, min_y, max_x, max_y in boxes:
        size = max_x - min_x, max_y - min_y
        look = {"fill": False, "edgecolor": color, "linewidth": 1.1, "zorder": 1, **style}
        axes.add_patch(Rectangle((min_x, min_y), *size, **look))


def frame(axes: Axes, box: Sequence[float], margin: float = 1.0) -> None:
    """Show a box, with y downwards."""
    min_x, min_y, max_x, max_y = box
    axes.set(xlim=(min_x - margin, max_x + margin), ylim=(max_y + margin, min_y - margin))


def leaf_of_each(nodes: jostle.Nodes, centers: Numbers) -> Numbers:
    """Return the index of the leaf that contains each centre."""
    boxes = np.where(nodes.is_leaf[:, None], nodes.boxes, np.nan)
    inside = (boxes[:, None, :2] <= centers) & (centers < boxes[:, None, 2:])
    found: Numbers = inside.all(axis=2).argmax(axis=0)
    return found


def colors_of(leaves: Numbers) -> list[str]:
    """Return one colour for each leaf; neighbours in Morton order differ."""
    number = {leaf: k for k, leaf in enumerate(dict.fromkeys(leaves.tolist()))}
    return [LEAVES[number[leaf] % len(LEAVES)] for leaf in leaves.tolist()]


def morton_order(nodes: jostle.Nodes, centers: Numbers) -> Numbers:
    """Return the rows of the centres in Morton order."""
    low, high = nodes.boxes[0, :2], nodes.boxes[0, 2:]
    cells = ((centers - low) / (high - low) * 2**16).astype(int)
    keys = [(cells[:, axis] >> bit & 1) << 2 * bit + axis for bit in range(16) for axis in (0, 1)]
    return np.argsort(np.sum(keys, axis=0))


def quadtree_cells(path: Path) -> None:
    """The tree after each subdivision."""
    names = first_block("quadtree.md")
    centers, radii = names["centers"], names["radii"]
    whole = names["nodes"].boxes[0]

    def panel(depth: int) -> tuple[Panel, str]:
        tree = jostle.Quadtree(centers, radii, leaf_capacity=4, max_depth=depth)
        nodes = tree.nodes()

        def draw(axes: Axes) -> None:
            draw_boxes(axes, nodes.boxes)
            draw_discs(axes, centers, radii, colors_of(leaf_of_each(nodes, centers)))
            frame(axes, whole)

        count = int(nodes.is_leaf.sum())
        return draw, f"{count} boxes" if count > 1 else "one box"

    panels, titles = zip(*[panel(depth) for depth in (0, 1, 2, 4096)], strict=True)
    titles = (*titles[:3], f"{titles[3].split()[0]} leaves of at most 4 discs")
    picture(path, panels, titles)


def quadtree_order(path: Path) -> None:
    """The Z-curve, and the discs connected in Morton order."""
    names = first_block("quadtree.md")
    centers, radii, nodes = names["centers"], names["radii"], names["nodes"]

    def curve(axes: Axes) -> None:
        keys = range(64)
        column = [sum((key >> 2 * bit & 1) << bit for bit in range(3)) for key in keys]
        row = [sum((key >> 2 * bit + 1 & 1) << bit for bit in range(3)) for key in keys]
        for side in (1, 2, 4):
            starts = np.mgrid[0:8:side, 0:8:side].reshape(2, -1).T
            draw_boxes(axes, np.hstack([starts, starts + side]), linewidth=0.5 * side)
        axes.plot(np.add(column, 0.5), np.add(row, 0.5), color=TEAL, linewidth=1.6, zorder=2)
        for key in keys:
            place = column[key] + 0.08, row[key] + 0.28
            axes.text(*place, str(key), color=SOFT, size=8, zorder=3)
        frame(axes, (0, 0, 8, 8), 0.1)

    def discs(axes: Axes) -> None:
        order = morton_order(nodes, centers)
        draw_boxes(axes, nodes.boxes)
        draw_discs(axes, centers, radii, colors_of(leaf_of_each(nodes, centers)))
        axes.plot(*centers[order].T, color=TEXT, linewidth=1.2, zorder=4, alpha=0.9)
        frame(axes, nodes.boxes[0], 2)

    titles = "Z-curve: the key of each cell", "the discs in the order of their keys"
    picture(path, [curve, discs], titles, aspect=1.12)


def quadtree_bounds(path: Path) -> None:
    """A leaf, the leaves that its bounds overlap, and the pairs found."""
    names = first_block("quadtree.md")
    centers, radii, nodes = names["centers"], names["radii"], names["nodes"]
    leaves = leaf_of_each(nodes, centers)
    low, high = np.full((2, len(nodes.boxes), 2), np.nan)
    for leaf in np.unique(leaves):
        row = leaves == leaf
        low[leaf] = (centers[row] - radii[row, None]).min(axis=0)
        high[leaf] = (centers[row] + radii[row, None]).max(axis=0)
    reached = ((low[:, None] < high) & (high[:, None] > low)).all(axis=2)
    chosen = int(reached.sum(axis=1).argmax())
    near = np.flatnonzero(reached[chosen] & (np.arange(len(low)) != chosen))
    pairs = np.array([pair for pair in names["tree"].pairs() if chosen in leaves[pair]])

    def draw(axes: Axes) -> None:
        role = np.where(leaves == chosen, YELLOW, np.where(np.isin(leaves, near), TEAL, LINE))
        draw_boxes(axes, nodes.boxes)
        draw_boxes(axes, nodes.boxes[[chosen]], YELLOW, linewidth=2.2, zorder=3)
        bounds = np.concatenate([low, high], axis=1)
        draw_boxes(axes, bounds[near], TEAL, linestyle=(0, (3, 2)), zorder=3)
        draw_boxes(axes, bounds[[chosen]], YELLOW, linestyle=(0, (3, 2)), linewidth=1.6, zorder=4)
        draw_discs(axes, centers, radii, role)
        lines = LineCollection(list(centers[pairs]), colors=RED, linewidths=2.4, zorder=5)
        axes.add_collection(lines)
        around = bounds[[chosen, *near]]
        (min_x, min_y), (max_x, max_y) = around[:, :2].min(axis=0), around[:, 2:].max(axis=0)
        extra = (1.75 * (max_y - min_y) - (max_x - min_x)) / 2
        frame(axes, (min_x - extra, min_y, max_x + extra, max_y), 4)

    title = (
        f"a leaf (yellow) with its cell and its bounds (dashed), the {len(near)} leaves that it is "
        f"tested against, and {len(pairs)} pairs (red)"
    )
    picture(path, [draw], [title], aspect=1.75)


def article_trees(path: Path) -> None:
    """The article's tree and jostle's, over the same balls."""
    simulation = Simulation(500, "quadtree", seed=0)
    balls = simulation.particles
    centers = np.array([(ball.x, ball.y) for ball in balls])
    radii = np.array([float(ball.radius) for ball in balls])
    rectangles = np.array([ball.rectangle for ball in balls], float)
    simulation.frame()
    boxes = np.array([(x, y, x + w, y + h) for x, y, w, h, _ in simulation.leaves], float)
    low, high = rectangles[:, :2], rectangles[:, :2] + rectangles[:, 2:]
    overlap = (boxes[:, None, :2] < high) & (boxes[:, None, 2:] > low)
    counts = overlap.all(axis=2).sum(axis=0)
    tree = jostle.Quadtree(centers, radii, leaf_capacity=3)
    nodes = tree.nodes()
    pairs = len(tree.pairs())
    shade = np.array([RED, BLUE, YELLOW, ORANGE, RED])  # in 0, 1, 2, 3, 4 or more leaves

    def article(axes: Axes) -> None:
        draw_boxes(axes, boxes, linewidth=0.8)
        draw_discs(axes, centers, radii, shade[np.minimum(counts, 4)], dots=0)
        frame(axes, (0, 0, 800, 500), 4)

    def ours(axes: Axes) -> None:
        draw_boxes(axes, nodes.boxes, linewidth=0.8)
        draw_discs(axes, centers, radii, BLUE, dots=0)
        frame(axes, (0, 0, 800, 500), 4)

    several = int((counts > 1).sum())
    titles = (
        f"the article's tree: {several} of 500 balls in more than one leaf",
        f"jostle's, leaves of 3: each ball in one leaf; {pairs} pairs, each once",
    )
    picture(path, [article, ours], titles, aspect=1.6)


DRAWINGS: dict[str, Callable[[Path], None]] = {
    "quadtree-cells": quadtree_cells,
    "quadtree-order": quadtree_order,
    "quadtree-bounds": quadtree_bounds,
    "article-trees": article_trees,
}
"""Name of a picture: the function that draws it into a file."""
