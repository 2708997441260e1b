"""Runs `>>>` examples of a text, for the tests of docstrings and documents."""

import doctest
from typing import Any

import pytest

FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


def run_examples(text: str, names: dict[str, Any], title: str) -> dict[str, Any]:
    """Run the examples of a text; return the names that they define."""
    test = doctest.DocTestParser().get_doctest(text, names, title, None, 0)
    report: list[str] = []
    doctest.DocTestRunner(optionflags=FLAGS).run(test, out=report.append, clear_globs=False)
    if report:
        pytest.fail("".join(report), pytrace=False)
    return test.globs
