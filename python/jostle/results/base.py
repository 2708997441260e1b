"""What all results have in common: fields that cannot be changed, and sequences of lists."""

from __future__ import annotations

import operator
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Generic, NoReturn, SupportsIndex, TypeVar

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from typing_extensions import Self, dataclass_transform
else:

    def dataclass_transform(**_):
        """Return a decorator that does nothing: only type checkers read it."""
        return lambda kind: kind


T = TypeVar("T")
_set = object.__setattr__


@dataclass_transform(frozen_default=True)
class Result:
    """Base of the results: the fields of `__slots__`, in this order, which cannot be changed."""

    # `dataclasses` would do the same, but it takes a third of the time of `import jostle`.
    __slots__: tuple[str, ...] = ()

    if not TYPE_CHECKING:  # a type checker derives the arguments from the fields

        def __init__(self, *args, **kwargs):
            names = self.__slots__
            if kwargs:
                args += tuple(kwargs.pop(name) for name in names[len(args) :] if name in kwargs)
            if kwargs or len(args) != len(names):
                raise TypeError(f"{type(self).__name__} has the fields {', '.join(names)}")
            for name, value in zip(names, args, strict=True):
                _set(self, name, value)

    def __setattr__(self, name: str, value: object) -> NoReturn:
        """Refuse to change a field."""
        raise AttributeError(f"a field of {type(self).__name__} cannot be changed: {name}")

    def __delattr__(self, name: str) -> NoReturn:
        """Refuse to delete a field."""
        raise AttributeError(f"a field of {type(self).__name__} cannot be deleted: {name}")

    def __eq__(self, other: object) -> bool:
        """Whether the other is of the same class and has equal fields."""
        if type(other) is not type(self):
            return NotImplemented
        return all(_same(getattr(self, name), getattr(other, name)) for name in self.__slots__)

    __hash__ = None  # type: ignore[assignment]

    def to_dict(self) -> dict[str, Any]:
        """Return the fields by their names, for instance as arguments of `add` or `set`.

        Returns
        -------
        dict
            A new one, with the values that the fields have.
        """
        return {name: getattr(self, name) for name in self.__slots__}

    def __reduce__(self) -> tuple[type[Self], tuple[Any, ...]]:
        """Return the class and the values of the fields, for pickle and copy."""
        return type(self), tuple(getattr(self, name) for name in self.__slots__)

    def __repr__(self) -> str:
        """Return the class with its fields."""
        fields = ", ".join(f"{name}={getattr(self, name)!r}" for name in self.__slots__)
        return f"{type(self).__name__}({fields})"


def _same(one: Any, other: Any) -> bool:
    """Whether two fields are equal; NaN, which stands for no value, equals itself."""
    return np.array_equal(one, other, equal_nan=np.asarray(one).dtype.kind == "f")


class Lists(Generic[T]):
    """A sequence of lists, one for each query, whose elements are stored one after the other.

    A result that derives from it has the field `offsets`, and a method `_elements` that returns
    one list.
    """

    __slots__ = ()

    offsets: NDArray[np.int64]

    def _elements(self, at: slice) -> T:
        """Return the elements in a slice."""
        raise NotImplementedError

    def __len__(self) -> int:
        """Return the number of lists."""
        return len(self.offsets) - 1

    def __getitem__(self, index: SupportsIndex) -> T:
        """Return the list of a query; a negative index counts from the end."""
        nth, count = operator.index(index), len(self)
        if not -count <= nth < count:
            raise IndexError(f"list {nth} of {count} lists")
        return self._elements(slice(*self.offsets[nth % count : nth % count + 2].tolist()))

    def __iter__(self) -> Iterator[T]:
        """Yield the list of each query."""
        return map(self.__getitem__, range(len(self)))

    @property
    def counts(self) -> NDArray[np.int64]:
        """The number of elements of each list, an array of int64 of shape (k,)."""
        return np.diff(self.offsets)

    @property
    def queries(self) -> NDArray[np.int64]:
        """The query of each element, an array of int64 of shape (m,)."""
        return np.repeat(np.arange(len(self)), self.counts)
