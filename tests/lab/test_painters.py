"""Pictures of both painters, by the statistics of their pixels."""

from collections.abc import Iterator

import numpy as np
import pygame
import pytest
from lab_overlays import SIZE, camera_of_pixels, frame_of, open_screen, pixels, tree_of

import jostle
from jostle_lab.draw.base_layers import (
    STRONGEST,
    draw_container,
    draw_discs,
    draw_filled,
    draw_outline,
)
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.painter import Painter
from jostle_lab.draw.palette import DISCS, SHADES, STAGE, WALL, blend, level_colour
from jostle_lab.draw.software import MEMORY_LIMIT, SoftwarePainter, Stamps
from jostle_lab.simulate.frame import Frame
from jostle_lab.simulate.region import Torus


@pytest.fixture(scope="module", params=["software", "opengl"])
def painter(request: pytest.FixtureRequest) -> Iterator[Painter]:
    if request.param == "software":
        yield SoftwarePainter(SIZE)
        return
    screen = open_screen()
    yield screen.opengl
    screen.close()


def draw(painter: Painter, frame: Frame, camera: Camera | None = None, shade: int = 20):
    camera = camera or camera_of_pixels()
    draw_container(painter, None, camera)
    draw_discs(painter, frame, np.full(len(frame), shade, np.uint8), camera)
    return pixels(painter).astype(float)


def covered_area(picture, shade: int = 20) -> float:
    """The pixels' worth of ink, by the channel in which ink and ground differ most."""
    ink, ground = np.array(DISCS[shade], float), np.array(STAGE, float)
    channel = np.argmax(np.abs(ink - ground))
    return ((picture[:, :, channel] - ground[channel]) / (ink - ground)[channel]).sum()


@pytest.mark.parametrize("radius", [0.6, 0.8, 1.0, 1.4, 2.5])
@pytest.mark.parametrize("place", [(100.5, 100.5), (100.1, 100.9), (100.4, 100.7)])
def test_small_discs_cover_their_area(painter, radius: float, place: tuple[float, float]) -> None:
    area = covered_area(draw(painter, frame_of([place], radius)))
    assert area == pytest.approx(np.pi * radius**2, rel=0.12)


@pytest.mark.parametrize("radius", [5, 20, 47, 49, 90])
def test_larger_discs_cover_their_area_and_have_the_colour_inside(painter, radius: float) -> None:
    picture = draw(painter, frame_of([(160.5, 120.5)], radius))
    lit = (np.abs(picture - np.array(STAGE)).max(axis=2) > 8).sum()
    assert lit == pytest.approx(np.pi * (radius + 0.4) ** 2, rel=0.06)
    assert tuple(picture[160, 120].astype(int)) == pytest.approx(DISCS[20], abs=2)


def test_dust_adds_up_and_does_not_run_over(painter) -> None:
    positions = np.full((1000, 2), 50.5)
    picture = draw(painter, frame_of(positions, 0.2))
    assert tuple(picture[50, 50].astype(int)) == pytest.approx(DISCS[20], abs=2)
    assert (picture[:49] == STAGE).all() and (picture[52:] == STAGE).all()


def test_sparse_dust_does_not_vanish_and_dense_dust_keeps_its_share(painter) -> None:
    assert covered_area(draw(painter, frame_of([(100.5, 100.5)], 1e-6))) > 0.8
    places = np.random.default_rng(3).uniform(0, 240, (200_000, 2))
    assert covered_area(draw(painter, frame_of(places, 0.0))) < 0.15 * 320 * 240


def test_discs_half_outside_are_cut_and_those_outside_leave_no_trace(painter) -> None:
    for radius in (0.3, 1.0, 6.0, 60.0):
        edge = covered_area(draw(painter, frame_of([(0.0, 120.0)], radius)))
        whole = covered_area(draw(painter, frame_of([(160.0, 120.0)], radius)))
        if radius >= 1:
            assert edge == pytest.approx(whole / 2, rel=0.2)
        far = [(-radius - 2, 50), (50, 242 + radius), (1e30, 50), (50, -1e30)]
        assert (draw(painter, frame_of(far, radius)) == STAGE).all()


def test_a_fill_covers_everything_after_a_clip(painter) -> None:
    painter.clip(pygame.Rect(50, 60, 100, 80))
    painter.fill((200, 0, 0))
    painter.lines(np.array([[0.0, 0.0, 320.0, 240.0]]), np.array([[0, 200, 0]], np.uint8), 2.0)
    inside = pixels(painter)[50:150, 60:140]
    assert inside.any(axis=2).all() and (inside[:, :, 1] > 100).any()
    painter.clip(None)
    painter.fill((0, 0, 200))
    assert (pixels(painter) == (0, 0, 200)).all()


def test_no_particles_no_ink(painter) -> None:
    assert (draw(painter, frame_of(np.empty((0, 2)), 1.0)) == STAGE).all()


def test_a_disc_glides_between_pixels(painter) -> None:
    """The centre of the ink follows the disc to a fraction of a pixel."""
    for radius in (1.0, 5.0, 15.0):
        for shift in (0.0, 0.3, 0.6, 0.9):
            picture = draw(painter, frame_of([(100 + shift, 100)], radius))
            ink = np.abs(picture - np.array(STAGE)).sum(axis=(1, 2))
            middle = (ink * (np.arange(SIZE[0]) + 0.5)).sum() / ink.sum()
            assert middle == pytest.approx(100 + shift, abs=0.3)


@pytest.mark.parametrize("zoom", [1e-3, 1e2, 1e5])
def test_any_zoom(painter, zoom: float) -> None:
    frame = frame_of(np.random.default_rng(1).uniform(0, 240, (500, 2)), 4.0)
    camera = camera_of_pixels()
    camera.zoom_at((frame.positions[0, 0], frame.positions[0, 1]), zoom)
    picture = draw(painter, frame, camera)
    if zoom > 1:
        x, y = (int(at) for at in frame.positions[0])
        assert tuple(picture[x, y].astype(int)) == DISCS[20]
    else:
        assert 0 < covered_area(picture) < 50


def test_a_million_particles_are_drawn(painter) -> None:
    rng = np.random.default_rng(2)
    frame = frame_of(rng.uniform(0, 240, (1_000_000, 2)).astype(np.float32), 0.1)
    assert covered_area(draw(painter, frame)) > 0.3 * 240 * 240


def test_the_store_of_stamps_stays_small() -> None:
    stamps, target = Stamps(), pygame.Surface(SIZE)
    place = np.array([100.0])
    for radius in np.linspace(2, 47, 40):
        for shade in range(SHADES):
            stamps.blit(target, place, place, np.array([radius]), np.array([shade], np.uint8))
    assert 0 < stamps.bytes < 2 * MEMORY_LIMIT


def test_drawing_leaves_the_frame_alone(painter) -> None:
    frame = frame_of([(30, 40), (31, 44)], [3, 0.5])
    before = frame.positions.copy(), frame.radii.copy()
    draw(painter, frame)
    assert (frame.positions == before[0]).all() and (frame.radii == before[1]).all()


@pytest.mark.parametrize(
    ("container", "edge", "outside"),
    [
        (jostle.Box(60, 40, 260, 200), (59, 120), (40, 120)),
        (Torus(200, 160), (200, 80), (210, 170)),
        (jostle.Circle((160, 120), 100), (59, 120), (50, 40)),
    ],
)
def test_walls_are_outlined(painter, container, edge, outside) -> None:
    draw_container(painter, container, camera_of_pixels())
    canvas = painter.canvas()
    assert canvas.get_at(edge)[:3] == pytest.approx(WALL, abs=24)
    assert canvas.get_at((160, 120))[:3] == STAGE
    assert canvas.get_at(outside)[:3] not in (STAGE, WALL)


def test_tree_is_coloured_by_level(painter) -> None:
    boxes = [(20, 20, 220, 220), (20, 20, 120, 120), (120, 20, 220, 120)]
    tree = tree_of(boxes, [0, 1, 1], [1, 1, 1], [False, True, True])
    painter.fill(STAGE)
    draw_outline(painter, tree, camera_of_pixels())
    canvas = painter.canvas()
    root, child = canvas.get_at((20, 180)), canvas.get_at((120, 60))
    assert root[:3] == pytest.approx(blend(STAGE, level_colour(0, 1), STRONGEST), abs=8)
    assert STAGE[0] + 20 < child[0] < root[0]  # a share of its level's colour, a fainter one
    assert canvas.get_at((60, 60))[:3] == STAGE
    draw_filled(painter, tree, camera_of_pixels())
    canvas = painter.canvas()
    assert canvas.get_at((60, 60))[:3] != STAGE
    assert canvas.get_at((60, 180))[:3] == STAGE  # no leaf there


def test_no_tree_is_no_trouble(painter) -> None:
    painter.fill((0, 0, 0))
    tree = tree_of([], [], [], [])
    draw_outline(painter, tree, camera_of_pixels())
    draw_filled(painter, tree, camera_of_pixels())
    assert not pixels(painter).any()
