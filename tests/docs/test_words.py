"""The check for replaced words: what it finds, and that the repository passes."""

from __future__ import annotations

from pathlib import Path

import check_words
import pytest

ROOT = Path(__file__).parents[2]

APP_FILE = "python/jostle/app/session.py"


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("The rest is as it was.\nThe others are as air.", 2),
        ("/// What hangs\n/// together.", 1),
        ("# Pictures a\n# second", 1),
        ("# What the colours tell", 1),
        ("/// The wall on the way.", 1),
    ],
)
def test_a_replaced_term_is_found_everywhere(text: str, line: int) -> None:
    (found,) = check_words.findings("crates/jostle/src/lib.rs", text)
    assert found.startswith(f"crates/jostle/src/lib.rs:{line}: ") and " is now: " in found


@pytest.mark.parametrize("text", ["session.deeds", "_deeds = 1", "Beside the window", "DEED"])
def test_identifiers_and_any_case_are_found(text: str) -> None:
    for name in (APP_FILE, "README.md", "crates/jostle/src/lib.rs"):
        assert len(list(check_words.findings(name, text))) == 1


@pytest.mark.parametrize(
    ("text", "inside", "outside"),
    [
        ("nobody", APP_FILE, "tests/signals.py"),
        ("built anew", "docs/physics.md", "crates/jostle/src/lib.rs"),
    ],
)
def test_some_terms_are_allowed_in_some_folders(text: str, inside: str, outside: str) -> None:
    assert len(list(check_words.findings(inside, text))) == 1
    assert not list(check_words.findings(outside, text))


@pytest.mark.parametrize("text", ["indeed", "shortway", "Col_.resize_grip", "a push", "seams"])
def test_other_words_are_not_found(text: str) -> None:
    assert not list(check_words.findings(APP_FILE, text))


def test_the_repository_passes() -> None:
    try:
        names = check_words.files()
    except (OSError, check_words.subprocess.CalledProcessError):
        pytest.skip("there is no git to ask for the files of the repository")
    assert "python/jostle/cli/commands.py" in names and "ARCHITECTURE.md" in names
    assert check_words.main() == 0
