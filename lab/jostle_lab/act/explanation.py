"""Why two particles touch or do not: their distance, their AABBs, and their leaves.

The leaves are those of a tree over the present positions, as it is drawn. A step builds its tree
over swept bounds, so the pairs that it tested may differ.
"""

from dataclasses import dataclass
from math import hypot

import numpy as np
from numpy.typing import NDArray

import jostle
from jostle_lab.draw.text import plural
from jostle_lab.schema import Settings
from jostle_lab.simulate.containers import minimum_image
from jostle_lab.simulate.frame import Frame, Rect

AXES = ("x", "y")
INTERVAL = 1.0  # seconds between two explanations in scenes of
MANY = 50_000  # particles and more
TREE_NOW = "In a tree over the present positions"


@dataclass(frozen=True)
class Leaf:
    """A leaf of the tree."""

    box: Rect
    level: int
    count: int
    bounds: Rect  # of the discs in it


@dataclass(frozen=True)
class Explanation:
    """Sentences, and the shapes to draw with them, in world units."""

    lines: tuple[str, ...]
    touching: bool
    compared: bool  # whether the pair is a candidate pair of such a tree
    centres: tuple[tuple[float, float], tuple[float, float]]
    boxes: tuple[Rect, Rect]
    leaves: tuple[Leaf, ...]


def explain(frame: Frame, first: int, second: int, settings: Settings) -> Explanation | None:
    """Explain the pair of two tags in a frame; None if one does not exist, or both are the same."""
    rows = frame.rows([first, second])
    if len(rows) < 2 or first == second:
        return None
    a, b = frame.positions[rows].astype(np.float64)
    b = a + minimum_image(frame.container, b - a)
    radii = [float(radius) for radius in frame.radii[rows]]
    reach, distance = sum(radii), hypot(*(b - a))
    boxes = _box(a, radii[0]), _box(b, radii[1])
    touching = distance < reach
    leaves, compared, sentences = _leaves(frame, rows, settings)
    lines = [
        _verdict(first, second, reach - distance),
        f"The distance of their centres is {distance:.4g}; the sum of their radii "
        f"{radii[0]:.4g} + {radii[1]:.4g} is {reach:.4g}.",
        _of_boxes(boxes, touching),
        *sentences,
        *_of_rules(frame, rows, settings, touching),
    ]
    centres = (float(a[0]), float(a[1])), (float(b[0]), float(b[1]))
    return Explanation(tuple(lines), touching, compared, centres, boxes, leaves)


def _verdict(first: int, second: int, depth: float) -> str:
    pair = f"Particles {first} and {second}"
    if depth > 0:
        return f"{pair} touch: they overlap by {depth:.4g}."
    if depth == 0:
        return f"{pair} do not touch: the gap is 0, and touching requires overlap."
    return f"{pair} do not touch: the gap is {-depth:.4g}."


def _of_boxes(boxes: tuple[Rect, Rect], touching: bool) -> str:
    gaps = _gaps(*boxes)
    apart = [f"by {gap:.4g} in {axis}" for axis, gap in zip(AXES, gaps, strict=True) if gap >= 0]
    if apart:
        return f"Their AABBs are separated {' and '.join(apart)}, so they cannot touch."
    if touching:
        return "Their AABBs overlap, and so do the circles."
    return "Their AABBs overlap, but the circles do not."


def _of_rules(
    frame: Frame, rows: NDArray[np.intp], settings: Settings, touching: bool
) -> list[str]:
    """Return the effect of a contact if it is not a bounce."""
    if not frame.movable[rows].any():
        return ["Both are immovable, so a contact has no effect."]
    if not (frame.categories[rows] & frame.masks[rows[::-1]]).all():
        return ["Their collision filters do not match: they pass through each other."]
    if settings.on_touch == "ignore":
        return ["In this scene collisions are off."]
    if settings.on_touch == "merge" and touching:
        return ["In this scene touching particles merge at the end of the step."]
    return []


# Leaves


def _leaves(
    frame: Frame, rows: NDArray[np.intp], settings: Settings
) -> tuple[tuple[Leaf, ...], bool, list[str]]:
    """Return the leaves of both, whether they are a candidate pair, and why."""
    tree = frame.tree
    if settings.method == "brute" or tree is None or not len(tree.boxes):
        return (), True, ["Without a tree every pair is tested."]
    first, second = (_home(tree, frame.positions[row]) for row in rows)
    leaf, other = _leaf(frame, tree, first), _leaf(frame, tree, second)
    if first == second:
        said = f"{TREE_NOW} both are in one leaf, {_describe(leaf)}: they are a candidate pair."
        return (leaf,), True, [said]
    said = f"{TREE_NOW} they are in two leaves: {_describe(leaf)}, and {_describe(other)}."
    gaps = _gaps(leaf.bounds, _moved(frame, other.bounds, leaf.bounds))
    apart = [f"{gap:.4g} in {axis}" for axis, gap in zip(AXES, gaps, strict=True) if gap > 0]
    if apart:
        gaps_text = " and ".join(apart)
        why = f"The bounds of these leaves are {gaps_text} apart: they are no candidate pair."
        return (leaf, other), False, [said, why]
    why = "The bounds of these leaves overlap: they are a candidate pair."
    return (leaf, other), True, [said, why]


def _home(tree: jostle.Nodes, point: NDArray[np.floating]) -> int:
    """Return the leaf that contains a centre; on a border, the deepest and the last of them."""
    held = (tree.boxes[:, :2] <= point) & (point <= tree.boxes[:, 2:])
    found = np.flatnonzero(held.all(axis=1) & tree.is_leaf)
    inside = found[(point < tree.boxes[found, 2:]).all(axis=1)]
    found = inside if len(inside) else found
    return int(max(found, key=lambda index: (tree.levels[index], index)))


def _leaf(frame: Frame, tree: jostle.Nodes, index: int) -> Leaf:
    box = tree.boxes[index]
    places = frame.positions
    inside = ((places >= box[:2]) & (places <= box[2:])).all(axis=1)
    reach = frame.radii[inside, None]
    low = (places[inside] - reach).min(axis=0, initial=np.inf)
    high = (places[inside] + reach).max(axis=0, initial=-np.inf)
    return Leaf(_rect(box), int(tree.levels[index]), int(tree.counts[index]), _rect([*low, *high]))


def _describe(leaf: Leaf) -> str:
    return f"{plural(leaf.level, 'level')} below the root with {plural(leaf.count, 'particle')}"


# Boxes


def _moved(frame: Frame, cover: Rect, to: Rect) -> Rect:
    """Return the periodic image of bounds that is nearest to others."""
    middle = np.array([cover[0] + cover[2] - to[0] - to[2], cover[1] + cover[3] - to[1] - to[3]])
    shift = minimum_image(frame.container, middle / 2) - middle / 2
    return _rect(np.array(cover) + np.concatenate([shift, shift]))


def _box(centre: NDArray[np.float64], radius: float) -> Rect:
    return _rect([*(centre - radius), *(centre + radius)])


def _gaps(a: Rect, b: Rect) -> tuple[float, float]:
    """Return the gaps between two boxes in x and in y; negative where they overlap."""
    return max(a[0] - b[2], b[0] - a[2]), max(a[1] - b[3], b[1] - a[3])


def _rect(corners: NDArray[np.floating] | list[float]) -> Rect:
    x0, y0, x1, y1 = (float(corner) for corner in corners)
    return x0, y0, x1, y1


class PairQuestion:
    """The pair whose contact is explained, until it is cleared."""

    def __init__(self) -> None:
        self.pair: tuple[int, int] | None = None  # its tags
        self._frame: Frame | None = None  # the frame that is explained, and its explanation
        self._answer: Explanation | None = None
        self._due = 0.0

    def ask(self, tags: NDArray[np.int64]) -> str | None:
        """Set the pair, or clear it; return a message if not exactly two are selected."""
        if self.pair is not None:
            self.pair = None
            return None
        if len(tags) != 2:
            return f"Select two particles; {len(tags)} are selected."
        self.pair, self._frame = (int(tags[0]), int(tags[1])), None
        return None

    def answer(self, frame: Frame, settings: Settings, now: float) -> Explanation | None:
        """Return the explanation for a frame, or for an earlier one of very many particles.

        None without a pair, or if one of it does not exist.
        """
        if self.pair is None:
            return None
        late = len(frame) < MANY or now >= self._due
        if self._frame is None or (frame is not self._frame and late):
            self._frame, self._due = frame, now + INTERVAL
            self._answer = explain(frame, *self.pair, settings)
            if self._answer is None:
                self.pair = None
        return self._answer
