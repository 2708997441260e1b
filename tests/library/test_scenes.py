"""`jostle.scenes`: every scene by name, at every size."""

from typing import Any

import numpy as np
import pytest

import jostle
from jostle import scenes

NAMES = [
    *("article", "gas", "pile", "rain", "mixed", "clusters", "shots", "billiards", "orbit"),
    *("springs", "stars", "thermostat", "sand", "galton", "brownian", "emitters", "heap"),
    *("mill", "conveyor", "piston", "pinball", "life", "flock", "fluid"),
]
# With immovable discs, which are additional.
WITH_FIXED = {"galton", "emitters", "heap", "mill", "conveyor", "pinball"}


def test_the_names() -> None:
    assert scenes.names() == NAMES
    assert scenes.create.__name__ == "create"


@pytest.mark.parametrize("name", NAMES)
def test_a_description_is_two_sentences(name: str) -> None:
    text = scenes.describe(name)
    assert text.count(". ") == 1
    assert text.endswith(".")
    assert "\n" not in text
    assert "  " not in text


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("n", [0, 1, 2, 3, 17, 400])
def test_any_number_of_particles(name: str, n: int) -> None:
    world = scenes.create(name, n=n)
    assert isinstance(world, jostle.World)
    assert (world.movable.sum() if name in WITH_FIXED else len(world)) == n
    world.step(1 / 60, steps=3)
    assert np.isfinite(world.positions).all()
    assert np.isfinite(world.velocities).all()


@pytest.mark.parametrize("name", NAMES)
def test_the_seed_decides_the_start(name: str) -> None:
    hashes = [scenes.create(name, 300, seed).state_hash() for seed in (0, 0, 1, 2**63)]
    assert hashes[0] == hashes[1] == scenes.create(name, n=300).state_hash()
    assert len({*hashes}) == 3


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("n", [None, 1, 5000])
def test_the_view_shows_something(name: str, n: int | None) -> None:
    min_x, min_y, max_x, max_y = scenes.view(name, n)
    assert min_x < max_x
    assert min_y < max_y
    world = scenes.create(name, n)
    if n is None:
        assert world.state_hash() == scenes.create(name, scenes.default_count(name)).state_hash()
    x, y = world.positions.T
    # Rain and piles start above the view and fall into it.
    assert (x >= min_x).all()
    assert (x <= max_x).all()
    assert (y <= max_y).all()


def test_the_scene_of_the_article() -> None:
    world = scenes.create("article")
    assert len(world) == 500
    assert world.container == jostle.Box(0, 0, 800, 500)
    assert scenes.view("article") == (0, 0, 800, 500)
    radii = world.radii
    assert {*radii.tolist()} == {5, 6, 7, 8, 9, 10}
    densities = world.masses / radii**2
    np.testing.assert_allclose(densities, densities.round())
    assert {*densities.round().tolist()} == {*range(1, 21)}


def test_the_gas_covers_two_fifths_of_its_box() -> None:
    world = scenes.create("gas", n=2000)
    box = world.container
    assert isinstance(box, jostle.Box)
    area = (box.max_x - box.min_x) * (box.max_y - box.min_y)
    assert np.pi * (world.radii.astype(float) ** 2).sum() / area == pytest.approx(0.4, rel=0.01)
    assert (world.restitution == 1).all() and not world.gravity.any()


def test_the_other_scenes_have_what_makes_them() -> None:
    assert isinstance(scenes.create("orbit").container, jostle.Circle)
    mixed = scenes.create("mixed").radii
    assert mixed.max() / mixed.min() == pytest.approx(100, rel=0.1)
    assert not scenes.create("shots").movable.all()
    assert scenes.create("pile").gravity[1] == 900
    assert len(scenes.create("billiards")) == 16


def test_the_cue_ball_passes_its_spin_on() -> None:
    world = scenes.create("billiards")
    spins = world.angular_velocities
    assert spins[0] > 0 and (spins[1:] == 0).all()
    world.step(1 / 60, steps=60)
    assert (world.angular_velocities[1:] != 0).sum() > 5
    assert 0 < world.angular_velocities[0] < spins[0]


def test_springs_hang_from_what_nothing_moves() -> None:
    world = scenes.create("springs")
    (springs,) = world.forces
    assert isinstance(springs, jostle.Springs)
    radii = world.radii
    assert (springs.lengths >= radii[springs.pairs].sum(axis=1)).all()
    cloth = ~world.movable & (world.radii == world.radii.min())
    assert np.ptp(world.positions[cloth, 1]) == 0
    before = world.positions[~world.movable]
    world.step(1 / 60, steps=30)
    np.testing.assert_array_equal(world.positions[~world.movable], before)


def test_two_gases_of_different_density() -> None:
    world = scenes.create("thermostat", n=1000)
    assert [type(force) for force in world.forces] == [jostle.Thermostat]
    densities = world.masses / world.radii**2
    assert {*densities.tolist()} == {1, 8}
    x = world.positions[:, 0]
    assert x[densities == 1].max() < x[densities == 8].min() + 2
    light, heavy = (np.hypot(*world.velocities[densities == d].T).mean() for d in (1, 8))
    assert light > 3 * heavy


def test_one_heavy_disc_at_rest_in_the_middle() -> None:
    world = scenes.create("brownian")
    box = world.container
    assert isinstance(box, jostle.Box)
    assert world.positions[0] == pytest.approx([box.max_x / 2, box.max_y / 2])
    assert world.velocities[0].tolist() == [0, 0]
    assert world.masses[0] > 100 * world.masses[1:].max()
    assert len(world.last_step.contacts.pairs) == 0


def test_the_galton_board_is_where_it_says() -> None:
    board = scenes.galton_board(200)
    world = scenes.create("galton", n=200)
    assert isinstance(board, scenes.GaltonBoard)
    assert len(board.bin_edges) == board.rows + 2
    assert board.bin_edges.dtype == np.float32
    view = scenes.view("galton", 200)
    assert (view[0], view[2]) == (board.bin_edges[0], board.bin_edges[-1])
    assert view[3] == board.floor > board.bin_top > 0
    assert world.radii[world.movable].tolist() == pytest.approx([board.ball_radius] * 200)
    walls = world.walls.segments
    bins = walls[walls[:, :, 1].min(axis=1) >= board.bin_top]
    assert (bins[:, 0, 0] == bins[:, 1, 0]).all()
    np.testing.assert_array_equal(bins[:, 0, 0], board.bin_edges[1:-1])


@pytest.mark.usefixtures("usual_threads")
@pytest.mark.parametrize("n", [300, 1500])
def test_the_fountain_runs_by_itself(n: int) -> None:
    """Drops leave the basin through the nozzles as long as it is stepped, and none is lost."""
    world = scenes.create("emitters", n)
    assert [type(force) for force in world.forces] == [jostle.Pump] * 3
    assert world.movable.sum() == n
    level, top = -120 * (n / 3000) ** 0.5, scenes.view("emitters", n)[1]
    for _ in range(8):
        before = world.positions[world.movable]
        world.step(1 / 60, 60)
        drops = world.positions[world.movable]
        flying = drops[:, 1] < level
        # In each second a part of what was in the basin has begun to fly.
        assert 0.1 < flying.mean() < 0.8
        assert (flying & (before[:, 1] >= level)).mean() > 0.02
        assert drops[:, 1].min() > top * 1.2
    assert world.movable.sum() == n and world.ids[-1] == len(world) - 1


@pytest.mark.usefixtures("usual_threads")
@pytest.mark.parametrize(
    ("name", "n", "seconds"), [("mill", 150, 15), ("conveyor", 300, 8), ("pinball", 30, 60)]
)
def test_machines_keep_discs_inside_and_moving(name: str, n: int, seconds: int) -> None:
    world = scenes.create(name, n)
    view = np.array(scenes.view(name, n))
    world.step(1 / 60, steps=60 * seconds)
    before = world.positions[world.movable]
    assert ((before > view[:2]) & (before < view[2:])).all()
    world.step(1 / 60, steps=300)
    moved = np.hypot(*(world.positions[world.movable] - before).T)
    assert (moved > 1).mean() > 0.8


def test_the_piston_heats_the_gas_and_cools_it() -> None:
    world = scenes.create("piston", 400)
    length = world.walls.segments[0, 0, 0]
    energy = world.kinetic_energy()
    world.step(1 / 60, steps=480)
    assert world.walls.segments[0, 0, 0] == pytest.approx(length / 2, rel=1e-4)
    assert (world.positions[:, 0] < world.walls.segments[0, 0, 0]).all()
    # For points the adiabatic factor is 2; it is larger for a covered area of 1/5 to 2/5.
    assert 3 < world.kinetic_energy() / energy < 5
    world.step(1 / 60, steps=480)
    assert 0.8 < world.kinetic_energy() / energy < 1.4
    assert (world.positions[:, 0] < length).all()


NO_SCENE = f"name is 'chess'; the scenes are {', '.join(NAMES)}"


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: scenes.create("chess"), ValueError, NO_SCENE),
        (lambda: scenes.describe("chess"), ValueError, NO_SCENE),
        (lambda: scenes.view("chess"), ValueError, NO_SCENE),
        (lambda: scenes.default_count("chess"), ValueError, NO_SCENE),
        (lambda: scenes.galton_board(10**12), ValueError, "n is 1000000000000; a scene holds"),
        (lambda: scenes.create("gas", n=-1), ValueError, "n is -1; it must be at least 0"),
        (lambda: scenes.create("gas", n=10**12), ValueError, "n is 1000000000000; a scene holds"),
        (lambda: scenes.view("gas", n=10**12), ValueError, "n is 1000000000000; a scene holds"),
        (lambda: scenes.create("gas", seed=-1), ValueError, "seed is -1; it must be at least 0"),
        (lambda: scenes.create("gas", seed=2**64), ValueError, f"seed is {2**64}; it must be at"),
        (lambda: scenes.create(3), TypeError, "name must be the name of a scene, not int"),
        (lambda: scenes.describe(None), TypeError, "name must be the name of a scene, not None"),
        (lambda: scenes.create("gas", n=1.5), TypeError, "n must be an integer, not float"),
        (lambda: scenes.view("gas", n="all"), TypeError, "n must be an integer, not str"),
        (lambda: scenes.create("gas", seed="x"), TypeError, "seed must be an integer, not str"),
        (lambda: scenes.create("gas", seed=None), TypeError, "seed must be an integer, not None"),
    ],
)
def test_refused(call: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=f"^{message}"):
        call()
