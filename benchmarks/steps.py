"""Comparison of simulations: the same discs, the same second, then times."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np
import step_rivals as rivals
from machine import Row, version_of
from step_rivals import Column, InitialState, RunningSimulation
from timing import THREADS, Call, Effort, clock, interleaved

import jostle

__all__ = ["SCENES", "compare"]

SCENES = ("gas", "pile")

CHECKED_FRAMES = 60
"""Frames after which speeds and contacts are compared: one second."""

COMPARED_MOST = 20_000
"""Results, and the settings of each simulation, are compared up to this size. Larger scenes use the
best setting of these, and are only run in."""

RUN_IN_FRAMES = 10

NEAR = 1.02
"""Discs count as touching up to this many times the sum of their radii."""

ENERGY_TOLERANCE = 0.05
"""A simulation that changes the energy of a gas by more than this fraction gets a note."""

FALL = 0.12
"""Fraction of the patience per frame while a pile falls, which takes hundreds of frames."""

Make = Callable[[InitialState], RunningSimulation]


@dataclass
class Entrant:
    """A simulation with a number of threads, and its results so far."""

    name: str
    package: str
    threads: int
    make: Make
    settings: dict[str, Make] = field(default_factory=dict)
    """Choices by name; the first is `make`, and the fastest replaces it."""
    substeps: int | None = None
    """The same number as the others if None."""
    seconds_a_disc: float = 0.0

    @property
    def setting(self) -> str:
        """The name of the chosen setting."""
        return next((name for name, make in self.settings.items() if make is self.make), "")


def entrants(scene: str) -> Iterator[Entrant]:
    """Yield all installed simulations; the first is the reference."""
    for number in THREADS:
        yield Entrant("jostle", "jostle", number, partial(rivals.jostle_world, threads=number))
    brute = partial(rivals.jostle_world, threads=1, method="brute")
    yield Entrant("jostle, brute force", "jostle", 1, brute)
    if version_of("pymunk") is not None:
        yield from pymunk_entrants(scene)
    if version_of("pyb2d3") is not None:
        yield from box2d_entrants(scene)


def pymunk_entrants(scene: str) -> Iterator[Entrant]:
    """Yield pymunk, with the choice of its index."""

    def entrant(name: str, number: int, substeps: int | None = None) -> Entrant:
        tree = partial(rivals.pymunk_space, threads=number, substeps=substeps)
        settings: dict[str, Make] = {"tree": tree, "spatial hash": partial(tree, hashed=True)}
        return Entrant(name, "pymunk", number, tree, settings, substeps)

    for number in sorted({min(number, 2) for number in THREADS}):
        yield entrant("pymunk", number)
    if scene == "pile":  # the usual choice of its users
        yield entrant("pymunk, one sub-step", 1, substeps=1)


def box2d_entrants(scene: str) -> Iterator[Entrant]:
    """Yield Box2D, with the choice of its unit of length for a gas.

    In a pile, 1 px a metre lets discs sink into each other: Box2D limits the speed of separation
    to 3 m/s.
    """

    def entrant(name: str, number: int, substeps: int | None = None) -> Entrant:
        coarse = partial(rivals.box2d_world, threads=number, substeps=substeps)
        settings: dict[str, Make] = {"10 px a metre": coarse}
        if scene == "gas":
            settings["1 px a metre"] = partial(coarse, pixels=1.0)
        return Entrant(name, "pyb2d3", number, coarse, settings, substeps)

    for number in THREADS:
        yield entrant("pyb2d3", number)
    if scene == "gas":  # as its documents recommend; a pile has four
        for number in THREADS:
            yield entrant("pyb2d3, four sub-steps", number, substeps=4)


def compare(
    scene: str,
    counts: Sequence[int],
    effort: Effort = Effort(),  # noqa: B008 (it is frozen)
) -> Iterator[list[Row]]:
    """Compare and time one frame of every simulation, and yield the rows of each size.

    For the gas the article's programs are timed, too, each with the same number of its own
    particles, at its own density and with its own rules.

    Parameters
    ----------
    scene : {"gas", "pile"}
        A gas of elastic discs, or a pile at rest.
    counts : sequence of int
        Numbers of discs, ascending.
    """
    everyone = list(entrants(scene))
    for count in counts:
        effort.report(f"{scene}, {count:,}: initial state")
        start = rivals.gas(count) if scene == "gas" else rivals.pile(count, FALL * effort.patience)
        if start is None:  # it would take too long to fall
            return
        rows: list[Row] = []
        timed: list[tuple[Row, Call, Entrant | None]] = []
        everything: list[RunningSimulation] = []
        for entrant in everyone:
            row = begin(scene, start, entrant)
            if entrant.seconds_a_disc * count > effort.patience:
                rows.append({**row, "note": "not tried at this size"})
                continue
            effort.report(f"{scene}, {count:,}: {entrant.name}, compared")
            running = at_its_best(entrant, start).make(start)
            everything.append(running)
            for frame in running.frames.values():
                frame()  # the first finds all contacts
            slowest = max(clock(frame) for frame in running.frames.values())
            entrant.seconds_a_disc = slowest / count
            if slowest > effort.patience:
                rows.append({**row, "note": f"a frame takes {slowest:.1f} s"})
                continue
            row |= after_a_second(running, start)
            if stands_still(running, start):
                rows.append({**row, "note": "its discs do not move"})
                continue
            for manner, frame in running.frames.items():
                rows.append({**row, "manner": manner, "setting": entrant.setting})
                timed.append((rows[-1], frame, entrant))
        if scene == "gas":
            for method in ("quadtree", "brute"):
                row, old_frame = article_row(scene, count, method)
                rows.append(row)
                if old_frame is None or clock(old_frame) > effort.patience:
                    row["note"] = "too slow at this size"
                else:
                    timed.append((row, old_frame, None))
        effort.report(f"{scene}, {count:,}: {effort.rounds} rounds of {len(timed)}")
        timings = interleaved([frame for _, frame, _ in timed], effort.rounds)
        for (row, _, timed_entrant), timing in zip(timed, timings, strict=True):
            row |= timing.columns()
            if timed_entrant is not None:
                timed_entrant.seconds_a_disc = timing.median / count
        for running in everything:
            running.close()
        yield rows


def begin(scene: str, start: InitialState, entrant: Entrant) -> Row:
    """Return the row of a simulation before timing."""
    return {
        "scene": scene,
        "count": len(start),
        "substeps": entrant.substeps or start.substeps,
        "name": entrant.name,
        "version": version_of(entrant.package),
        "threads": entrant.threads,
        "manner": "",
        "setting": "",
        "rms_speed": "",
        "contacts": "",
        "rounds": 0,
        "median_s": "",
        "low_s": "",
        "high_s": "",
        "note": "",
    }


def article_row(scene: str, count: int, method: str) -> tuple[Row, Call | None]:
    """Return a row for the article's program and its frame; None if it is certainly too slow."""
    name = "the article's tree" if method == "quadtree" else "the article's brute force"
    start = rivals.gas(1)
    row = begin(scene, start, Entrant(name, "jostle", 1, partial(rivals.jostle_world, threads=1)))
    row |= {"count": count, "substeps": 1, "manner": "its own rules and particles"}
    most = 50_000 if method == "quadtree" else 3_000
    return row, rivals.article(count, method) if count <= most else None


def after_a_second(running: RunningSimulation, start: InitialState) -> Row:
    """Run for one second; return the speed of the discs, the number of contacts, and errors.

    Positions are not compared: the motion is chaotic. For large scenes nothing is returned.
    """
    frame = next(reversed(running.frames.values()))
    compared = len(start) <= COMPARED_MOST
    for _ in range(CHECKED_FRAMES if compared else RUN_IN_FRAMES):
        frame()
    if not compared:
        return {}
    positions, velocities = running.state()
    near = np.asarray(start.radii, np.float64) * NEAR
    contacts = len(jostle.find_pairs(positions.astype(np.float64), near))
    note = "; ".join(faults(start, positions, velocities))
    return {"rms_speed": f"{rivals.speed(velocities):.2f}", "contacts": contacts, "note": note}


def stands_still(running: RunningSimulation, start: InitialState) -> bool:
    """Return whether most discs of a gas have not moved.

    With one thread, Box2D 3 moves none of 200,000 discs.
    """
    if start.restitution < 1:  # a pile is at rest
        return False
    positions, _ = running.state()
    moved = np.abs(positions - start.positions).max(axis=1) > 1e-3 * np.asarray(start.radii)
    return bool(moved.mean() < 0.5)


def faults(start: InitialState, positions: Column, velocities: Column) -> Iterator[str]:
    """Yield a note for discs outside the box, and one for a change of the energy of a gas.

    Only centres are compared with the box: in some engines discs overlap walls.
    """
    low, high = start.box[:2], start.box[2:]
    inside = np.all((positions >= low) & (positions <= high), axis=1)
    if not inside.all():
        yield f"{np.count_nonzero(~inside)} discs are outside the box"
    if start.restitution == 1 and start.gravity == (0, 0):
        share = energy(start, velocities) / energy(start, start.velocities)
        if not abs(share - 1) <= ENERGY_TOLERANCE:
            yield f"{100 * share:.0f} % of the energy is left"


def energy(start: InitialState, velocities: Column) -> float:
    """Return the kinetic energy."""
    return float(0.5 * start.masses @ np.einsum("ij,ij->i", velocities, velocities))


def at_its_best(entrant: Entrant, start: InitialState) -> Entrant:
    """Choose the fastest setting of a simulation for these discs."""
    if len(entrant.settings) > 1 and len(start) <= COMPARED_MOST:
        tried = [make(start) for make in entrant.settings.values()]
        frames = [next(reversed(running.frames.values())) for running in tried]
        for _ in range(CHECKED_FRAMES // 4):
            for frame in frames:
                frame()
        medians = [timing.median for timing in interleaved(frames, 5)]
        entrant.make = list(entrant.settings.values())[medians.index(min(medians))]
        for running in tried:
            running.close()
    return entrant
