"""Walk in a map of Tiled, read with pytmx: tiles are merged into boxes, lines become slopes."""

from pathlib import Path

import numpy as np
import pygame
import pytmx

import jostle
import show

WALL, LEDGE, WALKER = 1, 2, 4
tiled = pytmx.TiledMap(str(Path(__file__).with_name("cave.tmx")), load_all_tiles=True)
layers = [np.array(tiled.layernames[name].data) for name in ("walls", "ledges")]
walls, ledges = (jostle.tiles(grid, (tiled.tilewidth, tiled.tileheight)) for grid in layers)
ledges[:, 3] -= 16  # thin
starts = [(start.x, start.y) for start in tiled.layernames["starts"]]
slopes = [jostle.polyline(line.points) for line in tiled.layernames["slopes"]]

space, rng = jostle.Space(), np.random.default_rng(3)
space.add(segments=np.concatenate(slopes), categories=WALL)
space.add(boxes=walls, categories=WALL)
space.add(boxes=ledges, categories=LEDGE)
ids = space.add(starts * 6, 2.0, (3, 5), categories=WALKER)
velocities, speeds = np.zeros((len(ids), 2)), rng.uniform(1, 2.5, len(ids))

for screen in show.frames("A map of Tiled", until=300):
    velocities = np.stack([speeds, velocities[:, 1] + 0.4], axis=1)
    slides = space.move_and_slide(ids, velocities, mask=WALL | LEDGE, one_way=LEDGE)
    velocities[:] = slides.remaining
    speeds[slides.on_wall] *= -1
    velocities[slides.on_floor & (rng.random(len(ids)) < 0.02), 1] = -7.5

    all_boxes = walls, ledges, space.get(ids).boxes
    for boxes, color in zip(all_boxes, (show.DIM, show.GREEN, show.ORANGE)):
        for left, top, right, bottom in boxes:
            pygame.draw.rect(screen, color, (left, top, right - left, bottom - top))
    for start, end in np.concatenate(slopes):
        pygame.draw.line(screen, show.YELLOW, start, end, 3)
    show.caption(screen, f"{np.count_nonzero(layers)} tiles in {len(walls) + len(ledges)} boxes")
