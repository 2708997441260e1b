"""Running the command in the process of the test."""

import sys

import pytest

from jostle_lab import cli


class Command:
    """Calls the command with arguments, and reads what it prints."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
        self._monkeypatch, self._capsys = monkeypatch, capsys

    def run(self, *arguments: object) -> tuple[int, str, str]:
        """Return the exit code and both outputs."""
        self._monkeypatch.setattr(sys, "argv", ["jostle", *map(str, arguments)])
        with pytest.raises(SystemExit) as end:
            cli.main()
        return int(str(end.value.code)), *self._capsys.readouterr()

    def refuses(self, *arguments: object) -> str:
        """Return the one sentence of a refusal."""
        code, printed, sentence = self.run(*arguments)
        assert (code, printed, sentence.count("\n")) == (2, "", 1)
        assert sentence.startswith("jostle: ")
        return sentence
