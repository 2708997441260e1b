"""Times of the adapters: the same calls of the other library and of jostle.

.venv/bin/python benchmarks/adapters.py pyqtree
.venv-arcade/bin/python benchmarks/adapters.py arcade
.venv-arcade/bin/python benchmarks/adapters.py engines
.venv/bin/python benchmarks/adapters.py mesa
"""

from __future__ import annotations

import importlib
import os
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

ROUNDS = 5
Timed = tuple[str, Callable[[], Any]]


def milliseconds(act: Callable[[], Any]) -> float:
    """Return the minimum of a few rounds in milliseconds: other processes only increase a time."""
    times = []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        act()
        times.append(time.perf_counter() - start)
    return 1e3 * min(times)


def report(n: int, *acts: Timed) -> None:
    print(f"n = {n:,}")
    for name, act in acts:
        print(f"  {name:58} {milliseconds(act):9.2f} ms", flush=True)


def boxes(n: int) -> list[tuple[float, ...]]:
    """Unit boxes that cover 40 % of a square."""
    corners = np.random.default_rng(0).uniform(0, np.sqrt(n / 0.4), (n, 2))
    return list(map(tuple, np.hstack([corners, corners + 1]).tolist()))


def measure_pyqtree(n: int) -> None:
    """Fill an index, query it once for each box, and move every tenth box."""
    from jostle.pyqtree import Index

    table = boxes(n)
    side = float(np.sqrt(n / 0.4))

    def filled(kind: Any) -> Any:
        index = kind(bbox=(0, 0, side, side))
        for number, box in enumerate(table):
            index.insert(number, box)
        for box in table[:4]:  # after which even a lazy index has built its tree
            index.intersect(box)
        return index

    def ask(index: Any) -> None:
        for box in table:
            index.intersect(box)

    def move(index: Any) -> None:
        for number, box in enumerate(table[: n // 10]):
            index.remove(number, box)
            index.insert(number, box)
            index.intersect(box)

    theirs, mine = importlib.import_module("pyqtree").Index, Index
    old, new = filled(theirs), filled(mine)
    report(
        n,
        ("fill: pyqtree", lambda: filled(theirs)),
        ("fill: jostle.pyqtree", lambda: filled(mine)),
        ("ask for each box: pyqtree", lambda: ask(old)),
        ("ask for each box: jostle.pyqtree", lambda: ask(new)),
        ("ask for each box: jostle.pyqtree, intersect_many", lambda: new.intersect_many(table)),
        ("move a tenth, ask after each: pyqtree", lambda: move(old)),
        ("move a tenth, ask after each: jostle.pyqtree", lambda: move(new)),
    )


def measure_arcade(n: int) -> None:
    """Find all pairs of rotated squares after every one has moved."""
    os.environ["ARCADE_HEADLESS"] = "True"
    import arcade

    import jostle.arcade

    table = boxes(n)
    rng = np.random.default_rng(1)
    plain, hashed = (
        arcade.SpriteList(lazy=True),
        arcade.SpriteList(use_spatial_hash=True, lazy=True),
    )
    for sprites in (plain, hashed):
        for x, y, *_ in table:
            turn = float(rng.uniform(0, 360))
            sprites.append(arcade.SpriteSolidColor(16, 16, x * 20, y * 20, angle=turn))

    def moved(sprites: Any) -> Any:
        for sprite in sprites:
            sprite.center_x += 0.5
        return sprites

    def one_by_one(sprites: Any, method: int) -> None:
        for sprite in moved(sprites):
            arcade.check_for_collision_with_list(sprite, sprites, method)

    def from_a_snapshot() -> None:
        now = jostle.arcade.Snapshot(moved(plain))
        for sprite in plain:
            jostle.arcade.check_for_collision_with_list(sprite, now)

    acts: list[Timed] = [
        ("move, no collisions", lambda: moved(plain)),
        ("arcade, a spatial hash", lambda: one_by_one(hashed, 1)),
        ("jostle.arcade, a query of a snapshot for each sprite", from_a_snapshot),
        ("jostle.arcade, selfcollide", lambda: jostle.arcade.selfcollide(moved(plain))),
    ]
    if n <= 1_000:
        acts.insert(1, ("arcade, every sprite with every other", lambda: one_by_one(plain, 3)))
    report(n, *acts)


def measure_engines(n: int) -> None:
    """A second of a platformer: walk, jump, ride, on a ground of some walls and among others."""
    os.environ["ARCADE_HEADLESS"] = "True"
    import arcade

    import jostle.arcade

    def game(kind: Any, hashed: bool) -> Callable[[], None]:
        walls = arcade.SpriteList(use_spatial_hash=hashed, lazy=True)
        for number in range(n):
            x, level = 40 * (number % (n // 4)), number // (n // 4)
            walls.append(arcade.SpriteSolidColor(40, 40, x, 140 * level))
        platforms = arcade.SpriteList(lazy=True)
        for x in range(10):
            lift = arcade.SpriteSolidColor(80, 10, 200 * x, 60)
            lift.change_x, lift.boundary_left, lift.boundary_right = 2, 200 * x - 90, 200 * x + 90
            platforms.append(lift)
        player = arcade.SpriteSolidColor(20, 30, 200, 40)
        engine = kind(player, platforms, walls=walls)

        def second() -> None:
            player.position = 200, 40
            for frame in range(60):
                player.change_x = 4
                if frame % 20 == 0 and engine.can_jump():
                    engine.jump(9)
                engine.update()

        return second

    theirs, mine = arcade.PhysicsEnginePlatformer, jostle.arcade.PhysicsEnginePlatformer
    acts: list[Timed] = [
        ("60 updates: arcade, walls with a spatial hash", game(theirs, True)),
        ("60 updates: jostle.arcade", game(mine, False)),
    ]
    if n <= 1_000:  # more are searched on the graphics card
        acts.insert(0, ("60 updates: arcade, walls without it", game(theirs, False)))
    report(n, *acts)


def measure_mesa(n: int) -> None:
    """Steps of Mesa's own flocking example, after which the boids are at the same positions."""
    from mesa.examples.basic.boid_flockers import model as flocking
    from mesa.experimental.continuous_space import ContinuousSpace as MesaSpace

    from jostle.mesa import ContinuousSpace

    side = float(np.sqrt(10 * n))
    models, times = [], []
    for space in (MesaSpace, ContinuousSpace):
        flocking.ContinuousSpace = space
        model = flocking.BoidFlockers(n, side, side, vision=4, seed=1)
        models.append(model)
        # The first step, so that both have made as many: a step of Mesa takes minutes.
        start = time.process_time()
        model.step()
        times.append(time.process_time() - start)
    places = [np.array([agent.position for agent in model.agents]) for model in models]
    assert np.array_equal(*places), "the boids are at other positions"
    print(f"n = {n:,}")
    for name, seconds in zip(("Mesa", "jostle.mesa"), times, strict=True):
        what = f"CPU time of a boid in the flocking example: {name}"
        print(f"  {what:58} {1e6 * seconds / n:9.1f} µs", flush=True)


if __name__ == "__main__":
    measure = {
        "pyqtree": measure_pyqtree,
        "arcade": measure_arcade,
        "engines": measure_engines,
        "mesa": measure_mesa,
    }[sys.argv[1]]
    for n in (1_000, 10_000, 100_000)[: 3 if measure is measure_pyqtree else 2]:
        measure(n)
