"""The camera: world to screen and back."""

import numpy as np
import pytest

from jostle_lab.draw.camera import MARGIN, Camera

VIEW = (-50.0, 20.0, 750.0, 520.0)


@pytest.mark.parametrize("zoom", [1e-3, 1.0, 1e4])
def test_a_point_goes_to_the_screen_and_back(zoom: float) -> None:
    camera = Camera((1280, 720), VIEW)
    camera.zoom_at((300, 200), zoom)
    camera.pan((37, -81))
    for pixel in [(0, 0), (640, 360), (1279.5, 3.25)]:
        (x,), (y,) = camera.to_screen(np.array([camera.to_world(pixel)]))
        assert (x, y) == pytest.approx(pixel, abs=1e-6)


def test_zoom_keeps_the_point_under_the_cursor() -> None:
    camera = Camera((1280, 720), VIEW)
    before = camera.to_world((917, 77))
    for factor in (1.15, 20.0, 1e9, 1e-12):  # the last two run into the limits
        camera.zoom_at((917, 77), factor)
        assert camera.to_world((917, 77)) == pytest.approx(before, abs=1e-6)


def test_home_shows_the_whole_view_next_to_the_readout_where_there_is_room() -> None:
    camera = Camera((1280, 720), VIEW, left=270)
    x0, y0, x1, y1 = camera.rect_to_screen(VIEW)
    assert x0 >= 270 + MARGIN - 1e-6 and y0 >= MARGIN - 1e-6
    assert x1 <= 1280 - MARGIN + 1e-6 and y1 <= 720 - MARGIN + 1e-6
    left = 1280 - 270 - 2 * MARGIN - (x1 - x0), 720 - 2 * MARGIN - (y1 - y0)
    assert min(left) == pytest.approx(0, abs=1e-6)
    camera = Camera((400, 300), VIEW, left=270)
    x0, _, x1, _ = camera.rect_to_screen(VIEW)
    assert (x0 + x1) / 2 == pytest.approx(200)


def test_resize_keeps_home_but_leaves_a_chosen_view_alone() -> None:
    camera = Camera((1280, 720), VIEW)
    camera.resize((640, 360))
    assert camera.scale == pytest.approx(Camera((640, 360), VIEW).scale)
    camera.zoom_at((10, 10), 3)
    scale, center = camera.scale, camera.center
    camera.resize((800, 600))
    assert (camera.scale, camera.center) == (scale, center)


def test_an_empty_view_and_a_screen_of_one_pixel_are_no_trouble() -> None:
    camera = Camera((1, 1), (0.0, 0.0, 0.0, 0.0))
    assert np.isfinite([*camera.to_world((0, 0)), camera.scale]).all()
