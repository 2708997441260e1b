"""Avalanches of a pile of discs that is tilted slowly.

The scene is that of S. Deboeuf et al., *Evolution of the contact network during tilting cycles of a
granular pile under gravity*, Powders and Grains 2005, simulated there by contact dynamics: 4,000
rigid discs with a coefficient of friction of 0.5 in a box 120 mean diameters wide. The angles of
their surface to the horizontal are about 21° when an avalanche starts and about 15° after it.

`python tests/tilted_pile.py` prints the angles for 8 seeds, in about two minutes. `python
tests/tilted_pile.py 16` takes 16 sub-steps instead of four, and four times as long.
"""

import math
import sys

import numpy as np

import jostle

GRAVITY = 9.8
STEP = 1 / 60

# Of the speed √(g D) with the mean diameter D = 1: an avalanche has begun, and has ended.
FLOWS, RESTS = 0.1, 0.01


class TiltedPile:
    """Discs with a mean diameter of 1 at rest in a box, whose tilt can be changed."""

    def __init__(
        self, discs: int, width: float, seed: int, friction: float = 0.5, substeps: int = 4
    ) -> None:
        rng = np.random.default_rng(seed)
        largest = 1.2
        columns = int(width / (1.02 * largest))
        rows, column = np.divmod(np.arange(discs), columns)
        positions = np.stack([(column + 0.5) * width / columns, (rows + 0.5) * largest * 1.02], 1)
        radii = 0.5 * rng.uniform(2 - largest, largest, discs)
        self.width = width
        self.tilt = 0.0
        self.world = jostle.World(
            positions,
            radii,
            velocities=rng.normal(size=positions.shape),
            masses=radii**2,
            gravity=(0, -GRAVITY),
            restitution=0.0,
            friction=friction,
            substeps=substeps,
            container=jostle.Box(0, 0, width, 2 * largest * (rows[-1] + 2)),
            sleeping=False,
        )
        self.world.step(STEP, steps=400)

    def tilt_by(self, degrees: float, steps: int) -> None:
        """Tilt the box by so much in each step."""
        for _ in range(steps):
            self.tilt += degrees
            angle = math.radians(self.tilt)
            self.world.gravity = (GRAVITY * math.sin(angle), -GRAVITY * math.cos(angle))
            self.world.step(STEP)

    def angle(self) -> float:
        """Angle to the horizontal of a line through the highest discs, in degrees."""
        world = self.world
        tops = world.positions[:, 1] + world.radii
        column = ((world.positions[:, 0] / self.width - 0.1) / 0.8 * 32).astype(int)
        highest = [
            np.flatnonzero(column == k)[np.argmax(tops[column == k])]
            for k in range(32)
            if (column == k).any()
        ]
        slope = np.polyfit(world.positions[highest, 0], tops[highest], 1)[0]
        return float(self.tilt - math.degrees(math.atan(slope)))

    def speed(self) -> float:
        """Root of the mean square of the speeds, in units of √(g D)."""
        return math.sqrt((self.world.velocities**2).sum(axis=1).mean() / GRAVITY)

    def avalanche(self, rate: float = 0.01, least: float = 2.0) -> tuple[float, float]:
        """Tilt until the surface flows, then wait; return its angles before and after.

        Avalanches that change the angle by less than `least` degrees do not count.
        """
        while self.tilt < 40:
            self.tilt_by(rate, 10)
            if self.speed() > FLOWS:
                before = self.angle()
                for _ in range(300):
                    self.world.step(STEP, steps=10)
                    if self.speed() < RESTS:
                        break
                if before - self.angle() > least:
                    return before, self.angle()
        return math.nan, math.nan


def main() -> None:
    substeps = int(sys.argv[1]) if len(sys.argv) > 1 else 4
    angles = []
    for seed in range(8):
        angles.append(TiltedPile(4000, 120.0, seed, substeps=substeps).avalanche())
        print(
            f"seed {seed}: {angles[-1][0]:.1f}° before the avalanche, {angles[-1][1]:.1f}° after it"
        )
    mean = np.mean(angles, axis=0)
    error = np.std(angles, axis=0, ddof=1) / math.sqrt(len(angles))
    print(f"mean: {mean[0]:.1f} ± {error[0]:.1f}° and {mean[1]:.1f} ± {error[1]:.1f}°")


if __name__ == "__main__":
    main()
