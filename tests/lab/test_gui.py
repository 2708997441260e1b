"""ImGui over a canvas: clicks by posted events, text, and who gets an event."""

from collections.abc import Callable, Iterator

import numpy as np
import pygame
import pytest
from imgui_bundle import imgui
from lab_overlays import open_screen, pixels

from jostle_lab.draw import palette
from jostle_lab.draw.opengl import OpenGLPainter
from jostle_lab.gui.host import Gui

SIZE = (400, 300)
FRAME = 1 / 60


class Panel:
    """A window with one widget of each kind."""

    def __init__(self, painter: OpenGLPainter, scale: float = 1.0) -> None:
        self.painter, self.scale = painter, scale
        self.gui = Gui(painter)
        self.clicks, self.value, self.text = 0, 0.5, ""
        self.more: Callable[[], None] = lambda: None

    def frame(self) -> np.ndarray:
        self.painter.fill(palette.STAGE)
        points = tuple(round(side / self.scale) for side in self.painter.size)
        self.gui.begin(FRAME, points, self.scale)
        imgui.set_next_window_pos((20, 20))
        imgui.set_next_window_size((200, 200))
        imgui.begin("panel")
        self.clicks += imgui.button("press")
        self.gui.mark("press")
        self.value = imgui.slider_float("##value", self.value, 0, 1)[1]
        self.gui.mark("value")
        self.text = imgui.input_text("##text", self.text)[1]
        self.gui.mark("text")
        self.more()
        imgui.end()
        self.gui.end()
        return pixels(self.painter)

    def post(self, kind: int, **what: object) -> bool:
        wanted = self.gui.handle(pygame.event.Event(kind, **what))
        self.frame()
        return wanted

    def mouse(self, kind: int, place: tuple[int, int], button: int = 1) -> bool:
        if kind == pygame.MOUSEMOTION:
            return self.post(kind, pos=place, rel=(0, 0), buttons=(0, 0, 0))
        return self.post(kind, pos=place, button=button)

    def click(self, name: str, button: int = 1) -> None:
        place = self.gui.marks[name].center
        assert self.mouse(pygame.MOUSEMOTION, place)
        assert self.mouse(pygame.MOUSEBUTTONDOWN, place, button)
        assert not self.mouse(pygame.MOUSEBUTTONUP, place, button)  # both receive releases
        self.frame()


@pytest.fixture(params=[1])
def panel(request: pytest.FixtureRequest) -> Iterator[Panel]:
    """Provide a panel of a scale."""
    screen, scale = open_screen(SIZE), request.param
    screen.opengl.resize((scale * SIZE[0], scale * SIZE[1]))
    panel = Panel(screen.opengl, scale)
    for _ in range(2):
        panel.frame()
    yield panel
    panel.gui.close()
    screen.close()


def test_a_button_is_clicked_and_a_slider_dragged_even_out_of_the_panel(panel: Panel) -> None:
    panel.click("press")
    assert panel.clicks == 1
    panel.click("press")
    assert panel.clicks == 2
    rect = panel.gui.marks["value"]
    panel.mouse(pygame.MOUSEMOTION, rect.center)
    assert panel.mouse(pygame.MOUSEBUTTONDOWN, rect.center)
    assert panel.mouse(pygame.MOUSEMOTION, (390, 290))  # not for the scene
    assert panel.value == 1.0
    panel.mouse(pygame.MOUSEBUTTONUP, (390, 290))
    assert not panel.mouse(pygame.MOUSEMOTION, (380, 280))
    assert panel.value == 1.0


def test_text_is_typed_and_keys_are_kept_from_the_scene(panel: Panel) -> None:
    key = {"key": pygame.K_a, "mod": 0, "unicode": "a"}
    assert not panel.post(pygame.KEYDOWN, **key)
    panel.post(pygame.KEYUP, **key)
    panel.click("text")
    assert panel.post(pygame.KEYDOWN, **key)
    assert panel.post(pygame.TEXTINPUT, text="añ")
    assert not panel.post(pygame.KEYUP, **key)
    panel.frame()
    assert panel.text == "añ"
    panel.post(pygame.KEYDOWN, key=pygame.K_BACKSPACE, mod=0, unicode="")
    panel.frame()
    assert panel.text == "a"
    panel.mouse(pygame.MOUSEBUTTONDOWN, (390, 290))  # a click into the scene takes the keys back
    panel.mouse(pygame.MOUSEBUTTONUP, (390, 290))
    panel.frame()
    assert not panel.post(pygame.KEYDOWN, **key)


def test_the_scene_receives_events_outside_the_panels(panel: Panel) -> None:
    assert not panel.mouse(pygame.MOUSEMOTION, (300, 250))
    assert not panel.mouse(pygame.MOUSEBUTTONDOWN, (300, 250))
    assert not panel.mouse(pygame.MOUSEMOTION, panel.gui.marks["press"].center)  # its drag goes on
    assert not panel.mouse(pygame.MOUSEBUTTONUP, panel.gui.marks["press"].center)
    assert panel.clicks == 0
    wheel = {"x": 0, "y": 1, "precise_x": 0.0, "precise_y": 1.0, "flipped": False}
    assert panel.post(pygame.MOUSEWHEEL, **wheel)  # the mouse is over the panel now
    panel.mouse(pygame.MOUSEMOTION, (300, 250))
    assert not panel.post(pygame.MOUSEWHEEL, **wheel)
    assert not panel.post(pygame.QUIT)


def test_escape_closes_a_menu_and_nothing_else(panel: Panel) -> None:
    opened = []

    def menu() -> None:
        if not opened:
            imgui.open_popup("menu")
            opened.append(True)
        if imgui.begin_popup("menu"):
            imgui.menu_item("Delete", "Del", False, True)
            imgui.end_popup()

    panel.more = menu
    for _ in range(3):
        panel.frame()
    assert panel.gui.modal
    assert panel.gui.covers((390, 290))
    escape = {"key": pygame.K_ESCAPE, "mod": 0, "unicode": ""}
    assert panel.post(pygame.KEYDOWN, **escape)
    panel.post(pygame.KEYUP, **escape)
    panel.frame()
    assert not panel.gui.modal
    assert not panel.post(pygame.KEYDOWN, **escape)


def test_panels_have_their_colours_and_text(panel: Panel) -> None:
    picture = panel.frame()
    assert (picture[300:, 230:] == palette.STAGE).all()
    assert tuple(picture[120, 190]) == pytest.approx(palette.PANEL[:3], abs=6)
    rect = panel.gui.marks["press"]
    button = picture[rect.left : rect.right, rect.top : rect.bottom]
    brightest = button.reshape(-1, 3).max(axis=0)
    assert tuple(brightest) == pytest.approx(palette.TEXT, abs=30)
    inked = (button.sum(axis=2) > 500).mean()
    assert 0.01 < inked < 0.3


@pytest.mark.parametrize("panel", [2], indirect=True)
def test_twice_the_density_is_twice_the_size(panel: Panel) -> None:
    picture = panel.frame()
    rect = panel.gui.marks["press"]
    assert rect.left > 20 and rect.right < 200  # points
    assert (picture[460:, 460:] == palette.STAGE).all()
    assert tuple(picture[300, 400]) == pytest.approx(palette.PANEL[:3], abs=6)
    panel.click("press")
    assert panel.clicks == 1


def test_text_goes_over_the_clipboard(panel: Panel) -> None:
    panel.click("text")
    panel.post(pygame.TEXTINPUT, text="gas")
    ctrl = pygame.KMOD_CTRL
    for key in (pygame.K_a, pygame.K_c, pygame.K_v, pygame.K_v):
        panel.post(pygame.KEYDOWN, key=key, mod=ctrl, unicode="")
        panel.post(pygame.KEYUP, key=key, mod=ctrl, unicode="")
        panel.frame()
    assert pygame.scrap.get_text() == "gas"
    assert panel.text == "gasgas"
