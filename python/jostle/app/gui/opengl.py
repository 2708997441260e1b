"""ImGui's output on a graphics card, drawn by ImGui's own backend."""

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
        """Draw a frame over the canvas; the state of OpenGL does not change."""
        self._painter.target.use()
        imgui.backends.opengl3_render_draw_data(data)

    def again(self) -> None:
        """Draw the last frame again."""
        self.draw(imgui.get_draw_data())

    def close(self) -> None:
        """Release all resources."""
        imgui.backends.opengl3_shutdown()
