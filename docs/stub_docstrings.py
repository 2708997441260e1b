"""Copy the docstrings of the compiled module into its stub, where editors read them.

    python docs/stub_docstrings.py          writes python/jostle/_core.pyi
    python docs/stub_docstrings.py --check  fails if the stub is out of date

The docstrings are written in crates/jostle-py, so the wheel has to be built and installed first
(make setup). Of several overloads only the first has the docstring: editors show it for all.
"""

from __future__ import annotations

import ast
import inspect
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

STUB = Path(__file__).parents[1] / "python" / "jostle" / "_core.pyi"

Definition: TypeAlias = "ast.ClassDef | ast.FunctionDef"


class Edit(NamedTuple):
    """Characters of the stub and what takes their place."""

    start: int
    end: int
    text: str


def with_docstrings(stub: str, module: object) -> str:
    """Return the text of a stub with the docstrings of a module in place of its own."""
    line_starts = [0]
    for line in stub.splitlines(keepends=True):
        line_starts.append(line_starts[-1] + len(line))
    edits = [
        edited(stub, line_starts, definition, docstring)
        for definition, docstring in definitions(ast.parse(stub).body, module)
        if docstring != clean(ast.get_docstring(definition))
    ]
    for edit in reversed(edits):
        stub = stub[: edit.start] + edit.text + stub[edit.end :]
    return stub


def definitions(body: list[ast.stmt], owner: Any) -> Iterator[tuple[Definition, str]]:
    """Yield the public classes and functions of a stub, each with the docstring it should have."""
    previous = ""
    for node in body:
        if not isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            continue
        is_first, previous = node.name != previous, node.name
        # In the stub alone, for the classes that have these methods.
        if node.name in ("_Queries", "_ShapeQueries"):
            yield from definitions(node.body, owner.Quadtree)
            continue
        thing = inspect.getattr_static(owner, node.name, None)
        if isinstance(thing, staticmethod):  # its own docstring is that of the type
            thing = thing.__func__
        if node.name.startswith("_") or thing is None:
            continue
        yield node, clean(thing.__doc__) if is_first else ""
        if isinstance(node, ast.ClassDef):
            yield from definitions(node.body, thing)


def clean(docstring: str | None) -> str:
    """Return a docstring without indentation and without spaces at the ends of lines."""
    return "\n".join(map(str.rstrip, inspect.cleandoc(docstring or "").splitlines()))


def edited(stub: str, line_starts: list[int], definition: Definition, docstring: str) -> Edit:
    """Return the edit that gives a definition this docstring, or takes away the one it has."""
    first, *rest = definition.body
    start, end = span(first, line_starts, stub)
    before = len(stub[:start].rstrip())  # after the colon
    indent = "\n" + " " * (definition.col_offset + 4)
    if ast.get_docstring(definition) is None and not is_ellipsis(first):
        return Edit(before, before, indent + quoted(docstring, indent) + "\n")
    if docstring:
        return Edit(before, end, indent + quoted(docstring, indent))
    return Edit(before, end, "" if rest else " ...")


def span(node: ast.stmt, line_starts: list[int], stub: str) -> tuple[int, int]:
    """Return where a statement begins, decorators included, and where it ends."""
    decorators = getattr(node, "decorator_list", [])
    line = min([node.lineno, *(decorator.lineno for decorator in decorators)])
    assert node.end_lineno is not None and node.end_col_offset is not None
    return (
        line_starts[line - 1] + characters(stub, line_starts[line - 1], node.col_offset),
        line_starts[node.end_lineno - 1]
        + characters(stub, line_starts[node.end_lineno - 1], node.end_col_offset),
    )


def characters(stub: str, start: int, count: int) -> int:
    """Return how many characters the first `count` bytes of a line are: ast counts in UTF-8."""
    line = stub[start:].partition("\n")[0]
    return len(line.encode()[:count].decode())


def is_ellipsis(node: ast.stmt) -> bool:
    """Whether a statement is `...`."""
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and node.value.value is ...
    )


def quoted(docstring: str, indent: str) -> str:
    """Return a docstring as Python source; `indent` is a line break and the spaces after it."""
    text = docstring.replace("\\", r"\\").replace('"""', r"\"\"\"")
    if text.endswith('"'):
        text = text[:-1] + r"\""
    lines = text.split("\n")
    body = "\n".join([lines[0], *(line and indent[1:] + line for line in lines[1:])])
    return f'"""{body}"""' if len(lines) == 1 else f'"""{body}{indent}"""'


def main() -> int:
    """Write the stub, or report that it is out of date."""
    import jostle._core

    old = STUB.read_text(encoding="utf-8")
    new = with_docstrings(old, jostle._core)
    if "--check" in sys.argv[1:]:
        if new != old:
            print(f"The docstrings of {STUB.name} are out of date: run docs/{Path(__file__).name}")
        return int(new != old)
    STUB.write_text(new, encoding="utf-8")
    subprocess.run([sys.executable, "-m", "ruff", "format", "--quiet", STUB], check=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
