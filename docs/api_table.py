"""Write docs/api.md, the table of all public names with their arguments, results and fields.

    python docs/api_table.py          writes docs/api.md
    python docs/api_table.py --check  fails if it is out of date

Arguments and their order come from the library itself, so it has to be built and installed first
(make setup). Results come from the annotations of the stub, and so does whether an attribute can be
assigned.
"""

from __future__ import annotations

import ast
import difflib
import inspect
import math
import re
import sys
from collections.abc import Iterator
from enum import Enum
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import jostle
from jostle.mpi.attributes import Attribute
from jostle.results.base import Result

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "api.md"
STUB = ROOT / "python" / "jostle" / "_core.pyi"
MODULES = ("jostle.life", "jostle.scenes", "jostle.record", "jostle.mpi")

HEAD = """\
# All public names

This page is written by `python docs/api_table.py`; do not edit it. A value after = is the default,
arguments after \\* are given by keyword, ALL is 2³² − 1. Where two results are named, the first is
that for one id or point, the other that for many. Docstrings have types, shapes and units.
"""


def page() -> str:
    """Return the text of the page."""
    things = {name: getattr(jostle, name) for name in jostle.__all__}
    modules = {name: thing for name, thing in things.items() if isinstance(thing, ModuleType)}
    classes = {name: thing for name, thing in things.items() if isinstance(thing, type)}
    functions = things.keys() - modules.keys() - classes.keys() - {"__version__"}
    results = {name for name, thing in classes.items() if issubclass(thing, Result)}
    parts = [
        HEAD,
        table("Functions", (called(f"{name}", things[name]) for name in sorted(functions))),
    ]
    for name, thing in classes.items():
        if name not in results and not issubclass(thing, (Enum, BaseException)):
            parts.append(table(name, members(name, thing)))
    parts.append(table("Results", (fields(classes[name]) for name in sorted(results)), "fields"))
    others = [thing for thing in classes.values() if issubclass(thing, (Enum, BaseException))]
    parts.append(table("Errors and numbers", map(other, others), "values"))
    parts += [module_table(name) for name in MODULES]
    return "\n".join(parts)


def table(title: str, rows: Iterator[tuple[str, str, str]] | Any, second: str = "arguments") -> str:
    """Return a heading and a table below it."""
    lines = ["| " + " | ".join(escaped(cell) for cell in row) + " |" for row in rows]
    return "\n".join(
        [f"## {title}", "", f"| name | {second} | result |", "|---|---|---|", *lines, ""]
    )


def escaped(cell: str) -> str:
    return cell.replace("|", "\\|").replace("  ", " ")


def members(name: str, owner: type) -> Iterator[tuple[str, str, str]]:
    """Yield the constructor, the methods and the attributes of a class, as the stub lists them."""
    constructor = signature(owner)
    if constructor is not None:
        yield f"`{name}`", constructor, ""
    listed = stub_members(name)
    for key, (kind, result) in listed.items():
        thing = inspect.getattr_static(owner, key, None)
        if thing is None:
            continue
        if kind == "method":
            yield f"`.{key}()`", signature(getattr(owner, key)) or "", result
        else:
            yield f"`.{key}`", kind, result


def called(name: str, function: Any) -> tuple[str, str, str]:
    """Return the row of a function."""
    result = STUB_FUNCTIONS.get(name) or annotation(inspect.signature(function).return_annotation)
    return f"`{name}()`", signature(function) or "", result


def fields(kind: type) -> tuple[str, str, str]:
    """Return the row of a class of results: its fields, and what else it has."""
    slots = [name for base in reversed(kind.__mro__) for name in base.__dict__.get("__slots__", ())]
    also = [
        f"`.{name}()`" if callable(getattr(kind, name)) else f"`.{name}`"
        for name in sorted(set(dir(kind)) - set(dir(Result)) - set(slots))
        if not name.startswith("_")
    ]
    shown = [f"`{name}`" for name in slots if not name.startswith("_")]
    return f"`{kind.__name__}`", ", ".join(shown), ", ".join(also)


def other(kind: type) -> tuple[str, str, str]:
    """Return the row of an error or an enumeration."""
    if issubclass(kind, Enum):
        values = ", ".join(f"`{one.name}` {one.value}" for one in kind)
        return f"`{kind.__name__}`", values, ""
    bases = ", ".join(base.__name__ for base in kind.__bases__)
    return f"`{kind.__name__}`", f"a {bases}", ""


def module_table(name: str) -> str:
    """Return the table of a module."""
    module = import_module(name)
    rows = []
    for key in module.__all__:
        thing = getattr(module, key)
        if isinstance(thing, type) and issubclass(thing, Result):
            rows.append(fields(thing))
        elif isinstance(thing, type):
            rows.append((f"`{key}`", signature(thing) or "", ""))
            for method, (kind, result) in python_members(thing).items():
                rows.append((f"`{key}.{method}`", kind, result))
        elif callable(thing):
            rows.append(called(key, thing))
        else:
            rows.append((f"`{key}`", "constant", type(thing).__name__))
    return table(name, rows)


ATTRIBUTES = {
    "Setting": "assignable",
    "Column": "read-only",
    "WallColumn": "assignable",
    "Query": "method of `jostle.World`",
    "WallQuery": "method of `jostle.Walls`",
}
"""What the attributes of distributed worlds are."""


def python_members(owner: type) -> dict[str, tuple[str, str]]:
    """Return the methods and properties of a class in Python: name, arguments or kind, result."""
    found = {}
    for key in sorted(dir(owner)):
        thing = inspect.getattr_static(owner, key)
        if key.startswith("_"):
            continue
        if isinstance(thing, property):
            result = annotation(inspect.signature(thing.fget).return_annotation)
            found[key] = ("assignable" if thing.fset else "read-only", result)
        elif isinstance(thing, Attribute):
            found[key] = (ATTRIBUTES[type(thing).__name__], "")
        elif inspect.isfunction(thing) or isinstance(thing, classmethod):
            called_as = getattr(owner, key)
            result = annotation(inspect.signature(called_as).return_annotation)
            found[f"{key}()"] = (signature(called_as) or "", result)
    return found


def signature(thing: Any) -> str | None:
    """Return the arguments in order with their defaults, without types."""
    try:
        found = inspect.signature(thing)
    except (TypeError, ValueError):
        return None
    shown, only_keywords = [], False
    for one in found.parameters.values():
        if one.name in ("self", "cls"):
            continue
        if one.kind is one.KEYWORD_ONLY and not only_keywords:
            shown.append("\\*")
            only_keywords = True
        only_keywords |= one.kind is one.VAR_POSITIONAL
        star = {one.VAR_POSITIONAL: "\\*", one.VAR_KEYWORD: "\\*\\*"}.get(one.kind, "")
        value = "" if one.default is one.empty else f"={default(one.default)}"
        shown.append(f"{star}{one.name}{value}")
    return ", ".join(shown)


def default(value: object) -> str:
    """Return how a default value is shown."""
    named = {2**32 - 1: "ALL", 2**27: "2²⁷", math.pi / 4: "π/4"}
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return named.get(value, f"{value:.12g}")  # type: ignore[call-overload, no-any-return]
    if isinstance(value, tuple):
        return f"({', '.join(map(default, value))}{',' * (len(value) == 1)})"
    return repr(value).replace("'", '"')


# ---- what the stub says about results ----


def stub_members(name: str) -> dict[str, tuple[str, str]]:
    """Return the public members of a class of the stub, its own first: name, kind, result."""
    node = STUB_CLASSES[name]
    found: dict[str, tuple[str, str]] = {}
    for one in node.body:
        if not isinstance(one, ast.FunctionDef) or one.name.startswith("_"):
            continue
        decorators = {ast.unparse(decorator) for decorator in one.decorator_list}
        if f"{one.name}.setter" in decorators:
            found[one.name] = ("assignable", found[one.name][1])
        elif "property" in decorators:
            found[one.name] = (
                "read-only",
                annotation(ast.unparse(one.returns or ast.Name("None"))),
            )
        else:
            kind, results = found.get(one.name, ("method", ""))
            found[one.name] = (kind, joined(results, ast.unparse(one.returns or ast.Name("None"))))
    for base in node.bases:
        if isinstance(base, ast.Name) and base.id in STUB_CLASSES:
            found = found | {
                key: row for key, row in stub_members(base.id).items() if key not in found
            }
    return found


def joined(results: str, further: str) -> str:
    """Return the results of the overloads so far and of another one, each once."""
    kept = [result for result in results.split(" or ") if result]
    for one in re.split(r" \| (?![^\[]*\])", further):
        text = annotation(one)
        if text not in kept and text != "Any":
            kept.append(text)
    return " or ".join(kept)


def annotation(text: Any) -> str:
    """Return a type as readers say it."""
    if text is inspect.Signature.empty:
        return ""
    text = text if isinstance(text, str) else getattr(text, "__name__", str(text))
    for pattern, said in SAID:
        text = re.sub(pattern, said, text)
    # A forward reference has quotes around it, and a choice of words has them in it.
    return text.strip('"') if text.count('"') == 2 else text


SAID = (
    (r"\b_Pairs\b|\b_Ids\b", "int64 array"),
    (r"\b_Coefficient\b", "float, array or None"),
    (r"\b_Container\b", "Box or Circle"),
    (r"tuple\[_Force, \.\.\.\]", "tuple of forces"),
    (r"NDArray\[(?:np\.)?floating(?:\[Any\])?\]", "array"),
    (r"NDArray\[Any\]", "array"),
    (r"NDArray\[(?:np\.)?(\w+?)_?\]", r"\1 array"),
    (r"Literal\[(.*)\]", lambda found: found[1].replace("'", '"').replace(", ", " or ")),
    (r"\bjostle\.", ""),
    (r" \| ", " or "),
)
"""Annotations, as patterns, and what the page says instead."""


TREE = ast.parse(STUB.read_text(encoding="utf-8"))
STUB_CLASSES = {node.name: node for node in TREE.body if isinstance(node, ast.ClassDef)}
STUB_FUNCTIONS: dict[str, str] = {}
for _node in TREE.body:
    if isinstance(_node, ast.FunctionDef) and _node.returns is not None:
        _so_far = STUB_FUNCTIONS.get(_node.name, "")
        STUB_FUNCTIONS[_node.name] = joined(_so_far, ast.unparse(_node.returns))


def main() -> int:
    """Write the page, or report how it differs."""
    new = page()
    if "--check" not in sys.argv[1:]:
        PAGE.write_text(new, encoding="utf-8")
        return 0
    old = PAGE.read_text(encoding="utf-8")
    lines = difflib.unified_diff(old.splitlines(), new.splitlines(), "docs/api.md", "library", n=0)
    print("\n".join(lines))
    if new != old:
        print(f"{PAGE.name} is out of date: run python docs/{Path(__file__).name}")
    return int(new != old)


if __name__ == "__main__":
    sys.exit(main())
