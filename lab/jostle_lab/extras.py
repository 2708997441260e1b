"""What to do where a package of an extra is not installed."""

from __future__ import annotations


def remedy(extra: str) -> str:
    """Return the end of a sentence: the command that installs the packages of an extra."""
    return f'in the folder of the source of jostle, run pip install ".[{extra}]"'
