"""The tests of physics, which run small worlds for long."""

import pytest


@pytest.fixture(autouse=True)
def _usual_threads(request: pytest.FixtureRequest) -> None:
    """Use threads only where they save time, except in tests of threads."""
    if request.node.get_closest_marker("threads") is None:
        request.getfixturevalue("usual_threads")
