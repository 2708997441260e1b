"""The compiled library computes without functions of the system's mathematical library.

These differ in their last bits between systems, so the bits of a state would, too.
"""

import struct
import sys
from pathlib import Path

import numpy as np
import pytest

import jostle._core

#: Functions of `math.h`, also with the ends f (float32) and l; square roots are an instruction.
FUNCTIONS = {
    *("acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "cbrt", "cos", "cosh", "erf"),
    *("erfc", "exp", "exp10", "exp2", "expm1", "fma", "fmod", "hypot", "j0", "j1", "jn", "lgamma"),
    *("lgamma_r", "log", "log10", "log1p", "log2", "logb", "pow", "remainder", "remquo", "sin"),
    *("sincos", "sinh", "sqrt", "tan", "tanh", "tgamma", "y0", "y1", "yn"),
}

#: Those that the library may use, each with the reason why no state depends on it. There are none.
ALLOWED: dict[str, str] = {}

#: Kinds of sections of an ELF file, and the entry of the dynamic section for a library.
DYNAMIC, SYMBOLS, NEEDED = 6, 11, 1


def imports(path: Path) -> tuple[set[str], set[str]]:
    """The undefined symbols of an ELF file of 64 bits, and the libraries that it needs."""
    data = path.read_bytes()
    if data[:5] != b"\x7fELF\x02":
        pytest.skip(f"{path.name} is no ELF file of 64 bits")
    order = "<" if data[5] == 1 else ">"

    def read(form: str, at: int) -> tuple[int, ...]:
        return struct.unpack_from(order + form, data, at)

    def text(at: int) -> str:
        return data[at : data.index(b"\0", at)].decode()

    [sections_at] = read("Q", 0x28)
    size, count = read("HH", 0x3A)
    sections = [read("IIQQQQIIQQ", sections_at + at * size) for at in range(count)]
    symbols, libraries = set(), set()
    for _, kind, _, _, start, length, link, _, _, entry in sections:
        if kind == SYMBOLS:
            names = sections[link][4]
            for at in range(start, start + length, entry):
                name, _, _, section = read("IBBH", at)
                if section == 0 and name:
                    symbols.add(text(names + name))
        elif kind == DYNAMIC:
            names = sections[link][4]
            tags = (read("QQ", at) for at in range(start, start + length, 16))
            libraries |= {text(names + value) for tag, value in tags if tag == NEEDED}
    return symbols, libraries


def mathematical(path: Path) -> set[str]:
    symbols, _ = imports(path)
    plain = {f"{name}{end}" for name in FUNCTIONS for end in ("", "f", "l")}
    # glibc has further names of some, for example __exp_finite.
    return {name for name in symbols if name.removeprefix("__").removesuffix("_finite") in plain}


@pytest.fixture(autouse=True)
def _only_elf() -> None:
    if not sys.platform.startswith("linux"):
        pytest.skip("the symbols of ELF files are read, which this system does not have")


def test_the_library_imports_no_mathematical_functions() -> None:
    path = Path(jostle._core.__file__)
    symbols, libraries = imports(path)
    assert {"memcpy", "PyObject_GetAttr"} <= symbols
    assert mathematical(path) <= set(ALLOWED)
    assert ALLOWED or not any(name.startswith("libm.") for name in libraries)


def test_mathematical_functions_of_another_library_are_found() -> None:
    [other] = Path(np.__file__).parent.rglob("_multiarray_umath.*so")
    assert {"exp", "hypot"} <= mathematical(other)
