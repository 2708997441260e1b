"""Scenes whose states are saved, loaded and rewound."""

import pytest

from jostle_lab.schema import Group, Settings

SCENES = [
    Settings("gas", 300, gravity=(1.0, 2.0), restitution=0.9),
    Settings("emitters", 200),
    Settings("springs", 200),
    Settings("orbit", 200, on_touch="merge"),
    Settings("pile", 200, particles=(Group(3, radius=(2.0, 4.0)),)),
    Settings("mixed", 60, method="brute"),
    Settings("life", 50, matrix=((0.5, -1.0), (1.0, 0.0))),
]

in_many_scenes = pytest.mark.parametrize("settings", SCENES, ids=lambda settings: settings.scene)
