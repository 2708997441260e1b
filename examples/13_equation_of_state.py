"""Measure the equation of state of a gas of hard discs, and compare it with Henderson's."""

import numpy as np

import jostle
import show

n = 900
rng = np.random.default_rng(2)
grid = np.indices((30, 30)).reshape(2, n).T + 0.5


def compressibility(covered: float) -> float:
    """Return pV / NkT of discs of radius 1 that cover a share of a periodic plane."""
    side = np.sqrt(n * np.pi / covered)
    start = rng.normal(size=(n, 2))
    world = jostle.World(grid * side / 30, 1.0, velocities=start, period=(side, side))
    world.step(0.05, steps=400)  # the grid melts
    world.step(0.05, steps=1500)
    call = world.last_call  # sums over these 1,500 steps
    virial = np.trace(call.collision_virial) / (2 * call.duration)
    return float(1 + virial / (n * world.temperature()))


line = np.linspace(0, 0.65, 66)
law = (1 + line**2 / 8) / (1 - line) ** 2
covered, henderson = line[5::5], law[5::5]
measured = np.array([compressibility(share) for share in covered])
for row in zip(covered, measured, henderson):
    print("covered {:.2f}: pV / NkT = {:.3f}, Henderson {:.3f}".format(*row))

worst = abs(measured / henderson - 1).max()
text = f"{n} hard discs: measured, and Henderson's equation; the difference is at most {worst:.1%}"
with show.axes(text, ("share of the plane that the discs cover", "pV / NkT")) as plot:
    plot.plot(line, law, color=show.TEAL)
    plot.scatter(covered, measured, color=show.YELLOW, zorder=3)
