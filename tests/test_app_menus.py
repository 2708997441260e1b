"""The menus of the right mouse button: what they say and do, and that ImGui shows them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

pygame = pytest.importorskip("pygame")
pytest.importorskip("imgui_bundle")  # without it a right click says so, and there is no menu

from app_hands import RIGHT, Hands, article_with, post, tags, world_of  # noqa: E402

from jostle.app.act.menu import Item, Number  # noqa: E402
from jostle.app.gui import host as gui  # noqa: E402

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


def test_two_selected_particles_can_be_asked_about() -> None:
    hands = Hands(world_of([*TWO, (600, 400)]))
    hands.click((400, 300), RIGHT)
    assert all(
        line is None or line.name != "why" for line in hands.session.menu.lines(hands.session)
    )
    hands.drag((150, 50), (450, 350))
    choose(hands, "why", (400, 300))
    assert hands.session.question.pair == (0, 1)
    hands.key(pygame.K_w)
    assert hands.session.question.pair is None


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


@pytest.fixture
def hands() -> Hands:
    pytest.importorskip("imgui_bundle")
    from jostle.app.panels import menus

    hands = Hands(world_of(TWO, gravity=(0.0, 90.0)))
    hands.window.builders = [menus.build]
    hands.session.paused = True
    hands.frames(2)
    return hands


def open_at(hands: Hands, point: tuple[float, float]) -> None:
    hands.click(point, RIGHT)
    hands.frames(3)
    assert hands.window.gui.asks


def click_on(hands: Hands, place: tuple[int, int]) -> None:
    for kind, extra in [
        (pygame.MOUSEMOTION, {"rel": (0, 0), "buttons": (0, 0, 0)}),
        (pygame.MOUSEBUTTONDOWN, {"button": 1}),
        (pygame.MOUSEBUTTONUP, {"button": 1}),
    ]:
        post(kind, pos=place, **extra)
        hands.frames(2)


def place_of(hands: Hands, name: str) -> tuple[int, int]:
    return hands.window.gui.marks[f"menu {name}"].center


def test_a_click_on_a_line_acts_and_closes_the_menu(hands: Hands) -> None:
    open_at(hands, (400, 300))
    click_on(hands, place_of(hands, "delete"))
    assert tags(hands.session.frame.tags) == [0] and hands.session.menu is None


def test_every_line_of_both_menus_is_shown(hands: Hands) -> None:
    for point in [(400, 300), (600, 100)]:
        open_at(hands, point)
        names = [line.name for line in hands.session.menu.lines(hands.session) if line is not None]
        assert {f"menu {name}" for name in names} <= set(hands.window.gui.marks)
        hands.key(pygame.K_ESCAPE)
        hands.frames(3)
        assert hands.session.menu is None and hands.session.open


def test_a_click_beside_the_menu_closes_it_and_does_nothing_else(hands: Hands) -> None:
    hands.session.selection.take([0])
    open_at(hands, (400, 300))
    click_on(hands, (990, 20))
    assert hands.session.menu is None
    assert len(hands.session.frame) == 2 and len(hands.session.selection) == 1


def test_a_right_click_elsewhere_ends_one_menu_and_the_next_opens_another(hands: Hands) -> None:
    open_at(hands, (400, 300))
    hands.click((700, 50), RIGHT)
    hands.frames(3)
    assert hands.session.menu is None
    open_at(hands, (700, 50))
    assert hands.session.menu.tag is None


def test_the_menu_closes_when_its_particle_goes(hands: Hands) -> None:
    open_at(hands, (400, 300))
    hands.session.engine.edit(lambda simulation: simulation.remove([1]))
    hands.frames(3)
    assert hands.session.menu is None and not hands.window.gui.asks


def test_a_gravity_can_be_typed(hands: Hands) -> None:
    open_at(hands, (600, 100))
    x, y = place_of(hands, "gravity")
    click_on(hands, (x - 40, y))
    post(pygame.KEYDOWN, key=pygame.K_a, mod=pygame.KMOD_CTRL)
    hands.frames(2)
    post(pygame.KEYUP, key=pygame.K_a, mod=pygame.KMOD_CTRL)
    post(pygame.KEYUP, key=pygame.K_LCTRL, mod=0)
    hands.frames(2)
    post(pygame.TEXTINPUT, text="-45")
    hands.frames(2)
    hands.key(pygame.K_RETURN)
    hands.frames(2)
    assert hands.world.gravity == (0, -45)
    assert len(hands.session.frame) == 2  # A, which adds a particle, went to the field alone


def test_m_opens_the_menu_at_the_cursor(hands: Hands) -> None:
    hands.point_at((400, 300))
    hands.key(pygame.K_m)
    hands.frames(3)
    assert hands.session.menu.tag == 1 and hands.window.gui.asks


def test_without_imgui_the_menu_says_what_is_missing(monkeypatch) -> None:
    monkeypatch.setattr(gui, "available", lambda: False)
    hands = Hands(world_of(TWO))
    hands.click((400, 300), RIGHT)
    assert hands.session.menu is None and "imgui" in hands.session.notice
