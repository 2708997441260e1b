"""What a public class has, for the checks of docstrings."""

from typing import Any


def members(owner: type) -> dict[str, Any]:
    """Return what a class has, and what it inherits from those of the modules below its own."""
    below = f"{owner.__module__}."
    bases = [base for base in owner.__mro__ if base is owner or base.__module__.startswith(below)]
    return {name: value for base in reversed(bases) for name, value in vars(base).items()}
