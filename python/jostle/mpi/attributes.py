"""Attributes of distributed worlds: settings, the same on all ranks, and columns of particles."""

from __future__ import annotations

from typing import Any, Generic, TypeVar, overload

from numpy.typing import NDArray

Value = TypeVar("Value")


class Attribute:
    """An attribute of `World` with a docstring, named as that of the core."""

    def __init__(self, doc: str) -> None:
        self.__doc__ = doc

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name


class Setting(Attribute, Generic[Value]):
    """A setting of the core. To assign it is a collective call."""

    @overload
    def __get__(self, world: None, owner: type) -> Setting[Value]: ...
    @overload
    def __get__(self, world: Any, owner: type) -> Value: ...
    def __get__(self, world: Any, owner: type) -> Setting[Value] | Value:
        if world is None:
            return self
        value: Value = getattr(world._core, self._name)
        return value

    def __set__(self, world: Any, value: Any) -> None:
        world._assign(self._name, value)


class Column(Attribute):
    """A column of the core, without the rows of ghosts."""

    @overload
    def __get__(self, world: None, owner: type) -> Column: ...
    @overload
    def __get__(self, world: Any, owner: type) -> NDArray[Any]: ...
    def __get__(self, world: Any, owner: type) -> Column | NDArray[Any]:
        if world is None:
            return self
        column: NDArray[Any] = getattr(world._core, self._name)
        return column[: len(world)]

    def __set__(self, world: Any, value: object) -> None:
        raise AttributeError(f"{self._name} cannot be assigned; use World.set")
