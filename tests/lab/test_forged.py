"""Scene files with a right checksum and wrong contents: they are refused, or they run.

A checksum says that nothing was lost, not who wrote the file. So each field of valid files is set
to values that jostle does not write, and the file is sealed again. The app must either refuse it in
one sentence and keep the scene that runs, or go on with the file: step, draw, save and load again.
`python tests/test_app_forged.py` tries every change instead of a sample, which takes many minutes.
"""

from __future__ import annotations

import copy
import random
import sys
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import jostle
from jostle_lab.draw.software import SoftwarePainter
from jostle_lab.draw.view_options import ColourBy, TreeView
from jostle_lab.session import Session
from jostle_lab.simulate.packing import pack, seal, unpack, unseal
from jostle_lab.simulate.settings import Group, Settings
from jostle_lab.simulate.start import start

SIZE = (160, 90)
SAMPLE = 150  # changes that a test run tries

SCENES = [
    Settings("gas", 12, gravity=(1.0, 2.0), container="circle"),
    Settings("emitters", 20),
    Settings("springs", 20),
    Settings("orbit", 12, on_touch="merge", world_size=2.0),
    Settings("pile", 8, particles=(Group(3, radius=(2.0, 4.0), region=(0, 0, 50, 50)),)),
    Settings("galton", 12),
    Settings("thermostat", 12, container="torus"),
    Settings("brownian", 12, container="none"),
    Settings("mixed", 8, method="brute"),
]

VALUES: list[Any] = [
    *(None, True, "x", "", "nan", "\n", [], {}, [[]], [None], {"x": 1}),
    *(-1, 0, 1, 0.5, -0.5, 10**9, 2**31, 2**53, 2**63, -(2**64), 10**400),
    *(1e-320, 1e18, 1e30, 1e300, -1e300, float("inf"), float("-inf"), float("nan")),
    *([0, 0], [1, 1], [1e300, 1e300], [float("nan"), 0], [0, 0, 0, 0], [0, 0, 1e-300, 1e-300]),
    *([-1e18, -1e18, 1e18, 1e18], [1, 1, 0, 0], [1] * 100, ["x"] * 4),
    *("quadtree", "brute", "article-quadtree", "emitters", "article", "galton"),
]

Change = tuple[str, str, Any]  # which of the three parts of a file, where, and to what
REMOVED = object()


def saved(settings: Settings, folder: Path) -> bytes:
    """The file of a scene, with a wall and with attractions."""
    session = Session(start(settings), SIZE, synchronous=True)
    for _ in range(3):
        session.engine.step()
    x0, y0, x1, y1 = session.engine.view
    session.interaction.commands.wall((x0, y0), (x0 + (x1 - x0) / 50, y0))
    session.interaction.attractors.place(((x0 + x1) / 2, (y0 + y1) / 2))
    session.interaction.attractors.set_attracting(session.frame.tags[:2], True)
    session.camera.zoom_at((10, 10), 1.5)
    path = folder / "valid.jostle"
    session.files.save(path)
    session.close()
    return path.read_bytes()


def paths_of(facts: Any) -> Iterator[tuple[Any, ...]]:
    """The path of every field of nested tables and lists."""
    inner = facts.items() if isinstance(facts, dict) else enumerate(facts)
    for name, value in inner:
        yield (name,)
        if isinstance(value, (dict, list)):
            for path in paths_of(value):
                yield (name, *path)


def put(facts: Any, path: tuple[Any, ...], value: Any) -> None:
    """Set or remove what a path leads to."""
    for name in path[:-1]:
        facts = facts[name]
    if value is REMOVED:
        del facts[path[-1]]
    else:
        facts[path[-1]] = value


def arrays_like(array: np.ndarray) -> Iterator[np.ndarray]:
    """Other arrays in the place of one."""
    yield from (array[:-1], np.concatenate([array, array[-1:]]), array[:0], array[None])
    yield from (array.astype(np.float64), array.astype(np.float32), array.reshape(-1)[:1])
    numbers = [0, -1, 1, 10**9, 2**62, -(2**62)]
    if array.dtype.kind == "f":
        numbers += [np.nan, np.inf, -np.inf, 1e-320, 1e17, 1e18, 1e30, -1e30, 1e300, 1e308]
    if array.dtype.kind == "u":
        numbers = [0, 255]
    for at in {0, array.size // 2, array.size - 1} & set(range(array.size)):
        for number in numbers:
            other = array.copy()
            other.reshape(-1)[at] = number
            yield other
    for number in numbers:
        yield np.full_like(array, number)
    yield array[::-1].copy()


class File:
    """A scene file taken apart: `scene` and `state` facts, and arrays of the state."""

    def __init__(self, data: bytes) -> None:
        self.scene, (state,) = unpack("scene", unseal(data), 1)
        self.state, (born, world) = unpack("world", state, 2)
        self.arrays = {"born": np.frombuffer(born), "world": np.frombuffer(world, np.uint8)}

    def changes(self) -> Iterator[Change]:
        """Every change."""
        for part in ("scene", "state"):
            facts = getattr(self, part)
            for path in paths_of(facts):
                for value in (*VALUES, REMOVED):
                    yield part, path, value
        for name, array in self.arrays.items():
            yield "arrays", (name,), REMOVED
            for other in arrays_like(array):
                yield "arrays", (name,), other

    def forged(self, *changes: Change) -> bytes:
        """The file with some changes, sealed again."""
        parts = copy.deepcopy({"scene": self.scene, "state": self.state, "arrays": self.arrays})
        for part, path, value in changes:
            put(parts[part], path, value)
        arrays = [array.tobytes() for array in parts["arrays"].values()]
        return seal(pack("scene", parts["scene"], pack("world", parts["state"], *arrays)))


class Trial:
    """A running session that files are loaded into."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / "forged.jostle"
        self.again = folder / "again.jostle"
        self.painter = SoftwarePainter(SIZE)
        self.loaded = self.refused = 0

    def load(self, data: bytes) -> str:
        """Load a file; return the error, or None if the session continues with it."""
        session = Session(start(Settings("gas", 3)), SIZE, synchronous=True)
        before = session.engine.simulation, session.frame, session.camera.center
        self.path.write_bytes(data)
        session.files.load(self.path)
        if session.message != "Loaded forged.jostle":
            assert before == (session.engine.simulation, session.frame, session.camera.center)
            assert session.message.startswith("forged.jostle")
            assert "\n" not in session.message and len(session.message) < 300, session.message
            self.refused += 1
            return session.message
        self.loaded += 1
        self.go_on(session)
        return ""

    def go_on(self, session: Session) -> None:
        """Step, draw with all that can be shown, save and load again."""
        session.settings.time_scale = 1.0
        shown = session.view_options
        shown.tree, shown.colour_by = TreeView.FILLED, ColourBy.VELOCITY
        shown.contacts = shown.velocities = shown.trails = shown.labels = True
        for _ in range(3):
            session.advance(1 / 60)
            session.draw(self.painter)
        session.camera.home()
        session.draw(self.painter)
        session.runner.adjust("world_size", 0.5)
        session.files.save(self.again)
        session.files.load(self.again)
        assert session.message == "Loaded again.jostle", session.message
        session.close()


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> list[File]:
    folder = tmp_path_factory.mktemp("scenes")
    return [File(saved(settings, folder)) for settings in SCENES]


def test_a_forged_file_is_refused_or_runs(files: list[File], tmp_path: Path) -> None:
    chance, trial = random.Random(1), Trial(tmp_path)
    with np.errstate(all="ignore"):
        for file in files:
            assert not trial.load(file.forged())
            changes = list(file.changes())
            for change in chance.sample(changes, SAMPLE // len(files)):
                trial.load(file.forged(change))
    assert trial.refused > trial.loaded > len(files)


NAMED: list[tuple[str, tuple[Any, ...], Any, str]] = [
    ("state", ("settings", "particles"), ["x"], "settings.particles[0] is 'x'; it must be a table"),
    ("state", ("settings", "method"), None, "settings.method is None; it must be one of quadtree"),
    ("state", ("settings", "n"), 10**400, "settings.n is 1000000"),
    ("state", ("settings",), "gas", "settings is 'gas'; it must be a table"),
    ("state", ("settings", "seeb"), 0, "settings.seeb is not a setting; did you mean seed?"),
    ("scene", ("camera", "scale"), REMOVED, "camera.scale is missing"),
    ("scene", ("camera", "center"), [0, float("nan")], "camera.center is [0, nan]; it must be [x,"),
    ("scene", ("shown", "labels"), "yes", "shown.labels is 'yes'; it must be true or false"),
    ("scene", ("shown", "tree"), "outlime", "shown.tree is 'outlime'; it must be one of off, out"),
    ("state", ("pulls", 0, "strength"), True, "pulls[0].strength is true; it must be a number"),
    ("state", ("home", "kind"), "cone", "home.kind is 'cone'; it must be one of box, circle"),
    ("state", ("view",), [1, 0, 0, 1], "view is [1, 0, 0, 1]; it must be [min_x, min_y, max_x"),
    ("state", ("own_forces",), 99, "own_forces is 99; its world has"),
    ("arrays", ("born",), np.zeros(3), "born has 24 bytes; it must have "),
    ("arrays", ("born",), REMOVED, "it is damaged"),
]


@pytest.mark.parametrize(
    ("part", "path", "value", "words"), NAMED, ids=[words[:30] for *_, words in NAMED]
)
def test_a_refusal_names_the_field_and_the_value(
    files: list[File], tmp_path: Path, part: str, path: tuple, value: object, words: str
) -> None:
    said = Trial(tmp_path).load(files[0].forged((part, path, value)))
    assert said.startswith(f"forged.jostle cannot be loaded: {words}"), said


def try_all(folder: Path, seconds: Callable[[], float]) -> None:
    """Try every change, and some pairs of changes."""
    chance, trial = random.Random(2), Trial(folder)
    first = int(sys.argv[1]) if len(sys.argv) > 1 else 0
    for settings in [*SCENES, *(Settings(name, 10) for name in jostle.scenes.names())][first:]:
        file = File(saved(settings, folder))
        changes = list(file.changes())
        pairs = [tuple(chance.sample(changes, 2)) for _ in range(len(changes) // 2)]
        for chosen in [*((change,) for change in changes), *pairs]:
            try:
                data = file.forged(*chosen)
            except (KeyError, IndexError, TypeError):
                continue  # the second change is to what the first has removed
            try:
                began = seconds()
                trial.load(data)
                if seconds() - began > 2:
                    print("slow", settings.scene, chosen, seconds() - began, flush=True)
            except BaseException as error:
                print(settings.scene, settings.method, chosen, repr(error)[:200], flush=True)
                if not isinstance(error, Exception):
                    raise
        print(settings.scene, settings.method, trial.refused, "refused", trial.loaded, "ran")


if __name__ == "__main__":
    import tempfile
    import time

    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as folder:
        try_all(Path(folder), time.perf_counter)
    sys.exit(0)
