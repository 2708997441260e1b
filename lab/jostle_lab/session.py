"""The session: everything between the window and the simulation.

Keys, mouse, menus, panels and tests call the methods of its parts. It is independent of the window.
"""

import sys
from concurrent.futures import Future
from contextlib import ExitStack
from dataclasses import dataclass, replace

from jostle_lab.act.explanation import Explanation, PairQuestion
from jostle_lab.act.interaction import Interaction, Messages
from jostle_lab.draw.camera import Camera, Size
from jostle_lab.draw.painter import Painter
from jostle_lab.draw.view_options import TreeView, ViewOptions
from jostle_lab.measure import Traces
from jostle_lab.runner import Runner
from jostle_lab.schema import Settings
from jostle_lab.simulate.engine import Engine
from jostle_lab.simulate.frame import Frame
from jostle_lab.simulate.simulation import Simulation
from jostle_lab.storage.files import Files

RATE_SECONDS = 1.0  # over which the rate is averaged


@dataclass
class FileChoice:
    """The open window of Ctrl+O, and the path in it."""

    path: str = ""
    shown: bool = False


class Session:
    """One run of the program, composed of parts.

    `size` is that of the canvas in pixels. In synchronous mode, for tests and videos, steps, edits
    and new scenes are computed by the calling thread. Otherwise they are computed on worker
    threads, and the last finished frame is shown.
    """

    def __init__(self, simulation: Simulation, size: Size, *, synchronous: bool = False) -> None:
        self.engine = Engine(simulation, synchronous=synchronous)  # steps the simulation
        self.camera = Camera(size, simulation.view)
        self.view_options = ViewOptions(tree=TreeView.OUTLINE)
        self.messages = Messages()  # and the time of the session
        self.interaction = Interaction(self.engine, self.camera, self.messages)
        self.runner = Runner(self.engine, self.camera, self.interaction, self.messages)
        self.files = Files(self.runner, self.camera, self.view_options, self.messages)
        self.traces = Traces(self.runner.statistics)  # the plots of the statistics
        self.rate = 0.0  # simulated seconds per second, a mean
        self.full_screen = False  # as the window is to be
        self.shows_times = True  # whether the statistics have the times of frames
        self.question = PairQuestion()  # the pair whose contact is explained
        self.choice: FileChoice | None = None  # the file to be opened
        self._autosaved: Future[object] | None = None  # its message
        self.open = True  # false if the window is to be closed

    @property
    def frame(self) -> Frame:
        return self.engine.frame

    @property
    def settings(self) -> Settings:
        return self.engine.settings

    @property
    def message(self) -> str:
        """Return the message to show now, or an empty string."""
        return self.engine.message or self.messages.current

    # Time

    def advance(self, elapsed: float) -> int:
        """Advance the simulation by `elapsed` seconds of real time; return the finished steps."""
        inputs = self.interaction.inputs(paused=self.runner.paused)
        request = self.runner.picture.request(self.view_options)
        request = replace(request, tree=request.tree or self.question.pair is not None)
        self.runner.prepare(request)
        steps = self.engine.advance(elapsed, inputs, paused=self.runner.paused)
        self.runner.follow(elapsed)
        self._measure_rate(steps, elapsed)
        self.files.follow()
        return steps

    def _measure_rate(self, steps: int, elapsed: float) -> None:
        if self.runner.paused:
            self.rate = 0.0
        elif elapsed > 0:
            rate = steps * self.engine.time_step / elapsed
            share = min(elapsed / RATE_SECONDS, 1.0)
            self.rate += (rate - self.rate) * share if self.rate else rate

    # Display

    def draw(self, painter: Painter) -> None:
        self.runner.draw(painter, self.view_options)

    def cycle(self, name: str) -> None:
        """Choose the next value of one of the view options."""
        value = getattr(self.view_options, name).next()
        setattr(self.view_options, name, value)
        self.messages.say(f"{name.replace('_', ' ').capitalize()}: {value.label}")

    def toggle(self, name: str) -> None:
        """Toggle one of the view options."""
        setattr(self.view_options, name, not getattr(self.view_options, name))

    def toggle_full_screen(self) -> None:
        self.full_screen = not self.full_screen

    # Explanation of a contact

    def explain(self) -> None:
        """Explain why the two selected particles touch or not, or end that."""
        self.messages.say(self.question.ask(self.interaction.selection.tags))

    @property
    def explanation(self) -> Explanation | None:
        return self.question.answer(self.frame, self.settings, self.messages.now)

    def choose_file(self) -> None:
        """Open the window that opens a file."""
        self.choice = FileChoice()

    # Closing

    def escape(self) -> None:
        """Cancel a drag, else close a menu or the help, else deselect; it never quits."""
        interaction = self.interaction
        if interaction.cancel():
            return
        if interaction.menu is not None:
            interaction.menu = None
        elif self.view_options.help:
            self.view_options.help = False
        elif not interaction.dismiss():
            self.messages.say("Ctrl+Q quits.")

    def quit(self) -> None:
        """Close the window; unsaved edits are saved first."""
        self.runner.end_race()
        if self.runner.unsaved and self.open:
            self._autosaved = self.files.autosave()
        self.open = False

    def close(self) -> None:
        """End all threads, and complete all files."""
        with ExitStack() as closing:  # in reverse order: files first, whatever fails
            closing.callback(self.engine.close)
            closing.callback(self.runner.end_race)
            closing.callback(self.files.close)
        if self._autosaved is not None and self._autosaved.done():
            print(self._autosaved.result(), file=sys.stderr)
