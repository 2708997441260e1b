"""docs/api.md has the names, arguments and fields that the library has."""

import inspect
import subprocess
import sys
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path

import pytest

import jostle

ROOT = Path(__file__).parents[2]
PROGRAM = ROOT / "docs" / "api_table.py"

if find_spec("mpi4py") is None:
    pytest.skip("the table includes jostle.mpi", allow_module_level=True)


@pytest.fixture(scope="module")
def program():
    found = spec_from_file_location("api_table", PROGRAM)
    assert found is not None and found.loader is not None
    module = module_from_spec(found)
    found.loader.exec_module(module)
    return module


def test_the_page_is_up_to_date() -> None:
    """`python docs/api_table.py` writes it: its difference shows what users will notice."""
    child = subprocess.run([sys.executable, PROGRAM, "--check"], capture_output=True, text=True)
    assert child.returncode == 0, child.stdout + child.stderr


def test_every_public_name_has_a_row(program) -> None:
    page = program.page()
    for name in set(jostle.__all__) - {"__version__", "life", "scenes"}:
        assert f"| `{name}" in page, name
    for kind in (jostle.World, jostle.Space, jostle.Quadtree, jostle.Walls):
        section = page.partition(f"\n## {kind.__name__}\n")[2].partition("\n## ")[0]
        for name in dir(kind):
            if not name.startswith("_"):
                assert f"| `.{name}`" in section or f"| `.{name}()`" in section, name


def test_arguments_are_those_of_the_library(program) -> None:
    shown = program.signature(jostle.Space.query_circle)
    assert shown == "center, radius, \\*, mask=None, exclude=None"
    assert list(inspect.signature(jostle.Space.query_circle).parameters)[1:3] == [
        "center",
        "radius",
    ]


def test_a_change_is_reported(program, capsys, monkeypatch) -> None:
    monkeypatch.setattr(sys, "argv", ["api_table.py", "--check"])
    monkeypatch.setattr(program, "page", lambda: "another page")
    assert program.main() == 1
    assert "python docs/api_table.py" in capsys.readouterr().out
