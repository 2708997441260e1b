"""ImGui's shapes on a graphics card, by ImGui's own means."""

from __future__ import annotations

from imgui_bundle import imgui

from jostle.app.draw.opengl import OpenGLPainter


class OpenGLGui:
    """Draws on the canvas of a painter."""

    def __init__(self, painter: OpenGLPainter) -> None:
        self._painter = painter
        imgui.backends.opengl3_init("#version 330")

    def begin(self) -> None:
        """Prepare a frame."""
        imgui.backends.opengl3_new_frame()

    def draw(self, data: imgui.ImDrawData) -> None:
        """Draw a frame over the canvas; the state of OpenGL is left as it was."""
        self._painter.target.use()
        imgui.backends.opengl3_render_draw_data(data)

    def again(self) -> None:
        """Draw the last frame once more."""
        self.draw(imgui.get_draw_data())

    def close(self) -> None:
        """Give everything back."""
        imgui.backends.opengl3_shutdown()
