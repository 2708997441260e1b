"""Check that terms which the project has replaced do not come back: `python docs/check_words.py`.

CONTRIBUTING.md asks for plain technical English in the terms of the field. Each row below is a
regular expression (whole words, any case, across line breaks) and its replacement. Identifiers are
checked, too: `deeds` is found in `session.deeds`, but not in `indeed`.
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
SOURCES = ("*.rs", "*.py", "*.pyi", "*.md", "*.toml")
EXEMPT = ("docs/check_words.py", "tests/test_words.py")  # they name the words

EVERYWHERE = {
    r"beside the window": "on a worker thread",
    r"_?deeds?": "command",
    r"hands": "Interaction; references, parameters",
    r"backdrop": "background rendering",
    r"under way": "in progress, current",
    r"give up|gives up": "cancel, discard",
    r"let go of|lets go": "release",
    r"a person": "the user",
    r"once more": "again",
    r"next to nothing": "almost no time",
    r"ways to come": "swept bounds",
    r"what comes of it": "its result",
    r"lean(?:s|ing)? on": "rest on, resting contact",
    r"are as far": "at equal distances",
    r"what hangs together": "island (disjoint-set union)",
    r"what leans|leaning on": "resting contact",
    r"softly started": "warm starting",
    r"short way": "minimum image",
    r"are as air": "are ignored",
    r"who is near": "neighbours",
    r"what it may get to": "bounds",
    r"speeds die away": "linear damping coefficient",
    r"share of its speed": "coefficient of restitution",
    r"living space": "dynamic index",
    r"pictures a second": "FPS",
    r"what the colours tell": "colour by",
    r"waits for nothing": "never blocks",
    r"come what may": "in any case",
    r"push apart": "position correction, separate",
    r"the seam": "periodic boundary",
    r"nobody sees": "hidden, without a display",
    r"can(?:not)? be had": "is (not) available",
    r"on the way|on its way|in its way": "along the path",
    r"their way": "their displacement",
    r"in no way": "out of range",
}

# Words that other parts of the project still contain, or use in another sense. A folder is added
# to APP or TEXTS when it is clean; a word moves to EVERYWHERE when all folders are.
IN_APP = {
    r"(?<!resize_)grip": "drag state",
    r"beads": "discs of a wall",
    r"(?:any|some|every)body": "the user, the caller",
    r"is gone|are gone": "does not exist",
    r"asked for|asks for": "requested",
    r"frames a second|steps a second|ms a step": "per second, per step",
    r"told apart|tells apart": "distinguished, significantly different",
    r"the last half minute": "rewind, the last 30 s",
}
APP = ("python/jostle/app/", "python/jostle/tune/", "python/jostle/bench/", "python/jostle/cli/")

IN_TEXTS = {
    r"anew": "again",
    r"asks for|asked for": "requires, requests",
    r"(?:any|some|every)body|nobody|whoever": "the user, the caller",
    r"told apart|tells apart": "distinguished, significantly different",
    r"is gone|are gone": "does not exist",
    r"goes on|go on": "continues",
    r"gives? back": "returns",
    r"cut to whole": "truncated to",
    r"world of its own": "a separate world",
    r"who is|who are": "which",
    r"living": "dynamic",
}
"""Words that the core and its tests still contain."""
TEXTS = (
    *("README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/", "examples/"),
    *(f"python/jostle/{name}" for name in ("__init__", "_core.pyi", "arcade", "article", "pygame")),
    *(f"python/jostle/{name}" for name in ("pyqtree", "results", "scenes", "sprites", "walls")),
    "benchmarks/",
)


class Words:
    """Expressions and their replacements, found in one pass over a text."""

    def __init__(self, words: dict[str, str]) -> None:
        spaces = (
            r"(?:[ \t]*\n[ \t]*(?:///?!?|#|\"|>)?[ \t]*| )"  # or a line break and a comment sign
        )
        either = "|".join(f"({word.replace(' ', spaces)})" for word in words)
        self.pattern = re.compile(rf"(?<![^\W_])(?:{either})(?![^\W_])", re.IGNORECASE)
        self.replacements = list(words.values())

    def findings(self, text: str) -> Iterator[tuple[re.Match[str], str]]:
        """Yield each match and its replacement."""
        for match in self.pattern.finditer(text):
            assert match.lastindex is not None
            yield match, self.replacements[match.lastindex - 1]


WORDS = [(("",), Words(EVERYWHERE)), (APP, Words(IN_APP)), (TEXTS, Words(IN_TEXTS))]
"""Beginnings of the names of files, and the words that must not be in them."""


def findings(name: str, text: str) -> Iterator[str]:
    """Yield a message for each replaced term in a file."""
    for part, words in WORDS:
        for match, replacement in words.findings(text) if name.startswith(part) else ():
            line = text.count("\n", 0, match.start()) + 1
            term = " ".join(match[0].split())
            yield f'{name}:{line}: "{term}" is now: {replacement}'


def files() -> list[str]:
    """Return the names of the checked files, tracked or not yet tracked by git."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", *SOURCES]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    names = set(listed.stdout.splitlines()) - set(EXEMPT)
    return sorted(name for name in names if (ROOT / name).is_file())


def main() -> int:
    """Print all findings; return 1 if there are any."""
    found = [
        message
        for name in files()
        for message in findings(name, (ROOT / name).read_text(encoding="utf-8"))
    ]
    print(*found, sep="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
