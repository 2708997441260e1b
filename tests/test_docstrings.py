"""Every public name says what it is, and every example in the documentation is true."""

import doctest
import inspect
import re
from collections.abc import Iterator
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import GetSetDescriptorType, MemberDescriptorType, ModuleType
from typing import Any

import numpy as np
import pytest

import jostle
import jostle.article
import jostle.pyqtree
import jostle.scenes

ROOT = Path(__file__).parents[1]
DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
# Adapters are there where the library is that they adapt to.
ADAPTERS = {"jostle.pygame": "pygame", "jostle.arcade": "arcade"}
MODULES = [
    *(jostle, jostle.scenes, jostle.life, jostle.article, jostle.pyqtree),
    *(import_module(name) for name, needed in ADAPTERS.items() if find_spec(needed)),
]


def public_things(module: ModuleType) -> Iterator[tuple[str, Any]]:
    """Yields (dotted name, object) for a module, its functions and classes, and their members."""
    yield module.__name__, module
    for name in module.__all__:
        thing = getattr(module, name)
        if inspect.isclass(thing) or inspect.isroutine(thing):
            yield f"{module.__name__}.{name}", thing
        if inspect.isclass(thing):
            for member, value in sorted(vars(thing).items(), key=lambda item: item[0]):
                if not member.startswith("_") and is_property_or_method(value, thing):
                    yield f"{module.__name__}.{name}.{member}", value


def is_property_or_method(member: Any, owner: type) -> bool:
    """Fields of tuples and slots are neither: the docstring of their class speaks for them."""
    if isinstance(member, MemberDescriptorType):
        return not hasattr(owner, "__slots__")
    kinds = (property, GetSetDescriptorType, staticmethod, classmethod)
    return isinstance(member, kinds) or inspect.isroutine(member)


def own_docstring(thing: Any) -> str:
    """The words that somebody wrote: Python makes up 'Name(field, ...)' for some classes."""
    words = inspect.cleandoc(thing.__doc__ or "")
    made_up = inspect.isclass(thing) and words.startswith(f"{thing.__name__}(")
    return "" if made_up else words


PUBLIC = [
    pytest.param(thing, module, id=name)
    for module in MODULES
    for name, thing in public_things(module)
]
WITH_EXAMPLES = [case for case in PUBLIC if ">>>" in own_docstring(case.values[0])]


def run_examples(text: str, names: dict[str, Any], title: str) -> dict[str, Any]:
    """Runs the `>>>` examples of a text; returns the names that they leave behind."""
    test = doctest.DocTestParser().get_doctest(text, names, title, None, 0)
    report: list[str] = []
    doctest.DocTestRunner(optionflags=FLAGS).run(test, out=report.append, clear_globs=False)
    if report:
        pytest.fail("".join(report), pytrace=False)
    return test.globs


@pytest.mark.parametrize(("thing", "module"), PUBLIC)
def test_public_name_has_a_docstring(thing: Any, module: ModuleType) -> None:
    assert own_docstring(thing)


@pytest.mark.parametrize(("thing", "module"), WITH_EXAMPLES)
def test_examples_of_a_docstring_run(
    thing: Any, module: ModuleType, request: pytest.FixtureRequest
) -> None:
    """An example sees what stands in its own module, and `jostle` and `np` everywhere."""
    names = {**vars(module), "jostle": jostle, "np": np}
    run_examples(own_docstring(thing), names, request.node.callspec.id)


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_python_of_a_document_runs(
    document: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The python blocks of a document run in order, each seeing what those before it left."""
    monkeypatch.chdir(tmp_path)
    text = document.read_text(encoding="utf-8")
    blocks = list(re.finditer(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL))
    assert blocks or document.name not in {"README.md", "which.md"}
    if any("import pygame" in block[1] for block in blocks):
        pytest.importorskip("pygame")
    names: dict[str, Any] = {}
    for block in blocks:
        title = f"{document.name}:{text.count(chr(10), 0, block.start(1)) + 1}"
        if ">>>" in block[1]:
            names = run_examples(block[1], names, title)
        else:
            exec(compile(block[1], title, "exec"), names)
