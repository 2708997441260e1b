"""What every test stands on: no window, no sound, property tests that can be repeated."""

import os

from hypothesis import settings

# Set before any test imports a window library.
os.environ["SDL_VIDEODRIVER"] = "offscreen"
os.environ["SDL_AUDIODRIVER"] = "dummy"
os.environ["PYGAME_HIDE_SUPPORT_PROMPT"] = "1"
os.environ["ARCADE_HEADLESS"] = "True"

# Times on a shared machine vary too much for a deadline.
settings.register_profile("here", deadline=None, print_blob=True)
# A failure there must come from the change at hand, so every run draws the same examples.
settings.register_profile("ci", parent=settings.get_profile("here"), derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "here")
