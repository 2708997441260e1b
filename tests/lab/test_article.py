"""The article's rules, compared with values computed by hand, and the demonstrations of faults."""

import doctest
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from jostle_lab import article
from jostle_lab.article import Particle, Simulation, add_vectors, collide, overlaps, quarters

UP, RIGHT, DOWN, LEFT = 0.0, math.pi / 2, math.pi, 3 * math.pi / 2
METHODS = ["brute", "quadtree"]

Point = tuple[float, float]


def ball(x: float, y: float = 250.0, **others: Any) -> Particle:
    return Particle(x, y, **{"radius": 10, "density": 1, **others})


def velocity(particle: Particle) -> Point:
    return (particle.speed * math.sin(particle.angle), -particle.speed * math.cos(particle.angle))


def state(simulation: Simulation) -> list[tuple[float, ...]]:
    return [(p.x, p.y, p.speed, p.angle, p.radius, p.density) for p in simulation.particles]


def test_every_fault_has_a_demonstration() -> None:
    page = Path(__file__).parents[2] / "examples" / "article" / "README.md"
    faults = re.split(r"^\*\*(?=\d+\. )", page.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]
    assert [int(fault.split(".")[0]) for fault in faults] == list(range(1, 12))
    assert all(">>> " in fault for fault in faults)
    assert doctest.testfile(str(page), module_relative=False).failed == 0
    assert doctest.testmod(article).failed == 0


def test_particles_keep_to_the_ranges_and_formulas_of_the_article() -> None:
    particles = Simulation(2000, seed=3).particles
    assert {p.radius for p in particles} == set(range(5, 11))
    assert {p.density for p in particles} == set(range(1, 21))
    assert all(0 <= p.speed < 1 and 0 <= p.angle <= 2 * math.pi for p in particles)
    assert all(p.radius <= p.x <= 800 - p.radius for p in particles)
    assert all(p.radius <= p.y <= 500 - p.radius for p in particles)
    particle = ball(50, radius=5, density=2)
    assert particle.mass == 50
    assert particle.drag == pytest.approx((50 / 50.2) ** 5)


def test_vectors_are_added_by_their_components() -> None:
    assert add_vectors((UP, 3), (RIGHT, 4)) == pytest.approx((math.atan2(4, 3), 5))
    assert add_vectors((RIGHT, 2), (DOWN, 0)) == pytest.approx((RIGHT, 2))


def test_move_adds_gravity_then_the_velocity_then_drag() -> None:
    particle = ball(100, 100, speed=3, angle=RIGHT)
    particle.move()
    assert (particle.x, particle.y) == pytest.approx((103, 100.5))
    assert particle.speed == pytest.approx(math.hypot(3, 0.5) * (100 / 100.2) ** 10)


@pytest.mark.parametrize(
    ("start", "end", "before", "after", "speed"),
    [
        ((795, 250), (785, 250), (2, -1), (-1.5, -0.75), 0.75),
        ((4, 250), (16, 250), (-2, 1), (1.5, 0.75), 0.75),
        ((400, 493), (400, 487), (2, 1), (1.5, -0.75), 0.75),
        ((400, 7), (400, 13), (2, -1), (1.5, 0.75), 0.75),
        ((795, 493), (785, 487), (2, 1), (-1.125, -0.5625), 0.5625),
        ((790, 490), (790, 490), (2, 1), (2, 1), 1),
        ((2000, 250), (-420, 250), (2, 0), (-1.5, 0), 0.75),  # reflected once only
    ],
)
def test_walls(start: Point, end: Point, before: Point, after: Point, speed: float) -> None:
    length = math.hypot(*before)
    particle = ball(*start, speed=length, angle=math.atan2(before[0], -before[1]))
    particle.bounce(800, 500)
    assert (particle.x, particle.y) == pytest.approx(end)
    assert velocity(particle) == pytest.approx(after)
    assert particle.speed == pytest.approx(speed * length)


def test_collision_by_hand() -> None:
    # n = (-1, 0), masses 100 and 300:
    # v1' = -1/2 * 4 + 3/2 * 2 * -1 = -5, and v2' = 1/2 * -2 - 1/2 * 5 * -1 = 1.5
    first = ball(100, speed=4, angle=RIGHT)
    second = ball(118, speed=2, angle=LEFT, density=3)
    assert collide(first, second)
    assert velocity(first) == pytest.approx((-5 * 0.75, 0))
    assert velocity(second) == pytest.approx((1.5 * 0.75, 0))
    assert (first.x, second.x) == pytest.approx((98.5, 119.5))  # a gap of one pixel
    assert (first.y, second.y) == pytest.approx((250, 250))


def test_equal_shares_along_the_line_of_centres() -> None:
    first, second = ball(100, 100, density=20), ball(106, 108)
    assert collide(first, second)
    assert (first.x, first.y) == pytest.approx((100 - 0.6 * 5.5, 100 - 0.8 * 5.5))
    assert (second.x, second.y) == pytest.approx((106 + 0.6 * 5.5, 108 + 0.8 * 5.5))


def test_balls_that_just_touch_are_left_alone_and_coincident_ones_part_along_x() -> None:
    first, second = ball(100, speed=1, angle=RIGHT), ball(120)
    assert not collide(first, second)
    assert (first.x, first.speed, second.x, second.speed) == (100, 1, 120, 0)
    assert overlaps([first, ball(115), ball(135)]) == {(0, 1): 5.0}
    first, second = ball(100), ball(100)
    assert collide(first, second)
    assert (first.x, second.x) == pytest.approx((110.5, 89.5))
    assert (first.y, second.y) == pytest.approx((250, 250))


@pytest.mark.parametrize(
    ("method", "order"),
    [
        ("brute", "move0 bounce0 collide01 collide02 move1 bounce1 collide12 move2 bounce2"),
        (
            "quadtree",
            "collide01 collide02 collide12 move0 bounce0 rectangle0"
            " move1 bounce1 rectangle1 move2 bounce2 rectangle2",
        ),
    ],
)
def test_order(method: str, order: str, monkeypatch: pytest.MonkeyPatch) -> None:
    simulation = Simulation.of([ball(100), ball(200), ball(300)], method)
    log: list[str] = []

    def recorded(name: str, act: Callable[..., Any]) -> Callable[..., Any]:
        def wrapper(*args: Any) -> Any:
            who = [simulation.particles.index(arg) for arg in args if isinstance(arg, Particle)]
            log.append(name + "".join(map(str, who)))
            return act(*args)

        return wrapper

    monkeypatch.setattr(article, "collide", recorded("collide", collide))
    for name in ("move", "bounce", "update_rectangle"):
        short = name.removeprefix("update_")
        monkeypatch.setattr(Particle, name, recorded(short, getattr(Particle, name)))
    simulation.frame()
    assert log[: len(order.split())] == order.split()


@pytest.mark.parametrize("method", METHODS)
def test_the_seed_decides_everything(method: str) -> None:
    first, second = Simulation(60, method, seed=5), Simulation(60, method, seed=5)
    for _ in range(20):
        first.frame()
        second.frame()
    assert state(first) == state(second)
    begun = state(Simulation(60, method, seed=5))
    assert state(Simulation(60, method, seed=6)) != begun
    assert all(state(Simulation(60, other, seed=5)) == begun for other in METHODS)


def test_the_method_may_be_changed_between_frames() -> None:
    simulation = Simulation(40, "brute", seed=2)
    simulation.frame()
    assert all(
        p.rectangle[:2] == (int(p.x - p.radius), int(p.y - p.radius)) for p in simulation.particles
    )
    simulation.method = "quadtree"
    simulation.frame()
    assert simulation.leaves


@pytest.mark.parametrize("n", [0, 1, 2, 50])
def test_brute_force_tests_every_pair_once(n: int) -> None:
    simulation = Simulation(n, "brute")
    simulation.frame()
    assert (simulation.tests, simulation.repeats) == (n * (n - 1) // 2, 0)
    assert (simulation.leaves, simulation.tested) == ([], set())


def test_a_box_of_three_is_a_leaf_and_one_of_four_splits() -> None:
    simulation = Simulation.of([ball(20), ball(35), ball(780)], "quadtree")
    simulation.frame()
    assert simulation.leaves == [(0, 0, 800, 500, 0)]
    assert (simulation.tests, simulation.repeats, simulation.hits) == (3, 0, 1)
    balls = [ball(400, 100), ball(405, 100), ball(20, 480), ball(780, 480)]
    simulation = Simulation.of(balls, "quadtree")
    simulation.frame()
    assert simulation.leaves == [
        (0, 0, 400, 250, 1),
        (400, 0, 400, 250, 1),
        (0, 250, 400, 250, 1),
        (400, 250, 400, 250, 1),
    ]
    assert (simulation.tests, simulation.repeats, simulation.hits) == (2, 1, 1)
    assert simulation.tested == {(0, 1)}


def test_counters_are_of_the_last_frame_only() -> None:
    simulation = Simulation.of([ball(100), ball(110)])
    simulation.frame()
    assert simulation.hits == 1
    simulation.frame()
    assert (simulation.tests, simulation.hits) == (1, 0)


def test_the_tree_does_not_see_a_particle_before_its_rectangle_is_renewed() -> None:
    balls = [ball(x, 100) for x in (100, 500, 600, 700)]
    simulation = Simulation.of(balls, "quadtree")
    balls[0].x = 505.0
    simulation.frame()
    assert simulation.hits == 0
    simulation.frame()
    assert simulation.hits == 1


def test_rectangles_are_cut_to_whole_pixels() -> None:
    assert quarters((10, 20, 7, 5)) == [
        (10, 20, 3, 2),
        (13, 20, 3, 2),
        (10, 22, 3, 2),
        (13, 22, 3, 2),
    ]
    assert ball(10.9, 9.4).rectangle == (0, 0, 20, 20)
