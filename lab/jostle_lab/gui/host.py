"""The host of ImGui: one context, which receives events and draws panels."""

import string

import pygame
from imgui_bundle import imgui, implot

from jostle_lab.draw.camera import Size
from jostle_lab.draw.opengl import OpenGLPainter
from jostle_lab.gui import style as gui_style

OUTSIDE = -1e30  # position of a mouse outside the window, for ImGui
SHORTEST = 1e-4  # seconds; ImGui requires a positive duration of a frame
BUTTONS = {1: 0, 3: 1, 2: 2}  # pygame's left, right, middle
_ANY_POPUP = imgui.PopupFlags_.any_popup_id | imgui.PopupFlags_.any_popup_level
MODIFIERS = (
    (pygame.KMOD_CTRL, imgui.Key.mod_ctrl),
    (pygame.KMOD_SHIFT, imgui.Key.mod_shift),
    (pygame.KMOD_ALT, imgui.Key.mod_alt),
    (pygame.KMOD_META, imgui.Key.mod_super),
)

# Pairs of names, pygame's and ImGui's, that text fields and menus need.
_SAME = ("TAB", "HOME", "END", "INSERT", "DELETE", "BACKSPACE", "SPACE", "ESCAPE")
_NAMES = {
    **{name: name.lower() for name in _SAME},
    **{name: f"{name.lower()}_arrow" for name in ("LEFT", "RIGHT", "UP", "DOWN")},
    **{"PAGEUP": "page_up", "PAGEDOWN": "page_down", "RETURN": "enter", "KP_ENTER": "keypad_enter"},
    **{letter: letter for letter in string.ascii_lowercase},
}
KEYS: dict[int, imgui.Key] = {
    getattr(pygame, f"K_{ours}"): getattr(imgui.Key, theirs) for ours, theirs in _NAMES.items()
}


class Gui:
    """Panels and menus over the canvas of a painter.

    Calls of ImGui are allowed between `begin` and `end`. All its coordinates are points, like those
    of the mouse, independent of the density of the screen.
    """

    def __init__(self, painter: OpenGLPainter) -> None:
        self._context = imgui.create_context()
        imgui.set_current_context(self._context)
        self._plots = implot.create_context()
        implot.set_current_context(self._plots)
        io = imgui.get_io()
        io.set_ini_filename("")  # no settings file
        clipboard = imgui.get_platform_io()
        clipboard.platform_get_clipboard_text_fn = lambda _: pygame.scrap.get_text()
        clipboard.platform_set_clipboard_text_fn = lambda _, text: pygame.scrap.put_text(text)
        gui_style.apply()
        self._painter = painter
        imgui.backends.opengl3_init("#version 330")
        # Rectangles, in points, of the widgets and windows named by `mark` and `mark_window`.
        self.marks: dict[str, pygame.Rect] = {}
        self._owned: set[int] = set()  # buttons pressed in a panel
        self._scene: set[int] = set()  # buttons pressed in the scene
        self._dismiss = False
        self._in_frame = False

    def _activate(self) -> None:
        imgui.set_current_context(self._context)
        implot.set_current_context(self._plots)

    def begin(self, elapsed: float, size: Size, scale: float = 1.0) -> None:
        """Begin a frame, with the size of the canvas in points and its pixels per point."""
        self._activate()
        io = imgui.get_io()
        io.delta_time = max(elapsed, SHORTEST)
        io.display_size = imgui.ImVec2(*size)
        io.display_framebuffer_scale = imgui.ImVec2(scale, scale)
        imgui.backends.opengl3_new_frame()
        imgui.new_frame()
        self._in_frame = True
        if self._dismiss:
            self._dismiss = False
            imgui.internal.close_popup_to_level(0, True)

    def end(self) -> None:
        """End the frame and draw it over the canvas."""
        self._in_frame = False
        imgui.render()
        self._draw()

    def again(self) -> None:
        """Draw the last frame again."""
        self._activate()
        self._draw()

    def _draw(self) -> None:
        self._painter.target.use()
        imgui.backends.opengl3_render_draw_data(imgui.get_draw_data())

    def mark(self, name: str) -> None:
        """Record the rectangle of the last widget."""
        self.marks[name] = _rect(imgui.get_item_rect_min(), imgui.get_item_rect_max())

    def mark_window(self, name: str) -> None:
        """Record the rectangle of the present window."""
        low, size = imgui.get_window_pos(), imgui.get_window_size()
        self.marks[name] = _rect(low, low + size)

    def handle(self, event: pygame.event.Event) -> bool:
        """Handle an event; return whether it is for the panels, and not for the scene.

        A drag belongs to the part where it began. Both receive releases.
        """
        self._activate()
        io = imgui.get_io()
        if event.type == pygame.MOUSEMOTION:
            io.add_mouse_pos_event(*event.pos)
            return bool(self._owned) or (not self._scene and self.covers(event.pos))
        if event.type in (pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP):
            return self._handle_button(io, event)
        if event.type == pygame.MOUSEWHEEL:
            io.add_mouse_wheel_event(
                getattr(event, "precise_x", event.x), getattr(event, "precise_y", event.y)
            )
            return self.covers((io.mouse_pos.x, io.mouse_pos.y))
        if event.type in (pygame.KEYDOWN, pygame.KEYUP):
            return self._handle_key(io, event)
        if event.type == pygame.TEXTINPUT:
            io.add_input_characters_utf8(event.text)
            return io.want_text_input
        if event.type == pygame.WINDOWFOCUSLOST:
            io.add_focus_event(False)
            self._owned.clear()
            self._scene.clear()
        elif event.type == pygame.WINDOWFOCUSGAINED:
            io.add_focus_event(True)
        elif event.type == pygame.WINDOWLEAVE and not self._owned:
            io.add_mouse_pos_event(OUTSIDE, OUTSIDE)
        return False

    def covers(self, place: tuple[float, float]) -> bool:
        """Return whether a panel is at a point, or a menu is open."""
        return self.modal or any(rect.collidepoint(place) for rect in self._windows())

    def _windows(self) -> list[pygame.Rect]:
        """Return the rectangles of the visible windows that receive the mouse."""
        self._activate()
        return [
            _rect(window.rect().min, window.rect().max)
            for window in self._context.windows
            if window.active and not window.flags & imgui.WindowFlags_.no_mouse_inputs
        ]

    @property
    def modal(self) -> bool:
        """Whether a menu is open."""
        self._activate()
        return imgui.get_frame_count() > 0 and imgui.is_popup_open("", _ANY_POPUP)

    def close(self) -> None:
        self._activate()
        if self._in_frame:
            imgui.end_frame()
        imgui.backends.opengl3_shutdown()
        implot.destroy_context(self._plots)
        imgui.destroy_context(self._context)

    def _handle_button(self, io: imgui.IO, event: pygame.event.Event) -> bool:
        button = BUTTONS.get(event.button)
        if button is None:
            return False  # the wheel as a button
        io.add_mouse_pos_event(*event.pos)  # a touch has no motion before it
        down = event.type == pygame.MOUSEBUTTONDOWN
        mine = down and not self._scene and self.covers(event.pos)
        for owners in (self._owned, self._scene):
            owners.discard(button)
        if down:
            (self._owned if mine else self._scene).add(button)
        if mine or not down or not self._windows():
            io.add_mouse_button_event(button, down)
        elif button == 0:
            imgui.set_window_focus(None)  # text fields lose the keyboard focus
        return mine

    def _handle_key(self, io: imgui.IO, event: pygame.event.Event) -> bool:
        down = event.type == pygame.KEYDOWN
        for mask, modifier in MODIFIERS:
            io.add_key_event(modifier, bool(getattr(event, "mod", 0) & mask))
        key = KEYS.get(event.key)
        if key is not None:
            io.add_key_event(key, down)
        if down and event.key == pygame.K_ESCAPE and self.modal and not io.want_text_input:
            self._dismiss = True
            return True
        return down and (io.want_text_input or (io.want_capture_keyboard and self.modal))


def _rect(low: imgui.ImVec2, high: imgui.ImVec2) -> pygame.Rect:
    return pygame.Rect(low.x, low.y, high.x - low.x, high.y - low.y)
