"""jostle.mpi.find_pairs finds the pairs of one process, each on one rank."""

import pytest
from mpi_ranks import HERE, needs_mpi, run_ranks


@needs_mpi
@pytest.mark.parametrize("ranks", [1, 2, 3, 4])
def test_ranks_find_the_pairs_of_one_process(ranks: int) -> None:
    assert "all pairs are right" in run_ranks(ranks, HERE / "mpi_pairs.py")
