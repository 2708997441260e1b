"""Particle life in the app: the panel, the setting, colours and files."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from test_panels import Desk

from jostle import life
from jostle_lab.act.interaction import Tool
from jostle_lab.draw.colouring import Colouring
from jostle_lab.draw.palette import FIRST_KIND, FIXED_SHADE, KINDS
from jostle_lab.draw.view_options import ColourBy
from jostle_lab.schema import Settings, read
from jostle_lab.simulate.start import start
from jostle_lab.storage.config import read_config

TWO = ((0.5, -1.0), (1.0, 0.0))


def matrix_of(desk: Desk) -> np.ndarray:
    matrix = desk.session.frame.matrix
    assert matrix is not None
    return matrix


@pytest.fixture
def desk() -> Iterator[Desk]:
    here = Desk(Settings("life", n=60))
    yield here
    here.close()


def test_a_click_raises_an_attraction_and_a_right_click_lowers_it(desk: Desk) -> None:
    before = matrix_of(desk)
    desk.click("attraction 1 4")
    changed = before.copy()
    changed[1, 4] = round(before[1, 4] + 0.1, 1)
    np.testing.assert_allclose(matrix_of(desk), changed, atol=1e-6)
    desk.click("attraction 1 4", button=3)
    np.testing.assert_allclose(matrix_of(desk), before, atol=1e-6)
    for _ in range(5):
        desk.click("attraction 0 0")
    assert matrix_of(desk)[0, 0] == 1.0


def test_a_preset_and_random_matrices_are_chosen(desk: Desk) -> None:
    desk.click("preset")
    desk.click("preset: flowers")
    np.testing.assert_array_equal(matrix_of(desk), life.MATRICES["flowers"])
    assert desk.session.settings.matrix == "flowers"
    desk.click("randomise")
    first = matrix_of(desk)
    desk.click("randomise")
    assert (matrix_of(desk) != first).any()
    desk.click("randomise symmetric")
    assert (matrix_of(desk) == matrix_of(desk).T).all()


def test_new_particles_have_the_chosen_kind(desk: Desk) -> None:
    desk.click("kind 3")
    assert desk.session.interaction.tool is Tool.BRUSH
    n = len(desk.session.frame)
    desk.session.interaction.commands.create((50.0, 50.0))
    desk.frame(2)
    frame = desk.session.frame
    assert len(frame) == n + 1 and frame.kinds is not None and frame.kinds[-1] == 3
    desk.session.interaction.commands.clone(frame.tags[[1, 2]])
    desk.frame(2)
    frame = desk.session.frame
    assert frame.kinds is not None
    assert sorted(frame.kinds[n + 1 :].tolist()) == sorted(frame.kinds[[1, 2]].tolist())


def test_other_scenes_have_no_panel() -> None:
    desk = Desk(Settings("gas", n=10))
    assert "section Particle life" not in desk.gui.marks
    desk.close()
    simulation = start(Settings("gas", n=10))
    assert "choose the scene life" in str(simulation.adjust("matrix", TWO))
    assert simulation.settings.matrix is None


def test_a_matrix_may_have_fewer_kinds_and_come_from_a_file(tmp_path: Path) -> None:
    simulation = start(Settings("life", n=9, matrix=TWO))
    frame = simulation.frame()
    assert frame.kinds is not None
    assert frame.kinds.tolist() == [0, 1] * 4 + [0]
    simulation.add([(1, 1), (2, 2)], [(0, 0)] * 2, [2.0, 2.0])
    frame = simulation.frame()
    assert frame.kinds is not None and frame.kinds[-2:].tolist() == [1, 0]
    path = tmp_path / "scene.toml"
    path.write_text('scene = "life"\nn = 8\nmatrix = [[0.5, -1], [1, 0]]')
    settings = read_config(path).settings
    assert settings.matrix == TWO
    np.testing.assert_allclose(start(settings).frame().matrix, TWO)
    assert read(Settings, {"scene": "life", "matrix": "wheels"}).matrix == "wheels"


def test_colours_are_those_of_the_kinds() -> None:
    frame = start(Settings("life", n=12)).frame()
    colouring = Colouring()
    shades = colouring.shades(frame)
    assert colouring.shows == "kind" and colouring.legend is None
    assert shades.tolist() == [FIRST_KIND + k % 6 for k in range(12)]
    assert colouring.shades(frame, ColourBy.VELOCITY).max() < FIXED_SHADE
    plain = start(Settings("gas", n=5)).frame()
    assert Colouring().shades(plain, ColourBy.KIND).tolist() == [FIRST_KIND] * 5
    assert len({*KINDS}) == len(KINDS)
