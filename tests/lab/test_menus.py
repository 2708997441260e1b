"""The menus of the right mouse button: what they say and do, and that ImGui shows them."""

import numpy as np
import pygame
import pytest
from lab_interaction import RIGHT, Driver, post, tags, world_of

from jostle_lab.panels.menus import Item, Number, is_over, lines_of, numbers, title

TWO = [(200, 100), (400, 300)]


def lines_by_name(driver: Driver) -> dict[str, Item | Number]:
    """The lines of the menu that is open."""
    lines = lines_of(driver.session, driver.session.interaction.menu)
    return {line.name: line for line in lines if line is not None}


def line_of(driver: Driver, name: str) -> Item | Number:
    return lines_by_name(driver)[name]


def choose(driver: Driver, name: str, point: tuple[float, float]) -> None:
    """Open the menu at a point and act on one of its lines."""
    driver.click(point, RIGHT)
    line = line_of(driver, name)
    assert isinstance(line, Item) and line.enabled
    line.command()


def test_the_menu_of_a_particle_tells_its_numbers_as_they_change() -> None:
    driver = Driver(world_of(TWO), paused=True)
    driver.click((400, 300), RIGHT)
    driver.session.engine.edit(lambda simulation: simulation.change([1], velocities=(30, 40)))
    facts = numbers(driver.session.interaction.menu, driver.session.frame)
    assert facts == {"speed": "50.0", "position": "400.0, 300.0", "mass": "100", "radius": "10"}
    assert title(driver.session.interaction.menu, driver.session.frame) == "particle 1"


def test_delete_clone_and_stop() -> None:
    driver = Driver(world_of(TWO), paused=True)
    choose(driver, "clone", (400, 300))
    assert len(driver.session.frame) == 3
    driver.session.engine.edit(lambda simulation: simulation.change([0, 1], velocities=(30, 40)))
    choose(driver, "stop", (400, 300))
    speeds = np.hypot(*driver.session.frame.velocities.T)
    assert speeds == pytest.approx([50, 0, 0], abs=1e-4)
    choose(driver, "delete", (200, 100))
    assert tags(driver.session.frame.tags) == [1, 2]


def test_a_particle_attracts_the_others_until_that_is_ended() -> None:
    driver = Driver(world_of(TWO))
    choose(driver, "attract", (400, 300))
    driver.frames(8)
    towards = driver.session.frame.velocities
    assert towards[0, 0] > 20 and abs(towards[1, 0]) < 1e-3
    driver.session.runner.paused = True
    driver.frames(1)
    place = driver.session.frame.positions[1].tolist()
    driver.click((place[0], place[1]), RIGHT)
    assert line_of(driver, "attract").label == "Stop attracting"
    line_of(driver, "attract").command()
    assert driver.session.frame.attractors == ()


def test_immovable_and_movable_again() -> None:
    driver = Driver(world_of(TWO, gravity=(0.0, 500.0)))
    choose(driver, "movable", (400, 300))
    driver.frames(10)
    assert driver.world.positions[1].tolist() == [400, 300] and driver.world.positions[0, 1] > 101
    assert line_of(driver, "movable").label == "Make movable"
    assert not line_of(driver, "stop").enabled
    line_of(driver, "movable").command()
    driver.frames(10)
    assert driver.world.positions[1, 1] > 301


def test_the_menu_acts_on_the_whole_selection_or_on_a_particle_outside_it_alone() -> None:
    driver = Driver(world_of([*TWO, (600, 400)]))
    driver.drag((150, 50), (450, 350))
    driver.click((400, 300), RIGHT)
    menu = driver.session.interaction.menu
    assert title(menu, driver.session.frame) == "particle 1 of 2 selected"
    line_of(driver, "delete").command()
    assert tags(driver.session.frame.tags) == [2]
    choose(driver, "select", (600, 400))
    assert tags(driver.session.interaction.selection.tags) == [2]
    assert line_of(driver, "select").checked
    driver = Driver(world_of([*TWO, (600, 400)]))
    driver.drag((150, 50), (450, 350))
    choose(driver, "delete", (600, 400))
    assert tags(driver.session.frame.tags) == [0, 1]
    assert tags(driver.session.interaction.selection.tags) == [0, 1]


def test_two_selected_particles_can_be_asked_about() -> None:
    driver = Driver(world_of([*TWO, (600, 400)]))
    driver.click((400, 300), RIGHT)
    assert "why" not in lines_by_name(driver)
    driver.drag((150, 50), (450, 350))
    choose(driver, "why", (400, 300))
    assert driver.session.question.pair == (0, 1)
    driver.key(pygame.K_w)
    assert driver.session.question.pair is None


def test_create_and_attract_here() -> None:
    driver = Driver(world_of(TWO), paused=True)
    choose(driver, "create", (600, 100))
    assert driver.session.frame.positions[2] == pytest.approx((600, 100), abs=1)
    choose(driver, "attractor", (100, 400))
    assert driver.session.frame.attractors[0].point == pytest.approx((100, 400), abs=1)
    choose(driver, "stop attraction", (500, 400))
    assert driver.session.frame.attractors == ()
    driver.click((500, 400), RIGHT)
    assert not line_of(driver, "stop attraction").enabled


def test_gravity_by_the_menu() -> None:
    driver = Driver(world_of(TWO, gravity=(0.0, 90.0)))
    for name, expected in [("triple", 270), ("third", 90), ("invert", -90), ("zero", 0)]:
        choose(driver, name, (600, 100))
        assert tuple(driver.world.gravity) == pytest.approx((0, expected), rel=1e-5)
    number = line_of(driver, "gravity")
    assert isinstance(number, Number)
    number.command(123.0)
    assert tuple(driver.world.gravity) == (0, 123) and line_of(driver, "gravity").value == 123


def test_clear_walls_scramble_and_randomise_are_offered() -> None:
    driver = Driver(world_of(TWO))
    driver.session.interaction.commands.wall((100, 450), (300, 450))
    choose(driver, "clear walls", (600, 100))
    assert len(driver.session.frame) == 2
    before = driver.session.frame.positions
    choose(driver, "scramble", (700, 50))
    assert (driver.session.frame.positions != before).any()
    choose(driver, "randomise", (driver.session.camera.to_world((5, 5))))
    assert np.abs(driver.session.frame.velocities).max() > 0


@pytest.fixture
def driver() -> Driver:
    pytest.importorskip("imgui_bundle")
    from jostle_lab.panels import menus

    driver = Driver(world_of(TWO, gravity=(0.0, 90.0)))
    driver.window.builders = [menus.build]
    driver.session.runner.paused = True
    driver.frames(2)
    return driver


def open_at(driver: Driver, point: tuple[float, float]) -> None:
    driver.click(point, RIGHT)
    driver.frames(3)
    assert driver.window.gui.modal


def click_on(driver: Driver, place: tuple[int, int]) -> None:
    for kind, extra in [
        (pygame.MOUSEMOTION, {"rel": (0, 0), "buttons": (0, 0, 0)}),
        (pygame.MOUSEBUTTONDOWN, {"button": 1}),
        (pygame.MOUSEBUTTONUP, {"button": 1}),
    ]:
        post(kind, pos=place, **extra)
        driver.frames(2)


def place_of(driver: Driver, name: str) -> tuple[int, int]:
    return driver.window.gui.marks[f"menu {name}"].center


def test_a_click_on_a_line_acts_and_closes_the_menu(driver: Driver) -> None:
    open_at(driver, (400, 300))
    click_on(driver, place_of(driver, "delete"))
    assert tags(driver.session.frame.tags) == [0] and driver.session.interaction.menu is None


def test_every_line_of_both_menus_is_shown(driver: Driver) -> None:
    for point in [(400, 300), (600, 100)]:
        open_at(driver, point)
        assert {f"menu {name}" for name in lines_by_name(driver)} <= set(driver.window.gui.marks)
        driver.key(pygame.K_ESCAPE)
        driver.frames(3)
        assert driver.session.interaction.menu is None and driver.session.open


def test_a_click_outside_the_menu_closes_it_and_does_nothing_else(driver: Driver) -> None:
    driver.session.interaction.selection.take([0])
    open_at(driver, (400, 300))
    click_on(driver, (990, 20))
    assert driver.session.interaction.menu is None
    assert len(driver.session.frame) == 2 and len(driver.session.interaction.selection) == 1


def test_a_right_click_elsewhere_ends_one_menu_and_the_next_opens_another(driver: Driver) -> None:
    open_at(driver, (400, 300))
    driver.click((700, 50), RIGHT)
    driver.frames(3)
    assert driver.session.interaction.menu is None
    open_at(driver, (700, 50))
    assert driver.session.interaction.menu.tag is None


def test_the_menu_closes_when_its_particle_goes(driver: Driver) -> None:
    open_at(driver, (400, 300))
    menu = driver.session.interaction.menu
    driver.session.engine.edit(lambda simulation: simulation.remove([1]))
    assert is_over(menu, driver.session.frame) and numbers(menu, driver.session.frame) == {}
    driver.frames(3)
    assert driver.session.interaction.menu is None and not driver.window.gui.modal


def test_a_gravity_can_be_typed(driver: Driver) -> None:
    open_at(driver, (600, 100))
    x, y = place_of(driver, "gravity")
    click_on(driver, (x - 40, y))
    post(pygame.KEYDOWN, key=pygame.K_a, mod=pygame.KMOD_CTRL)
    driver.frames(2)
    post(pygame.KEYUP, key=pygame.K_a, mod=pygame.KMOD_CTRL)
    post(pygame.KEYUP, key=pygame.K_LCTRL, mod=0)
    driver.frames(2)
    post(pygame.TEXTINPUT, text="-45")
    driver.frames(2)
    driver.key(pygame.K_RETURN)
    driver.frames(2)
    assert tuple(driver.world.gravity) == (0, -45)
    assert len(driver.session.frame) == 2  # A, which adds a particle, went to the field alone


def test_m_opens_the_menu_at_the_cursor(driver: Driver) -> None:
    driver.point_at((400, 300))
    driver.key(pygame.K_m)
    driver.frames(3)
    assert driver.session.interaction.menu.tag == 1 and driver.window.gui.modal
