"""The tests of the documents and examples."""

import pytest


@pytest.fixture(autouse=True)
def _usual_threads(usual_threads: None) -> None:
    """Use threads as the programs of readers do."""
