"""The panels, driven by the mouse: each widget is found by its mark, and does what it says."""

from collections.abc import Iterator

import numpy as np
import pygame
import pytest
from lab_overlays import open_screen

import jostle
from jostle_lab import panels
from jostle_lab.draw.view_options import ColourBy, TreeView
from jostle_lab.gui.host import Gui
from jostle_lab.panels import cards, column, settings_panel
from jostle_lab.schema import SCALARS, Settings, extra, wrong
from jostle_lab.session import Session
from jostle_lab.simulate.start import start

FRAME = 1 / 60
BESIDE, MIDDLE = 2, 0.5
FIRST_OPEN = column.OPEN


class Desk:
    """A session with its panels, and a mouse; they are painted only after `paint` is called."""

    def __init__(
        self, settings: Settings, size: tuple[int, int] = (1600, 1100), *, all_open: bool = True
    ) -> None:
        self.session = Session(start(settings), size, synchronous=True)
        column.OPEN = {title for title, _ in column.SECTIONS} if all_open else FIRST_OPEN
        self.screen = open_screen(size)
        self.painter = self.screen.opengl
        self.painter.resize(size)
        self.gui = Gui(self.painter)
        self.taken: list[bool] = []
        self._draw, self.gui._draw = self.gui._draw, lambda: None
        self.frame(3)

    def paint(self) -> None:
        """From now on paint each frame."""
        self.gui._draw = self._draw
        self.frame()

    def frame(self, count: int = 1) -> None:
        for _ in range(count):
            self.session.messages.now += FRAME
            self.session.advance(FRAME)
            self.gui.begin(FRAME, self.painter.size)
            panels.build(self.session, self.gui)
            self.gui.end()

    def send(self, kind: int, place: tuple[float, float], button: int = 1) -> None:
        extra = {} if kind == pygame.MOUSEMOTION else {"button": button}
        at = (round(place[0]), round(place[1]))
        self.taken.append(self.gui.handle(pygame.event.Event(kind, pos=at, **extra)))
        self.frame()

    def place(self, mark: str, across: float = MIDDLE) -> tuple[float, float]:
        rect = self.gui.marks[mark]
        return rect.left + across * rect.width, rect.centery

    def click(self, mark: str, button: int = 1) -> None:
        for kind in (pygame.MOUSEMOTION, pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP):
            self.send(kind, self.place(mark), button)
        self.frame(2)

    def press(self, mark: str, *ways: float) -> None:
        """Press on the middle of a slider and go to places along it, without letting go."""
        self.send(pygame.MOUSEMOTION, self.place(mark))
        self.send(pygame.MOUSEBUTTONDOWN, self.place(mark))
        for way in ways:
            self.send(pygame.MOUSEMOTION, self.place(mark, way))

    def let_go(self, mark: str, way: float) -> None:
        self.send(pygame.MOUSEBUTTONUP, self.place(mark, way))
        self.frame(2)

    def slide(self, mark: str, way: float) -> None:
        self.press(mark, way)
        self.let_go(mark, way)

    def type(self, mark: str, text: str) -> None:
        """Click a slider with Ctrl, which makes it a text field, and type into that."""
        ctrl = {"key": pygame.K_LCTRL, "mod": pygame.KMOD_CTRL}
        self.gui.handle(pygame.event.Event(pygame.KEYDOWN, ctrl))
        self.click(mark)
        self.gui.handle(pygame.event.Event(pygame.KEYUP, ctrl | {"mod": 0}))
        self.frame()
        self.gui.handle(pygame.event.Event(pygame.TEXTINPUT, text=text))
        self.frame()
        for kind in (pygame.KEYDOWN, pygame.KEYUP):
            self.gui.handle(pygame.event.Event(kind, key=pygame.K_RETURN, mod=0))
            self.frame()

    @property
    def world(self) -> jostle.World:
        return self.session.engine.simulation.world

    def close(self) -> None:
        self.session.close()
        self.gui.close()
        self.screen.close()


@pytest.fixture
def desk() -> Iterator:
    made = []

    def make(scene: str = "gas", n: int | None = 200, *args: object, **settings: object) -> Desk:
        made.append(Desk(Settings(scene, n, **settings), *args))
        return made[-1]

    yield make
    for each in made:
        each.close()


def test_gravity_follows_the_slider_while_it_is_held(desk) -> None:
    here = desk()
    assert tuple(here.world.gravity) == (0.0, 0.0)
    here.press("gravity y", 0.85)
    x, y = here.world.gravity
    assert x == 0.0 and 1000 < y < 2000
    here.press("gravity y", 0.6)
    assert 0 < here.world.gravity[1] < 1000
    here.let_go("gravity y", 0.6)
    assert 0 < here.world.gravity[1] < 1000


def test_gravity_can_point_anywhere(desk) -> None:
    here = desk("pile")
    here.slide("gravity x", 0.1)
    x, y = here.world.gravity
    assert x < -1000 and y == 900.0
    here.type("gravity y", "-12.5")
    assert here.world.gravity.tolist() == [x, -12.5]


@pytest.mark.parametrize(
    ("mark", "attribute"),
    [
        ("leaf capacity", "leaf_capacity"),
        ("max. depth", "max_depth"),
        ("drag", "drag"),
        ("restitution", "restitution"),
        ("sub-steps", "substeps"),
    ],
)
def test_each_slider_changes_its_rule_of_the_world(desk, mark, attribute) -> None:
    here = desk()
    values = []
    for way in (0.3, 0.8):
        here.slide(mark, way)
        values.append(np.unique(getattr(here.world, attribute)).item())  # of all particles
    assert values[0] < values[1]
    assert getattr(here.session.settings, attribute) == pytest.approx(values[1])


def test_the_slider_of_wall_friction_changes_drawn_walls(desk) -> None:
    here = desk()
    here.session.interaction.commands.wall((10.0, 10.0), (90.0, 10.0))
    here.frame()
    here.slide("wall friction", 0.25)
    friction = here.session.settings.wall_friction
    assert 0.3 < friction < 0.6
    assert here.world.walls.friction.tolist() == [np.float32(friction)]


def test_the_slider_of_friction_changes_all_particles(desk) -> None:
    here = desk("pile")
    here.slide("friction", 0.25)
    friction = here.session.settings.friction
    assert 0.3 < friction < 0.6
    assert (here.world.friction == np.float32(friction)).all()
    assert here.session.frame.angles is not None


def test_the_number_of_particles_changes_on_release(desk) -> None:
    here = desk()
    here.press("particles", 0.3, 0.6)
    assert len(here.session.frame) == 200
    here.let_go("particles", 0.6)
    assert 1_000 < len(here.session.frame) < 10_000
    assert here.session.settings.n == len(here.session.frame)


def test_numbers_can_be_typed_and_time_scale_and_threads_reach_the_settings(desk) -> None:
    here = desk()
    here.type("particles", "321")
    assert len(here.session.frame) == 321
    here.type("drag", "nonsense")
    assert here.world.drag == 0.0
    here.type("drag", "99")
    assert here.world.drag == 99.0, "more than the slider has"
    for number, why in (("-5", "at least 0"), ("999999999", "at most 100,000,000")):
        here.type("particles", number)
        assert here.session.message == f"n is {number}; it must be {why}"
    assert len(here.session.frame) == 321
    here.slide("speed", 0.2)
    assert here.session.settings.time_scale < 0.5
    here.slide("threads", 0.0)
    assert here.world.threads == 1


def test_new_particles_have_the_filter_of_the_panel(desk) -> None:
    here = desk("gas", 200, (1600, 1600))
    for mark in ("category 0", "category 3", "collides with 0"):
        here.click(mark)
    here.session.interaction.commands.create((50.0, 50.0))
    here.frame(2)
    assert here.world.categories.tolist() == [1] * 200 + [8]
    assert here.world.masks.tolist() == [2**32 - 1] * 200 + [2**32 - 2]


def test_a_click_changes_one_bit_of_all_selected_particles(desk) -> None:
    here = desk("gas", 200, (1600, 1600))
    here.session.engine.edit(lambda simulation: simulation.change([5], categories=1 << 20))
    here.session.interaction.selection.take([4, 5])
    here.frame()
    here.click("category 1")
    assert here.world.categories[3:7].tolist() == [1, 3, 1 << 20 | 2, 1]
    here.click("category 1")
    here.click("collides with 7")
    assert here.world.categories[3:7].tolist() == [1, 1, 1 << 20, 1]
    assert here.world.masks[3:6].tolist() == [2**32 - 1, 2**32 - 129, 2**32 - 129]
    commands = here.session.interaction.commands
    assert commands.new_filter == {"categories": 1, "masks": 2**32 - 1}
    commands.clone(here.session.frame.tags[[5]])
    here.frame(2)
    assert (here.world.categories[-1], here.world.masks[-1]) == (1 << 20, 2**32 - 129)


def test_the_buttons_do_what_the_keys_do(desk) -> None:
    here = desk()
    here.click("pause")
    assert here.session.runner.paused
    steps = here.session.engine.steps
    here.click("step")
    assert here.session.engine.steps == steps + 1 and here.session.runner.paused
    after = here.session.frame.stats.time
    here.click("step back")
    assert here.session.frame.stats.time < after
    here.click("restart")
    assert here.session.frame.stats.time == 0.0
    here.click("pause")
    assert not here.session.runner.paused


def test_clicks_choose_the_previous_the_next_or_a_named_scene(desk) -> None:
    here = desk()
    here.click("next scene")
    names = jostle.scenes.names()
    assert here.session.engine.scene == names[names.index("gas") + 1]
    here.click("previous scene")
    assert here.session.engine.scene == "gas"
    here.click("scene pile")
    assert here.session.engine.scene == "pile"
    assert len(here.session.frame) == 1000


def test_the_method_changes_under_the_same_particles(desk) -> None:
    here = desk("orbit")
    here.session.runner.paused = True
    here.click("brute")
    assert here.world.method == "brute"
    before = here.session.frame.positions
    here.click("quadtree")
    assert here.world.method == "quadtree"
    assert (here.session.frame.positions == before).all()


def test_what_would_take_too_long_cannot_be_clicked(desk) -> None:
    here = desk("gas", 40_000)
    here.click("brute")
    assert here.session.settings.method == "quadtree"


def test_a_second_method_runs_next_to_the_scene(desk) -> None:
    here = desk()
    here.click("compare with")
    here.click("compare with: brute")
    runner = here.session.runner
    assert runner.race is not None and runner.race.method == "brute"
    here.click("compare with")
    here.click("compare with: article-brute")
    assert runner.race is not None and runner.race.method == "article-brute"
    here.click("compare with")
    here.click("compare with: ")
    assert here.session.runner.race is None


def test_more_particles_come_into_the_scene_where_there_is_room(desk) -> None:
    here = desk("billiards", 10)
    here.frame(20)
    first = here.session.frame
    here.type("particles", "12")
    assert len(here.session.frame) == 12
    assert here.session.frame.stats.time > first.stats.time, "it goes on"


def test_sleeping_can_be_turned_off(desk) -> None:
    here = desk("pile", 10)
    assert here.session.engine.effective_settings.sleeping
    here.click("sleeping")
    here.click("sleeping: off")
    here.frame(2)
    assert here.session.engine.effective_settings.sleeping is False


@pytest.mark.parametrize("switch", ["contacts", "forces", "velocities", "trails", "labels"])
def test_each_switch_of_what_is_shown(desk, switch) -> None:
    here = desk()
    assert not getattr(here.session.view_options, switch)
    here.click(switch)
    assert getattr(here.session.view_options, switch)
    here.click(switch)
    assert not getattr(here.session.view_options, switch)


def test_lists_to_choose_from(desk) -> None:
    here = desk()
    here.click("tree")
    here.click(f"tree: {TreeView.HEAT.label}")
    assert here.session.view_options.tree is TreeView.HEAT
    here.click("colour by")
    here.click(f"colour by: {ColourBy.MASS.label}")
    assert here.session.view_options.colour_by is ColourBy.MASS


def test_drift_can_be_measured_from_now_on_and_says_for_how_long_or_why_not(desk) -> None:
    here = desk("pile")
    here.frame(40)
    statistics = here.session.runner.statistics
    first = statistics.reference
    here.click("measure drift")
    assert statistics.reference is not first and statistics.reference is not None
    here = desk("gas")
    here.frame(60)
    assert panels.statistics_panel.change_text(here.session, "+0.00 %") == "+0.00 % in 1 s"
    here.session.engine.edit(lambda simulation: simulation.remove([0]))
    here.frame(20)
    text = panels.statistics_panel.change_text(here.session, "+0.00 %")
    assert text == "particles are added and removed"


def test_statistics_fold_and_the_camera_takes_their_room(desk) -> None:
    here = desk()
    small = here.session.camera.scale
    right = here.session.camera.right
    here.click("statistics")
    assert not here.session.view_options.statistics
    assert here.session.camera.right == 0 < right
    assert here.session.camera.scale >= small
    here.click("statistics")
    assert here.session.camera.right == right


def test_sections_fold_and_hidden_panels_give_all_room_to_the_scene(desk) -> None:
    here = desk()
    here.click("section Method")
    here.gui.marks.clear()
    here.frame()
    assert "brute" not in here.gui.marks and "tree" in here.gui.marks
    assert here.gui.covers((10, 500))
    here.session.toggle("panels")
    here.frame(2)
    assert not here.gui.covers((10, 500))
    assert here.session.camera.left == here.session.camera.right == 0


def test_a_bar_opens_the_panels_and_has_the_buttons_of_the_time(desk) -> None:
    here = desk()
    here.session.view_options.panels = False
    here.frame(3)
    assert "section World" not in here.gui.marks or not here.gui.covers((10, 600))
    here.click("pause")
    assert here.session.runner.paused
    here.session.rate = 0.02  # measured
    here.click("open panels")
    assert here.session.view_options.panels and here.gui.covers((10, 600))


def test_the_first_hint_fades_after_a_throw(desk) -> None:
    here = desk()
    here.frame(5)
    assert "first hint" in here.gui.marks
    here.session.interaction.thrown_at = here.session.messages.now
    here.frame(round(cards.FADE / FRAME) + 2)
    here.gui.marks.clear()
    here.frame(2)
    assert "first hint" not in here.gui.marks


def test_everything_is_readable_at_1280_by_720_without_scrolling() -> None:
    here = Desk(Settings("mixed", 500), (1280, 720), all_open=False)
    here.frame(5)
    for name in ("section Files", "friction", "section Momentum", "measure drift"):
        assert here.gui.marks[name].bottom < 720, name
    here.close()


@pytest.mark.parametrize("size", [(640, 360), (960, 540), (1280, 720), (1920, 1080), (3840, 2160)])
def test_panels_leave_the_scene_half_of_every_window(desk, size) -> None:
    here = desk("gas", 50, size)
    clear = [here.gui.covers((x, size[1] / 2)) for x in range(0, size[0], 5)]
    assert np.mean(clear) <= 0.5
    assert here.session.camera.left > 0


def test_there_is_one_column_in_a_narrow_window_and_none_in_a_small_one(desk) -> None:
    here = desk("gas", 50, (400, 300))
    assert not here.gui.covers((10, 150))
    assert here.session.camera.left == 0
    here = desk("gas", 50, (800, 3000))
    assert here.session.camera.right == 0
    assert here.gui.marks["plot times"].right < 400


def test_no_click_on_a_panel_reaches_the_scene(desk) -> None:
    here = desk()
    here.click("pause")
    assert here.taken == [True, True, False]  # both receive releases
    here.taken.clear()
    here.send(pygame.MOUSEMOTION, (800, 500))
    here.send(pygame.MOUSEBUTTONDOWN, (800, 500))
    assert not any(here.taken)


@pytest.mark.parametrize("settings", [("gas", 0), ("gas", 1), ("pile", 5000)])
def test_all_sizes_of_scenes_are_shown(desk, settings) -> None:
    here = desk(*settings)
    here.frame(25)
    here.paint()
    here.frame(5)
    picture = pygame.surfarray.array3d(here.painter.canvas())
    assert picture[:290].std() > 10 and picture[-296:].std() > 10


def test_a_still_session_has_still_panels(desk) -> None:
    here = desk()
    here.session.runner.paused = True
    here.paint()
    here.frame(40)
    first = pygame.surfarray.array3d(here.painter.canvas())[:290]
    here.frame(5)
    assert (pygame.surfarray.array3d(here.painter.canvas())[:290] == first).mean() > 0.999


def test_the_slider_goes_through_the_last_half_minute(desk) -> None:
    desk = desk("gas", 100, (1600, 1600))
    desk.frame(60)
    time = desk.session.frame.stats.time
    desk.press("moment", 0.3, 0.5)
    desk.let_go("moment", 0.5)
    assert desk.session.runner.paused
    assert desk.session.frame.stats.time == pytest.approx(time / 2, abs=0.15)
    desk.click("step back")
    assert desk.session.runner.history.back > 0


def test_files_are_saved_loaded_recorded_and_exported(desk, tmp_path) -> None:
    desk = desk("gas", 30, (1600, 1600))
    session = desk.session
    session.files.folder = tmp_path
    desk.click("save")
    desk.click("screenshot")
    assert {path.suffix for path in tmp_path.iterdir()} == {".jostle", ".png"}
    session.engine.edit(lambda simulation: simulation.remove([0]))
    desk.frame(70)  # the list of files is renewed every second
    (saved,) = session.files.scenes()
    desk.click("load")
    desk.click(f"load: {saved}")
    assert len(session.frame) == 30
    desk.click("film GIF")
    desk.click("record")
    film = session.files.recording
    assert film.path.suffix == ".gif"
    desk.frame(10)
    desk.click("record")
    film.close()
    desk.frame()
    assert session.files.recording is None and film.path.stat().st_size > 0
    desk.click("export CSV")
    session.close()
    assert len([*tmp_path.glob("*.csv")]) == 2


def test_two_selected_particles_are_asked_about(desk) -> None:
    desk = desk("gas", 30, (1600, 1600))
    desk.click("why")
    assert desk.session.explanation is None
    desk.session.interaction.selection.take([3, 4])
    desk.click("why")
    assert desk.session.explanation is not None
    desk.click("why")
    assert desk.session.explanation is None


SLIDERS = [name for name in SCALARS if extra(name, "slider") and name != "gravity"]


@pytest.mark.parametrize("name", SLIDERS)
def test_a_slider_stays_within_the_limits_of_its_setting(name: str) -> None:
    span = settings_panel.span_of(name)
    for end in (span.low, span.high):
        assert wrong(name, int(end) if span.whole else end) is None
