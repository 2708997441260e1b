"""Moving discs, and lines between near ones: raylib_net.py [--frames N] [--out picture.png].

The discs near the mouse are bright.
"""

import argparse

import numpy as np
from raylib import ffi, rl

import jostle

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--frames", type=int, help="number of frames")
parser.add_argument("--out", help="keep the last of them as a picture")
options = parser.parse_args()

WIDTH, HEIGHT, COUNT = 960, 600, 2_000
JOINED, AROUND = 28.0, 110.0  # pixels
DARK, CALM, WARM = (15, 18, 26, 255), (94, 148, 176), (255, 205, 130)

rng = np.random.default_rng(0)
places = rng.uniform((0, 0), (WIDTH, HEIGHT), (COUNT, 2)).astype(np.float32)
speeds = rng.normal(0, 18, (COUNT, 2)).astype(np.float32)
radii = rng.uniform(1.2, 3.2, COUNT).tolist()

rl.SetTraceLogLevel(rl.LOG_WARNING)
rl.SetConfigFlags(rl.FLAG_MSAA_4X_HINT)
rl.InitWindow(WIDTH, HEIGHT, b"jostle and raylib")
rl.SetTargetFPS(0 if options.frames else 60)
rl.rlEnableSmoothLines()
frames = 0
while not rl.WindowShouldClose() and frames != options.frames:
    frames += 1
    places += speeds / 60
    places %= np.array([WIDTH, HEIGHT], np.float32)
    tree = jostle.Quadtree(places, np.float32(JOINED / 2))
    pairs = tree.pairs()
    gaps = np.linalg.norm(places[pairs[:, 0]] - places[pairs[:, 1]], axis=1)
    mouse = rl.GetMousePosition()
    center = (350.0, 255.0) if options.frames else (mouse.x, mouse.y)
    colors = [CALM] * COUNT
    for disc in tree.query_circle(center, AROUND - JOINED / 2).tolist():
        colors[disc] = WARM

    rl.BeginDrawing()
    rl.ClearBackground(DARK)
    spots = places.tolist()
    for (i, j), light in zip(pairs.tolist(), (150 * (1 - gaps / JOINED)).tolist(), strict=True):
        rl.DrawLineV(spots[i], spots[j], (*colors[i], int(light)))
    for spot, radius, color in zip(spots, radii, colors, strict=True):
        rl.DrawCircleV(spot, radius, (*color, 255))
    rl.EndDrawing()

if options.out:
    rl.ExportImage(rl.LoadImageFromScreen(), ffi.new("char[]", options.out.encode()))
rl.CloseWindow()
