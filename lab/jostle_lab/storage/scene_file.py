"""A scene in a file, `.jostle`: a world; settings, camera and view options are attached."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, Strict, TypeAdapter
from pydantic.dataclasses import dataclass as checked

import jostle
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.view_options import ViewOptions
from jostle_lab.schema import FORBID, Truth, fields_of, read
from jostle_lab.simulate.simulation import Simulation, attached

SUFFIX = ".jostle"
NOT_RESTORED = {"help", "panels"}  # view options of the window

TINY, HUGE = 1e-30, 1e30  # limits of pixels per world unit, and of world units
Coordinate = Annotated[float, Strict(), Field(ge=-HUGE, le=HUGE)]
Side = Annotated[int, Strict(), Field(ge=1, le=1_000_000)]


@checked(frozen=True, config=FORBID)
class SavedCamera:
    """The view of a camera, and the size of its screen in pixels."""

    center: tuple[Coordinate, Coordinate]
    scale: Annotated[float, Strict(), Field(ge=TINY, le=HUGE)]
    size: tuple[Side, Side]
    at_home: Truth


@checked(frozen=True, config=FORBID)
class SavedWindow:
    """What a window shows."""

    camera: SavedCamera
    shown: ViewOptions


@dataclass(frozen=True)
class SavedScene:
    """The contents of a file; a world that no window has saved has no `window`."""

    simulation: Simulation
    window: SavedWindow | None

    def show(self, camera: Camera, options: ViewOptions) -> None:
        """Set a camera, at the size of its own screen, and view options to the saved ones."""
        camera.look_at(self.simulation.view)
        if self.window is None:
            return
        saved, shown = self.window.camera, vars(self.window.shown)
        options.update({name: shown[name] for name in shown if name not in NOT_RESTORED})
        if not saved.at_home:
            shares = (side / before for side, before in zip(camera.size, saved.size, strict=True))
            camera.aim(saved.center, saved.scale * min(shares))


def scene_bytes(simulation: Simulation, camera: Camera, options: ViewOptions) -> bytes:
    """Return the contents of a scene file."""
    view = {name: getattr(camera, name) for name in fields_of(SavedCamera)}
    shown = TypeAdapter(ViewOptions).dump_python(options, mode="json")
    return simulation.save({"camera": view, "shown": shown})


def read_scene(path: Path) -> SavedScene:
    """Return the scene of a file; raise a ValueError if it does not contain one."""
    try:
        world = jostle.World.load(path)
    except ValueError as error:
        raise ValueError(f"{str(error).replace(str(path), path.name)}.") from error
    if world.attachment is None:
        return SavedScene(Simulation.of_own(world, path.stem), None)
    try:
        simulation = Simulation.of_world(world)
        window: Any = attached(world).get("window")
        saved = None if window is None else read(SavedWindow, window, within="window")
    except (ValueError, OverflowError) as error:
        raise ValueError(f"{path.name} cannot be loaded: {str(error).rstrip('.')}.") from error
    return SavedScene(simulation, saved)
