"""Marbles fall into a box, and each impact makes a sound as loud as its impulse, in a WAV file."""

import tempfile
import wave
from pathlib import Path

import numpy as np

import jostle
import show

n, rate, seconds = 120, 44100, 3
rng = np.random.default_rng(11)
world = jostle.World(
    rng.uniform((20, -1500), (780, 380), (n, 2)),
    rng.uniform(6, 18, n),
    gravity=(0, 900),
    restitution=0.8,
    container=jostle.Box(0, -2000, *show.SIZE),
)
sound, time = np.zeros(rate * (seconds + 1)), np.arange(rate // 5) / rate
for frame in range(60 * seconds):
    world.step(1 / 60)
    pairs, walls = world.last_step.contacts, world.last_step.wall_contacts
    ids = np.concatenate([pairs.pairs[:, 0], walls.ids])
    impulses = np.concatenate([pairs.normal_impulses, walls.normal_impulses])
    for id, impulse in zip(ids[impulses > 2e4], impulses[impulses > 2e4]):
        pitch = 9000 / world.radii[id]  # small marbles have a high pitch
        start = frame * rate // 60 + rng.integers(rate // 60)
        tone = np.sin(2 * np.pi * pitch * time) * np.exp(-30 * time)
        sound[start : start + len(time)] += impulse * tone

sound /= abs(sound).max()
path = Path(tempfile.gettempdir()) / "impacts.wav"
with wave.open(str(path), "wb") as file:
    file.setparams((1, 2, rate, 0, "NONE", ""))
    file.writeframes((32767 * sound).astype("<i2").tobytes())
with show.axes(f"{seconds} s of sound, now in {path.name} of your temporary folder") as plot:
    plot.plot(np.linspace(0, 800, len(sound)), 250 - 200 * sound, color=show.TEAL)
