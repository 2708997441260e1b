"""Why two particles touch or do not: the sentences are true, whatever the tree and the rules."""

from dataclasses import replace

import numpy as np
import pygame
import pytest

import jostle
from jostle_lab.act.explanation import Explanation, explain
from jostle_lab.act.view import draw_explanation
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.software import SoftwarePainter
from jostle_lab.schema import Settings
from jostle_lab.session import Session
from jostle_lab.simulate.frame import Frame, FrameRequest
from jostle_lab.simulate.region import Container, Torus, set_container
from jostle_lab.simulate.simulation import Simulation
from jostle_lab.simulate.start import start

VIEW = (0.0, 0.0, 100.0, 100.0)
TREE = FrameRequest(tree=True)


def frame_of(
    places, radii, container: Container = None, movable=True, **settings
) -> tuple[Frame, Settings]:
    rules = Settings("some discs", **settings)
    world = jostle.World(places, radii, movable=movable)
    set_container(world, container)
    simulation = Simulation(rules, VIEW, world)
    return simulation.frame(TREE), rules


def answer(*args, **options) -> Explanation:
    frame, settings = frame_of(*args, **options)
    why = explain(frame, 0, 1, settings)
    assert why is not None
    return why


def test_two_that_overlap_with_and_without_filters_that_match() -> None:
    why = answer([(10, 10), (13, 14)], [3, 4])
    assert why.touching and why.compared
    assert why.lines[0] == "Particles 0 and 1 touch: they overlap by 2."
    assert why.lines[1] == "The distance of their centres is 5; the sum of their radii 3 + 4 is 7."
    assert "overlap, and so do the circles" in why.lines[2]
    assert why.lines[3] == (
        "In a tree over the present positions both are in one leaf, 0 levels below the root with "
        "2 particles: they are a candidate pair."
    )
    assert why.boxes == ((7, 7, 13, 13), (9, 10, 17, 18))
    assert why.centres == ((10, 10), (13, 14))
    frame, settings = frame_of([(10, 10), (13, 14)], [3, 4])
    filters = {"categories": np.array([1, 2], np.uint32), "masks": np.array([3, 2], np.uint32)}
    why = explain(replace(frame, **filters), 0, 1, settings)
    assert why is not None
    assert why.lines[-1] == "Their collision filters do not match: they pass through each other."


def test_two_whose_boxes_overlap_but_not_the_circles_also_if_they_just_meet() -> None:
    why = answer([(0, 0), (3, 4)], [2, 2.5])
    assert not why.touching
    assert why.lines[0] == "Particles 0 and 1 do not touch: the gap is 0.5."
    assert "Their AABBs overlap, but the circles do not" in why.lines[2]
    why = answer([(0, 0), (3, 4)], [2, 3])
    said = "Particles 0 and 1 do not touch: the gap is 0, and touching requires overlap."
    assert not why.touching and why.lines[0] == said


@pytest.mark.parametrize(
    ("place", "words"),
    [((10, 0), "by 6 in x, "), ((0, 7), "by 3 in y, "), ((10, 7), "by 6 in x and by 3 in y, ")],
)
def test_on_which_axis_boxes_are_apart(place, words) -> None:
    why = answer([(0, 0), place], [2, 2])
    assert why.lines[2] == f"Their AABBs are separated {words}so they cannot touch."


def test_across_the_seam_of_a_torus_and_without_an_answer_for_one_that_is_gone() -> None:
    why = answer([(1, 50), (99, 50)], [2, 2], Torus(100, 100))
    assert why.touching
    assert "overlap by 2" in why.lines[0]
    assert why.centres == ((1, 50), (-1, 50))
    frame, settings = frame_of([(0, 0), (1, 1)], 1.0)
    assert explain(frame, 0, 2, settings) is None
    assert explain(frame, 1, 1, settings) is None


def test_leaves_that_are_apart_part_what_they_hold() -> None:
    places = [(5, 5), (95, 95), (6, 6), (94, 94)]
    why = answer(places, 1.0, leaf_capacity=2)
    assert not why.compared and len(why.leaves) == 2
    assert why.lines[3].startswith("In a tree over the present positions they are in two leaves: ")
    assert "leaves: 1 level below the root with 2 particles, and 1 level" in why.lines[3]
    assert why.lines[4].endswith("they are no candidate pair.")
    assert {leaf.bounds for leaf in why.leaves} == {(4, 4, 7, 7), (93, 93, 96, 96)}


@pytest.mark.parametrize("seed", range(5))
def test_the_tree_finds_all_that_touch(seed: int) -> None:
    """What the sentences say of the tree agrees with the pairs that overlap."""
    chance = np.random.default_rng(seed)
    places, radii = chance.uniform(0, 100, (60, 2)), chance.uniform(1, 8, 60)
    frame, settings = frame_of(places, radii, leaf_capacity=3)
    pairs = set(map(tuple, jostle.find_pairs(frame.positions, frame.radii).tolist()))
    untested = 0
    for i in range(60):
        for j in range(i + 1, 60):
            why = explain(frame, i, j, settings)
            assert why.touching == ((i, j) in pairs)
            assert why.compared or not why.touching
            assert all(leaf.count <= 3 for leaf in why.leaves)
            untested += not why.compared
    assert untested > 500


def test_nothing_is_said_of_what_a_step_has_tested() -> None:
    """Its tree is built of swept bounds; this one of current positions."""
    simulation = start(Settings("gas", 60))
    simulation.step()
    frame = simulation.frame(TREE)
    for other in range(1, 60):
        why = explain(frame, 0, other, simulation.settings)
        assert "the present positions" in why.lines[3] and "tested" not in " ".join(why.lines)
        assert why.lines[-1].endswith(
            "they are a candidate pair." if why.compared else "they are no candidate pair."
        )


def test_brute_force_and_contacts_that_are_not_a_bounce_are_explained() -> None:
    near = [(0, 0), (1, 0)]
    assert "collisions are off" in answer(near, 1.0, on_touch="ignore").lines[-1]
    assert "merge at the end" in answer(near, 1.0, on_touch="merge").lines[-1]
    assert "Both are immovable" in answer(near, 1.0, movable=[False, False]).lines[-1]
    why = answer([(0, 0), (50, 50)], 1.0, method="brute")
    assert why.compared and why.leaves == ()
    assert why.lines[3] == "Without a tree every pair is tested."


def test_a_session_answers_for_two_selected_until_it_is_taken_back() -> None:
    session = Session(start(Settings("gas", 40)), (640, 360), synchronous=True)
    session.explain()
    assert session.message == "Select two particles; 0 are selected."
    assert session.explanation is None
    session.interaction.selection.take([3, 5])
    session.explain()
    session.advance(1 / 60)
    first = session.explanation
    assert first.lines[0].startswith("Particles 3 and 5 ")
    assert len(first.leaves) in (1, 2)  # though the picture shows no tree
    for _ in range(5):
        session.advance(1 / 60)
    assert session.explanation.centres != first.centres
    session.engine.edit(lambda simulation: simulation.remove([5]))
    assert session.explanation is None
    session.advance(1 / 60)
    assert session.question.pair is None


@pytest.mark.parametrize("size", [(1280, 720), (200, 100)])
def test_the_answer_is_drawn(size) -> None:
    why = answer([(10, 10), (60, 70)], [3, 4])
    painter = SoftwarePainter(size)
    draw_explanation(painter, why, Camera(size, VIEW))
    assert len(np.unique(pygame.surfarray.array2d(painter.canvas()))) > 2


@pytest.mark.parametrize("size", [(1280, 720), (640, 360)])
@pytest.mark.parametrize("pair", ["highest", "lowest"])
def test_the_sentences_are_on_the_screen_and_not_over_the_pair(
    open_window, size, pair: str
) -> None:
    window = open_window(Settings("gas", 300), size)
    session = window.session
    session.runner.paused = True
    order = np.argsort(session.frame.positions[:, 1])
    chosen = order[:2] if pair == "highest" else order[-2:]
    session.interaction.selection.take(session.frame.tags[chosen])
    session.explain()
    for _ in range(4):
        window.frame(1 / 60)
    card = window.gui.marks["explanation"]
    x, y = session.camera.to_screen(session.frame.positions[chosen])
    assert pygame.Rect((0, 0), size).contains(card)
    assert not any(card.collidepoint(place) for place in zip(x, y, strict=True))
