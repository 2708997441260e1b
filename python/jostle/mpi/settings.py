"""Settings of distributed worlds, which are the same on all ranks."""

from __future__ import annotations

from typing import Any, Generic, TypeVar, overload

Value = TypeVar("Value")


class Setting(Generic[Value]):
    """An attribute of `World` that is a setting of its core. To assign it is a collective call."""

    def __init__(self, doc: str) -> None:
        self.__doc__ = doc

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

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
