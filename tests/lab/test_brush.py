"""The brush of the simulator: particles along a drag, of the chosen kind, where there is room."""

import numpy as np
import pygame
from lab_interaction import Driver, world_of

import jostle
from jostle_lab.act.commands import REACH
from jostle_lab.act.interaction import Tool
from jostle_lab.act.view import draw_preview
from jostle_lab.draw.palette import KINDS
from jostle_lab.draw.software import SoftwarePainter
from jostle_lab.schema import Settings
from jostle_lab.simulate.containers import free_among
from jostle_lab.simulate.start import start

LINE = (200.0, 250.0), (600.0, 250.0)


def test_a_drag_adds_particles_within_reach_of_its_path_until_its_release() -> None:
    driver = Driver(world_of([(400, 250)]))
    driver.key(pygame.K_4)
    driver.drag(*LINE)
    frame = driver.session.frame
    places = frame.positions[1:].astype(float)
    assert 20 < len(places) < 100
    nearest = np.clip(places[:, 0], LINE[0][0], LINE[1][0])
    reach = np.hypot(places[:, 0] - nearest, places[:, 1] - LINE[0][1])
    assert (reach <= REACH * 10 + 1).all() and reach.max() > REACH * 5
    assert np.ptp(places[:, 0]) > 350 and (frame.radii == 10).all()
    assert len(jostle.find_pairs(frame.positions, frame.radii)) == 0
    driver = Driver(world_of([(100, 100)]))
    driver.key(pygame.K_4)
    driver.drag((200, 400), (300, 400))
    count = len(driver.session.frame)
    assert count > 1
    driver.point_at((600, 100))
    driver.key(pygame.K_1)
    driver.drag((500, 50), (700, 90))
    assert len(driver.session.frame) == count


def test_free_places_in_a_circle_are_all_used() -> None:
    world = world_of([(1, 1)], container=jostle.Circle((0.1, 0.3), 70)).world
    grid = np.stack(np.meshgrid(np.arange(-60, 61, 7.3), np.arange(-60, 61, 7.3)), -1)
    places = grid.reshape(-1, 2)
    inside = np.hypot(*(places - (0.1, 0.3)).T) <= 70 - 3
    apart = np.hypot(*(places - 1).T) >= 14
    assert set(free_among(world, places, 3.0)) == set(np.flatnonzero(inside & apart))


def test_nothing_is_added_outside_or_on_a_wall() -> None:
    driver = Driver(world_of([(100, 100)], radii=5.0))
    driver.session.interaction.commands.wall((300, 0), (300, 500))
    driver.key(pygame.K_4)
    for _ in range(3):
        driver.drag((0, 490), (790, 490))
    frame = driver.session.frame
    places = frame.positions.astype(float)
    assert len(frame) > 40
    assert (places >= 5).all() and (places <= np.array([800, 500]) - 5).all()
    assert (np.abs(places[:, 0] - 300) >= 5).all()
    assert driver.session.message is None or "Tool" in driver.session.message


def test_it_paints_the_chosen_kind_and_shows_it() -> None:
    driver = Driver(start(Settings("life", n=40)))
    session = driver.session
    session.runner.toggle_pause()
    session.interaction.commands.kind = 4
    session.interaction.commands.rng = np.random.default_rng(1)
    driver.key(pygame.K_4)
    x0, y0, x1, y1 = session.engine.view
    middle = (y0 + y1) / 2
    driver.drag((x0 + 0.3 * (x1 - x0), middle), (x0 + 0.6 * (x1 - x0), middle))
    kinds = session.frame.kinds
    assert kinds is not None and len(kinds) == 40 + 15
    assert (kinds[40:] == 4).all()
    preview = session.interaction.preview
    assert preview is not None and preview.tool is Tool.BRUSH and preview.kind == 4
    painter = SoftwarePainter(session.camera.size)
    painter.fill((0, 0, 0))
    draw_preview(painter, preview, session.camera)
    canvas = pygame.surfarray.array3d(painter.canvas())
    assert (canvas == np.array(KINDS[4])).all(axis=2).any()
