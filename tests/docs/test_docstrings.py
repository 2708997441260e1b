"""Every public name has a docstring, and the examples of docstrings run."""

import inspect
from collections.abc import Iterator
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import GetSetDescriptorType, MemberDescriptorType, ModuleType
from typing import Any

import numpy as np
import pytest
from class_members import members
from doctests import run_examples

import jostle
import jostle.pyqtree
import jostle.scenes

# Modules that are tested if what they need is installed.
NEEDED = {
    "jostle.pygame": "pygame",
    "jostle.arcade": "arcade",
    "jostle.mesa": "mesa",
    "jostle.mpi": "mpi4py",
    "jostle.record": "imageio_ffmpeg",
}
MODULES = [
    *(jostle, jostle.scenes, jostle.life, jostle.pyqtree),
    *(import_module(name) for name, needed in NEEDED.items() if find_spec(needed)),
]


def public_things(module: ModuleType) -> Iterator[tuple[str, Any]]:
    """Yield (dotted name, object) for a module, its functions and classes, and their members."""
    yield module.__name__, module
    for name in module.__all__:
        thing = getattr(module, name)
        if inspect.isclass(thing) or inspect.isroutine(thing):
            yield f"{module.__name__}.{name}", thing
        if inspect.isclass(thing):
            for member, value in sorted(members(thing).items(), key=lambda item: item[0]):
                if not member.startswith("_") and is_property_or_method(value, thing):
                    yield f"{module.__name__}.{name}.{member}", value


def is_property_or_method(member: Any, owner: type) -> bool:
    """Fields of tuples and slots are neither; the docstring of their class documents them."""
    if isinstance(member, MemberDescriptorType):
        return not hasattr(owner, "__slots__")
    kinds = (property, GetSetDescriptorType, staticmethod, classmethod)
    return isinstance(member, kinds) or inspect.isroutine(member)


def own_docstring(thing: Any) -> str:
    """Return the written docstring; Python generates 'Name(field, ...)' for some classes."""
    text = inspect.cleandoc(thing.__doc__ or "")
    is_generated = inspect.isclass(thing) and text.startswith(f"{thing.__name__}(")
    return "" if is_generated else text


PUBLIC = [
    pytest.param(thing, module, id=name)
    for module in MODULES
    for name, thing in public_things(module)
]
WITH_EXAMPLES = [case for case in PUBLIC if ">>>" in own_docstring(case.values[0])]


def test_functions_classes_methods_and_properties_are_found() -> None:
    names = {case.id for case in PUBLIC}
    assert names >= {"jostle", "jostle.find_pairs", "jostle.World.step", "jostle.World.positions"}
    assert len(WITH_EXAMPLES) > 80


@pytest.mark.parametrize(("thing", "module"), PUBLIC)
def test_public_name_has_a_docstring(thing: Any, module: ModuleType) -> None:
    assert own_docstring(thing)


@pytest.mark.parametrize(("thing", "module"), WITH_EXAMPLES)
def test_examples_of_a_docstring_run(
    thing: Any,
    module: ModuleType,
    request: pytest.FixtureRequest,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """An example may use the names of its module, `jostle` and `np` without importing them."""
    monkeypatch.chdir(tmp_path)  # examples write files
    names = {**vars(module), "jostle": jostle, "np": np}
    run_examples(own_docstring(thing), names, request.node.callspec.id)
