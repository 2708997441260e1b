"""The stub has what editors show; type checkers get the code of documents."""

import ast
import inspect
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import check_types
import pytest
import stub

import jostle._core

ROOT = Path(__file__).parents[2]
TEXT = stub.STUB.read_text(encoding="utf-8")

STUB = '''"""A module."""

class Disc:
    @property
    def radius(self) -> float: ...
    @radius.setter
    def radius(self, value: float) -> None: ...
    @overload
    def grow(self, by: int) -> None:
        """Old words."""
    @overload
    def grow(self, by: str) -> None:
        """Stale words."""
    @classmethod
    def unit(cls) -> Self: ...
    __hash__: None  # of no use
    def __len__(self) -> int: ...


# What a name may be.
_Name: TypeAlias = (
    str
    | None
)
def find(
    what: Literal["é", "a, b"] = "é",
    *,
    nearest_to_the_centre: SupportsFloat | None = None,
    maximum_distance: float | None = None,
) -> int: ...
def private_in_the_stub_alone() -> int:
    """Its own words."""
'''

COMPLETE = r'''"""A module."""

class Disc:
    """A disc."""

    @property
    def radius(self) -> float:
        """In metres, \\alpha."""
    @radius.setter
    def radius(self, value: float) -> None: ...
    @overload
    def grow(self, by: int) -> None:
        """Grow.

        Words that are on two lines, up to ``a b`` there.

        Parameters
        ----------
        by : int
            A length, also on two lines.

            inner : int
                Of a result."""
    @overload
    def grow(self, by: str) -> None: ...
    @classmethod
    def unit(cls) -> Self: ...
    __hash__: None  # of no use
    def __len__(self) -> int: ...

# What a name may be.
_Name: TypeAlias = str | None
def find(what: Literal["é", "a, b"] = "é", *, nearest_to_the_centre: SupportsFloat | None = None,
        maximum_distance: float | None = None) -> int:
    """Find "what\""""
def private_in_the_stub_alone() -> int:
    """Its own words."""
'''


class Disc:
    """A disc."""

    radius = property(doc="In metres, \\alpha.")

    def grow(self) -> None:
        """Grow.

        Words that are
        on two lines, up to ``a b`` there.

        Parameters
        ----------
        by : int
            A length,
            also on two lines.

            inner : int
                Of a result.

        See Also
        --------
        find : Find.

        Examples
        --------
        >>> disc.grow(1)
        """


def find() -> None:
    """Find "what\""""


MODULE = SimpleNamespace(Disc=Disc, find=find)


def test_the_stub_is_up_to_date() -> None:
    expected = stub.Writer(TEXT, jostle._core, stub.internal(jostle._core)).text()
    assert expected == TEXT, "run: .venv/bin/python docs/stub.py"


def test_the_stub_is_short() -> None:
    lines = TEXT.splitlines()
    assert len(lines) <= 3500
    assert max(map(len, lines)) <= stub.WIDTH


def test_docstrings_and_layout_of_a_stub() -> None:
    assert stub.Writer(STUB, MODULE).text() == COMPLETE
    assert stub.Writer(COMPLETE, MODULE).text() == COMPLETE


def test_a_docstring_that_was_removed_is_removed_from_the_stub() -> None:
    bare = SimpleNamespace(Disc=SimpleNamespace(__doc__=None, grow=Disc.grow), find=find)
    text = stub.Writer(COMPLETE, bare).text()
    assert "A disc." not in text
    assert ast.parse(text)


def test_of_internal_functions_the_first_paragraph_is_enough() -> None:
    module = SimpleNamespace(find=SimpleNamespace(__doc__="Find.\n\nMore."))
    assert "More" in stub.Writer("def find() -> int: ...", module).text()
    assert "More" not in stub.Writer("def find() -> int: ...", module, {"find"}).text()
    assert {"sprite_pairs", "begin_hash"} <= stub.internal(jostle._core)
    assert not {"find_pairs", "scene_view"} & stub.internal(jostle._core)


class Shown(NamedTuple):
    """A public name of the stub, its docstring there and what the compiled module has."""

    path: str
    nodes: list[stub.Definition]
    compiled: Any


def shown(body: list[ast.stmt], owner: Any, prefix: str = "") -> Iterator[Shown]:
    """Yield public names; a member that classes share is one of each of these classes."""
    named: dict[str, list[stub.Definition]] = {}
    for node in body:
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            named.setdefault(node.name, []).append(node)
    for name, nodes in named.items():
        if not name.startswith("_") and (prefix or name not in stub.internal(jostle._core)):
            thing = inspect.getattr_static(owner, name)
            yield Shown(prefix + name, nodes, getattr(thing, "__func__", thing))
        if isinstance(nodes[0], ast.ClassDef):
            for one in [name] if hasattr(owner, name) else stub.sharing(name, ast.parse(TEXT)):
                yield from shown(nodes[0].body, getattr(owner, one, None), f"{one}.")


def is_in_the_stub_alone(node: ast.stmt) -> bool:
    """Whether a class describes arguments, such as those with the attributes x and y."""
    name = getattr(node, "name", "")
    return name.startswith("_") and not stub.sharing(name, ast.parse(TEXT))


NAMES = list(
    shown(
        [node for node in ast.parse(TEXT).body if not is_in_the_stub_alone(node)],
        jostle._core,
    )
)


def test_public_names_are_found() -> None:
    paths = {name.path for name in NAMES}
    assert paths >= {"find_pairs", "World", "World.step", "World.positions", "scene_view"}
    assert paths >= {"World.raycast", "Walls.raycast", "Box.clip", "Circle.clip"}


@pytest.mark.parametrize("name", NAMES, ids=[name.path for name in NAMES])
def test_an_editor_shows_the_words_of_the_compiled_docstring(name: Shown) -> None:
    """All but the sections that are left out, in lines of another length."""
    here = ast.get_docstring(name.nodes[0])
    assert here
    left = inspect.cleandoc(name.compiled.__doc__)
    for section in ("See Also", "References", "Examples"):
        before, heading, after = left.partition(f"\n{section}\n{'-' * len(section)}\n")
        following = [after.find(f"\n{one}\n---") for one in ("Notes", "References", "Examples")]
        rest = min((found for found in following if found >= 0), default=len(after))
        left = before + after[rest:] if heading else left
    assert here.split() == left.split()


@pytest.mark.parametrize("name", NAMES, ids=[name.path for name in NAMES])
def test_an_editor_shows_every_argument(name: Shown) -> None:
    nodes = name.nodes
    if isinstance(nodes[0], ast.ClassDef):  # its docstring has the arguments of the constructor
        nodes = [
            one
            for one in nodes[0].body
            if isinstance(one, ast.FunctionDef) and one.name == "__new__"
        ]
    lines = (ast.get_docstring(name.nodes[0]) or "").splitlines()
    documented = {
        one
        for line, following in zip(lines, [*lines[1:], ""], strict=True)
        if " : " in line and following.startswith("    ")
        for one in line.partition(" : ")[0].split(", ")
    }
    for node in nodes:
        assert isinstance(node, ast.FunctionDef)
        if not any(ast.unparse(one).endswith(".setter") for one in node.decorator_list):
            arguments = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
            assert {one.arg for one in arguments} - {"self", "cls"} <= documented


DOCUMENT = """# Title

```python
>>> x = 1  # one
>>> for _ in range(x):
...     print(x)
...
1

```

```sh
make
```
```python
def f():
    return x
```
"""


def test_code_of_a_document_keeps_its_line_numbers() -> None:
    lines = check_types.code_of(DOCUMENT).splitlines()
    assert len(lines) == len(DOCUMENT.splitlines())
    code = {number: line for number, line in enumerate(lines, 1) if line}
    assert code == {
        4: "x = 1  # one",
        5: "for _ in range(x):",
        6: "    print(x)",
        16: "def f():",
        17: "    return x",
    }


@pytest.mark.parametrize("document", check_types.DOCUMENTS, ids=lambda path: path.name)
def test_code_of_every_document_is_python(document: Path) -> None:
    text = document.read_text(encoding="utf-8")
    code = check_types.code_of(text)
    assert bool(code.strip()) == ("```python\n" in text)
    compile(code, document.name, "exec")
