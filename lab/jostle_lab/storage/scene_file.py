"""A scene in a file, `.jostle`: a world; settings, camera and view options are attached."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from enum import Enum
from pathlib import Path
from typing import Any

import jostle
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.view_options import OPTION_RULES, ViewOptions, spelling
from jostle_lab.simulate.settings import TRUTH, unknown_scene
from jostle_lab.simulate.simulation import Simulation, attached
from jostle_lab.simulate.validation import Fields, each, read, real, whole

SUFFIX = ".jostle"
NOT_RESTORED = {"help", "panels"}  # view options of the window

TINY, HUGE = 1e-30, 1e30  # limits of pixels per world unit, and of world units

CAMERA = Fields(
    {
        "center": each(real(-HUGE, HUGE), "x", "y"),
        "scale": real(TINY, HUGE),
        "size": each(whole(1, 1_000_000), "width", "height"),
        "at_home": TRUTH,
    }
)
SHOWN = Fields(OPTION_RULES, "a switch", required=())
WINDOW = Fields({"camera": CAMERA, "shown": SHOWN})


@dataclass(frozen=True)
class SavedScene:
    """The contents of a file."""

    simulation: Simulation
    camera: Mapping[str, Any]
    view_options: Mapping[str, Any]

    def aim(self, camera: Camera) -> None:
        """Set a camera to the saved view, at the size of its own screen."""
        (x, y), (width, height) = self.camera["center"], self.camera["size"]
        scale = self.camera["scale"] * min(camera.size[0] / width, camera.size[1] / height)
        camera.look_at(self.simulation.view)
        if not self.camera["at_home"]:
            camera.aim((x, y), scale)


def scene_bytes(simulation: Simulation, camera: Camera, options: ViewOptions) -> bytes:
    """Return the contents of a scene file."""
    window = {
        "camera": {name: getattr(camera, name) for name in CAMERA.rules},
        "shown": {
            name: spelling(value) if isinstance(value, Enum) else value
            for name, value in asdict(options).items()
        },
    }
    return simulation.save(window)


def read_scene(path: Path) -> SavedScene:
    """Return the scene of a file; raise a ValueError if it does not contain one."""
    try:
        world = jostle.World.load(path)
    except ValueError as error:
        raise ValueError(f"{str(error).replace(str(path), path.name)}.") from error
    try:
        simulation = Simulation.of_world(world)
        window = read(attached(world)["window"], WINDOW)
        if why := unknown_scene(simulation.settings.scene):
            raise ValueError(why)
    except (ValueError, OverflowError) as error:
        raise ValueError(f"{path.name} cannot be loaded: {str(error).rstrip('.')}.") from error
    shown = {name: value for name, value in window["shown"].items() if name not in NOT_RESTORED}
    return SavedScene(simulation, window["camera"], shown)
