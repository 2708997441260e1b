"""The panel of numbers of a video: scene, speed, times of the stages, pairs."""

from __future__ import annotations

from dataclasses import dataclass

import pygame

from jostle.app.draw.formatting import pairs_of, scientific, share
from jostle.app.draw.painter import Painter
from jostle.app.draw.palette import ACCENT, PANEL_EDGE, TEXT, TEXT_SOFT, Colour
from jostle.app.draw.text import BODY, SMALL, TITLE, font, panel, write
from jostle.app.simulate.engine import Engine
from jostle.app.simulate.settings import METHODS

WIDTH = 248
EDGE = 12  # pixels between the panel and the edge of the screen
SPACE = WIDTH + 2 * EDGE  # margin of the scene
PAD = 14
RULE = 11  # pixels, the height of a line between two parts
BAR = 44  # length of the longest bar of a stage
SMOOTH = 0.1  # weight of a new measurement
EVERY = 0.2  # seconds between updates


@dataclass(frozen=True)
class _Row:
    """A line of the panel: a name at the left, a value at the right, and a bar before it."""

    name: str
    value: str = ""
    size: int = BODY
    colour: Colour = TEXT_SOFT
    value_colour: Colour = TEXT
    bar: float | None = None  # its length, from 0 to 1

    @property
    def height(self) -> int:
        return font(self.size).get_linesize() + 3


class Readout:
    """Collects measurements every frame, and redraws its panel a few times per second."""

    def __init__(self) -> None:
        self._times: dict[str, float] = {}
        self._sheet: pygame.Surface | None = None
        self._due = 0.0

    def measure(self, **milliseconds: float) -> None:
        """Add one measurement for each named stage."""
        for stage, value in milliseconds.items():
            shown = self._times.get(stage, value)
            self._times[stage] = shown + SMOOTH * (value - shown)

    def draw(self, painter: Painter, engine: Engine, rate: float | None, now: float) -> None:
        """Draw the panel; `rate` is the number of steps per second."""
        if self._sheet is None or now >= self._due:
            self._sheet = _sheet(self._rows(engine, rate))
            self._due = now + EVERY
        painter.sheet(self._sheet, (EDGE, EDGE))

    def _rows(self, engine: Engine, rate: float | None) -> list[_Row | None]:
        """Return the lines; None is a rule between two parts."""
        facts, n = engine.frame.stats, len(engine.frame)
        every_pair = pairs_of(n)
        longest = max(self._times.values(), default=0.0) or 1.0
        # Drawing is last, in the order of work.
        stages = sorted(self._times.items(), key=lambda entry: entry[0] == "draw")
        return [
            _Row(engine.scene, size=TITLE, colour=TEXT),
            _Row(f"{METHODS[engine.settings.method]} · {n:,} particles"),
            None,
            _Row("steps/s", "–" if rate is None else f"{rate:,.0f}"),
            None,
            _Row("stage", "ms per step", SMALL, value_colour=TEXT_SOFT),
            *(_Row(name, f"{ms:.2f}", bar=ms / longest) for name, ms in stages),
            None,
            _Row("pairs tested", f"{facts.pairs_tested:,}"),
            _Row("of n(n−1)/2", f"{every_pair:,}"),
            _Row("tested, % of all pairs", share(facts.pairs_tested, every_pair)),
            _Row("touching", f"{facts.touching:,}"),
            _Row("asleep", f"{facts.asleep:,}"),
            _Row("kinetic energy", scientific(facts.kinetic_energy)),
        ]


def _sheet(rows: list[_Row | None]) -> pygame.Surface:
    """Return the lines on a panel, from top to bottom."""
    sheet = panel((WIDTH, 2 * PAD + sum(row.height if row else RULE for row in rows)))
    y, right = PAD, WIDTH - PAD
    for row in rows:
        if row is None:
            pygame.draw.line(sheet, PANEL_EDGE, (PAD, y + 4), (right, y + 4))
            y += RULE
            continue
        write(sheet, (PAD, y), row.name, row.colour, row.size)
        write(sheet, (right, y), row.value, row.value_colour, row.size, flush_right=True)
        if row.bar is not None:
            bar = right - 62 - BAR, y + row.height // 2 - 3, max(round(BAR * row.bar), 1), 4
            pygame.draw.rect(sheet, ACCENT, bar)
        y += row.height
    return sheet
