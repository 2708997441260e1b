"""Distributed worlds have the bits of one process, on 1 to 4 ranks and for any distribution."""

import pytest
from mpi_ranks import HERE, needs_mpi, run_ranks

pytestmark = [pytest.mark.ranks, pytest.mark.slow, needs_mpi]


@pytest.mark.parametrize("module", sorted(path.stem for path in HERE.glob("mpi_cases_*.py")))
def test_ranks_have_the_bits_of_one_process(module: str) -> None:
    """All cases of a module in one start of the ranks, each on as many as it is marked for."""
    assert "all bits are right" in run_ranks(4, HERE / "mpi_world.py", module)


def test_all_scenes_have_the_bits_of_one_process_after_300_steps() -> None:
    assert "all bits are right" in run_ranks(2, HERE / "mpi_world.py", "long")


def test_worlds_do_not_use_up_the_communicators() -> None:
    assert "all bits are right" in run_ranks(2, HERE / "mpi_world.py", "many")


def test_the_death_of_a_rank_ends_all() -> None:
    run_ranks(3, HERE / "mpi_world.py", "killed", is_right=False)
