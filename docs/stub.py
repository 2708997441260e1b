"""Write the stub of the compiled module, from which editors show docstrings: `python docs/stub.py`.

    python docs/stub.py          writes python/jostle/_core.pyi
    python docs/stub.py --check  fails if it is out of date

Signatures are written by hand, in the stub itself. Docstrings are written in crates/jostle-py and
copied, so the wheel has to be built and installed first (make setup). The copies omit the sections
in `LEFT_OUT`: links do not work in a hover text, and help(), IPython and the documents show
everything. Those of internal functions are their first paragraph. Of several overloads only the
first has the docstring, which editors show for all. Signatures and paragraphs are filled to
`WIDTH` columns, so `ruff format` leaves the stub alone.
"""

from __future__ import annotations

import ast
import inspect
import re
import sys
import textwrap
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any, TypeAlias

STUB = Path(__file__).parents[1] / "python" / "jostle" / "_core.pyi"
WIDTH = 120
LEFT_OUT = {"See Also", "References", "Examples"}
ENTRIES = {"Parameters", "Attributes", "Returns", "Yields", "Raises"}
"""Sections of names and types, each with an indented description."""

Definition: TypeAlias = "ast.ClassDef | ast.FunctionDef"


class Writer:
    """Writes a stub again, with the docstrings of a module; those of `short` are one paragraph."""

    def __init__(self, stub: str, module: Any, short: Collection[str] = ()) -> None:
        self.source = stub.splitlines()
        self.tree = ast.parse(stub)
        self.module = module
        self.short = short
        self.lines: list[str] = []

    def text(self) -> str:
        """Return the whole text."""
        self.write_body(self.tree.body, self.module, 0, 0)
        return "\n".join(self.lines) + "\n"

    def write_body(self, body: list[ast.stmt], owner: Any, last: int, depth: int) -> None:
        """Write statements at this indentation; `last` is the last line before them."""
        previous = ""
        for node in body:
            self.write_between(self.source[last : first_line(node) - 1])
            last = node.end_lineno or 0
            if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
                is_first, previous = node.name != previous, node.name
                self.write_definition(node, owner, is_first, depth)
            else:
                self.lines += packed("\n".join(self.source[first_line(node) - 1 : last]), depth)

    def write_between(self, lines: list[str]) -> None:
        """Write the comments before a statement, and one empty line for several."""
        for line in lines:
            if line.strip() or (self.lines and self.lines[-1]):
                self.lines.append(line.rstrip())

    def write_definition(self, node: Definition, owner: Any, is_first: bool, depth: int) -> None:
        """Write a class or a function of what the owner stands for."""
        thing = compiled(node.name, owner, self.tree)
        own = (ast.get_docstring(node) or "").rstrip()
        docstring = own
        if thing is not None and not node.name.startswith("_"):
            docstring = shown(thing.__doc__) if is_first else ""
        if node.name in self.short:
            docstring = docstring.partition("\n\n")[0]
        members = [one for one in node.body[bool(own) :] if not is_ellipsis(one)]
        is_empty = not docstring and not members
        self.lines += [" " * depth + "@" + ast.unparse(one) for one in node.decorator_list]
        self.lines += packed(self.header(node) + " ..." * is_empty, depth)
        self.lines += quoted(docstring, depth + 4) if docstring else []
        if members:
            last = node.body[0].end_lineno if own else first_line(members[0]) - 1
            if docstring and not own:
                self.lines.append("")
            self.write_body(members, thing, last or 0, depth + 4)

    def header(self, node: Definition) -> str:
        """Return the source of a definition up to its colon, without decorators."""
        first = node.body[0]
        lines = self.source[node.lineno - 1 : first_line(first)]
        is_decorated = bool(decorators(first))
        lines[-1] = "" if is_decorated else lines[-1].encode()[: first.col_offset].decode()
        return "\n".join(lines).rstrip()


def decorators(node: ast.stmt) -> list[ast.expr]:
    """Return the decorators of a statement, if it can have some."""
    found: list[ast.expr] = getattr(node, "decorator_list", [])
    return found


def first_line(node: ast.stmt) -> int:
    """Return the number of the line where a statement begins, decorators included."""
    return min([node.lineno, *(one.lineno for one in decorators(node))])


def compiled(name: str, owner: Any, tree: ast.Module) -> Any:
    """Return what a name of the stub stands for, or None if it is in the stub alone.

    A class in the stub alone has the members that several compiled classes share; the first of
    these stands for it.
    """
    thing = inspect.getattr_static(owner, name, None)
    if isinstance(thing, staticmethod):  # its own docstring is that of the type
        return thing.__func__
    if thing is not None:
        return thing
    users = sharing(name, tree)
    return inspect.getattr_static(owner, users[0], None) if users else None


def sharing(name: str, tree: ast.Module) -> list[str]:
    """Return the compiled classes that have the members of a class in the stub alone."""
    found = []
    for node in tree.body:
        if isinstance(node, ast.ClassDef) and name in map(ast.unparse, node.bases):
            found += sharing(node.name, tree) if node.name.startswith("_") else [node.name]
    return found


def is_ellipsis(node: ast.stmt) -> bool:
    """Whether a statement is `...`."""
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and node.value.value is ...
    )


# ---- signatures ----


def packed(text: str, depth: int) -> list[str]:
    """Return a statement with as many arguments or operands in a line as fit."""
    if "\n" not in text and len(" " * depth + text.strip()) <= WIDTH:
        return [" " * depth + text.strip()]
    flat = re.sub(r"\s*\n\s*", " ", text.strip())
    flat = re.sub(r"([(\[{]) ", r"\1", flat)
    flat = re.sub(r",? ([)\]}])", r"\1", flat)
    is_union = bool(re.search(r"^\w+: TypeAlias = \(", flat))
    bare = re.sub(r" = \((.*)\)$", r" = \1", flat) if is_union else flat
    if depth + len(bare) <= WIDTH:
        return [" " * depth + bare]
    further = " " * (depth + (8 if flat.endswith((":", "...")) else 4))
    lines = [" " * depth]
    for number, part in enumerate(parts(flat, "|" if is_union else ",")):
        if number and len(lines[-1]) + len(part.rstrip()) > WIDTH:
            lines.append(further)
        lines[-1] += part
    return [line.rstrip() for line in lines]


def parts(flat: str, mark: str) -> list[str]:
    """Split a statement after each comma, or before each |, within its outer brackets."""
    found, depth, inside = [""], 0, ""
    for i, character in enumerate(flat):
        ends = flat[i - 2 : i] == ", " if mark == "," else character == mark
        if ends and depth == 1 and not inside:
            found.append("")
        found[-1] += character
        inside = quote_after(inside, character)
        depth += 0 if inside else (character in "([{") - (character in ")]}")
    return found


def quote_after(inside: str, character: str) -> str:
    """Return the quotation mark of the string that goes on after a character, or nothing."""
    if inside:
        return "" if character == inside else inside
    return character if character in "\"'" else ""


# ---- docstrings ----


def shown(docstring: str | None) -> str:
    """Return a docstring without the sections that are left out."""
    lines = [line.rstrip() for line in inspect.cleandoc(docstring or "").splitlines()]
    kept, section = [], ""
    for line, following in zip(lines, [*lines[1:], ""], strict=False):
        if is_underline(following) and line and not line.startswith(" "):
            section = line
        if section not in LEFT_OUT:
            kept.append(line)
    return "\n".join(kept).rstrip()


def is_underline(line: str) -> bool:
    """Whether a line underlines the heading of a section."""
    return bool(re.fullmatch(r"-{3,}", line))


def quoted(docstring: str, depth: int) -> list[str]:
    """Return the lines of a docstring as Python source, each paragraph filled."""
    text = docstring.replace("\\", r"\\").replace('"""', r"\"\"\"")
    if text.endswith('"'):
        text = text[:-1] + r"\""
    lines = list(filled(text.split("\n"), depth))
    lines[0] = '"""' + lines[0]
    if depth + len(lines[-1]) + 3 <= WIDTH:
        lines[-1] += '"""'
    else:
        lines.append('"""')
    return [" " * depth + line if line else "" for line in lines]


def filled(lines: list[str], depth: int) -> Iterator[str]:
    """Yield the lines of a docstring with filled paragraphs; headings, names and code stay."""
    section, paragraph = "", ""
    is_start = True
    for line, following in zip(lines, [*lines[1:], ""], strict=True):
        is_heading = bool(line) and is_underline(following)
        section = line if is_heading else section
        stays = not line or is_heading or is_underline(line) or is_entry(line, following, section)
        same = paragraph and indentation(line) == indentation(paragraph)
        if paragraph and (stays or not same):
            yield from wrapped(paragraph, depth, is_start)
            paragraph, is_start = "", False
        if stays:
            yield line
            is_start = False
        else:
            paragraph = f"{paragraph} {line.strip()}" if paragraph else line
    if paragraph:
        yield from wrapped(paragraph, depth, is_start)


def is_entry(line: str, following: str, section: str) -> bool:
    """Whether a line is a name, with a type or without, above its description, or is code."""
    if section == "Examples":
        return True
    return section in ENTRIES and indentation(following) > indentation(line)


def indentation(line: str) -> int:
    return len(line) - len(line.lstrip())


def wrapped(paragraph: str, depth: int, is_start: bool) -> list[str]:
    """Return the lines of a paragraph, no literal on two of them and none like a list item."""
    text = re.sub(r"(``[^`]+``|`[^`]+`)", lambda found: found[0].replace(" ", "\0"), paragraph)
    text = re.sub(r" (?=(?:[-+*|#]|\d+[.)])(?: |$))", "\0", text)
    indent = " " * indentation(paragraph)
    lines = textwrap.wrap(
        text.strip(),
        WIDTH - depth,
        initial_indent=indent + "   " * is_start,
        subsequent_indent=indent,
        break_long_words=False,
        break_on_hyphens=False,
    )
    lines[0] = lines[0][3 * is_start :]
    return [line.replace("\0", " ") for line in lines]


def internal(module: Any) -> set[str]:
    """Return the functions of a module that neither `jostle` nor `jostle.scenes` has."""
    import jostle
    import jostle.scenes

    public = {id(thing) for one in (jostle, jostle.scenes) for thing in vars(one).values()}
    functions = {name: thing for name, thing in vars(module).items() if inspect.isroutine(thing)}
    return {name for name, thing in functions.items() if id(thing) not in public}


def main() -> int:
    """Write the stub, or report that it is out of date."""
    import jostle._core

    old = STUB.read_text(encoding="utf-8")
    new = Writer(old, jostle._core, internal(jostle._core)).text()
    if "--check" in sys.argv[1:]:
        if new != old:
            print(f"{STUB.name} is out of date: run python docs/{Path(__file__).name}")
        return int(new != old)
    STUB.write_text(new, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
