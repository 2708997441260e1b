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
}

# Words that other parts of the project still contain, or use in another sense. A folder is added
# to APP when it is clean; a word moves to EVERYWHERE when all folders are.
IN_APP = {
    r"beside the window": "on a worker thread",
    r"_?deeds?": "command",
    r"(?<!resize_)grip": "drag state",
    r"beads": "discs of a wall",
    r"backdrop": "background rendering",
    r"under way": "in progress, current",
    r"give up|gives up": "cancel, discard",
    r"let go of|lets go": "release",
    r"(?:any|some|every)body": "the user, the caller",
    r"a person": "the user",
    r"is gone|are gone": "does not exist",
    r"asked for|asks for": "requested",
    r"frames a second|steps a second|ms a step": "per second, per step",
    r"told apart|tells apart": "distinguished, significantly different",
    r"the last half minute": "rewind, the last 30 s",
    r"once more": "again",
}
APP = ("python/jostle/app/", "python/jostle/tune/", "python/jostle/bench/", "python/jostle/cli.py")


def compiled(words: dict[str, str]) -> list[tuple[re.Pattern[str], str]]:
    """Return the expressions, which match any white space and comment sign for a space."""
    return [
        (re.compile(rf"(?<![^\W_])(?:{word.replace(' ', spaces)})(?![^\W_])", re.I), replacement)
        for word, replacement in words.items()
        for spaces in [r"(?:[ \t]*\n[ \t]*(?:///?!?|#|\"|>)?[ \t]*| )"]
    ]


PATTERNS = compiled(EVERYWHERE)
APP_PATTERNS = compiled(IN_APP)


def findings(name: str, text: str) -> Iterator[str]:
    """Yield a message for each replaced term in a file."""
    patterns = PATTERNS + (APP_PATTERNS if name.startswith(APP) else [])
    for pattern, replacement in patterns:
        for match in pattern.finditer(text):
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
