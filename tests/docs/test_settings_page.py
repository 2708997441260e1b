"""docs/settings.md has the settings of the simulator as they are declared."""

import subprocess
import sys
from pathlib import Path

from jostle_lab.draw.view_options import ViewOptions
from jostle_lab.schema import Group, Polyline, Settings, fields_of

ROOT = Path(__file__).parents[2]


def test_the_page_is_up_to_date_and_explains_every_entry() -> None:
    program = ROOT / "docs" / "settings.py"
    child = subprocess.run([sys.executable, program, "--check"], capture_output=True, text=True)
    assert child.returncode == 0, child.stdout + child.stderr
    page = program.with_suffix(".md").read_text(encoding="utf-8")
    for kind in (Settings, Group, Polyline, ViewOptions):
        for name, field in fields_of(kind).items():
            assert f"| `{name}` | " in page and field.description, name
