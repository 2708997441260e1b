"""What single scenes draw and do beyond their particles."""

import math

import numpy as np
import pytest
from lab_overlays import Notes, camera_of_pixels, frame_of

import jostle
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.scene_overlays import SceneOverlays, binomial
from jostle_lab.schema import Settings
from jostle_lab.simulate.containers import bounds, center_of
from jostle_lab.simulate.region import container_of
from jostle_lab.simulate.start import start

PATH_POINTS = 60  # in these tests


def test_the_curve_is_the_binomial_distribution() -> None:
    chances = binomial(np.arange(11), 10)
    assert chances == pytest.approx([math.comb(10, k) / 1024 for k in range(11)])
    between = binomial(np.array([4.5, 5.5]), 10)
    assert chances[4] < between[0] < chances[5] and between[0] == pytest.approx(between[1])


def test_galton_counts_the_balls_in_each_bin() -> None:
    board = jostle.scenes.galton_board(100)
    middles = (board.bin_edges[:-1] + board.bin_edges[1:]) / 2
    floor = board.floor - board.ball_radius
    places = [(middles[2], floor)] * 3 + [(middles[4], floor)] * 2 + [(0.0, -10.0)]
    frame = frame_of(places, board.ball_radius, scene="galton", begun_with=100)
    notes, camera = Notes((1280, 720)), Camera((1280, 720), (-300, -100, 300, board.floor))
    said = SceneOverlays().draw_above(notes, frame, camera)
    assert said == ["5 of 6 in bins; line: binomial"]
    assert len(notes.sheets_drawn()) == board.rows + 1
    ends = notes.lines_drawn()
    peak = ends[np.argmin(ends[:, 1]), 0]
    (centre,), _ = camera.to_screen(np.array([[0.0, 0.0]]))
    assert peak == pytest.approx(centre, abs=16)  # highest in the middle, low at both ends
    assert ends[0, 1] > ends[:, 1].min() and ends[-1, 3] > ends[:, 1].min()


def test_the_path_of_the_heavy_particle_is_where_it_has_been_and_stays_short(monkeypatch) -> None:
    extras = SceneOverlays()
    for step in range(10):
        frame = frame_of([(0, 0), (100 + 5 * step, 80)], [1, 9], time=step / 30, scene="brownian")
        notes = Notes()
        extras.draw_below(notes, frame, camera_of_pixels())
    ends = notes.lines_drawn()
    assert ends[0, :2] == pytest.approx((100, 80)) and ends[-1, 2:] == pytest.approx((145, 80))
    (said,) = extras.draw_above(notes, frame, camera_of_pixels())
    assert "45" in said
    monkeypatch.setattr("jostle_lab.draw.scene_overlays.PATH_POINTS", PATH_POINTS)
    extras, notes = SceneOverlays(), Notes()
    for step in range(3 * PATH_POINTS):
        notes = Notes()
        frame = frame_of([(step / 100, 50)], time=step / 30, scene="brownian")
        extras.draw_below(notes, frame, camera_of_pixels())
    ends = notes.lines_drawn()
    assert len(ends) <= PATH_POINTS and ends[0, 0] == pytest.approx(0)
    assert ends[-1, 2] == pytest.approx(3 * PATH_POINTS / 100, abs=0.2)


@pytest.mark.parametrize(("swapped", "mixed"), [(0, "0 %"), (1, "100 %"), (2, "0 %")])
def test_two_gases_are_mixed_when_half_of_each_is_on_each_side(swapped: int, mixed: str) -> None:
    left, right = [(10, 10), (10, 30)], [(90, 10), (90, 30)]
    light, heavy = (left, right) if swapped != 2 else (right, left)
    if swapped == 1:
        light, heavy = [left[0], right[0]], [left[1], right[1]]
    frame = frame_of([*light, *heavy], densities=[1, 1, 9, 9], scene="thermostat")
    said = SceneOverlays().draw_above(Notes(), frame, camera_of_pixels())
    assert said[0] == f"mixed: {mixed}"


def test_stars_are_counted_other_scenes_have_no_extras_and_none_needs_particles() -> None:
    frame = frame_of([(0, 0), (9, 9)], [1.0, 3.0], scene="stars")
    said = SceneOverlays().draw_above(Notes(), frame, camera_of_pixels())
    assert said == ["2 bodies; largest: 90 % of the mass"]
    frame = frame_of([(1, 1)], scene="gas")
    assert SceneOverlays().draw_above(Notes(), frame, camera_of_pixels()) == []
    for scene in ("galton", "brownian", "thermostat", "stars"):
        notes, extras = Notes(), SceneOverlays()
        extras.draw_below(notes, frame_of([], scene=scene), camera_of_pixels())
        assert extras.draw_above(notes, frame_of([], scene=scene), camera_of_pixels()) == []


def test_drops_of_a_fountain_stay_the_same_particles() -> None:
    simulation = start(Settings("emitters", 120))
    first = simulation.frame()
    for _ in range(120):
        simulation.step()
    frame = simulation.frame()
    assert (frame.tags == first.tags).all() and frame.movable.sum() == 120
    assert simulation.adjust("n", 60) is None
    simulation.step()
    assert simulation.frame().movable.sum() == 60


def test_a_fountain_goes_on_from_a_state_as_it_went_on_the_first_time() -> None:
    simulation = start(Settings("emitters", 150, seed=5))
    for _ in range(30):
        simulation.step()
    state, hashes = simulation.save(), []
    for _ in range(2):
        for _ in range(40):
            simulation.step()
        hashes.append((simulation.world.state_hash(), simulation.frame().tags.tolist()))
        simulation.load(state)
    assert hashes[0] == hashes[1]


def test_a_fountain_moves_with_its_container() -> None:
    """Drains and nozzles stay where they are in the basin."""
    simulation = start(Settings("emitters", 200))
    before = simulation.world.forces
    offset = center_of(bounds(container_of(simulation.world)))
    assert simulation.adjust("world_size", 1.5) is None
    by = np.subtract(center_of(bounds(container_of(simulation.world))), offset)
    for old, new in zip(before, simulation.world.forces, strict=True):
        assert new.position == pytest.approx(np.add(old.position, by), abs=1e-2)
        assert new.drain == pytest.approx(np.add(old.drain, np.tile(by, 2)), abs=1e-2)
        assert (new.rate, new.velocity, new.seed) == (old.rate, old.velocity, old.seed)


def test_tags_follow_particles_through_merging() -> None:
    simulation = start(Settings("gas", 300, on_touch="merge"))
    first = simulation.frame()
    for _ in range(60):
        before = simulation.frame()
        simulation.step()
        frame = simulation.frame()
        assert (np.diff(frame.tags) > 0).all() and np.isin(frame.tags, before.tags).all()
        assert len(frame.born) == len(frame.radii) == len(frame)
    assert len(frame) < len(first)
    assert frame.masses.sum() == pytest.approx(first.masses.sum(), rel=1e-3)
    alone = frame.radii == first.radii[frame.rows(frame.tags)[0]]
    assert alone.any() and not alone.all()
