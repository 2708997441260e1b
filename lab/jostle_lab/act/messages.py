"""The message in the window, and the time of the session."""

from __future__ import annotations

DURATION = 3.0  # seconds that a message is shown


class Messages:
    """Shows one message at a time."""

    def __init__(self) -> None:
        self.now = 0.0  # seconds since the session began
        self._message = "", 0.0  # and when it ends; replaced by threads, never changed

    def say(self, message: str | None) -> None:
        if message:
            self._message = message, self.now + DURATION

    @property
    def current(self) -> str:
        """Return the message to show now, or an empty string."""
        message, end = self._message
        return message if self.now < end else ""
