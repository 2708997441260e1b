"""3,000 drifting discs in a raylib window: those that touch glow, the mouse lights up a circle.

python examples/raylib_balls.py [--frames N --out PICTURE.png]    the second ends by itself
"""

import argparse

import numpy as np
from raylib import ffi, rl

import jostle

options = argparse.ArgumentParser()
options.add_argument("--frames", type=int, help="end after so many frames")
options.add_argument("--out", help="keep the last frame as a picture")
options = options.parse_args()

WIDTH, HEIGHT, COUNT, REACH = 960, 600, 3_000, 90.0
CALM, WARM, NEAR = np.array([(58, 84, 112), (255, 196, 120), (150, 226, 214)], float)
SIZE = np.array([WIDTH, HEIGHT], np.float32)

rng = np.random.default_rng(0)
places = rng.uniform((0, 0), SIZE, (COUNT, 2)).astype(np.float32)
angles = rng.uniform(0, 2 * np.pi, COUNT)
speeds = 25 * np.column_stack([np.cos(angles), np.sin(angles)]).astype(np.float32)
radii = rng.uniform(2, 5.5, COUNT).astype(np.float32)
glow = np.zeros(COUNT)

rl.SetTraceLogLevel(rl.LOG_WARNING)
rl.SetConfigFlags(rl.FLAG_MSAA_4X_HINT)
rl.InitWindow(WIDTH, HEIGHT, b"jostle and raylib")
rl.SetTargetFPS(0 if options.frames else 60)
frames = 0
while not rl.WindowShouldClose() and frames != options.frames:
    frames += 1
    places = (places + speeds / 60) % SIZE
    tree = jostle.Quadtree(places, radii)
    glow *= 0.95
    glow[tree.pairs().ravel()] = 1
    mouse = rl.GetMousePosition()
    center = (mouse.x, mouse.y) if not options.frames else (620.0, 330.0)
    colors = CALM + glow[:, None] * (WARM - CALM)
    colors[tree.query_circle(center, REACH)] = NEAR

    rl.BeginDrawing()
    rl.ClearBackground((15, 18, 26, 255))
    for place, radius, color in zip(
        places.tolist(), radii.tolist(), colors.astype(int).tolist(), strict=True
    ):
        rl.DrawCircleV(place, radius, (*color, 255))
    rl.DrawCircleLinesV(center, REACH, (*NEAR.astype(int).tolist(), 110))
    rl.EndDrawing()

if options.out:
    image = rl.LoadImageFromScreen()
    rl.ExportImage(image, ffi.new("char[]", options.out.encode()))
rl.CloseWindow()
