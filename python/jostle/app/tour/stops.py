"""The stops of the tour: a scene each, and what a visitor does with it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pygame

from jostle.app.act.input import ZOOM_STEP
from jostle.app.draw.shown import ColourBy, TreeView
from jostle.app.simulate.settings import Settings
from jostle.app.simulate.simulation import Frame, Point
from jostle.app.tour.visitor import LEFT, RIGHT, Visitor

SHIFT = pygame.KMOD_SHIFT


@dataclass(frozen=True)
class Stop:
    """One stop."""

    name: str  # of its files
    sentence: str  # what there is to see
    settings: Settings
    visit: Callable[[Visitor], None]
    filmed: bool = False


def first_look(visitor: Visitor) -> None:
    """The window as it opens, with the speed that it has here."""
    visitor.live(6)


def pile(visitor: Visitor) -> None:
    """Contacts in a pile at rest."""
    visitor.session.shown.tree = TreeView.OFF
    visitor.session.toggle("contacts")
    visitor.wait(7)


def rules(visitor: Visitor) -> None:
    """First right physics, then the article's rules on the same particles."""
    visitor.session.shown.tree = TreeView.OFF
    visitor.wait(8)
    visitor.session.choose_method("article-quadtree")
    visitor.wait(8)


def race(visitor: Visitor) -> None:
    """Two methods at once, each as fast as it can be."""
    visitor.session.shown.tree = TreeView.OFF
    visitor.key(pygame.K_q)
    visitor.live(6)


def heat(visitor: Visitor) -> None:
    """Leaves coloured by how full they are."""
    visitor.session.shown.tree = TreeView.HEAT
    visitor.wait(1.5)


def springs(visitor: Visitor) -> None:
    """Pick up a soft body, swing it, and throw it at the others."""
    visitor.session.shown.tree = TreeView.OFF
    visitor.wait(2.5)
    visitor.start_filming()
    visitor.move(visitor.pixel((260, 480)), 0.6)
    visitor.move(visitor.pixel(nearest(visitor.session.frame, (260, 540))), 0.2)
    visitor.press()
    visitor.move(visitor.pixel((200, 250)), 0.9)
    visitor.move(visitor.pixel((130, 300)), 0.4)
    visitor.move(visitor.pixel((460, 180)), 0.35)
    visitor.release()
    visitor.wait(3.5)


def stars(visitor: Visitor) -> None:
    """Dust that pulls itself together."""
    visitor.session.shown.tree = TreeView.OFF
    zoom(visitor, (0.0, 0.0), 2)
    visitor.start_filming()
    visitor.wait(8)


def sand(visitor: Visitor) -> None:
    """The hourglass begins to run."""
    visitor.session.shown.tree = TreeView.OFF
    visitor.wait(1)
    visitor.start_filming()
    visitor.wait(8)


def galton(visitor: Visitor) -> None:
    """The board, when its balls have come down."""
    visitor.session.shown.tree = TreeView.OFF
    visitor.wait(58, every=30)
    visitor.wait(5)


def thermostat(visitor: Visitor) -> None:
    """Hot and cold gas on their way to one temperature."""
    visitor.session.shown.tree = TreeView.OFF
    visitor.session.shown.colour_by = ColourBy.VELOCITY
    visitor.wait(4)


def brownian(visitor: Visitor) -> None:
    """The path of the large disc."""
    visitor.session.shown.tree = TreeView.OFF
    visitor.wait(25)


def emitters(visitor: Visitor) -> None:
    """Three jets and a fountain."""
    visitor.session.shown.tree = TreeView.OFF
    visitor.wait(3)
    visitor.start_filming()
    visitor.wait(6.5)


def menu(visitor: Visitor) -> None:
    """A right click on a particle."""
    visitor.session.shown.tree = TreeView.OFF
    visitor.wait(6)
    visitor.session.paused = True
    frame = visitor.session.frame
    third = np.argsort(frame.radii)[-3]  # the third largest
    x, y = frame.positions[third].tolist()
    visitor.click(visitor.pixel((x, y)), RIGHT)
    visitor.look()


def why(visitor: Visitor) -> None:
    """Two neighbours chosen, and W."""
    session = visitor.session
    session.shown.tree = TreeView.OFF
    visitor.wait(6)
    session.paused = True
    min_x, min_y, max_x, max_y = session.engine.view
    one = nearest(session.frame, ((min_x + max_x) / 2, (min_y + 3 * max_y) / 4))
    other = nearest(session.frame, one, rank=1)
    zoom(visitor, one, 9)
    visitor.click(visitor.pixel(one))
    visitor.click(visitor.pixel(other), LEFT, SHIFT)
    visitor.key(pygame.K_w)
    visitor.put_pointer_away()
    visitor.wait(4)


def controls(visitor: Visitor) -> None:
    """The list of mouse and keys."""
    visitor.wait(2)
    visitor.key(pygame.K_h)
    visitor.wait(4)


def walls(visitor: Visitor) -> None:
    """Rain on walls that are drawn, and an attractor that bends it."""
    session = visitor.session
    session.shown.tree = TreeView.OFF
    min_x, min_y, max_x, max_y = session.engine.view

    def at(across: float, down: float) -> tuple[float, float]:
        return visitor.pixel((min_x + across * (max_x - min_x), min_y + down * (max_y - min_y)))

    visitor.start_filming()
    visitor.key(pygame.K_2)
    visitor.drag(at(0.06, 0.45), at(0.42, 0.62))
    visitor.drag(at(0.94, 0.6), at(0.58, 0.77))
    visitor.wait(1)
    visitor.key(pygame.K_3)
    visitor.click(at(0.72, 0.4), seconds=0.5)
    visitor.key(pygame.K_1)
    visitor.put_pointer_away()
    visitor.wait(4)


def trails(visitor: Visitor) -> None:
    """Colours by velocity, and where everything has been."""
    session = visitor.session
    session.shown.tree = TreeView.OFF
    session.shown.colour_by = ColourBy.VELOCITY
    session.toggle("trails")
    visitor.wait(3, every=2)


def rewind(visitor: Visitor) -> None:
    """Back in time with the slider."""
    visitor.session.shown.tree = TreeView.OFF
    visitor.session.toggle("velocities")
    visitor.wait(4)
    fold(visitor, "Method", "Particles and tree", "World")
    visitor.session.scrub(3.2)
    visitor.put_pointer_away()
    visitor.look()


def settings(visitor: Visitor) -> None:
    """Another container and another gravity while it runs."""
    visitor.session.shown.tree = TreeView.OFF
    visitor.wait(3)
    fold(visitor, "Scenes", "Method", "Particles and tree", "Shown")
    visitor.session.adjust("container", "circle")
    visitor.session.adjust("gravity", (300.0, 300.0))
    visitor.put_pointer_away()
    visitor.wait(7)


def fold(visitor: Visitor, *titles: str) -> None:
    """Fold sections of the column."""
    visitor.look()
    for title in titles:
        visitor.click_on(f"section {title}")


def zoom(visitor: Visitor, point: Point, notches: int) -> None:
    """Turn the wheel over a point."""
    for _ in range(notches):
        visitor.session.camera.zoom_at(visitor.pixel(point), ZOOM_STEP)


def nearest(frame: Frame, point: Point, rank: int = 0) -> Point:
    """Return the centre of a particle that can move: the nearest to a point, or one after it."""
    centres = frame.positions[frame.movable]
    order = np.argsort(np.hypot(*(centres - np.array(point)).T))
    x, y = centres[order[rank]].tolist()
    return x, y


STOPS = (
    Stop("first-look", "The window as it opens: discs of all sizes, and the tree.",
         Settings("mixed"), first_look),
    Stop("pile", "A pile at rest; a line for each contact.", Settings("pile"), pile),
    Stop("rules", "A gas by the article's rules: its drift, and the one with right physics.",
         Settings("gas", 500), rules),
    Stop("race", "Brute force and quadtree side by side.", Settings("gas", 6_000, threads=1), race),
    Stop("heat", "The tree by occupancy: full leaves are bright.", Settings("clusters"), heat),
    Stop("springs", "A soft body is picked up and thrown.", Settings("springs"), springs, True),
    Stop("stars", "A cloud of dust becomes stars.", Settings("stars"), stars, True),
    Stop("sand", "An hourglass.", Settings("sand"), sand, True),
    Stop("galton", "A Galton board, and the binomial curve.", Settings("galton"), galton),
    Stop("thermostat", "Two gases between walls that have a temperature.",
         Settings("thermostat"), thermostat),
    Stop("brownian", "The path of a large disc among small ones.",
         Settings("brownian"), brownian),
    Stop("emitters", "Jets, a fountain, and steps.", Settings("emitters"), emitters, True),
    Stop("menu", "A right click on a particle.", Settings("mixed", 600), menu),
    Stop("why", "Why do these two touch?", Settings("pile"), why),
    Stop("help", "The list of mouse and keys.", Settings("pile"), controls),
    Stop("walls", "Walls and an attractor, drawn into the rain.", Settings("rain", 900),
         walls, True),
    Stop("trails", "Colours by velocity, and trails.", Settings("orbit", 600), trails),
    Stop("rewind", "Back in time.", Settings("billiards"), rewind),
    Stop("settings", "Another container and gravity, while it runs.",
         Settings("pile"), settings),
)  # fmt: skip
