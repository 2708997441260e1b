"""The compiled library computes without functions of the system's mathematical library.

These differ in their last bits between systems, so the bits of a state would, too.
"""

import struct
import sys
from pathlib import Path

import numpy as np
import pytest

import jostle._core

#: Functions of `math.h` whose last bits differ, also with the ends f (float32) and l. A square root
#: is an instruction.
FUNCTIONS = {
    *("acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "cbrt", "cos", "cosh", "erf"),
    *("erfc", "exp", "exp10", "exp2", "expm1", "fma", "fmod", "hypot", "j0", "j1", "jn", "lgamma"),
    *("lgamma_r", "log", "log10", "log1p", "log2", "logb", "pow", "remainder", "remquo", "sin"),
    *("sincos", "sinh", "sqrt", "tan", "tanh", "tgamma", "y0", "y1", "yn"),
}

#: Those that the library may import, each with the reason why no state depends on it. None is
#: needed: scenes, forces and motors compute with + - * / and square roots alone.
ALLOWED: dict[str, str] = {}

#: The kind of a section with dynamic symbols.
SYMBOLS = 11


def imports(path: Path) -> set[str]:
    """The undefined dynamic symbols of an ELF file of 64 bits."""
    data = path.read_bytes()
    if data[:5] != b"\x7fELF\x02":
        pytest.skip(f"{path.name} is no ELF file of 64 bits")
    order = "<" if data[5] == 1 else ">"

    def read(form: str, at: int) -> tuple[int, ...]:
        return struct.unpack_from(order + form, data, at)

    [sections_at] = read("Q", 0x28)
    size, count = read("HH", 0x3A)
    sections = [read("IIQQQQIIQQ", sections_at + at * size) for at in range(count)]
    found = set()
    for _, kind, _, _, start, length, link, _, _, entry in sections:
        if kind == SYMBOLS:
            names = sections[link][4]
            for at in range(start, start + length, entry):
                name, _, _, section = read("IBBH", at)
                if name and section == 0:
                    end = data.index(b"\0", names + name)
                    found.add(data[names + name : end].decode())
    return found


def mathematical(symbols: set[str]) -> set[str]:
    plain = {f"{name}{end}" for name in FUNCTIONS for end in ("", "f", "l")}
    # glibc has further names of some, for example __exp_finite.
    return {name for name in symbols if name.removeprefix("__").removesuffix("_finite") in plain}


@pytest.fixture(autouse=True)
def _only_elf() -> None:
    if not sys.platform.startswith("linux"):
        pytest.skip("the symbols of ELF files are read, which this system does not have")


def test_the_library_imports_no_mathematical_functions() -> None:
    symbols = imports(Path(jostle._core.__file__))
    assert {"memcpy", "PyObject_GetAttr"} <= symbols
    assert mathematical(symbols) <= set(ALLOWED)


def test_mathematical_functions_of_another_library_are_found() -> None:
    [other] = Path(np.__file__).parent.rglob("_multiarray_umath.*so")
    assert {"exp", "hypot"} <= mathematical(imports(other))
