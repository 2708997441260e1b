"""The check of docstrings by numpydoc: what it finds."""

import ast
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import check_docstrings
import pytest

ROOT = Path(__file__).parents[2]


def grow(radius: float, *, by: float = 1.0) -> float:
    """Return a larger radius.

    Parameters
    ----------
    radius : float
        In units of length.
    by : float, default 1.0
        The difference.

    Returns
    -------
    float
        The sum.
    """
    return radius + by


def changed(old: str, new: str) -> Any:
    """Return a copy of `grow` with other words in its docstring."""

    def copy(radius: float, *, by: float = 1.0) -> float:
        return radius + by

    assert grow.__doc__ is not None and old in grow.__doc__
    copy.__doc__ = grow.__doc__.replace(old, new)
    return copy


def found(function: Any, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Return the codes of the findings in a module with one function."""
    module = SimpleNamespace(__name__="jostle.trial", __all__=["grow"], grow=function)
    monkeypatch.setattr(check_docstrings, "MODULES", ["jostle.trial"])
    monkeypatch.setattr(check_docstrings, "import_module", lambda name: module)
    return [message.split(": ")[1].split()[0] for message in check_docstrings.findings()]


def test_a_complete_docstring_passes(monkeypatch: pytest.MonkeyPatch) -> None:
    assert found(grow, monkeypatch) == []


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        ("    by : float, default 1.0\n        The difference.\n", "", "PR01"),
        ("by : float, default 1.0", "by", "PR04"),
        ("        The difference.\n", "", "PR07"),
        ("\n    Returns\n    -------\n    float\n        The sum.\n", "", "RT01"),
        ("The sum.", "the sum.", "RT04"),
        ("Return a larger", "return a larger", "SS02"),
    ],
)
def test_a_fault_is_found(old: str, new: str, code: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert found(changed(old, new), monkeypatch) == [code]


def test_signatures_of_the_compiled_module_come_from_the_stub() -> None:
    stub = """
class Disc:
    def __new__(cls, radius: float) -> Self: ...
    def grow(self, by: int) -> None: ...
    @property
    def area(self) -> float: ...
def find(what: str, *, sort: bool) -> int: ...
"""
    assert dict(check_docstrings.declared(ast.parse(stub).body)) == {
        "Disc": (("radius",), True),
        "Disc.grow": (("by",), False),
        "find": (("what", "sort"), True),
    }
