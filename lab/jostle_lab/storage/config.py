"""A scene described in a TOML file, to read and to write; docs/settings.md lists its entries."""

import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import tomli_w
from pydantic import Field, TypeAdapter
from pydantic.dataclasses import dataclass as checked

from jostle_lab.draw.camera import Size
from jostle_lab.draw.view_options import ViewOptions
from jostle_lab.schema import FORBID, Pixels, Settings, read, unknown_scene

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

MOST_BYTES = 64 << 20  # of a file


class ConfigError(ValueError):
    """An error in a file; the message contains its name and the key or the line."""


@checked(frozen=True, config=FORBID)
class Window:
    """The table [window] of a file."""

    size: tuple[Pixels, Pixels] | None = Field(
        default=None, description="[width, height] of the window or of the video, in pixels"
    )


@dataclass(frozen=True)
class Config:
    """The entries of a file; missing ones are omitted or None."""

    settings: Settings = field(default_factory=Settings)
    view_options: Mapping[str, Any] = field(default_factory=dict)
    size: Size | None = None


def read_config(path: Path) -> Config:
    """Return the entries of a file; raise a ConfigError or an OSError if it is wrong."""
    with path.open("rb") as file:  # which may be a device without an end
        data = file.read(MOST_BYTES + 1)
    try:
        if len(data) > MOST_BYTES:
            raise ValueError(f"it has more than {MOST_BYTES >> 20} MiB")
        return _config(tomllib.loads(data.decode("utf-8-sig").replace("\r\n", "\n")))
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path.name}: it is not a text in UTF-8") from error
    except RecursionError as error:
        raise ConfigError(f"{path.name}: too many brackets are open") from error
    except ValueError as error:
        raise ConfigError(f"{path.name}: {error}") from error


def _config(entries: dict[str, Any]) -> Config:
    window, shown = entries.pop("window", {}), entries.pop("shown", {})
    settings = read(Settings, entries, known=("window", "shown"))
    if why := unknown_scene(settings.scene):
        raise ValueError(why)
    options = read(ViewOptions, shown, within="shown")
    size = read(Window, window, within="window").size
    return Config(settings, {name: getattr(options, name) for name in shown}, size)


def config_text(settings: Settings, options: ViewOptions) -> str:
    """Return a TOML text of the settings and view options that differ from the defaults.

    A world of one's own has no scene, which raises a ValueError.
    """
    if unknown_scene(settings.scene):
        raise ValueError("it is a world without a scene, whose file is .jostle")
    entries = TypeAdapter(Settings).dump_python(settings, mode="json", exclude_defaults=True)
    shown = TypeAdapter(ViewOptions).dump_python(options, mode="json", exclude_defaults=True)
    if shown:
        entries["shown"] = shown
    return tomli_w.dumps({"scene": settings.scene, **entries})
