"""Values and arrays packed into bytes, for states and scene files, and checks of what was read.

The format is a first line with the kind, a JSON header with the values and the names, types and
shapes of the arrays, then the bytes of the arrays in that order, little-endian. A checksum finds
damage, but not wrong values, so these are checked.
"""

from __future__ import annotations

import json
import math
import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from jostle_lab.simulate.frame import Attractor
from jostle_lab.simulate.validation import Many, fields_of, whole

Array = NDArray[Any]
Arrays = Mapping[str, Array]

_FIRST = b"jostle "
_VERSION = 1
_TYPES = frozenset({"|u1", "|b1", "<u4", "<i8", "<f4", "<f8"})
_LENGTH = 8  # bytes of the header's length, and of the checksum

COUNT = whole(0, 2**62)  # of tags or steps
ATTRACTORS = Many(fields_of(Attractor))


def pack(kind: str, facts: Mapping[str, Any], arrays: Mapping[str, ArrayLike]) -> bytes:
    """Return bytes of a kind, for `unpack`."""
    columns = {name: _plain(array) for name, array in arrays.items()}
    table = [[name, array.dtype.str, array.shape] for name, array in columns.items()]
    header = json.dumps({"facts": facts, "arrays": table}).encode()
    parts = [_first_line(kind), len(header).to_bytes(_LENGTH, "little"), header]
    return b"".join([*parts, *(array.tobytes() for array in columns.values())])


def unpack(kind: str, data: bytes) -> tuple[dict[str, Any], dict[str, Array]]:
    """Return values and arrays; raise a ValueError for other bytes."""
    begin = _first_line(kind)
    if not data.startswith(begin):
        raise ValueError(f"it is not a {kind} of this version of jostle")
    at = len(begin) + _LENGTH
    size = int.from_bytes(data[len(begin) : at], "little")
    try:
        header = json.loads(data[at : at + size])
        facts, table = dict(header["facts"]), list(header["arrays"])
        at, arrays = at + size, {}
        for name, kind_of_number, shape in table:
            if kind_of_number not in _TYPES:
                raise ValueError("it has an unknown type of number")
            if not all(isinstance(side, int) and side >= 0 for side in shape):
                raise ValueError("it has an array of an impossible shape")
            column = np.frombuffer(data, kind_of_number, math.prod(shape), at)
            arrays[str(name)] = column.reshape(shape).copy()
            at += column.nbytes
    except (KeyError, TypeError, ValueError, OverflowError, RecursionError) as error:
        raise ValueError("it is cut off or damaged") from error
    if at != len(data):
        raise ValueError("it is damaged: there is more in it than its header says")
    return facts, arrays


def seal(data: bytes) -> bytes:
    """Return the bytes followed by their checksum."""
    return data + zlib.crc32(data).to_bytes(_LENGTH, "little")


def unseal(data: bytes) -> bytes:
    """Return the bytes before the checksum, if it is correct."""
    body, checksum = data[:-_LENGTH], data[-_LENGTH:]
    if len(data) < _LENGTH or zlib.crc32(body).to_bytes(_LENGTH, "little") != checksum:
        raise ValueError("it is cut off or damaged: its checksum is wrong")
    return body


def blob(data: bytes) -> NDArray[np.uint8]:
    return np.frombuffer(data, np.uint8)


def is_of(kind: str, data: bytes) -> bool:
    return data.startswith(_first_line(kind))


def _first_line(kind: str) -> bytes:
    return _FIRST + f"{kind} {_VERSION}\n".encode()


def _plain(values: ArrayLike) -> Array:
    """Return the array in little-endian order."""
    array = np.asarray(values)
    return np.ascontiguousarray(array, array.dtype.newbyteorder("<"))


def column(arrays: Arrays, name: str, kind: str, shape: tuple[int, ...]) -> NDArray[Any]:
    """Return an array, after a check of its type and shape."""
    if name not in arrays:
        raise ValueError(f"{name} is missing")
    array = arrays[name]
    if (array.dtype.str, array.shape) != (kind, shape):
        raise ValueError(
            f"{name} is an array {array.shape} of {array.dtype.str}; it must be {shape} of {kind}"
        )
    return array


def bytes_of(arrays: Arrays, name: str) -> bytes:
    """Return an array of bytes."""
    length = arrays[name].size if name in arrays else 0
    return column(arrays, name, "|u1", (length,)).tobytes()


def within(name: str, array: NDArray[Any], low: float, high: float) -> None:
    """Raise a ValueError with the first number of a column that is outside the limits."""
    for row in np.flatnonzero(~((array >= low) & (array <= high)))[:1]:
        raise ValueError(f"{name}[{row}] is {array[row]}; it must be from {low:g} to {high:g}")
