"""Scenes in TOML: what is right arrives, what is wrong is refused by name and line."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pygame")

from jostle.app.draw.shown import ColourBy, Shown, TreeView
from jostle.app.keep.config import (
    WINDOW_RULES,
    Config,
    ConfigError,
    lines_of,
    read_config,
)
from jostle.app.simulate.settings import GROUP_RULES, RULES, Group, Settings
from jostle.app.simulate.start import start

EXAMPLE = Path(__file__).parents[1] / "examples" / "scene.toml"


def read(folder: Path, text: str) -> Config:
    path = folder / "scene.toml"
    path.write_text(text, encoding="utf-8")
    return read_config(path)


def refusal(folder: Path, text: str) -> str:
    with pytest.raises(ConfigError) as caught:
        read(folder, text)
    return str(caught.value)


def test_the_example_makes_the_scene_that_it_describes() -> None:
    config = read_config(EXAMPLE)
    assert (config.settings.scene, config.settings.n, config.size) == ("gas", 1500, (1280, 720))
    shown = Shown(velocities=True)
    config.show(shown)
    assert (shown.tree, shown.colour_by) == (TreeView.OUTLINE, ColourBy.VELOCITY)
    assert not shown.velocities
    simulation = start(config.settings)
    frame = simulation.frame()
    assert len(frame) == 1500 + 12 + 4
    assert simulation.world.gravity == (0, 120)
    assert simulation.world.restitution == pytest.approx(0.98)
    assert not frame.movable[-4:].any() and frame.movable[:-4].all()
    assert ((frame.radii[1500:1512] >= 12) & (frame.radii[1500:1512] <= 20)).all()
    assert (frame.velocities[1500:1512] == (60, 0)).all()
    np.testing.assert_array_equal(start(config.settings).frame().positions, frame.positions)


def test_the_documents_name_every_entry() -> None:
    page = (EXAMPLE.parents[1] / "docs" / "files.md").read_text(encoding="utf-8")
    shown = (field.name for field in fields(Shown))
    for name in (*RULES, *GROUP_RULES, *WINDOW_RULES, *shown):
        assert f"`{name}`" in page, name


def test_a_file_may_be_empty(tmp_path: Path) -> None:
    assert read(tmp_path, "").settings == Settings()


def test_every_setting_arrives(tmp_path: Path) -> None:
    config = read(
        tmp_path,
        """
        scene = "pile"
        n = 10
        seed = 3
        method = "brute"
        leaf_capacity = 5
        max_depth = 4
        world_size = 2
        container = "circle"
        gravity = [0.0, -1]
        drag = 0.25
        restitution = 1
        substeps = 2
        threads = 1
        on_touch = "merge"
        time_scale = 0.5
        """,
    )
    assert config.settings == Settings(
        "pile", 10, 3, "brute", 5, 4, 2, "circle", (0.0, -1.0), 0.25, 1, 2, 1, "merge", 0.5
    )


def test_ranges_of_particles_may_be_one_number(tmp_path: Path) -> None:
    config = read(tmp_path, "[[particles]]\nradius = 3\nspeed = [1, 2]\n[[particles]]\ncount = 2")
    assert config.settings.particles == (
        Group(radius=(3, 3), speed=(1.0, 2.0)),
        Group(count=2),
    )


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            "# a comment\n\ngravitas = [0, 1]",
            "scene.toml, line 3: gravitas is not a setting; did you mean gravity?",
        ),
        (
            'scene = "gas"\nrestitution = "high"',
            "scene.toml, line 2: restitution is 'high'; it must be a number from 0 to 1",
        ),
        ("n = true", "scene.toml, line 1: n is true; it must be a whole number from 0 to"),
        ("n = 1.5", "line 1: n is 1.5; it must be a whole number"),
        ("n = -1", "line 1: n is -1; it must be a whole number"),
        ("drag = nan", "line 1: drag is nan; it must be a number of at least 0"),
        (
            "gravity = [\n  0,\n  1,\n  2,\n]",
            "line 1: gravity is [0, 1, 2]; it must be two finite numbers",
        ),
        ("n = 1\n\n[window]\nsize = [\n 0, 10]", "line 4: size is [0, 10]; it must be two whole"),
        ('[window]\nrenderer = "gpu"', "line 2: renderer is 'gpu'; it must be one of auto, "),
        ("window = 3", "line 1: window is written as a table, [window]"),
        ("window.size = 3", "line 1: size is 3; it must be two whole"),
        ("[shown]\ntrees = true", "line 2: trees is not something to show; did you mean tree?"),
        ("[shown]\ntree = true", "line 2: tree is true; it must be one of off, outline,"),
        ('[shown]\nlabels = "yes"', "line 2: labels is 'yes'; it must be true or false"),
        ("particles = 3", "line 1: particles is written as [[particles]]"),
        (
            "[[particles]]\ncount = 1\n[[particles]]\n# two\ncolour = 2",
            "line 5: colour is not a property of particles; did you mean count?",
        ),
        ("[[particles]]\nradius = [3, 1]", "line 2: radius is [3, 1]; it must be a number of at"),
        ("[[particles]]\nregion = [0, 0, -1, 1]", "line 2: region is [0, 0, -1, 1]; it must be"),
        ("gravity = [nan, 0]", "line 1: gravity is [nan, 0]; it must be two finite numbers"),
        (
            'method = "article-quadtree"\ngravity = [0, 1]',
            "line 2: gravity cannot be set here: the article's rules are fixed",
        ),
        ('scene = "gases"', "line 1: gases is not a scene; did you mean gas?"),
        (
            'method = "article-brute"\nmax_depth = 3',
            "line 2: max_depth cannot be set here: the article's rules are fixed",
        ),
        ("n = 1\nn = 2", "scene.toml, line 2: cannot overwrite a value"),
        ("n =\nseed = 1", "scene.toml, line 1: "),
        ("n = 1\ngravity = [1,\n", "scene.toml, line 2: "),
    ],
)
def test_what_is_wrong_is_refused_by_name_and_line(
    tmp_path: Path, text: str, sentence: str
) -> None:
    assert sentence in refusal(tmp_path, text)


def test_a_file_that_is_no_text(tmp_path: Path) -> None:
    (tmp_path / "film.mp4").write_bytes(b"\x00\xff\xfe")
    with pytest.raises(ConfigError, match=r"film\.mp4 is not a text in UTF-8"):
        read_config(tmp_path / "film.mp4")
    with pytest.raises(FileNotFoundError):
        read_config(tmp_path / "missing.toml")


def test_lines_are_those_of_the_statements() -> None:
    text = '''a = """
b = 1
[c]
"""
b = [ # not the end
  [1, 2],
]
[c.d]
"e f".g = 1
h = {i = 2}
[[k]]
[[k]]
l = 1'''
    assert lines_of(text) == {
        ("a",): 1,
        ("b",): 5,
        ("c", "d"): 8,
        ("c", "d", "e f"): 9,
        ("c", "d", "e f", "g"): 9,
        ("c", "d", "h"): 10,
        ("c", "d", "h", "i"): 10,
        ("k", 0): 11,
        ("k", 1): 12,
        ("k", 1, "l"): 13,
    }


def test_the_mark_that_some_editors_put_first_is_no_mistake(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_bytes(b'\xef\xbb\xbfscene = "gas"\nn = 5\n')
    assert read_config(path).settings.n == 5
