"""4,000 balls poured into a pyglet window. Needs pyglet 2; Escape ends it.

python examples/pyglet_balls.py [--frames N --out PICTURE.png]    the second without a display
"""

import argparse

import numpy as np
import pyglet

import jostle

options = argparse.ArgumentParser()
options.add_argument("--frames", type=int, help="end after so many frames, without a display")
options.add_argument("--out", help="keep the last frame as a picture")
options = options.parse_args()
pyglet.options.headless = options.frames is not None

WIDTH, HEIGHT, COUNT = 960, 600, 4_000
VERTEX = """#version 330 core
in vec2 position; in float size; in vec3 tint; out vec3 color;
uniform WindowBlock { mat4 projection; mat4 view; } window;
void main() {
    gl_Position = window.projection * window.view * vec4(position, 0.0, 1.0);
    gl_PointSize = size; color = tint;
}"""
FRAGMENT = """#version 330 core
in vec3 color; out vec4 pixel;
void main() {
    float inside = 1.0 - length(2.0 * gl_PointCoord - 1.0);
    pixel = vec4(color, smoothstep(0.0, 2.5 * fwidth(inside), inside));
}"""

window = pyglet.window.Window(WIDTH, HEIGHT, "jostle and pyglet", vsync=True)
rng = np.random.default_rng(0)
places = rng.uniform((20, 60), (WIDTH - 20, 3 * HEIGHT), (COUNT, 2))
radii = rng.uniform(3, 6.5, COUNT)
floor = jostle.Box(0, 0, WIDTH, 4 * HEIGHT)
world = jostle.World(
    places, np.zeros((COUNT, 2)), radii, gravity=(0, -400), restitution=0.3, container=floor
)

shader = pyglet.graphics.shader
program = shader.ShaderProgram(
    shader.Shader(VERTEX, "vertex"), shader.Shader(FRAGMENT, "fragment")
)
height = (places[:, 1:] / places[:, 1].max()) ** 0.8  # the layers that fell first are blue
tints = (1 - height) * (0.20, 0.42, 0.62) + height * (0.98, 0.80, 0.55)
points = program.vertex_list(
    COUNT, pyglet.gl.GL_POINTS, size=("f", 2 * radii), tint=("f", tints.ravel())
)
frames = 0


@window.event
def on_draw() -> None:
    window.clear()
    points.position[:] = world.positions.ravel()
    program.use()
    points.draw(pyglet.gl.GL_POINTS)


def update(seconds: float) -> None:
    world.step(1 / 60)
    if options.frames and world.time * 60 > options.frames - 0.5:
        on_draw()
        if options.out:
            pyglet.image.get_buffer_manager().get_color_buffer().save(options.out)
        pyglet.app.exit()


pyglet.gl.glEnable(pyglet.gl.GL_PROGRAM_POINT_SIZE)
pyglet.gl.glEnable(pyglet.gl.GL_BLEND)
pyglet.gl.glBlendFunc(pyglet.gl.GL_SRC_ALPHA, pyglet.gl.GL_ONE_MINUS_SRC_ALPHA)
pyglet.gl.glClearColor(0.06, 0.07, 0.10, 1.0)
pyglet.clock.schedule(update)
pyglet.app.run(0 if options.frames else 1 / 60)
