"""Force chains: a line for each contact, as wide and as bright as its force."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jostle.app.draw.camera import Camera
from jostle.app.draw.painter import Painter
from jostle.app.draw.palette import CHAIN_STOPS, interpolated
from jostle.app.simulate.simulation import Frame

MOST_LINES = 8_000  # drawn: those with the largest impulses
STRONG = 95  # percentile of the impulses at the last colour and the largest width
FAINTEST = 0.06  # fraction of that, below which a contact is not drawn
WIDTHS = 5  # number of line widths
WIDEST = 0.7  # times the median radius
MOST_PIXELS = 9.0

Floats = NDArray[np.float64]


def draw_force_chains(painter: Painter, frame: Frame, camera: Camera) -> str | None:
    """Draw contacts by the normal impulses of the last step; return a note if some are omitted."""
    touching = frame.contacts
    if touching is None:
        return None
    ends, impulses = _lines(frame)
    if len(impulses) == 0 or impulses.max() <= 0:
        return None
    share = np.clip(impulses / np.percentile(impulses[impulses > 0], STRONG), 0, 1)
    lines = camera.lines_to_screen(ends[:, :2], ends[:, 2:])
    rows = np.flatnonzero(camera.sees(lines) & (share >= FAINTEST))
    # The strongest are drawn last, over the others.
    rows = rows[np.argsort(share[rows], kind="stable")]
    drawn = rows[-MOST_LINES:]
    lines, share = lines[drawn], share[drawn]
    widest = min(WIDEST * float(np.median(frame.radii)) * camera.scale, MOST_PIXELS)
    step = np.minimum((share * WIDTHS).astype(np.intp), WIDTHS - 1)
    for k in range(WIDTHS):
        some = step == k
        thick = 1.0 + max(widest - 1.0, 0.0) * k / (WIDTHS - 1)
        painter.lines(lines[some], interpolated(CHAIN_STOPS, share[some]), thick)
    left = len(rows) - len(drawn)
    return f"forces: the {len(drawn):,} largest of {len(rows):,} shown" if left else None


def _lines(frame: Frame) -> tuple[Floats, Floats]:
    """Return lines from centre to centre or to a wall, (m, 4) in world units, and impulses."""
    touching = frame.contacts
    assert touching is not None
    radii = frame.radii.astype(np.float64)
    i, j = touching.pairs[:, 0], touching.pairs[:, 1]
    starts = frame.positions[i].astype(np.float64)
    reach = (radii[i] + radii[j] - touching.depths)[:, None]
    between = np.column_stack([starts, starts + touching.normals * reach])
    at = touching.at_walls
    centers = frame.positions[at].astype(np.float64)
    foot = centers - touching.wall_normals * radii[at][:, None]
    lines = np.concatenate([between, np.column_stack([centers, foot])])
    return lines, np.concatenate([touching.impulses, touching.wall_impulses]).astype(np.float64)
