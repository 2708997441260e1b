"""What the tests of the driver share: a window without a display, and events to post to it."""

import threading
from collections.abc import Callable, Iterable, Sequence
from typing import ClassVar

import numpy as np
import pygame

import jostle
from jostle_lab.schema import Settings
from jostle_lab.session import Session
from jostle_lab.simulate.simulation import Simulation
from jostle_lab.window import Window

FRAME = 1 / 60
VIEW = (0.0, 0.0, 800.0, 500.0)
SIZE = (1000, 640)
LEFT, MIDDLE, RIGHT = 1, 2, 3

Point = tuple[float, float]


def world_of(places: Sequence[Point], radii: object = 10.0, **rules: object) -> Simulation:
    """Discs at rest in a box of 800 by 500, without gravity."""
    if "period" not in rules:
        rules.setdefault("container", jostle.Box(*VIEW))
    world = jostle.World(np.array(places).reshape(-1, 2), radii, **rules)
    return Simulation(Settings("test"), VIEW, world)


class Driver:
    """Scripted input of a window; its session is closed after the test."""

    opened: ClassVar[list[Session]] = []

    def __init__(
        self,
        simulation: Simulation,
        *,
        synchronous: bool = True,
        paused: bool = False,
        steps: int | None = None,
    ) -> None:
        self.window = Window(simulation, SIZE, steps, synchronous=synchronous)
        self.window.builders = []  # no panels between the mouse and the scene
        self.session = self.window.session
        self.opened.append(self.session)
        self.session.runner.paused = paused
        pygame.event.clear()

    @property
    def world(self) -> jostle.World:
        return self.session.engine.simulation.world

    def pixel(self, point: Point) -> tuple[int, int]:
        (x,), (y,) = self.session.camera.to_screen(np.array([point], np.float64))
        return round(float(x)), round(float(y))

    def frames(self, count: int = 1, elapsed: float = FRAME) -> None:
        """Run frames; of several only the last is drawn."""
        for left in reversed(range(count)):
            self.window._seen = left == 0
            self.window.frame(elapsed)

    def key(self, key: int, *, up: bool = True, mod: int = 0) -> None:
        post(pygame.KEYDOWN, key=key, mod=mod)
        if up:
            post(pygame.KEYUP, key=key, mod=0)
        self.window.frame(0.0)

    def key_up(self, key: int) -> None:
        post(pygame.KEYUP, key=key, mod=0)
        self.window.frame(0.0)

    def point_at(self, point: Point) -> None:
        self.move(self.pixel(point))
        self.window.frame(0.0)

    def move(self, pixel: tuple[int, int]) -> None:
        post(pygame.MOUSEMOTION, pos=pixel, rel=(0, 0), buttons=(0, 0, 0))

    def down(self, point: Point, button: int = LEFT, mod: int = 0) -> None:
        self.move(self.pixel(point))
        post(pygame.MOUSEBUTTONDOWN, pos=self.pixel(point), button=button, mod=mod)
        self.window.frame(0.0)

    def up(self, point: Point, button: int = LEFT, mod: int = 0) -> None:
        self.move(self.pixel(point))
        post(pygame.MOUSEBUTTONUP, pos=self.pixel(point), button=button, mod=mod)
        self.window.frame(0.0)

    def click(self, point: Point, button: int = LEFT, mod: int = 0) -> None:
        self.down(point, button, mod)
        self.up(point, button, mod)

    def drag(self, start: Point, end: Point, button: int = LEFT, mod: int = 0) -> None:
        """Press, move in ten frames without time, of which the last is drawn, release."""
        self.down(start, button, mod)
        for share in np.linspace(0, 1, 10):
            x, y = np.array(start) + share * (np.array(end) - np.array(start))
            self.move(self.pixel((float(x), float(y))))
            self.window._seen = share == 1
            self.window.frame(0.0)
        self.up(end, button, mod)


def gate_steps(simulation: Simulation) -> tuple[threading.Event, Callable[[], None]]:
    """Let steps wait until the second is called; the first is set when one has begun."""
    gate, begun, step = threading.Event(), threading.Event(), simulation.step

    def waiting(*inputs: object) -> None:
        begun.set()
        gate.wait(30)
        step(*inputs)

    simulation.step = waiting
    return begun, gate.set


def post(kind: int, **facts: object) -> None:
    pygame.event.post(pygame.event.Event(kind, **facts))


def tags(chosen: Iterable[int]) -> list[int]:
    return [int(tag) for tag in chosen]
