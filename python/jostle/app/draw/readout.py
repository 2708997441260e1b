"""The panel of numbers of a video: scene, speed, times of the stages, pairs."""

from __future__ import annotations

import pygame

from jostle.app.draw.formatting import method_name, pairs_of, scientific, share
from jostle.app.draw.painter import Painter
from jostle.app.draw.palette import ACCENT, PANEL_EDGE, TEXT, TEXT_SOFT
from jostle.app.draw.text import BODY, SMALL, TITLE, font, panel, write
from jostle.app.simulate.engine import Engine

WIDTH = 248
EDGE = 12  # pixels between the panel and the edge of the screen
SPACE = WIDTH + 2 * EDGE  # margin of the scene
PAD = 14
BAR = 44  # length of the longest bar of a stage
SMOOTH = 0.1  # weight of a new measurement
EVERY = 0.2  # seconds between updates


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

    def forget(self) -> None:
        """Discard the times, after a change of method or scene."""
        draw = self._times.get("draw")
        self._times = {} if draw is None else {"draw": draw}
        self._due = 0.0

    def draw(
        self,
        painter: Painter,
        engine: Engine,
        rate: tuple[str, float | None],
        now: float,
        *,
        paused: bool = False,
    ) -> None:
        """Draw the panel; `rate` is the label and value of the speed."""
        if self._sheet is None or now >= self._due:
            self._sheet = self._render(engine, rate, paused=paused)
            self._due = now + EVERY
        painter.sheet(self._sheet, (EDGE, EDGE))

    def _render(
        self, engine: Engine, rate: tuple[str, float | None], *, paused: bool
    ) -> pygame.Surface:
        times = {stage: self._times[stage] for stage in self._times if stage != "draw"}
        if "draw" in self._times:
            times["draw"] = self._times["draw"]  # last, in the order of work
        facts, n = engine.frame.stats, len(engine.frame)
        page = _Page(9 + len(times))
        page.title(engine.scene, "paused" if paused else "")
        page.soft(f"{method_name(engine.settings.method)} · {n:,} particles")
        page.rule()
        label, value = rate
        page.row(label, "–" if value is None else f"{value:,.0f}")
        page.rule()
        page.head("stage", "ms per step")
        longest = max(times.values(), default=0.0)
        for stage, milliseconds in times.items():
            page.stage(stage, milliseconds, milliseconds / longest if longest > 0 else 0.0)
        page.rule()
        every_pair = pairs_of(n)
        page.row("pairs tested", f"{facts.pairs_tested:,}")
        page.row("of n(n−1)/2", f"{every_pair:,}")
        page.row("tested, % of all pairs", share(facts.pairs_tested, every_pair))
        page.row("touching", f"{facts.touching:,}")
        page.row("asleep", f"{facts.asleep:,}")
        page.row("kinetic energy", scientific(facts.kinetic_energy))
        return page.sheet


class _Page:
    """A surface filled line by line from the top."""

    def __init__(self, rows: int) -> None:
        self._line = font(BODY).get_linesize() + 3
        self._y = PAD
        height = 2 * PAD + font(TITLE).get_linesize() + rows * self._line + 3 * 11
        self.sheet = panel((WIDTH, height))

    def title(self, text: str, note: str) -> None:
        write(self.sheet, (PAD, self._y), text, TEXT, TITLE)
        write(self.sheet, (WIDTH - PAD, self._y + 4), note, ACCENT, flush_right=True)
        self._y += font(TITLE).get_linesize() + 2

    def soft(self, text: str) -> None:
        write(self.sheet, (PAD, self._y), text, TEXT_SOFT)
        self._y += self._line

    def rule(self) -> None:
        y = self._y + 4
        pygame.draw.line(self.sheet, PANEL_EDGE, (PAD, y), (WIDTH - PAD, y))
        self._y += 11

    def head(self, name: str, unit: str) -> None:
        write(self.sheet, (PAD, self._y), name, TEXT_SOFT, SMALL)
        write(self.sheet, (WIDTH - PAD, self._y), unit, TEXT_SOFT, SMALL, flush_right=True)
        self._y += self._line

    def row(self, name: str, value: str) -> None:
        write(self.sheet, (PAD, self._y), name, TEXT_SOFT)
        write(self.sheet, (WIDTH - PAD, self._y), value, TEXT, flush_right=True)
        self._y += self._line

    def stage(self, name: str, milliseconds: float, part: float) -> None:
        middle = self._y + self._line // 2 - 1
        length = max(round(BAR * part), 1)
        pygame.draw.rect(self.sheet, ACCENT, (WIDTH - PAD - 62 - BAR, middle - 2, length, 4))
        self.row(name, f"{milliseconds:.2f}")
