"""The stub has the docstrings of the compiled module; type checkers get the code of documents."""

import ast
from pathlib import Path
from types import SimpleNamespace

import check_types
import pytest
import stub_docstrings

import jostle._core

ROOT = Path(__file__).parents[2]

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
    def __len__(self) -> int: ...

def find(what: str = "é") -> int: ...
def private_in_the_stub_alone() -> int: ...
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

        >>> disc.grow(1)
        """
    @overload
    def grow(self, by: str) -> None: ...
    @classmethod
    def unit(cls) -> Self: ...
    def __len__(self) -> int: ...

def find(what: str = "é") -> int:
    """Find "what\""""
def private_in_the_stub_alone() -> int: ...
'''


class Disc:
    """A disc."""

    radius = property(doc="In metres, \\alpha.")

    def grow(self) -> None:
        """Grow.

        >>> disc.grow(1)
        """


def find() -> None:
    """Find "what\""""


MODULE = SimpleNamespace(Disc=Disc, find=find)


def test_the_stub_has_the_docstrings_of_the_compiled_module() -> None:
    stub = stub_docstrings.STUB.read_text(encoding="utf-8")
    expected = stub_docstrings.with_docstrings(stub, jostle._core)
    assert stub == expected, "run: .venv/bin/python docs/stub_docstrings.py"
    first = next(node for node in ast.parse(stub).body if getattr(node, "name", "") == "find_pairs")
    assert ast.get_docstring(first) == jostle.find_pairs.__doc__


def test_docstrings_take_the_place_of_those_in_a_stub() -> None:
    assert stub_docstrings.with_docstrings(STUB, MODULE) == COMPLETE


def test_a_docstring_that_was_removed_is_removed_from_the_stub() -> None:
    bare = SimpleNamespace(Disc=SimpleNamespace(__doc__=None, grow=Disc.grow), find=find)
    stub = stub_docstrings.with_docstrings(COMPLETE, bare)
    assert "A disc." not in stub
    assert ast.parse(stub)


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
