"""The menus of the right mouse button: what they say and do, and that ImGui shows them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

pygame = pytest.importorskip("pygame")

from app_hands import FRAME, RIGHT, Hands, article_with, tags, world_of  # noqa: E402

from jostle.app.menu import Item, Number  # noqa: E402

TWO = [(200, 100), (400, 300)]
BOTH = [world_of, article_with]


@pytest.fixture(autouse=True)
def closed() -> Iterator[None]:
    yield
    pygame.display.quit()


def line_of(hands: Hands, name: str) -> Item | Number:
    lines = hands.session.menu.lines(hands.session)
    return next(line for line in lines if line is not None and line.name == name)


def choose(hands: Hands, name: str, point: tuple[float, float]) -> None:
    """Open the menu at a point and act on one of its lines."""
    hands.click(point, RIGHT)
    line = line_of(hands, name)
    assert isinstance(line, Item) and line.enabled
    line.act()


# ---- on a particle -------------------------------------------------------------------------------


@pytest.mark.parametrize("make", BOTH)
def test_the_menu_of_a_particle_tells_its_numbers_as_they_change(make) -> None:
    hands = Hands(make(TWO))
    hands.session.paused = True
    hands.click((400, 300), RIGHT)
    hands.session.engine.edit(lambda simulation: simulation.change([1], velocities=(30, 40)))
    facts = dict(hands.session.menu.facts(hands.session.frame))
    assert facts == {
        "speed": "50.0",
        "position": "400.0, 300.0",
        "mass": "100",
        "radius": "10",
    }
    assert hands.session.menu.title(hands.session.frame) == "particle 1"


@pytest.mark.parametrize("make", BOTH)
def test_delete_clone_and_stop(make) -> None:
    hands = Hands(make(TWO))
    hands.session.paused = True
    choose(hands, "clone", (400, 300))
    assert len(hands.session.frame) == 3
    hands.session.engine.edit(lambda simulation: simulation.change([0, 1], velocities=(30, 40)))
    choose(hands, "stop", (400, 300))
    speeds = np.hypot(*hands.session.frame.velocities.T)
    assert speeds == pytest.approx([50, 0, 0], abs=1e-4)
    choose(hands, "delete", (200, 100))
    assert tags(hands.session.frame.tags) == [1, 2]


@pytest.mark.parametrize("make", BOTH)
def test_a_particle_attracts_the_others_until_it_is_told_to_stop(make) -> None:
    hands = Hands(make(TWO))
    choose(hands, "attract", (400, 300))
    hands.frames(8)
    towards = hands.session.frame.velocities
    assert towards[0, 0] > 20 and abs(towards[1, 0]) < 1e-3
    hands.session.paused = True
    hands.frames(1)
    place = hands.session.frame.positions[1].tolist()
    hands.click((place[0], place[1]), RIGHT)
    assert line_of(hands, "attract").label == "Stop attracting"
    line_of(hands, "attract").act()
    assert hands.session.frame.attractors == ()


def test_immovable_and_movable_again() -> None:
    hands = Hands(world_of(TWO, gravity=(0.0, 500.0)))
    choose(hands, "movable", (400, 300))
    hands.frames(10)
    assert hands.world.positions[1].tolist() == [400, 300] and hands.world.positions[0, 1] > 101
    assert line_of(hands, "movable").label == "Make movable"
    assert not line_of(hands, "stop").enabled
    line_of(hands, "movable").act()
    hands.frames(10)
    assert hands.world.positions[1, 1] > 301


def test_the_menu_acts_on_the_whole_selection() -> None:
    hands = Hands(world_of([*TWO, (600, 400)]))
    hands.drag((150, 50), (450, 350))
    hands.click((400, 300), RIGHT)
    assert hands.session.menu.title(hands.session.frame) == "particle 1 of 2 selected"
    line_of(hands, "delete").act()
    assert tags(hands.session.frame.tags) == [2]
    choose(hands, "select", (600, 400))
    assert tags(hands.session.selection.tags) == [2]
    assert line_of(hands, "select").checked


def test_a_particle_outside_the_selection_is_acted_on_alone() -> None:
    hands = Hands(world_of([*TWO, (600, 400)]))
    hands.drag((150, 50), (450, 350))
    choose(hands, "delete", (600, 400))
    assert tags(hands.session.frame.tags) == [0, 1] == tags(hands.session.selection.tags)


def test_the_menu_ends_with_its_particle() -> None:
    hands = Hands(world_of(TWO))
    hands.click((400, 300), RIGHT)
    hands.session.engine.edit(lambda simulation: simulation.remove([1]))
    assert hands.session.menu.is_over(hands.session.frame)
    assert hands.session.menu.facts(hands.session.frame) == []


def test_the_article_offers_no_immovable_particles_and_no_other_gravity() -> None:
    hands = Hands(article_with(TWO))
    hands.session.paused = True
    hands.click((400, 300), RIGHT)
    assert not line_of(hands, "movable").enabled
    hands.click((600, 100), RIGHT)
    for name in ("triple", "third", "invert", "zero", "gravity"):
        assert not line_of(hands, name).enabled


# ---- on the ground -------------------------------------------------------------------------------


@pytest.mark.parametrize("make", BOTH)
def test_create_and_attract_here(make) -> None:
    hands = Hands(make(TWO))
    hands.session.paused = True
    choose(hands, "create", (600, 100))
    assert hands.session.frame.positions[2] == pytest.approx((600, 100), abs=1)
    choose(hands, "attractor", (100, 400))
    assert hands.session.frame.attractors[0].point == pytest.approx((100, 400), abs=1)
    choose(hands, "stop attraction", (500, 400))
    assert hands.session.frame.attractors == ()
    hands.click((500, 400), RIGHT)
    assert not line_of(hands, "stop attraction").enabled


def test_gravity_by_the_menu() -> None:
    hands = Hands(world_of(TWO, gravity=(0.0, 90.0)))
    for name, expected in [("triple", 270), ("third", 90), ("invert", -90), ("zero", 0)]:
        choose(hands, name, (600, 100))
        assert hands.world.gravity == pytest.approx((0, expected), rel=1e-5)
    number = line_of(hands, "gravity")
    assert isinstance(number, Number)
    number.act(123.0)
    assert hands.world.gravity == (0, 123) and line_of(hands, "gravity").value == 123


def test_clear_walls_scramble_and_dance_are_offered() -> None:
    hands = Hands(world_of(TWO))
    hands.session.deeds.wall((100, 450), (300, 450))
    choose(hands, "clear walls", (600, 100))
    assert len(hands.session.frame) == 2
    before = hands.session.frame.positions
    choose(hands, "scramble", (700, 50))
    assert (hands.session.frame.positions != before).any()
    choose(hands, "dance", (hands.session.camera.to_world((5, 5))))
    assert np.abs(hands.session.frame.velocities).max() > 0


# ---- shown by ImGui ------------------------------------------------------------------------------


class Shown:
    """The menus over a window's session, and events that ImGui sees first."""

    def __init__(self, hands: Hands) -> None:
        pytest.importorskip("imgui_bundle")
        from jostle.app import menus
        from jostle.app.gui import Gui

        self.hands, self._menus = hands, menus
        self.gui = Gui(hands.window.painter)

    def frames(self, count: int = 3) -> None:
        for _ in range(count):
            self.gui.begin(FRAME, self.hands.window.painter.size)
            self._menus.build(self.hands.session, self.gui)
            self.gui.end()

    def send(self, kind: int, **facts: object) -> bool:
        taken = self.gui.handle(pygame.event.Event(kind, **facts))
        self.frames(2)
        return taken

    def click(self, name: str) -> None:
        place = self.gui.marks[f"menu {name}"].center
        self.send(pygame.MOUSEMOTION, pos=place, rel=(0, 0), buttons=(0, 0, 0))
        assert self.send(pygame.MOUSEBUTTONDOWN, pos=place, button=1)
        self.send(pygame.MOUSEBUTTONUP, pos=place, button=1)


@pytest.fixture
def shown() -> Iterator[Shown]:
    shown = Shown(Hands(world_of(TWO, gravity=(0.0, 90.0))))
    shown.hands.session.paused = True
    yield shown
    shown.gui.close()


def test_a_click_on_a_line_acts_and_closes_the_menu(shown: Shown) -> None:
    shown.hands.click((400, 300), RIGHT)
    shown.frames()
    shown.click("delete")
    assert tags(shown.hands.session.frame.tags) == [0] and shown.hands.session.menu is None


def test_every_line_of_both_menus_is_shown(shown: Shown) -> None:
    session = shown.hands.session
    for point in [(400, 300), (600, 100)]:
        shown.hands.click(point, RIGHT)
        shown.frames()
        names = [line.name for line in session.menu.lines(session) if line is not None]
        assert {f"menu {name}" for name in names} <= set(shown.gui.marks)
        session.menu = None
        shown.frames()


def test_a_click_beside_the_menu_closes_it(shown: Shown) -> None:
    shown.hands.click((400, 300), RIGHT)
    shown.frames()
    assert shown.send(pygame.MOUSEBUTTONDOWN, pos=(990, 630), button=1)
    shown.send(pygame.MOUSEBUTTONUP, pos=(990, 630), button=1)
    assert shown.hands.session.menu is None and len(shown.hands.session.frame) == 2


def test_the_menu_closes_when_its_particle_goes(shown: Shown) -> None:
    shown.hands.click((400, 300), RIGHT)
    shown.frames()
    shown.hands.session.engine.edit(lambda simulation: simulation.remove([1]))
    shown.frames()
    assert shown.hands.session.menu is None and not shown.gui.asks


def test_a_gravity_can_be_typed(shown: Shown) -> None:
    shown.hands.click((600, 100), RIGHT)
    shown.frames()
    field = shown.gui.marks["menu gravity"]
    place = field.left + 20, field.centery
    for _ in range(2):
        shown.send(pygame.MOUSEMOTION, pos=place, rel=(0, 0), buttons=(0, 0, 0))
        shown.send(pygame.MOUSEBUTTONDOWN, pos=place, button=1)
        shown.send(pygame.MOUSEBUTTONUP, pos=place, button=1)
    shown.send(pygame.KEYDOWN, key=pygame.K_a, mod=pygame.KMOD_CTRL)
    shown.send(pygame.KEYUP, key=pygame.K_a, mod=pygame.KMOD_CTRL)
    shown.send(pygame.TEXTINPUT, text="-45")
    for kind in (pygame.KEYDOWN, pygame.KEYUP):
        shown.send(kind, key=pygame.K_RETURN, mod=0)
    assert shown.hands.world.gravity == (0, -45)


def test_m_opens_the_menu_at_the_cursor(shown: Shown) -> None:
    shown.hands.point_at((400, 300))
    shown.hands.key(pygame.K_m)
    assert shown.hands.session.menu.tag == 1
