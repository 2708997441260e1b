"""Distributed worlds have the bits of one process, for any number of ranks and any distribution."""

import pytest
from mpi_ranks import HERE, needs_mpi, run_ranks

CASES = ("gas", "scene", "containers", "rules", "nasty", "errors")


@needs_mpi
@pytest.mark.parametrize("ranks", [1, 2, 3, 4])
@pytest.mark.parametrize("case", CASES)
def test_ranks_have_the_bits_of_one_process(case: str, ranks: int) -> None:
    assert "all bits are right" in run_ranks(ranks, HERE / "mpi_world.py", case)
