"""jostle.mpi.find_pairs finds the pairs of one process, each on one rank."""

import pytest
from mpi_ranks import HERE, needs_mpi, run_ranks


@pytest.mark.ranks
@needs_mpi
def test_one_to_four_ranks_find_the_pairs_of_one_process() -> None:
    assert "all pairs are right" in run_ranks(4, HERE / "mpi_pairs.py")
