"""The documents: their Python code runs, and what they link to or name exists."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from doctests import run_examples

ROOT = Path(__file__).parents[2]
PAGES = {
    path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8")
    for path in [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("examples/*.md")]
}
# ```py marks code that needs a library which is not installed here.
BLOCK = re.compile(r"^```(python)\n(.*?)^```", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"^```.*?^```|`[^`\n]*`", re.MULTILINE | re.DOTALL)
WITH_CODE = sorted(name for name, text in PAGES.items() if BLOCK.search(text))
TEACHING = ("adapters", "article", "physics", "pygame", "pymunk", "quadtree", "which")
MUST_HAVE_CODE = {"README.md", *(f"docs/{name}.md" for name in TEACHING)}
NAMED_TEST = re.compile(r"`((?:tests|crates)/[\w/]+\.(?:py|rs))::(\w+)`")


def test_the_pages_that_teach_the_library_have_code() -> None:
    assert set(WITH_CODE) >= MUST_HAVE_CODE


@pytest.mark.parametrize("name", WITH_CODE)
def test_python_of_a_page_runs(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The blocks of a page run in order; each sees the names that the ones before it define."""
    monkeypatch.chdir(tmp_path)
    text = PAGES[name]
    blocks = list(BLOCK.finditer(text))
    for library in ("pygame", "mesa", "mpi4py"):
        if any(library in block[2] for block in blocks):
            pytest.importorskip(library)
    names: dict[str, Any] = {}
    for block in blocks:
        title = f"{name}:{text.count(chr(10), 0, block.start(2)) + 1}"
        if ">>>" in block[2]:
            names = run_examples(block[2], names, title)
        else:
            exec(compile(block[2], title, "exec"), names)


def anchors(text: str) -> set[str]:
    """Return the anchors of the headings of a page, as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", CODE.sub(keep_inline, text), re.MULTILINE)
    words = (re.sub(r"[^\w\- ]", "", heading.lower()) for heading in headings)
    return {word.replace(" ", "-") for word in words}


def keep_inline(match: re.Match[str]) -> str:
    """Return the text of inline code, and nothing for a block."""
    return "" if match[0].startswith("```") else match[0].strip("`")


def links(text: str) -> Iterator[str]:
    """Yield the targets of links and pictures outside code, without those on the web."""
    for target in re.findall(r"\]\(([^)\s]+)\)", CODE.sub("", text)):
        if "://" not in target:
            yield target


def missing(name: str, text: str) -> list[str]:
    """Return the targets of links that do not exist."""
    wrong = []
    for target in links(text):
        path, _, anchor = target.partition("#")
        page = (ROOT / name).parent / path if path else ROOT / name
        there = page.exists()
        if not there or (anchor and anchor not in anchors(page.read_text(encoding="utf-8"))):
            wrong.append(target)
    return wrong


@pytest.mark.parametrize("name", sorted(PAGES))
def test_links_of_a_page_lead_to_files_and_headings(name: str) -> None:
    assert missing(name, PAGES[name]) == []


def test_a_wrong_link_is_found() -> None:
    text = "[a](physics.md#no-such-heading) [b](nothing.md) [c](physics.md#walls) `[d](e.md)`"
    assert missing("docs/which.md", text) == ["physics.md#no-such-heading", "nothing.md"]


def test_every_page_can_be_reached_from_the_readme_and_every_picture_is_shown() -> None:
    reached, waiting = set(), ["README.md"]
    while waiting:
        name = waiting.pop()
        if name in PAGES and name not in reached:
            reached.add(name)
            for target in links(PAGES[name]):
                page = ((ROOT / name).parent / target.partition("#")[0]).resolve()
                waiting.append(page.relative_to(ROOT.resolve()).as_posix())
    assert set(PAGES) - reached == set()
    shown = {Path(target).name for text in PAGES.values() for target in links(text)}
    assert {path.name for path in (ROOT / "docs" / "pictures").iterdir()} <= shown


def test_the_tests_that_pages_name_exist() -> None:
    named = {match.groups() for text in PAGES.values() for match in NAMED_TEST.finditer(text)}
    assert len(named) > 10
    for path, test in named:
        source = (ROOT / path).read_text(encoding="utf-8")
        if path.endswith(".py"):
            functions = {
                node.name for node in ast.parse(source).body if isinstance(node, ast.FunctionDef)
            }
        else:
            functions = set(re.findall(r"^fn (\w+)", source, re.MULTILINE))
        assert test in functions, f"{path}::{test}"
