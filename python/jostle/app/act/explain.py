"""Why two particles touch, or do not: their distance, their boxes, and the leaves they lie in.

The leaves are those of a tree over where the particles are now, as it is drawn. A step of a world
builds its tree around the ways that are to be gone, so which pairs it tested may differ a little.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot

import numpy as np
from numpy.typing import NDArray

import jostle
from jostle.app.simulate.settings import Settings
from jostle.app.simulate.simulation import Frame, Rect, TreeBoxes

AXES = ("x", "y")
TREE_NOW = "In a tree over where they are now"


@dataclass(frozen=True)
class Leaf:
    """A leaf of the tree, or for the article one of those that a particle lies in."""

    box: Rect
    level: int
    count: int
    cover: Rect  # of all that it holds, radii included


@dataclass(frozen=True)
class Why:
    """An answer: sentences, and what to draw to them, in world units."""

    lines: tuple[str, ...]
    touching: bool
    compared: bool  # whether such a tree leaves the pair to be compared
    centres: tuple[tuple[float, float], tuple[float, float]]
    boxes: tuple[Rect, Rect]
    leaves: tuple[Leaf, ...]


def explain(frame: Frame, first: int, second: int, settings: Settings) -> Why | None:
    """Answer for two tags; None if one of them is gone, or both are the same.

    Parameters
    ----------
    frame
        With its tree, where there is one.
    settings
        By which the frame came about.
    """
    rows = frame.rows([first, second])
    if len(rows) < 2 or first == second:
        return None
    a, b = frame.positions[rows].astype(np.float64)
    b = a + _way(frame, b - a)
    radii = [float(radius) for radius in frame.radii[rows]]
    reach, distance = sum(radii), hypot(*(b - a))
    boxes = _box(a, radii[0]), _box(b, radii[1])
    touching = distance < reach
    leaves, compared, told = _leaves(frame, rows, settings)
    lines = [
        _verdict(first, second, reach - distance),
        f"Their centres are {distance:.4g} apart; the radii {radii[0]:.4g} and {radii[1]:.4g} "
        f"make {reach:.4g}.",
        _of_boxes(boxes, touching),
        *told,
        *_of_rules(frame, rows, settings, touching),
    ]
    centres = (float(a[0]), float(a[1])), (float(b[0]), float(b[1]))
    return Why(tuple(lines), touching, compared, centres, boxes, leaves)


def _verdict(first: int, second: int, depth: float) -> str:
    pair = f"Particles {first} and {second}"
    if depth > 0:
        return f"{pair} touch: they overlap by {depth:.4g}."
    if depth == 0:
        return f"{pair} just meet: touching without overlap does not count."
    return f"{pair} do not touch: there is a gap of {-depth:.4g}."


def _of_boxes(boxes: tuple[Rect, Rect], touching: bool) -> str:
    gaps = _gaps(*boxes)
    apart = [f"by {gap:.4g} in {axis}" for axis, gap in zip(AXES, gaps, strict=True) if gap >= 0]
    if apart:
        return f"The boxes around them are apart {' and '.join(apart)}, which settles it."
    if touching:
        return "The boxes around them overlap, and so do the circles in them."
    return "The boxes around them overlap, so the circles themselves have to be compared."


def _of_rules(
    frame: Frame, rows: NDArray[np.intp], settings: Settings, touching: bool
) -> list[str]:
    """Return what happens at a touch where it is not a bounce."""
    if settings.by_article:
        return []
    if not frame.movable[rows].any():
        return ["Neither of them can move, so a touch changes nothing."]
    if settings.on_touch == "ignore":
        return ["In this scene particles pass through each other, touching or not."]
    if settings.on_touch == "merge" and touching:
        return ["In this scene those that touch become one at the end of the step."]
    return []


# Leaves


def _leaves(
    frame: Frame, rows: NDArray[np.intp], settings: Settings
) -> tuple[tuple[Leaf, ...], bool, list[str]]:
    """Return the leaves of both, whether the pair is left to be compared, and why."""
    tree = frame.tree
    if settings.method.endswith("brute") or tree is None or not len(tree.boxes):
        return (), True, ["Without a tree every pair is tested, this one too."]
    if settings.by_article:
        return _article_leaves(frame, rows, tree)
    first, second = (_home(tree, frame.positions[row]) for row in rows)
    leaf, other = _leaf(frame, tree, first), _leaf(frame, tree, second)
    if first == second:
        said = f"{TREE_NOW} both lie in one leaf, {_place(leaf)}: it does not part them."
        return (leaf,), True, [said]
    said = f"{TREE_NOW} they lie in two leaves: {_place(leaf)}, and {_place(other)}."
    gaps = _gaps(leaf.cover, _moved(frame, other.cover, leaf.cover))
    apart = [f"{gap:.4g} in {axis}" for axis, gap in zip(AXES, gaps, strict=True) if gap > 0]
    if apart:
        why = f"What these leaves hold is apart by {' and '.join(apart)}: the tree parts them."
        return (leaf, other), False, [said, why]
    why = "What these leaves hold overlaps over their borders: the tree does not part them."
    return (leaf, other), True, [said, why]


def _article_leaves(
    frame: Frame, rows: NDArray[np.intp], tree: TreeBoxes
) -> tuple[tuple[Leaf, ...], bool, list[str]]:
    """Answer for the article's tree: a particle belongs to each leaf that its rectangle meets."""
    meets = []
    for row in rows:
        low = np.trunc(frame.positions[row] - frame.radii[row])
        high = low + 2 * frame.radii[row]
        meets.append(
            ((tree.boxes[:, :2] < high) & (tree.boxes[:, 2:] > low)).all(axis=1) & tree.is_leaf
        )
    common = np.flatnonzero(meets[0] & meets[1])
    shown = np.flatnonzero(meets[0] | meets[1])
    leaves = tuple(_leaf(frame, tree, int(index)) for index in shown)
    count = f"They lie in {meets[0].sum()} and {meets[1].sum()} leaves"
    if len(common) == 0:
        return leaves, False, [f"{count}, none in common: the pair is not tested."]
    times = "once" if len(common) == 1 else f"{len(common)} times"
    return leaves, True, [f"{count}, {len(common)} in common: the pair is tested {times} a frame."]


def _home(tree: TreeBoxes, point: NDArray[np.floating]) -> int:
    """Return the leaf that holds a centre; of several on a border, the deepest and the last."""
    held = (tree.boxes[:, :2] <= point) & (point <= tree.boxes[:, 2:])
    found = np.flatnonzero(held.all(axis=1) & tree.is_leaf)
    inside = found[(point < tree.boxes[found, 2:]).all(axis=1)]
    found = inside if len(inside) else found
    return int(max(found, key=lambda index: (tree.levels[index], index)))


def _leaf(frame: Frame, tree: TreeBoxes, index: int) -> Leaf:
    box = tree.boxes[index]
    places = frame.positions
    inside = ((places >= box[:2]) & (places <= box[2:])).all(axis=1)
    reach = frame.radii[inside, None]
    low = (places[inside] - reach).min(axis=0, initial=np.inf)
    high = (places[inside] + reach).max(axis=0, initial=-np.inf)
    return Leaf(_rect(box), int(tree.levels[index]), int(tree.counts[index]), _rect([*low, *high]))


def _place(leaf: Leaf) -> str:
    levels = f"{leaf.level} level{'s' if leaf.level != 1 else ''} down"
    return f"{levels} with {leaf.count:,} particle{'s' if leaf.count != 1 else ''}"


# Boxes


def _way(frame: Frame, way: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the short way, across a seam if need be."""
    if isinstance(frame.container, jostle.Torus):
        sides = np.array([frame.container.width, frame.container.height])
        way = way - sides * np.round(way / sides)
    return way


def _moved(frame: Frame, cover: Rect, to: Rect) -> Rect:
    """Return a cover as it is seen from another one, across a seam if that is nearer."""
    middle = np.array([cover[0] + cover[2] - to[0] - to[2], cover[1] + cover[3] - to[1] - to[3]])
    shift = _way(frame, middle / 2) - middle / 2
    return _rect(np.array(cover) + np.concatenate([shift, shift]))


def _box(centre: NDArray[np.float64], radius: float) -> Rect:
    return _rect([*(centre - radius), *(centre + radius)])


def _gaps(a: Rect, b: Rect) -> tuple[float, float]:
    """Return how far apart two boxes are in x and in y; negative where they overlap."""
    return max(a[0] - b[2], b[0] - a[2]), max(a[1] - b[3], b[1] - a[3])


def _rect(corners: NDArray[np.floating] | list[float]) -> Rect:
    x0, y0, x1, y1 = (float(corner) for corner in corners)
    return x0, y0, x1, y1


class Question:
    """Why two particles touch or do not, asked until it is taken back.

    Attributes
    ----------
    pair
        The tags that are asked about, or None.
    """

    def __init__(self) -> None:
        self.pair: tuple[int, int] | None = None
        self._answered: tuple[Frame, Why | None] | None = None

    def ask(self, tags: NDArray[np.int64]) -> str | None:
        """Ask about two particles, or take the question back; a sentence says what is missing."""
        if self.pair is not None:
            self.pair = None
            return None
        if len(tags) != 2:
            return f"Select two particles to ask about; {len(tags)} are selected."
        self.pair, self._answered = (int(tags[0]), int(tags[1])), None
        return None

    def answer(self, frame: Frame, settings: Settings) -> Why | None:
        """Return the answer for a frame; None if nothing is asked, or one of the two is gone."""
        if self.pair is None:
            return None
        if self._answered is None or self._answered[0] is not frame:
            self._answered = frame, explain(frame, *self.pair, settings)
            if self._answered[1] is None:
                self.pair = None
        return self._answered[1]
