"""Values and bytes packed together, for states and scene files, and checks of what was read.

The format is a first line with the kind, a JSON header with the values and the lengths of the
parts, then the parts. A checksum finds damage, but not wrong values, so these are checked.
"""

import itertools
import json
import zlib
from collections.abc import Mapping
from typing import Any

from jostle_lab.simulate.frame import Attractor
from jostle_lab.simulate.validation import Many, fields_of, whole

_FIRST = b"jostle "
_VERSION = 2
_LENGTH = 8  # bytes of the header's length, and of the checksum

COUNT = whole(0, 2**62)  # of tags or steps
ATTRACTORS = Many(fields_of(Attractor))


def pack(kind: str, facts: Mapping[str, Any], *parts: bytes) -> bytes:
    """Return bytes of a kind, for `unpack`."""
    lengths = [len(part) for part in parts]
    header = json.dumps({"facts": facts, "parts": lengths}).encode()
    return b"".join([_first_line(kind), len(header).to_bytes(_LENGTH, "little"), header, *parts])


def unpack(kind: str, data: bytes, count: int) -> tuple[dict[str, Any], list[bytes]]:
    """Return values, and a number of parts; raise a ValueError for other bytes."""
    begin = _first_line(kind)
    if not data.startswith(begin):
        raise ValueError(f"it is not a {kind} of this version of jostle")
    at = len(begin) + _LENGTH
    size = int.from_bytes(data[len(begin) : at], "little")
    try:
        header = json.loads(data[at : at + size])
        facts, lengths = dict(header["facts"]), header["parts"]
        ends = list(itertools.accumulate(lengths, initial=at + size))
        parts = [data[first:end] for first, end in itertools.pairwise(ends)]
    except (KeyError, TypeError, ValueError, OverflowError, RecursionError) as error:
        raise ValueError("it is cut off or damaged") from error
    if ends[-1] != len(data) or len(parts) != count:
        raise ValueError("it is damaged: its length is not that in its header")
    return facts, parts


def seal(data: bytes) -> bytes:
    """Return the bytes followed by their checksum."""
    return data + zlib.crc32(data).to_bytes(_LENGTH, "little")


def unseal(data: bytes) -> bytes:
    """Return the bytes before the checksum, if it is correct."""
    body, checksum = data[:-_LENGTH], data[-_LENGTH:]
    if len(data) < _LENGTH or zlib.crc32(body).to_bytes(_LENGTH, "little") != checksum:
        raise ValueError("it is cut off or damaged: its checksum is wrong")
    return body


def is_of(kind: str, data: bytes) -> bool:
    return data.startswith(_first_line(kind))


def _first_line(kind: str) -> bytes:
    return _FIRST + f"{kind} {_VERSION}\n".encode()
