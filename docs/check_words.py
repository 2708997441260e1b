"""Check that terms which the project has replaced do not come back: `python docs/check_words.py`.

CONTRIBUTING.md asks for plain technical English in the terms of the field. Each row below is a
regular expression (whole words, any case, across line breaks) and its replacement; `EXCEPT_IN`
adds the folders in which a word is allowed. Identifiers are checked, too: `deeds` is found in
`session.deeds`, but not in `indeed`.
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
    r"the seam": "periodic boundary",
    r"nobody sees": "hidden, without a display",
    r"can(?:not)? be had": "is (not) available",
    r"on the way|on its way|in its way": "along the path",
    r"their way": "their displacement",
    r"in no way": "out of range",
    r"(?<!resize_)grip": "drag state",
    r"the last half minute": "rewind, the last 30 s",
    r"told apart|tells apart": "distinguished, significantly different",
    r"asked for|asks for": "requires, requests",
    r"gives? back": "returns",
    r"cut to whole": "truncated to",
    r"world of its own": "a separate world",
    r"who is|who are": "which",
    r"push(?:es|ed|ing)? (?:\w+ )?apart": "position correction, separate",
    r"(?<!=)not movable": "immovable: static or kinematic",
    r"look(?:s|ing)? for": "search for",
    r"questions? (?:to|of)": "query",
    r"at wall": "wall contact",
    r"(?:a little|lose) way|never speed": "displacement",
    r"waits? for none": "never blocks",
    r"to and fro": "back and forth",
}

CORE, APP = "crates/jostle/", "python/jostle/app/"
TESTS = ("crates/jostle/tests/", "tests/")

UNITS = "ns|µs|ms|bytes|nanoseconds|milliseconds|frames|steps"
EXCEPT_IN: dict[str, tuple[str, tuple[str, ...]]] = {
    # Comments in these folders still contain them and are to be changed.
    r"anew": ("again", (CORE, APP, *TESTS)),
    r"goes on|go on": ("continues", (CORE, *TESTS)),
    rf"(?:{UNITS}) an? (?:second|step|frame|disc|shape)": ("per second, per step", (CORE, *TESTS)),
    r"order of the tree": ("Morton order", (CORE,)),
    # Identifiers in these folders contain them.
    r"(?:any|some|every)body|nobody|whoever": ("the user, the caller", TESTS),
    r"(?:is|are) gone": ("does not exist", TESTS),
    r"living": ("dynamic", (APP, *TESTS)),
    r"meetings?": ("time of impact", (CORE,)),
    # Constants and variables of the scenes are named so.
    r"beads": ("discs of a wall", (CORE, *TESTS)),
}
"""Words, their replacements, and the beginnings of the names of files in which they are allowed."""

#: A space, or a line break and a comment sign.
SPACE = r"(?:[ \t]*\n[ \t]*(?:///?!?|#|\"|>)?[ \t]*| )"

WORDS = {**{word: (instead, ()) for word, instead in EVERYWHERE.items()}, **EXCEPT_IN}
REPLACEMENTS = list(WORDS.values())
EITHER = "|".join(f"({word.replace(' ', SPACE)})" for word in WORDS)
PATTERN = re.compile(rf"(?<![^\W_])(?:{EITHER})(?![^\W_])", re.IGNORECASE)


def findings(name: str, text: str) -> Iterator[str]:
    """Yield a message for each replaced term in a file."""
    for match in PATTERN.finditer(text):
        assert match.lastindex is not None
        instead, folders = REPLACEMENTS[match.lastindex - 1]
        if not name.startswith(folders):
            line = text.count("\n", 0, match.start()) + 1
            yield f'{name}:{line}: "{" ".join(match[0].split())}" is now: {instead}'


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
