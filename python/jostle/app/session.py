"""The session: everything between the window and the simulation.

Keys, mouse, menus, panels and tests call the methods of its parts. It is independent of the window.
"""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace

from jostle.app.act.explanation import Explanation, PairQuestion
from jostle.app.act.interaction import Interaction
from jostle.app.act.messages import Messages
from jostle.app.draw.camera import Camera, Size
from jostle.app.draw.painter import Painter
from jostle.app.draw.view_options import TreeView, ViewOptions
from jostle.app.measure.traces import Traces
from jostle.app.runner import Runner
from jostle.app.simulate.engine import Engine
from jostle.app.simulate.settings import Settings
from jostle.app.simulate.simulation import Frame, Simulation
from jostle.app.storage.files import Files


class Session:
    """One run of the program, composed of parts.

    Parameters
    ----------
    simulation
        The first simulation.
    size
        Size of the canvas in pixels.
    left
        Margin of the scene at the left, in pixels.
    synchronous
        Whether steps, edits and new scenes are computed by the calling thread, for tests and
        videos; otherwise they are computed on worker threads, and the last finished frame is shown.
    """

    def __init__(
        self, simulation: Simulation, size: Size, left: int = 0, *, synchronous: bool = False
    ) -> None:
        self.engine = Engine(simulation, synchronous=synchronous)  # steps the simulation
        self.camera = Camera(size, simulation.view, left=left)
        self.view_options = ViewOptions(tree=TreeView.OUTLINE)
        self.messages = Messages()  # and the time of the session
        self.interaction = Interaction(self.engine, self.camera, self.messages)
        self.runner = Runner(self.engine, self.camera, self.interaction, self.messages)
        self.files = Files(self.runner, self.camera, self.view_options, self.messages)
        self.traces = Traces(self.runner.statistics)  # the plots of the statistics
        self.question = PairQuestion()  # the pair whose contact is explained
        self.open = True  # false if the window is to be closed

    @property
    def frame(self) -> Frame:
        """Return the last frame."""
        return self.engine.frame

    @property
    def settings(self) -> Settings:
        """Return the present settings."""
        return self.engine.settings

    @property
    def message(self) -> str:
        """Return the message to show now, or an empty string."""
        return self.runner.loader.message or self.messages.current

    # Time

    def tick(self, elapsed: float) -> int:
        """Advance clock and simulation by `elapsed` seconds; return the finished steps."""
        self.messages.now += elapsed
        return self.advance(elapsed)

    def advance(self, elapsed: float) -> int:
        """Advance the simulation by `elapsed` seconds of real time; return the finished steps."""
        self.interaction.track_cursor()
        request = self.runner.picture.request(self.view_options)
        request = replace(request, tree=request.tree or self.question.pair is not None)
        steps = self.runner.advance(elapsed, request)
        self.files.follow()
        return steps

    # Display

    def draw(self, painter: Painter) -> None:
        """Draw the scene, or both scenes of a comparison."""
        self.runner.draw(painter, self.view_options)

    def cycle_tree(self) -> None:
        """Choose the next way to draw the tree."""
        self.view_options.tree = self.view_options.tree.next()
        self.messages.say(f"Tree: {self.view_options.tree.label}")

    def cycle_colours(self) -> None:
        """Choose the next quantity that colours show."""
        self.view_options.colour_by = self.view_options.colour_by.next()
        self.messages.say(f"Colour by: {self.view_options.colour_by.label}")

    def toggle(self, name: str) -> None:
        """Toggle one of the view options."""
        setattr(self.view_options, name, not getattr(self.view_options, name))

    # Explanation of a contact

    def explain(self) -> None:
        """Explain why the two selected particles touch or not, or end that."""
        self.messages.say(self.question.ask(self.interaction.selection.tags))

    @property
    def explanation(self) -> Explanation | None:
        """Return the explanation of the pair, if there is one."""
        return self.question.answer(self.frame, self.settings, self.messages.now)

    # Closing

    def escape(self) -> None:
        """Cancel a drag; else close a menu or the help; else clear the selection; else quit."""
        interaction = self.interaction
        if interaction.cancel():
            return
        if interaction.menu is not None:
            interaction.menu = None
        elif self.view_options.help:
            self.view_options.help = False
        elif not interaction.dismiss():
            self.quit()

    def quit(self) -> None:
        """End the loop after this frame."""
        self.open = False

    def close(self) -> None:
        """End all threads, and complete all files."""
        with ExitStack() as closing:  # in reverse order: files first, whatever fails
            closing.callback(self.engine.close)
            closing.callback(self.runner.end_race)
            closing.callback(self.runner.loader.cancel)
            closing.callback(self.files.close)
