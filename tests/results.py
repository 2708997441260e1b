"""The fields of results of the library."""

from typing import Any


def fields(result: Any) -> tuple[Any, ...]:
    """Return the values of all fields, in their order."""
    return tuple(getattr(result, name) for name in result.__slots__)
