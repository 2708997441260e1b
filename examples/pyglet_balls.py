"""3,000 balls poured into a pyglet window: pyglet_balls.py [--frames N] [--out picture.png]."""

import argparse

import numpy as np
import pyglet

import jostle

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--frames", type=int, help="number of frames, without a display")
parser.add_argument("--out", help="keep the last of them as a picture")
options = parser.parse_args()
pyglet.options.headless = options.frames is not None

WIDTH, HEIGHT, COUNT = 960, 600, 3_000
VERTEX = """#version 330 core
in vec2 position; in float size; in vec3 tint; out vec3 color;
uniform WindowBlock { mat4 projection; mat4 view; } window;
void main() { gl_Position = window.projection * window.view * vec4(position, 0.0, 1.0);
              gl_PointSize = size; color = tint; }"""
FRAGMENT = """#version 330 core
in vec3 color; out vec4 pixel;
void main() { float outward = length(2.0 * gl_PointCoord - 1.0);
              pixel = vec4(color, 1.0 - smoothstep(1.0 - fwidth(outward), 1.0, outward)); }"""

window = pyglet.window.Window(WIDTH, HEIGHT, "jostle and pyglet")
gl = pyglet.gl
rng = np.random.default_rng(0)
places = rng.uniform((330, 40), (630, 1_900), (COUNT, 2))
box = jostle.Box(0, 0, WIDTH, 2_000)
world = jostle.World(
    places,
    rng.uniform(3, 7, COUNT),
    velocities=0 * places,
    gravity=(0, -400),
    restitution=0.4,
    container=box,
)

kinds = pyglet.graphics.shader
stages = kinds.Shader(VERTEX, "vertex"), kinds.Shader(FRAGMENT, "fragment")
program = kinds.ShaderProgram(*stages)
height = places[:, 1] / 1_900  # the first balls are blue
stops = [(0.16, 0.35, 0.55), (0.35, 0.68, 0.66), (0.99, 0.83, 0.56)]
tints = np.column_stack([np.interp(height, (0, 0.5, 1), of) for of in zip(*stops, strict=True)])
sizes = ("f", 2 * world.radii + 1)
points = program.vertex_list(COUNT, gl.GL_POINTS, size=sizes, tint=("f", tints.ravel()))
gl.glEnable(gl.GL_PROGRAM_POINT_SIZE)
gl.glEnable(gl.GL_BLEND)
gl.glBlendFunc(gl.GL_SRC_ALPHA, gl.GL_ONE_MINUS_SRC_ALPHA)
gl.glClearColor(0.06, 0.07, 0.10, 1.0)


@window.event
def on_draw() -> None:
    window.clear()
    points.position[:] = world.positions.ravel()
    program.use()
    points.draw(gl.GL_POINTS)


if not options.frames:
    pyglet.clock.schedule_interval(lambda _: world.step(1 / 60), 1 / 60)
    pyglet.app.run()
else:
    world.step(1 / 60, options.frames)
    on_draw()
    if options.out:
        pyglet.image.get_buffer_manager().get_color_buffer().save(options.out)
