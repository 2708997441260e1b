"""A scene in a file, `.jostle`: state, settings, camera and view options."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from enum import Enum
from pathlib import Path
from typing import Any

from jostle_lab.draw.camera import Camera
from jostle_lab.draw.view_options import OPTION_RULES, ViewOptions, spelling
from jostle_lab.simulate.packing import is_of, pack, seal, unpack, unseal
from jostle_lab.simulate.settings import TRUTH, unknown_scene
from jostle_lab.simulate.simulation import Simulation
from jostle_lab.simulate.validation import Fields, each, read, real, whole

SUFFIX = ".jostle"
KIND = "scene"
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
FACTS = Fields({"camera": CAMERA, "shown": SHOWN})


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
    facts = {
        "camera": {name: getattr(camera, name) for name in CAMERA.rules},
        "shown": {
            name: spelling(value) if isinstance(value, Enum) else value
            for name, value in asdict(options).items()
        },
    }
    return seal(pack(KIND, facts, simulation.save()))


def read_scene(path: Path) -> SavedScene:
    """Return the scene of a file; raise a ValueError if it does not contain one."""
    with path.open("rb") as file:
        data = file.read(64)  # the first line; there may be no end
        data += file.read() if is_of(KIND, data) else b""
    if not is_of(KIND, data):
        raise ValueError(f"{path.name} is not a scene of this version of jostle.")
    try:
        facts, (state,) = unpack(KIND, unseal(data), 1)
        facts = read(facts, FACTS)
        simulation = Simulation.resume(state)
        if why := unknown_scene(simulation.settings.scene):
            raise ValueError(why)
    except (ValueError, OverflowError) as error:
        raise ValueError(f"{path.name} cannot be loaded: {str(error).rstrip('.')}.") from error
    shown = {name: value for name, value in facts["shown"].items() if name not in NOT_RESTORED}
    return SavedScene(simulation, facts["camera"], shown)
