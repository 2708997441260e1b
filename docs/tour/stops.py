"""The stops of the tour: a scene each, and scripted input."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pygame

from jostle_lab.draw.view_options import ColourBy, TreeView
from jostle_lab.gui.input import ZOOM_STEP
from jostle_lab.schema import Settings
from jostle_lab.simulate.frame import Frame, Point
from tour.scripted_user import LEFT, RIGHT, ScriptedUser

SHIFT = pygame.KMOD_SHIFT


@dataclass(frozen=True)
class Stop:
    """One stop."""

    name: str  # of its files
    settings: Settings
    script: Callable[[ScriptedUser], None]
    tree: TreeView = TreeView.OFF
    colour_by: ColourBy = ColourBy.AUTO


def waiting(seconds: float) -> Callable[[ScriptedUser], None]:
    """Return the script that only waits."""
    return lambda user: user.wait(seconds)


def pile(user: ScriptedUser) -> None:
    """Contacts in a pile at rest."""
    user.session.toggle("contacts")
    user.wait(7)


def rules(user: ScriptedUser) -> None:
    """Exact physics and the article's rules with the same particles, side by side."""
    user.session.runner.toggle_race("article-quadtree")
    user.live(8)


def race(user: ScriptedUser) -> None:
    """Two methods at the same time."""
    user.key(pygame.K_q)
    user.live(5)


def springs(user: ScriptedUser) -> None:
    """Drag a soft body, swing it, and throw it at the others."""
    user.wait(2.5)
    user.start_recording()
    user.move(user.pixel((260, 480)), 0.6)
    user.move(user.pixel(nearest(user.session.frame, (260, 540))), 0.2)
    user.press()
    user.move(user.pixel((200, 250)), 0.9)
    user.move(user.pixel((130, 300)), 0.4)
    user.move(user.pixel((460, 180)), 0.35)
    user.release()
    user.wait(3.5)


def stars(user: ScriptedUser) -> None:
    """A cloud that contracts by its own gravity."""
    zoom(user, (0.0, 0.0), 2)
    user.start_recording()
    user.wait(8)
    user.session.runner.paused = True  # the panels show the number of this frame
    user.look()


def life(user: ScriptedUser) -> None:
    """Flowers form, and the panel with their matrix."""
    user.session.view_options.tree = TreeView.OFF
    user.session.runner.adjust("matrix", "flowers")
    fold(user, "Scenes")
    user.hide_pointer()
    user.wait(20, every=30)


def sand(user: ScriptedUser) -> None:
    """The hourglass begins to run."""
    user.wait(1)
    user.start_recording()
    user.wait(8)


def galton(user: ScriptedUser) -> None:
    """The board, after its balls have fallen."""
    user.wait(58, every=30)
    user.wait(5)


def emitters(user: ScriptedUser) -> None:
    """Three jets and a fountain."""
    user.wait(3)
    user.start_recording()
    user.wait(4.75)


def menu(user: ScriptedUser) -> None:
    """A right click on a particle."""
    user.wait(6)
    user.session.runner.paused = True
    frame = user.session.frame
    third = np.argsort(frame.radii)[-3]  # the third largest
    x, y = frame.positions[third].tolist()
    user.click(user.pixel((x, y)), RIGHT)
    user.look()


def why(user: ScriptedUser) -> None:
    """Two neighbours selected, and W."""
    session = user.session
    user.wait(6)
    session.runner.paused = True
    min_x, min_y, max_x, max_y = session.engine.view
    one = nearest(session.frame, ((min_x + max_x) / 2, (min_y + 3 * max_y) / 4))
    other = nearest(session.frame, one, rank=1)
    zoom(user, one, 9)
    user.click(user.pixel(one))
    user.click(user.pixel(other), LEFT, SHIFT)
    user.key(pygame.K_w)
    user.hide_pointer()
    user.wait(4)


def walls(user: ScriptedUser) -> None:
    """Rain on drawn walls, deflected by an attractor."""
    session = user.session
    min_x, min_y, max_x, max_y = session.engine.view

    def at(across: float, down: float) -> tuple[float, float]:
        return user.pixel((min_x + across * (max_x - min_x), min_y + down * (max_y - min_y)))

    user.start_recording()
    user.key(pygame.K_2)
    user.drag(at(0.06, 0.45), at(0.42, 0.62))
    user.drag(at(0.94, 0.6), at(0.58, 0.77))
    user.wait(1)
    user.key(pygame.K_3)
    user.click(at(0.72, 0.4), seconds=0.5)
    user.key(pygame.K_1)
    user.hide_pointer()
    user.wait(4)


def trails(user: ScriptedUser) -> None:
    """Colours by velocity, and trails."""
    user.session.toggle("trails")
    user.wait(1.3, every=2)


def rewind(user: ScriptedUser) -> None:
    """Back in time with the slider, to the middle of a fall."""
    user.wait(4)
    fold(user, "Scenes", "World", "Rewind")
    user.session.runner.rewind(4.0)
    user.hide_pointer()
    user.look()


def settings(user: ScriptedUser) -> None:
    """Another container and another gravity while it runs."""
    user.wait(3)
    fold(user, "Scenes")
    user.session.runner.adjust("container", "circle")
    user.session.runner.adjust("gravity", (300.0, 300.0))
    user.hide_pointer()
    user.wait(7)


def fold(user: ScriptedUser, *titles: str) -> None:
    """Fold sections of the column, or unfold them."""
    user.look()
    for title in titles:
        user.click_on(f"section {title}")


def zoom(user: ScriptedUser, point: Point, notches: int) -> None:
    """Turn the wheel over a point."""
    for _ in range(notches):
        user.session.camera.zoom_at(user.pixel(point), ZOOM_STEP)


def nearest(frame: Frame, point: Point, rank: int = 0) -> Point:
    """Return the centre of a particle that can move: the nearest to a point, or one after it."""
    centres = frame.positions[frame.movable]
    order = np.argsort(np.hypot(*(centres - np.array(point)).T))
    x, y = centres[order[rank]].tolist()
    return x, y


STOPS = (
    Stop("first-look", Settings("mixed"), waiting(3), tree=TreeView.OUTLINE),
    Stop("pile", Settings("pile"), pile),
    Stop("rules", Settings("gas", 500), rules),
    Stop("race", Settings("clusters", 12_000, threads=1), race),
    Stop("heat", Settings("clusters"), waiting(1.5), tree=TreeView.HEAT),
    Stop("springs", Settings("springs"), springs),
    Stop("stars", Settings("stars"), stars),
    Stop("life", Settings("life", 2_500), life),
    Stop("sand", Settings("sand"), sand),
    Stop("galton", Settings("galton"), galton),
    Stop("emitters", Settings("emitters"), emitters),
    Stop("menu", Settings("mixed", 600), menu),
    Stop("why", Settings("pile"), why),
    Stop("walls", Settings("rain", 900), walls),
    Stop("trails", Settings("billiards"), trails, colour_by=ColourBy.VELOCITY),
    Stop("rewind", Settings("pile", 300), rewind),
    Stop("settings", Settings("pile"), settings),
)
