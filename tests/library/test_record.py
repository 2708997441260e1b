"""Films, trajectories and tables of worlds, read again with other libraries."""

import csv
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import jostle
from jostle.record import Film, record, write_png, write_states
from jostle.record.picture import STAGE, Camera

imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg")
Image = pytest.importorskip("PIL.Image")
hoomd = pytest.importorskip("gsd.hoomd")

from outputs import frames_of  # noqa: E402 (it needs imageio-ffmpeg)
from signals import full_disk  # noqa: E402

SUFFIXES = [".mp4", ".gif", ".gsd", ".csv", ".npz"]
BOX = jostle.Box(0, 0, 40, 20)


def some(n: int = 30, **options: object) -> jostle.World:
    rng = np.random.default_rng(1)
    options = {"container": BOX, "gravity": (0, 10)} | options
    return jostle.World(
        rng.uniform(2, 18, (n, 2)), rng.uniform(0.2, 1, n), velocities=rng.normal(0, 5, (n, 2)),
        **options,
    )  # fmt: skip


WORLDS = {
    "empty": jostle.World,
    "one": lambda: jostle.World([(3, 4)], 2.0),
    "at one place": lambda: jostle.World([(3, 4), (3, 4)], 2.0),
    "without walls": lambda: some(container=None),
    "torus": lambda: some(container=None, period=(20, 30)),
    "circle": lambda: some(container=jostle.Circle((10, 10), 15)),
    "walls": lambda: some(walls=[[(0, 15), (40, 19)]], sensors=np.arange(30) % 2 == 0),
    "kinds": lambda: some(kinds=np.arange(30) % 3, movable=np.arange(30) % 5 > 0),
}


def pictures_of(path: Path) -> Iterator[np.ndarray]:
    """The pictures of a GIF, by Pillow."""
    with Image.open(path) as film:
        for frame in range(film.n_frames):
            film.seek(frame)
            yield np.asarray(film.convert("RGB"))


@pytest.mark.parametrize("suffix", [".mp4", ".gif"])
@pytest.mark.parametrize("size", [(64, 48), (65, 48), (64, 49), (65, 49), (3, 5)])
def test_films_of_any_size_have_the_pictures(tmp_path: Path, suffix: str, size) -> None:
    colours = [(16, 20, 26), (47, 103, 155), (233, 192, 116), (104, 113, 126)]
    with Film(tmp_path / f"film{suffix}", size) as film:
        for colour in colours:
            film.add(np.full((size[1], size[0], 3), colour, np.uint8))
    pictures = frames_of(tmp_path / f"film{suffix}")
    assert len(pictures) == film.frames == 4
    height, width = pictures[0].shape[:2]
    assert (width, height) == (size if suffix == ".gif" else tuple(s + s % 2 for s in size))
    for colour, picture in zip(colours if min(size) > 9 else (), pictures, strict=False):
        assert picture[: size[1], : size[0]].mean((0, 1)) == pytest.approx(colour, abs=6)


def test_a_gif_has_the_colours_of_each_picture_the_times_and_no_end(tmp_path: Path) -> None:
    world, path = some(), tmp_path / "film.gif"
    camera, pictures = Camera(world, 320), []
    with Film(path, camera.size, rate=30) as film:
        for _ in range(6):
            world.step(1 / 30)
            pictures.append(camera.picture(world))
            film.add(pictures[-1])
        film.add(pictures[-1])  # nothing changes
    found = list(pictures_of(path))
    assert len(found) == 7
    for one, other in zip(found, [*pictures, pictures[-1]], strict=True):
        assert np.abs(one.astype(int) - other).max() < 32  # a wrong palette is far off
        assert np.abs(one.astype(int) - other).mean() < 0.5
    with Image.open(path) as film:
        times = [film.seek(frame) or film.info["duration"] for frame in range(7)]
        assert film.info["loop"] == 0 and sum(times) == 230 and set(times) == {30, 40}


@pytest.mark.parametrize("name", WORLDS)
def test_a_picture_has_the_discs_where_they_are(name: str) -> None:
    world = WORLDS[name]()
    camera = Camera(world, 400)
    picture = camera.picture(world).astype(int)
    assert picture.dtype == int and picture.shape == (*camera.size[::-1], 3)
    assert max(camera.size) in (400, 402) and min(camera.size) >= 2
    back = Camera(world, 400).picture(jostle.World(container=world.container, period=world.period))
    places = (world.positions - camera._corner) * camera._scale
    for (x, y), radius, sensor in zip(places, world.radii, world.sensors, strict=True):
        column, row = int(x), int(y)
        if not sensor and radius > 0 and 0 <= row < len(picture) and 0 <= column < picture.shape[1]:
            assert np.abs(picture[row, column] - back[row, column]).sum() > 60


def test_a_container_has_a_ground_and_an_edge() -> None:
    world = jostle.World(container=BOX)
    picture = Camera(world, 400).picture(world)
    assert picture[100, 200].tolist() == list(STAGE)
    assert (picture.sum(axis=2) > 250).any(axis=1).sum() > 150
    fast = jostle.World([(10, 10), (30, 10)], 3, velocities=[(9, 0), (0, 0)], container=BOX)
    camera = Camera(fast, 400)
    left, right = (camera.picture(fast)[100, x].astype(int) for x in (110, 290))
    assert left.sum() > right.sum() + 60, "a fast disc is brighter"


@pytest.mark.parametrize("radius", [40.0, 1e3, 1e5, 1e7, 1e9])
def test_a_disc_of_any_size_covers_what_is_inside_of_it(radius: float) -> None:
    camera = Camera(jostle.World(container=BOX), 400)
    rows, columns = np.indices(camera.size[::-1]) + 0.5
    for x, y in ((20 - radius, 10), (20, 10 + radius), (20 - 0.6 * radius, 10 - 0.8 * radius)):
        places = [np.float32(x), np.float32(y)]
        world = jostle.World([places], radius)
        picture = camera.picture(world).astype(int)
        center = (np.array(places, float) - camera._corner) * camera._scale
        depth = radius * camera._scale - np.hypot(columns - center[0], rows - center[1])
        covered = np.abs(picture - picture[-1, -1]).sum(axis=2) > 60
        if depth[-1, -1] > 0:
            covered = ~covered
        assert (covered == (depth > 0))[np.abs(depth) > 3].all()


def test_discs_that_are_far_away_leave_no_trace() -> None:
    near, picture = jostle.World([(0, 0), (5, 0)], 1.0), []
    camera = Camera(near, 320)
    for far in (1e3, 1e6, 1e9, 1e15):
        world = jostle.World([(0, 0), (far, -far)], 1.0)
        picture.append(camera.picture(world))
        assert (picture[-1] == picture[0]).all()


@pytest.mark.parametrize("name", WORLDS)
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_every_world_is_written_in_every_format(tmp_path: Path, name: str, suffix: str) -> None:
    world, same, path = WORLDS[name](), WORLDS[name](), tmp_path / f"world{suffix}"
    seen: list[tuple[int, int]] = []
    record(world, path, 0.02, 5, every=2, progress=lambda *done: seen.append(done))
    assert [*tmp_path.iterdir()] == [path]
    assert seen == [(2, 5), (4, 5)]
    same.step(0.02, 5)
    assert world.state_hash() == same.state_hash()
    if suffix in (".mp4", ".gif"):
        assert len(frames_of(path)) == 3
    elif suffix == ".gsd":
        with hoomd.open(str(path), "r") as trajectory:
            assert [frame.particles.N for frame in trajectory] == [len(world)] * 3
    elif suffix == ".npz":
        assert len(np.load(path)["ids"]) == 3 * len(world)
    else:
        assert path.read_text().count("\n") == 1 + 3 * len(world)


def recorded(path: Path) -> list[jostle.World]:
    """Record a world that loses a particle; return copies of its states."""
    world, copies = some(), []

    def states() -> Iterator[jostle.World]:
        for step in range(3):
            if step == 2:
                world.remove(4)
            world.step(0.1)
            copies.append(jostle.World.restore(world.snapshot()))
            yield world

    write_states(path, states())
    return copies


def test_npz_has_the_same_bits(tmp_path: Path) -> None:
    states, data = recorded(tmp_path / "w.npz"), np.load(tmp_path / "w.npz")
    assert data["times"].tolist() == [state.time for state in states]
    assert data["offsets"].tolist() == [0, 30, 60, 89]
    for k, state in enumerate(states):
        rows = slice(*data["offsets"][k : k + 2])
        for name in set(data) - {"times", "offsets"}:
            column = getattr(state, name)
            assert data[name].dtype == column.dtype
            np.testing.assert_array_equal(data[name][rows], column)
    assert {"ids", "positions", "velocities", "angles", "radii", "masses"} < set(data)


def test_csv_has_a_row_for_each_particle_with_the_same_bits(tmp_path: Path) -> None:
    states = recorded(tmp_path / "w.csv")
    with (tmp_path / "w.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [*rows[0]] == ["time", "id", "x", "y", "vx", "vy", "radius", "mass"]
    found = {name: [row[name] for row in rows] for name in rows[0]}
    together = {
        "time": [state.time for state in states for _ in range(len(state))],
        "id": np.concatenate([state.ids for state in states]),
        "x": np.concatenate([state.positions[:, 0] for state in states]),
        "vy": np.concatenate([state.velocities[:, 1] for state in states]),
        "mass": np.concatenate([state.masses for state in states]),
    }
    for name, column in together.items():
        kind = np.asarray(column).dtype
        np.testing.assert_array_equal(np.array(found[name]).astype(float).astype(kind), column)


def test_gsd_has_the_schema_of_hoomd(tmp_path: Path) -> None:
    states = recorded(tmp_path / "w.gsd")
    with hoomd.open(str(tmp_path / "w.gsd"), "r") as trajectory:
        assert [frame.configuration.step for frame in trajectory] == [0, 1, 2]
        for frame, state in zip(trajectory, states, strict=True):
            assert frame.configuration.dimensions == 2
            assert frame.configuration.box[:2].tolist() == [40, 20]
            flip = np.array([1, -1])
            here = frame.particles.position[:, :2] * flip + (20, 10)
            np.testing.assert_allclose(here, state.positions, rtol=1e-5, atol=1e-5)
            np.testing.assert_array_equal(frame.particles.velocity[:, :2] * flip, state.velocities)
            np.testing.assert_array_equal(frame.particles.diameter, 2 * state.radii)
            np.testing.assert_array_equal(frame.particles.mass, state.masses)
            np.testing.assert_array_equal(frame.log["particles/id"], state.ids)
            assert frame.log["time"] == [state.time]


def test_a_png_is_the_picture(tmp_path: Path) -> None:
    picture = np.random.default_rng(0).integers(0, 255, (7, 9, 3), np.uint8)
    write_png(tmp_path / "p.png", picture[:, ::-1])
    assert (np.asarray(Image.open(tmp_path / "p.png")) == picture[:, ::-1]).all()


@pytest.mark.parametrize(
    ("path", "arguments", "said"),
    [
        (
            "w.mpg4",
            {},
            r"path is '.*w\.mpg4'; it must end with one of \.mp4, .*; did you mean \.mp4",
        ),
        ("w", {}, r"path is '.*w'; it must end with one of \.mp4, \.gif, \.gsd, \.csv, \.npz$"),
        ("w.csv", {"steps": -1}, "steps is -1; it must be at least 0"),
        ("w.csv", {"every": 0}, "every is 0; it must be at least 1"),
        ("w.csv", {"dt": 0}, "dt is 0; it must be finite and above 0"),
    ],
)
def test_wrong_arguments_change_nothing(tmp_path: Path, path: str, arguments, said: str) -> None:
    world = some()
    before = world.state_hash()
    with pytest.raises(ValueError, match=said):
        record(world, tmp_path / path, **{"dt": 0.1, "steps": 3} | arguments)
    assert world.state_hash() == before and not [*tmp_path.iterdir()]


def test_wrong_pictures_and_rates_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"film\.avi'; it must end with one of \.mp4, \.gif$"):
        Film(tmp_path / "film.avi", (4, 4))
    with pytest.raises(ValueError, match="rate is 0; it must be finite and above 0"):
        Film(tmp_path / "film.gif", (4, 4), rate=0)
    with pytest.raises(ValueError, match=r"size is \(0, 4\)"):
        Film(tmp_path / "film.gif", (0, 4))
    with Film(tmp_path / "film.gif", (4, 6)) as film:
        for wrong in (np.zeros((4, 6, 3), np.uint8), np.zeros((6, 4, 3)), np.zeros(3, np.uint8)):
            with pytest.raises(ValueError, match=r"it must be \(6, 4, 3\) of uint8"):
                film.add(wrong)
    with pytest.raises(ValueError, match=r"it must be \(height, width, 3\) of uint8"):
        write_png(tmp_path / "p.png", np.zeros((6, 4), np.uint8))
    assert not [*tmp_path.iterdir()], "a film without pictures leaves no file"


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_folder_that_is_not_there_is_refused(tmp_path: Path, suffix: str) -> None:
    world = some()
    with pytest.raises(FileNotFoundError):
        record(world, tmp_path / "no" / f"w{suffix}", 0.1, 3)
    assert world.time == 0.0


@pytest.mark.skipif(sys.platform == "win32", reason="there are no limits of processes")
@pytest.mark.parametrize("is_there", [True, False])
@pytest.mark.parametrize("suffix", [*SUFFIXES, ".png"])
def test_a_full_disk_leaves_the_old_file(tmp_path: Path, suffix: str, is_there: bool) -> None:
    path = tmp_path / f"w{suffix}"
    if is_there:
        path.write_bytes(b"old")
    world = some()
    with full_disk(), pytest.raises(OSError):
        if suffix == ".png":
            write_png(path, Camera(world, 200).picture(world))
        else:
            record(world, path, 0.02, 4)
    assert [*tmp_path.iterdir()] == ([path] if is_there else [])
    assert not is_there or path.read_bytes() == b"old"


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_an_interruption_keeps_a_film_that_plays_and_nothing_else(tmp_path, suffix: str) -> None:
    path = tmp_path / f"w{suffix}"
    path.write_bytes(b"old")

    def stop(done: int, total: int) -> None:
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        record(some(), path, 0.02, 9, progress=stop)
    assert [*tmp_path.iterdir()] == [path]
    if suffix in (".mp4", ".gif"):
        assert len(frames_of(path)) == 4
    else:
        assert path.read_bytes() == b"old"


def test_an_ffmpeg_that_dies_or_is_missing_is_an_error(tmp_path: Path, monkeypatch) -> None:
    dying = tmp_path / "ffmpeg"
    dying.write_text("#!/bin/sh\nhead -c 1000 > /dev/null\necho '[x] a reason' >&2\nexit 1\n")
    dying.chmod(0o755)
    monkeypatch.setattr(imageio_ffmpeg, "get_ffmpeg_exe", lambda: str(dying))
    with pytest.raises(OSError, match=r"^a reason$"):
        record(some(), tmp_path / "film.mp4", 0.02, 50)
    monkeypatch.setattr(imageio_ffmpeg, "get_ffmpeg_exe", lambda: str(tmp_path / "none"))
    with pytest.raises(OSError, match="no ffmpeg can be started"):
        record(some(), tmp_path / "film.mp4", 0.02, 50)
    assert [*tmp_path.iterdir()] == [dying]


def test_a_missing_package_is_named_and_numpy_is_enough_to_import(tmp_path: Path) -> None:
    code = """
import sys
import jostle.record
loaded = {"PIL", "gsd", "imageio_ffmpeg"} & set(sys.modules)
assert not loaded, loaded
sys.modules.update(dict.fromkeys(("PIL", "gsd", "gsd.hoomd", "imageio_ffmpeg")))
world = jostle.World([(0, 0)], 1.0)
for suffix in ("gif", "gsd"):
    try:
        jostle.record.record(world, f"w.{suffix}", 0.1, 1)
    except ModuleNotFoundError as error:
        print(error)
jostle.record.record(world, "w.npz", 0.1, 1)
"""
    child = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert child.stdout.splitlines() == [
        "a picture of a world needs the package PIL: pip install 'jostle[record]'",
        "a trajectory needs the package gsd: pip install 'jostle[record]'",
    ]
    assert [path.name for path in tmp_path.iterdir()] == ["w.npz"]
