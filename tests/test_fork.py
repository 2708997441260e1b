"""A forked process can go on: the parent's threads do not come along."""

import os
import signal

import numpy as np
import pytest

import jostle


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork:DeprecationWarning")
@pytest.mark.parametrize("threads", [None, 2])
def test_a_forked_process_finds_the_same_pairs(threads: int | None) -> None:
    centers = np.random.default_rng(0).random((60_000, 2))
    expected = jostle.find_pairs(centers, 0.001, threads=threads)
    assert len(expected) > 0
    child = os.fork()
    if child == 0:
        signal.alarm(20)  # a hang ends the child, not the test run
        same = np.array_equal(jostle.find_pairs(centers, 0.001, threads=threads), expected)
        os._exit(0 if same else 1)
    _, status = os.waitpid(child, 0)
    assert os.waitstatus_to_exitcode(status) == 0
