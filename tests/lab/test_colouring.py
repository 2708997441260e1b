"""Which colours particles get, and what a legend says of them."""

import importlib.util
from dataclasses import replace
from pathlib import Path

import numpy as np
import pygame
import pytest
from lab_overlays import frame_of

from jostle_lab.draw.colouring import Colouring
from jostle_lab.draw.palette import DISCS, FIXED_SHADE, SHADES, STAGE
from jostle_lab.draw.text import FONT, ICONS, font_file
from jostle_lab.draw.view_options import ColourBy

PLACES = [(10, 10), (20, 20), (30, 30)]
SPEEDS = [(0, 0), (3, 0), (0, 9)]


@pytest.mark.parametrize(
    ("by", "columns", "shows"),
    [
        (ColourBy.VELOCITY, {"velocities": SPEEDS}, "speed"),
        (ColourBy.MASS, {"densities": [1, 2, 3]}, "mass"),
        (ColourBy.DENSITY, {"densities": [1, 2, 3]}, "density"),
        (ColourBy.AGE, {"born": [0, 5, 9], "time": 10.0}, "age"),
        (ColourBy.ENERGY, {"velocities": SPEEDS}, "kinetic energy"),
        (ColourBy.AUTO, {"densities": [1, 10, 20], "radii": [1, 2, 3]}, "density"),
        (ColourBy.AUTO, {"radii": [1, 2, 3], "velocities": SPEEDS}, "radius"),
        (ColourBy.AUTO, {"velocities": SPEEDS}, "speed"),
    ],
)
def test_colours_rise_with_the_quantity(by: ColourBy, columns: dict, shows: str) -> None:
    colouring = Colouring()
    shades = colouring.shades(frame_of(PLACES, **columns), by)
    assert (np.diff(shades.astype(int)) > 0).all() and shades.max() < SHADES
    assert colouring.shows == shows and colouring.legend is not None
    assert colouring.legend.name.startswith(shows)


def test_mass_is_density_times_area_and_columns_over_decades_are_spread_evenly() -> None:
    frame = frame_of(PLACES, [3.0, 2.0, 1.0], densities=[1.0, 1.1, 1.2])
    shades = Colouring().shades(frame, ColourBy.MASS).astype(int)
    assert (np.diff(shades) < 0).all()
    assert (np.diff(Colouring().shades(frame, ColourBy.DENSITY).astype(int)) > 0).all()
    frame = frame_of(PLACES, densities=[1, 100, 10_000])
    low, middle, high = Colouring().shades(frame, ColourBy.DENSITY).astype(int)
    assert middle - low == pytest.approx(high - middle, abs=1)


def test_the_young_glow_and_each_its_own_colour_lasts_and_has_no_ramp() -> None:
    colouring = Colouring()
    assert (colouring.shades(frame_of(PLACES, time=0.2), ColourBy.AGE) > SHADES / 2).all()
    assert (colouring.shades(frame_of(PLACES, time=5.0), ColourBy.AGE) == 0).all()
    assert colouring.range == (5.0, 0.0)
    places, colouring = np.zeros((500, 2)), Colouring()
    first = colouring.shades(frame_of(places), ColourBy.RANDOM)
    fewer = colouring.shades(frame_of(places[:250], tags=np.arange(250, 500)), ColourBy.RANDOM)
    assert (first[250:] == fewer).all()
    assert len(np.unique(first)) > SHADES / 2 and np.bincount(first).max() < 60
    assert colouring.range is None and colouring.legend is None


def test_the_ramp_of_speeds_follows_a_scene_that_comes_to_rest_only_slowly() -> None:
    colouring = Colouring()
    colouring.shades(frame_of(PLACES, velocities=SPEEDS), ColourBy.VELOCITY)
    top = colouring.range[1]
    colouring.shades(frame_of(PLACES), ColourBy.VELOCITY)
    assert 0.9 * top < colouring.range[1] < top
    for _ in range(2_000):
        colouring.shades(frame_of(PLACES), ColourBy.VELOCITY)
    assert colouring.range[1] < 0.01 * top


def test_changed_columns_and_another_quantity_give_new_colours() -> None:
    colouring = Colouring()
    first = colouring.shades(frame_of(PLACES, densities=[1, 2, 3]), ColourBy.DENSITY)
    second = colouring.shades(frame_of(PLACES, densities=[3, 2, 1]), ColourBy.DENSITY)
    assert (first == second[::-1]).all() and (first != second).any()
    frame = frame_of(PLACES, velocities=[(1000, 0), (2000, 0), (3000, 0)])
    colouring.shades(frame, ColourBy.ENERGY)
    colouring.shades(frame, ColourBy.VELOCITY)
    assert colouring.range[1] < 10_000


def test_what_cannot_move_is_grey_and_does_not_stretch_the_ramp_any_more() -> None:
    frame = frame_of(PLACES, densities=[1, 2, 1_000_000], movable=[True, True, False])
    for by in ColourBy:
        assert Colouring().shades(frame, by)[2] == FIXED_SHADE
    assert Colouring().shades(frame, ColourBy.DENSITY)[0] == 0
    assert Colouring().shades(frame, ColourBy.DENSITY)[1] == SHADES - 1
    colouring, before = Colouring(), frame_of(PLACES, densities=[1, 2, 9])
    colouring.shades(before, ColourBy.DENSITY)
    after = replace(before, movable=np.array([True, True, False]))
    colouring.shades(after, ColourBy.DENSITY)
    assert colouring.range == (1.0, 2.0)


@pytest.mark.parametrize("by", ColourBy)
def test_nothing_has_no_colours(by: ColourBy) -> None:
    assert len(Colouring().shades(frame_of([]), by)) == 0


def lightness(colours: np.ndarray) -> np.ndarray:
    """L* of CIELAB, 0 to 100, of (n, 3) colours in sRGB."""
    share = colours / 255
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    luminance = linear @ [0.2126, 0.7152, 0.0722]
    return 116 * np.cbrt(np.maximum(luminance, (6 / 29) ** 3)) - 16


def test_the_ramp_of_discs_rises_evenly_in_lightness() -> None:
    levels = lightness(np.array(DISCS[:SHADES], float))
    steps = np.diff(levels)
    assert steps.min() > 0.5 and steps.max() < 4
    assert levels[0] > lightness(np.array([STAGE], float))[0] + 25  # visible on the background
    assert levels[-1] - levels[0] > 40


def test_text_has_a_font_that_comes_with_the_simulator(monkeypatch) -> None:
    for font in (FONT, ICONS):
        assert Path(font_file(font)).is_file()
    monkeypatch.setattr(importlib.util, "find_spec", lambda package: None)
    pygame.font.init()
    assert font_file.__wrapped__() is None and pygame.font.Font(None).get_height()
