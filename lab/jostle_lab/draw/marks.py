"""Marks over and under the discs: contacts, forces, velocities, trails, rotation, labels, springs.

Trails are the positions of particles during the last second, stored in world coordinates,
independent of the view, and by tag, independent of rows.
"""

import math
from functools import lru_cache

import numpy as np
import pygame
from numpy.typing import NDArray

from jostle_lab.draw import palette
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.colouring import hashed
from jostle_lab.draw.painter import Painter
from jostle_lab.draw.palette import DISCS
from jostle_lab.draw.text import SMALL, font, word
from jostle_lab.simulate.containers import crosses
from jostle_lab.simulate.frame import Frame, FrameContacts, Point

MOST_CONTACTS = 1_600  # drawn; a line takes about 2 µs
MOST_ARROWS = 500  # of three lines
MOST_SPRINGS = 2_000
MOST_SPINS = 5_000
LEAST_SPIN = 3.0  # pixels; smaller discs have no radius line
SHORTEST_SPRING = 0.5  # pixels between two discs; shorter springs are hidden
DEEP = 0.25  # depth at the last colour, as a fraction of the smaller radius
ARROW_TIME = 0.2  # seconds of motion that an arrow shows at most
SAMPLE = 5_000  # particles from which the typical speed is computed
LONGEST_ARROW = 90.0
HEAD = 0.32  # times the length of an arrow, at most
LONGEST_HEAD = 7.0  # pixels
RINGS = (5.0, 11.0, 18.0)  # pixels, around the point of an attractor
# Force chains
MOST_CHAINS = 8_000  # drawn: those with the largest impulses
STRONG = 95  # percentile of the impulses at the last colour and the largest width
FAINTEST = 0.06  # fraction of that, below which a contact is not drawn
CHAIN_WIDTHS = 5  # number of line widths
WIDEST_CHAIN = 0.7  # times the median radius
MOST_PIXELS = 9.0
# Labels
SMALLEST_LABELLED = 7.0  # pixels of radius; smaller discs have no label
SPEED_FROM = 20.0  # pixels of radius; larger discs show the speed, too
MOST_LABELS = 200
OUTLINE = (8, 10, 14)  # of the text

Floats = NDArray[np.float64]


def subset(tags: NDArray[np.integer], most: int) -> NDArray[np.intp]:
    """Return the rows of at most `most` of the tags: always the same ones, to avoid flicker."""
    if len(tags) <= most:
        return np.arange(len(tags))
    numbers = hashed(tags)
    low = np.flatnonzero(numbers < 1.5 * (most + 50) / len(tags))  # so that few are sorted
    if len(low) < most:
        low = np.arange(len(tags))
    return np.sort(low[np.argsort(numbers[low], kind="stable")[:most]])


def in_view(positions: NDArray[np.floating], camera: Camera) -> NDArray[np.intp]:
    """Return the rows of the points on the screen."""
    low, high = camera.to_world((0, 0)), camera.to_world(camera.size)
    x, y = positions[:, 0], positions[:, 1]
    return np.flatnonzero((x > low[0]) & (y > low[1]) & (x < high[0]) & (y < high[1]))


def draw_springs(painter: Painter, frame: Frame, camera: Camera) -> None:
    """Draw visible springs as lines, except those across the boundary of a torus."""
    if frame.springs is None or len(frame.springs) == 0:
        return
    i, j = frame.springs[:, 0], frame.springs[:, 1]
    away = frame.positions[i] - frame.positions[j]
    gaps = np.hypot(away[:, 0], away[:, 1]) - frame.radii[i] - frame.radii[j]
    open_ones = frame.springs[gaps * camera.scale >= SHORTEST_SPRING]
    pairs = open_ones[subset(np.arange(len(open_ones)), MOST_SPRINGS)]
    first, second = frame.positions[pairs[:, 0]], frame.positions[pairs[:, 1]]
    whole = ~crosses(frame.container, first, second)
    ends = camera.lines_to_screen(first[whole], second[whole])
    ends = ends[camera.sees(ends)]
    painter.lines(ends, palette.SPRING, 1.0)


def draw_spins(painter: Painter, frame: Frame, camera: Camera) -> None:
    """Draw a radius line on each large disc, which shows its rotation."""
    if frame.angles is None:
        return
    seen = _movable_in_view(frame, camera)
    large = seen[frame.radii[seen] * camera.scale >= LEAST_SPIN]
    drawn = large[subset(frame.tags[large], MOST_SPINS)]
    x, y = camera.to_screen(frame.positions[drawn])
    angles = frame.angles[drawn].astype(np.float64)
    radii = frame.radii[drawn].astype(np.float64) * camera.scale
    ends = np.column_stack([x, y, x + radii * np.cos(angles), y + radii * np.sin(angles)])
    painter.lines(ends, palette.STAGE, 1.0)


def draw_contacts(painter: Painter, frame: Frame, camera: Camera) -> str | None:
    """Draw a bar along the normal of each contact; return a note if some are omitted."""
    touching = frame.contacts
    if touching is None or len(touching.pairs) == 0:
        return None
    i, j = touching.pairs[:, 0], touching.pairs[:, 1]
    radii = frame.radii.astype(np.float64)
    touch = frame.positions[i] + touching.normals * (radii[i] - touching.depths / 2)[:, None]
    seen = in_view(touch, camera)
    drawn = seen[subset(frame.tags[i[seen]] * 7919 + frame.tags[j[seen]], MOST_CONTACTS)]
    x, y = camera.to_screen(touch[drawn])
    smaller = np.minimum(radii[i[drawn]], radii[j[drawn]])
    half = np.clip(0.45 * smaller * camera.scale, 1.5, 14.0)[:, None]
    middle = np.column_stack([x, y])
    along = touching.normals[drawn] * half
    depth = touching.depths[drawn] / np.maximum(DEEP * smaller, 1e-12)
    thick = 2.0 if len(drawn) and float(half.mean()) >= 3.0 else 1.0
    ends = np.column_stack([middle - along, middle + along])
    painter.lines(ends, palette.interpolated(palette.CONTACT_STOPS, depth), thick)
    return _left_out(len(drawn), len(seen), "contacts")


def draw_velocities(painter: Painter, frame: Frame, camera: Camera) -> str | None:
    """Draw velocities as arrows; return a note if some are omitted."""
    seen = _movable_in_view(frame, camera)
    drawn = seen[subset(frame.tags[seen], MOST_ARROWS)]
    x, y = camera.to_screen(frame.positions[drawn])
    velocities = frame.velocities[drawn].astype(np.float64)
    arrows = velocities * arrow_seconds(frame) * camera.scale
    lengths = np.hypot(arrows[:, 0], arrows[:, 1])
    arrows *= (np.minimum(lengths, LONGEST_ARROW) / np.maximum(lengths, 1e-9))[:, None]
    long_enough = lengths >= 2.0
    tails = np.column_stack([x, y])[long_enough]
    ends = _with_heads(tails, arrows[long_enough])
    painter.lines(ends, palette.ARROW, 1.0)
    return _left_out(len(drawn), len(seen), "velocities")


def arrow_seconds(frame: Frame) -> float:
    """Return the seconds of motion that an arrow shows, less in a fast scene.

    It depends on the typical speed and size, so arrows keep their length relative to the discs.
    """
    some = slice(None, None, max(len(frame) // SAMPLE, 1))
    movable = frame.movable[some]
    moving = frame.velocities[some][movable].astype(np.float64)
    if len(moving) == 0:
        return ARROW_TIME
    rms = math.sqrt(float((moving**2).sum(axis=1).mean()))
    size = float(np.median(frame.radii[some][movable]))
    return min(ARROW_TIME, 3.5 * size / rms) if rms > 0 and size > 0 else ARROW_TIME


def draw_attractors(painter: Painter, frame: Frame, camera: Camera) -> None:
    """Draw rings around attractors: points or particles."""
    for attractor in frame.attractors:
        place: Point | None = attractor.point
        inner = 0.0
        if attractor.tag is not None:
            rows = frame.rows(attractor.tag)
            if len(rows):
                x, y = frame.positions[rows[0]].tolist()
                place, inner = (x, y), float(frame.radii[rows[0]]) * camera.scale
        if place is None:
            continue
        (at_x,), (at_y,) = camera.to_screen(np.array([place], np.float64))
        center = float(at_x), float(at_y)
        for k, radius in enumerate(RINGS):
            colour = palette.blend(palette.STAGE, palette.ATTRACTOR, 0.9 - 0.28 * k)
            painter.circle(center, inner + radius, colour, 1.5)
        if inner == 0.0:
            painter.circle(center, 2.0, palette.ATTRACTOR)


def _with_heads(tails: Floats, arrows: Floats) -> Floats:
    """Return the lines of arrows: a shaft and two short lines at the tip."""
    tips = tails + arrows
    lengths = np.maximum(np.hypot(arrows[:, 0], arrows[:, 1]), 1e-9)
    back = -arrows * (np.minimum(HEAD, LONGEST_HEAD / lengths))[:, None]
    aside = 0.5 * np.column_stack([-back[:, 1], back[:, 0]])
    strokes = [(tails, tips), (tips, tips + back + aside), (tips, tips + back - aside)]
    return np.concatenate([np.concatenate(ends, axis=1) for ends in strokes])


def _movable_in_view(frame: Frame, camera: Camera) -> NDArray[np.intp]:
    seen = in_view(frame.positions, camera)
    return seen[frame.movable[seen]]


def _left_out(drawn: int, there: int, name: str) -> str | None:
    return f"{name}: {drawn:,} of {there:,} shown" if drawn < there else None


def draw_force_chains(painter: Painter, frame: Frame, camera: Camera) -> str | None:
    """Draw contacts by the normal impulses of the last step; return a note if some are omitted."""
    if frame.contacts is None:
        return None
    ends, impulses = _chains(frame, frame.contacts)
    if len(impulses) == 0 or impulses.max() <= 0:
        return None
    share = np.clip(impulses / np.percentile(impulses[impulses > 0], STRONG), 0, 1)
    lines = camera.lines_to_screen(ends[:, :2], ends[:, 2:])
    rows = np.flatnonzero(camera.sees(lines) & (share >= FAINTEST))
    # The strongest are drawn last, over the others.
    rows = rows[np.argsort(share[rows], kind="stable")]
    drawn = rows[-MOST_CHAINS:]
    lines, share = lines[drawn], share[drawn]
    widest = min(WIDEST_CHAIN * float(np.median(frame.radii)) * camera.scale, MOST_PIXELS)
    step = np.minimum((share * CHAIN_WIDTHS).astype(np.intp), CHAIN_WIDTHS - 1)
    for k in range(CHAIN_WIDTHS):
        some = step == k
        thick = 1.0 + max(widest - 1.0, 0.0) * k / (CHAIN_WIDTHS - 1)
        painter.lines(lines[some], palette.interpolated(palette.CHAIN_STOPS, share[some]), thick)
    left = len(rows) - len(drawn)
    return f"forces: the {len(drawn):,} largest of {len(rows):,} shown" if left else None


def _chains(frame: Frame, touching: FrameContacts) -> tuple[Floats, Floats]:
    """Return lines from centre to centre or to a wall, (m, 4) in world units, and impulses."""
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


def draw_labels(painter: Painter, frame: Frame, camera: Camera) -> str | None:
    """Draw tag and speed at large discs; return a note if some are omitted."""
    seen = _movable_in_view(frame, camera)
    places = seen[frame.radii[seen] * camera.scale >= SMALLEST_LABELLED]
    if len(seen) and not len(places):
        return "labels: zoom in to see them"
    drawn = places[subset(frame.tags[places], MOST_LABELS)]
    x, y = camera.to_screen(frame.positions[drawn])
    radii = frame.radii[drawn] * camera.scale
    speeds = np.hypot(frame.velocities[drawn, 0], frame.velocities[drawn, 1])
    line = font(SMALL).get_linesize()
    columns = x, y, radii, frame.tags[drawn], speeds
    for at_x, at_y, radius, tag, speed in zip(*(c.tolist() for c in columns), strict=True):
        texts = [f"{tag}"]
        if radius >= SPEED_FROM:
            texts.append(f"{speed:,.0f}" if speed >= 10 else f"{speed:.1f}")
        top = at_y - line * len(texts) / 2
        for k, text in enumerate(texts):
            sheet = _shaded(text)
            painter.sheet(sheet, (at_x - sheet.get_width() / 2, top + k * line))
    return _left_out(len(drawn), len(places), "labels")


@lru_cache(maxsize=4_000)
def _shaded(text: str) -> pygame.Surface:
    """Return a text with a dark outline."""
    light, dark = word(text, palette.TEXT, SMALL), word(text, OUTLINE, SMALL)
    sheet = pygame.Surface((light.get_width() + 2, light.get_height() + 2), pygame.SRCALPHA, 32)
    for shift in ((0, 1), (2, 1), (1, 0), (1, 2)):
        sheet.blit(dark, shift)
    sheet.blit(light, (1, 1))
    return sheet


TRAIL_SECONDS = 1.0
TRAIL_POINTS = 20  # per path, evenly over that time
MOST_TRAILS = 150  # paths; their lines take about 4 ms
BRIGHTEST = 0.95  # alpha at the newest part of a trail


class Trails:
    """A ring buffer of past positions for a fixed choice of particles."""

    def __init__(self) -> None:
        self._forget()

    def clear(self) -> None:
        """Clear all paths at the next frame: another thread may be drawing now."""
        self._cleared = True

    def _forget(self) -> None:
        self._cleared = False
        self._tags = np.empty(0, np.int64)
        self._ring = np.full((TRAIL_POINTS, 0, 2), np.nan)
        self._times = np.full(TRAIL_POINTS, -np.inf)
        self._next = 0
        self._last = -np.inf

    def note(self, frame: Frame) -> None:
        """Record the positions of a frame, if enough time has passed since the last."""
        now = frame.stats.time
        if now < self._last or self._cleared:
            self._forget()  # after a restart or a rewind
        if now - self._last < TRAIL_SECONDS / TRAIL_POINTS * 0.999:
            return
        self._follow(frame)
        self._ring[self._next] = frame.positions[self._rows]
        self._times[self._next] = self._last = now
        self._next = (self._next + 1) % TRAIL_POINTS

    def draw(
        self, painter: Painter, frame: Frame, shades: NDArray[np.uint8], camera: Camera
    ) -> str | None:
        """Draw the paths up to the present positions, the oldest parts first."""
        self.note(frame)
        there = np.isin(self._tags, frame.tags)
        rows = frame.rows(self._tags)
        recent = np.roll(self._ring, -self._next, axis=0)[:, there]
        times = np.roll(self._times, -self._next)
        path = np.concatenate([recent, frame.positions[None, rows].astype(np.float64)])
        ends = np.concatenate([path[:-1], path[1:]], axis=2)
        age = np.clip((frame.stats.time - times) / TRAIL_SECONDS, 0.0, 1.0)
        share = BRIGHTEST * (1 - np.nan_to_num(age, nan=1.0, posinf=1.0))
        steps, many = ends.shape[:2]
        flat = ends.reshape(-1, 4)
        gaps = np.isnan(flat).any(axis=1) | crosses(frame.container, flat[:, :2], flat[:, 2:])
        kept = np.flatnonzero(~gaps & np.repeat(share > 0.02, many))
        flat = flat[kept]
        colours = np.tile(np.array(DISCS, np.uint8)[shades[rows]], (steps, 1))
        alpha = np.rint(255 * np.repeat(share, many)).astype(np.uint8)
        lines = camera.lines_to_screen(flat[:, :2], flat[:, 2:])
        seen = camera.sees(lines)
        painter.lines(lines[seen], np.column_stack([colours, alpha])[kept][seen])
        movable = int(np.count_nonzero(frame.movable))
        return f"trails: {len(rows):,} of {movable:,} shown" if len(rows) < movable else None

    def _follow(self, frame: Frame) -> None:
        """Keep the paths of particles that exist, and begin those of new ones."""
        moving = np.flatnonzero(frame.movable)
        rows = moving[subset(frame.tags[moving], MOST_TRAILS)]
        tags = frame.tags[rows]
        if not np.array_equal(tags, self._tags):
            ring = np.full((TRAIL_POINTS, len(tags), 2), np.nan)
            _, new, old = np.intersect1d(tags, self._tags, return_indices=True)
            ring[:, new] = self._ring[:, old]
            self._tags, self._ring = tags, ring
        self._rows = rows
