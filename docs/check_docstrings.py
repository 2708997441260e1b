"""Validate the docstrings of public names with numpydoc: `python docs/check_docstrings.py`.

Every public name of the library and of its adapters is checked: sections and their order,
parameters documented in the order of the signature, each with a type and a description, and what a
function returns. The compiled module has to be built and installed first (make setup). Its
signatures are read from the stub, which says which functions return nothing.
"""

from __future__ import annotations

import ast
import inspect
import os
import sys
from collections.abc import Iterator
from enum import Enum
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import GetSetDescriptorType, MemberDescriptorType, ModuleType
from typing import Any, NamedTuple

from class_members import members
from numpydoc.docscrape import get_doc_object
from numpydoc.validate import ERROR_MSGS, Validator, validate

from jostle.results.base import Result

os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")

ROOT = Path(__file__).parents[1]
STUB = ROOT / "python" / "jostle" / "_core.pyi"
MODULES = [
    *("jostle", "jostle.scenes", "jostle.record", "jostle.pyqtree"),
    *(f"jostle.{name}" for name in ("pygame", "arcade") if find_spec(name)),
    *(["jostle.mpi"] if find_spec("mpi4py") else []),
]

NOT_CHECKED = {
    "GL02": "docstrings of the compiled module have no closing quotes",
    "ES01": "one sentence is enough for many names",
    "SA01": "many names have no related ones",
    "EX01": "properties and results are shown in the examples of what returns them",
    "SS06": "a property says what it is and its shape in one sentence, which may need two lines",
}

NOT_OURS = {
    *(f"jostle.pygame.collide_{name}" for name in ("circle", "circle_ratio", "mask")),
    *("jostle.pygame.collide_rect", "jostle.pygame.collide_rect_ratio"),
    "jostle.arcade.check_for_collision",
}
"""Functions of other libraries, which an adapter exports unchanged."""


class Name(NamedTuple):
    """A public name, and what has it."""

    path: str
    thing: Any
    owner: type | None


class Signature(NamedTuple):
    """The parameters of a function of the stub, and whether it returns anything."""

    parameters: tuple[str, ...]
    returns: bool


class Documented(Validator):  # type: ignore[misc]
    """A name whose signature, if it is compiled, comes from the stub."""

    def __init__(self, name: Name, stub: dict[str, Signature]) -> None:
        super().__init__(get_doc_object(name.thing))
        self.path = name.path
        own = name.path.removeprefix("jostle.")
        compiled = getattr(name.thing, "__module__", None) == "jostle._core" or (
            getattr(name.owner, "__module__", None) == "jostle._core"
        )
        original = getattr(name.thing, "__name__", own) if own.startswith("scenes.") else own
        self.declared = stub.get(original) if compiled else None
        self.is_property = isinstance(name.thing, (property, GetSetDescriptorType))
        self.is_result = inspect.isclass(name.thing) and issubclass(name.thing, Result)

    @property
    def is_function_or_method(self) -> bool:
        return inspect.isroutine(self.obj) or isinstance(self.obj, (classmethod, staticmethod))

    @property
    def signature_parameters(self) -> tuple[str, ...]:
        if self.declared is not None:
            return self.declared.parameters
        if self.is_result:
            return tuple(self.obj.__slots__)
        has_none = self.is_property or (inspect.isclass(self.obj) and issubclass(self.obj, Enum))
        return () if has_none else tuple(super().signature_parameters)

    @property
    def doc_all_parameters(self) -> dict[str, Any]:
        # The fields of a named tuple or a result are its attributes and the arguments of its class.
        has_fields = self.is_result or (inspect.isclass(self.obj) and hasattr(self.obj, "_fields"))
        sections = ["Attributes"] if has_fields else ["Parameters", "Other Parameters"]
        found: dict[str, Any] = self._doc_parameters(sections)
        return found

    @property
    def method_returns_something(self) -> bool:
        if self.declared is not None:
            return self.declared.returns
        return bool(super().method_returns_something)


def public_names(module: ModuleType) -> Iterator[Name]:
    """Yield the functions and classes of a module, and the members of its classes."""
    for name in module.__all__:
        thing = getattr(module, name)
        if not (inspect.isclass(thing) or inspect.isroutine(thing)):
            continue
        yield Name(f"{module.__name__}.{name}", thing, None)
        for member, value in members(thing).items() if inspect.isclass(thing) else ():
            kinds = (property, GetSetDescriptorType, staticmethod, classmethod)
            is_field = isinstance(value, MemberDescriptorType)
            if not member.startswith("_") and not is_field:
                value = getattr(thing, member)
                if isinstance(value, kinds) or inspect.isroutine(value):
                    yield Name(f"{module.__name__}.{name}.{member}", value, thing)


def declared(body: list[ast.stmt], prefix: str = "") -> Iterator[tuple[str, Signature]]:
    """Yield the functions, methods and classes of the stub; `__new__` stands for its class."""
    for node in body:
        if isinstance(node, ast.ClassDef):
            yield from declared(node.body, f"{prefix}{node.name}.")
        elif isinstance(node, ast.FunctionDef) and not is_property(node):
            arguments = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
            names = tuple(argument.arg for argument in arguments if argument.arg not in OWN)
            returns = not (isinstance(node.returns, ast.Constant) and node.returns.value is None)
            name = prefix.removesuffix(".") if node.name == "__new__" else prefix + node.name
            yield name, Signature(names, returns)


OWN = {"self", "cls"}


def is_property(node: ast.FunctionDef) -> bool:
    """Whether a function of the stub is a property or its setter."""
    return any(
        isinstance(decorator, ast.Attribute)
        or (isinstance(decorator, ast.Name) and decorator.id == "property")
        for decorator in node.decorator_list
    )


def findings() -> Iterator[str]:
    """Yield a message for each docstring that breaks a rule."""
    stub = dict(declared(ast.parse(STUB.read_text(encoding="utf-8")).body))
    checks = set(ERROR_MSGS) - set(NOT_CHECKED)
    for module in map(import_module, MODULES):
        for name in public_names(module):
            if name.path in NOT_OURS:
                continue
            result = validate(name, validator_cls=lambda obj_name: Documented(obj_name, stub))
            for code, message in result["errors"]:
                if code in checks:
                    yield f"{name.path}: {code} {message}"


def main() -> int:
    """Print all findings; return 1 if there are any."""
    found = list(findings())
    for message in found:
        print(message)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
