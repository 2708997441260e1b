"""Programs that use the library as its users do run as they are written."""

from pathlib import Path

import pytest
from signals import printed_by

PROGRAMS = sorted(set(Path(__file__).parent.glob("*.py")) - {Path(__file__)})


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda path: path.stem)
def test_runs_as_written(program: Path) -> None:
    printed_by("-W", "error", program)
