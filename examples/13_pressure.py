"""Measure the pressure of a gas by its impulses on walls, and compare it with Henderson's law."""

import numpy as np

import jostle
import show

SIDE, N, STEPS = 400.0, 400, 400
rng = np.random.default_rng(11)
grid = (np.indices((20, 20)).reshape(2, -1).T + 0.5) / 20


def pressures(share: float) -> tuple[float, float]:
    """Return the pressure of N elastic discs that cover a share of the box, and Henderson's."""
    radius = np.sqrt(share * SIDE**2 / (N * np.pi))
    box = jostle.Box(0, 0, SIDE, SIDE)
    world = jostle.World(
        grid * SIDE, radius, velocities=rng.normal(0, 60, (N, 2)), masses=1.0, container=box
    )
    world.step(1 / 60, steps=60)
    world.step(1 / 60, steps=STEPS)
    call = world.last_call
    side = SIDE - 2 * radius  # of the square in which centres move
    ideal = world.kinetic_energy() / side**2
    measured = call.side_impulses[:, 0].sum() / (call.duration * 4 * side)
    return measured, ideal * (1 + share**2 / 8) / (1 - share) ** 2


shares = np.linspace(0.05, 0.5, 6)
found = [pressures(share) for share in shares]
print("covered  measured  Henderson")
for share, (measured, law) in zip(shares, found):
    print(f"{share:7.2f} {measured:9.2f} {law:10.2f}")

with show.axes("Pressure over the share of covered area: measured, and Henderson's line") as plot:
    bars = 450 - 380 * np.array(found) / np.max(found)
    x = 100 + 600 * (shares - shares[0]) / np.ptp(shares)
    plot.plot(x, bars[:, 1], color=show.TEAL)
    plot.scatter(x, bars[:, 0], color=show.YELLOW, zorder=3)
