"""Check types with mypy and pyright: the library, the examples and the code of the documents.

    python docs/check_types.py

The code of a document is written to a file in target/documents, with the same line numbers, and
an error in that file is reported for the document. pyproject.toml sets how strict each checker is.
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
CODE = ROOT / "target" / "documents"
DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")), ROOT / "examples/README.md"]
CHECKED = ["python/jostle", "lab/jostle_lab", "examples", "tests/docs/typing"]


def code_of(document: str) -> str:
    """Return the Python code of a Markdown text, with the same line numbers."""
    return "".join(f"{line}\n" for line in code_lines(document.splitlines()))


def code_lines(lines: list[str]) -> Iterator[str]:
    """Yield one line for each line: code without its prompts, and an empty line for all else."""
    inside, prompts = False, False
    for number, line in enumerate(lines):
        if line.startswith("```"):
            inside = line == "```python"
            prompts = any(">>>" in later for later in until_fence(lines[number + 1 :]))
            yield ""
        elif inside and prompts:
            match = re.match(r"(?:>>>|\.\.\.)(?: |$)", line)
            yield line[match.end() :] if match else ""
        else:
            yield line if inside else ""


def until_fence(lines: list[str]) -> Iterator[str]:
    """Yield the lines up to the end of a block."""
    for line in lines:
        if line.startswith("```"):
            return
        yield line


def extract() -> dict[str, str]:
    """Write the code of all documents; return the document's name for the name of each file."""
    CODE.mkdir(parents=True, exist_ok=True)
    for file in CODE.glob("*.py"):
        file.unlink()
    names = {}
    for document in DOCUMENTS:
        name = document.relative_to(ROOT).as_posix()
        if code := code_of(document.read_text(encoding="utf-8")).rstrip():
            file = CODE / (name.removesuffix(".md").replace("/", "_") + ".py")
            file.write_text(code + "\n", encoding="utf-8")
            names[file.relative_to(ROOT).as_posix()] = name
    return names


def main() -> int:
    """Run both checkers at the same time, and print their output."""
    names = extract()
    mypy = [sys.executable, "-m", "mypy", *CHECKED, *names]
    pyright = [sys.executable, "-m", "basedpyright", "--warnings"]
    running = [
        subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
        for command in (mypy, pyright)
    ]
    for process in running:
        said = process.communicate()[0].replace(f"{ROOT}/", "")
        for file, document in names.items():
            said = said.replace(file, document)
        print(said, end="")
    return max(process.returncode for process in running)


if __name__ == "__main__":
    sys.exit(main())
