"""Drawing only reads: frames are read-only, and the state of the simulation does not change."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

pytest.importorskip("pygame")

from jostle.app.draw.software import SoftwarePainter
from jostle.app.draw.view_options import ColourBy, TreeView
from jostle.app.session import Session
from jostle.app.simulate.article_simulation import ArticleSimulation
from jostle.app.simulate.settings import Settings
from jostle.app.simulate.start import start
from jostle.app.simulate.world_simulation import WorldSimulation

SIZE = (160, 90)
FLAGS = ("contacts", "forces", "velocities", "trails", "labels", "statistics")
SCENES = [
    Settings("gas", 40),
    Settings("pile", 60),
    Settings("springs", 40),
    Settings("galton", 40),
    Settings("heap", 40),
    Settings("stars", 40),
    Settings("article", 40, method="article-quadtree"),
]


def freeze(thing: Any) -> Any:
    """Make all arrays of a frame read-only."""
    if isinstance(thing, np.ndarray):
        thing.flags.writeable = False
    elif dataclasses.is_dataclass(thing):
        for field in dataclasses.fields(thing):
            freeze(getattr(thing, field.name))
    return thing


@pytest.fixture
def frozen_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    for kind in (WorldSimulation, ArticleSimulation):
        original = kind.frame
        monkeypatch.setattr(kind, "frame", lambda *given, make=original: freeze(make(*given)))


@pytest.mark.parametrize("settings", SCENES, ids=lambda settings: settings.scene)
def test_drawing_writes_neither_to_frames_nor_to_the_simulation(
    settings: Settings, frozen_frames: None
) -> None:
    session = Session(start(settings), SIZE, synchronous=True)
    painter = SoftwarePainter(SIZE)
    for flag in FLAGS:
        assert hasattr(session.view_options, flag)
        setattr(session.view_options, flag, True)
    for tree in TreeView:
        for colour_by in ColourBy:
            session.view_options.tree, session.view_options.colour_by = tree, colour_by
            session.advance(1 / 60)
            before = session.engine.simulation.save()
            session.draw(painter)
            assert session.engine.simulation.save() == before
            assert not session.frame.positions.flags.writeable
    assert session.frame.stats.time > 0
    session.close()


def test_writing_to_a_frame_would_be_noticed(frozen_frames: None) -> None:
    frame = start(SCENES[0]).frame()
    with pytest.raises(ValueError, match="read-only"):
        frame.positions[0] = 0
    assert frame.tree is None or not frame.tree.boxes.flags.writeable
