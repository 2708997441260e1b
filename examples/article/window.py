"""The window of the article's two programs, or a film of it if there is no display."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from pathlib import Path

import pygame

from jostle.record import Film
from jostle_lab.article import FRAME_RATE, HEIGHT, WIDTH, Leaf, Particle, Simulation
from jostle_lab.cli.runs import has_display
from jostle_lab.storage.recording import pixels

WHITE, INK = (255, 255, 255), (40, 40, 40)
SIZE = WIDTH, HEIGHT
MOUSE_PULL = 0.1  # of the distance to the cursor, per frame


def options(name: str, n: int) -> argparse.Namespace:
    """Return the options of the command line; `n` is the number of balls in the article."""
    parser = argparse.ArgumentParser(description=f"The article's program: {name}.")
    parser.add_argument("-n", type=count, default=n, help="number of balls (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="the same seed gives the same balls")
    parser.add_argument("--film", type=Path, help="an .mp4 or .gif to write; no window is opened")
    parser.add_argument("--frames", type=count, default=300, help="of the film (%(default)s)")
    chosen = parser.parse_args()
    if chosen.film is None and not has_display():
        chosen.film = Path("out", f"{name}.mp4")
        chosen.film.parent.mkdir(exist_ok=True)
    return chosen


def count(text: str) -> int:
    """Return a whole number, at least 1."""
    if int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text}, which is less than 1")
    return int(text)


def frames(
    simulation: Simulation, chosen: argparse.Namespace
) -> Iterator[tuple[pygame.Surface, bool]]:
    """Yield an empty picture to draw each frame on, and whether to draw the boxes of the tree."""
    pygame.font.init()
    if chosen.film is None:
        yield from window_frames(simulation)
    else:
        screen = pygame.Surface(SIZE, depth=32)
        try:
            film = Film(chosen.film, SIZE, FRAME_RATE)
        except (OSError, ValueError) as error:
            raise SystemExit(f"--film is {str(chosen.film)!r}: {error}") from None
        with film:
            for frame in range(chosen.frames):
                screen.fill(WHITE)
                yield screen, frame >= chosen.frames // 2
                film.add(pixels(screen))
        print(f"{chosen.film}: {chosen.frames} frames")


class Mouse:
    """Drags a ball, which keeps its velocity when it is released."""

    held: Particle | None = None

    def press(self, balls: list[Particle], x: float, y: float) -> None:
        """Hold the first ball of the list that is under the cursor, if there is one."""
        under = (ball for ball in balls if math.hypot(x - ball.x, y - ball.y) <= ball.radius)
        self.held = next(under, None)

    def pull(self, x: float, y: float) -> None:
        """Set the velocity of the ball towards the cursor, before each frame."""
        if ball := self.held:
            ball.angle = math.pi / 2 + math.atan2(y - ball.y, x - ball.x)
            ball.speed = MOUSE_PULL * math.hypot(x - ball.x, y - ball.y)


def window_frames(simulation: Simulation) -> Iterator[tuple[pygame.Surface, bool]]:
    """Open the window, in which the mouse drags balls; T shows or hides the boxes."""
    screen, clock, boxes = pygame.display.set_mode(SIZE), pygame.time.Clock(), False
    mouse, cursor = Mouse(), (0, 0)
    while True:
        for event in pygame.event.get():
            if event.type == pygame.QUIT:
                return
            if event.type == pygame.KEYDOWN and event.key == pygame.K_t:
                boxes = not boxes
            elif event.type == pygame.MOUSEBUTTONDOWN:
                mouse.press(simulation.particles, *event.pos)
            elif event.type == pygame.MOUSEBUTTONUP:
                mouse.held = None
            cursor = getattr(event, "pos", cursor)
        mouse.pull(*cursor)
        screen.fill(WHITE)
        yield screen, boxes
        pygame.display.flip()
        clock.tick(FRAME_RATE)


def draw_ball(screen: pygame.Surface, ball: Particle) -> None:
    """Draw a ball: the denser, the darker."""
    light = 200 - 10 * ball.density
    pygame.draw.aacircle(screen, (light, light, 255), (ball.x, ball.y), ball.radius)


def draw_box(screen: pygame.Surface, leaf: Leaf) -> None:
    """Fill a leaf of the tree: 30 more red at each level."""
    x, y, width, height, level = leaf
    pale = 255 - 30 * level
    pygame.draw.rect(screen, (255, pale, pale), (x, y, width, height))
    pygame.draw.rect(screen, (225, pale - 30, pale - 30), (x, y, width, height), width=1)


def write(screen: pygame.Surface, words: str) -> None:
    """Write the numbers of a frame into the upper left corner."""
    text = pygame.font.Font(None, 22).render(words, True, INK, WHITE)
    screen.blit(text, (8, 8))
