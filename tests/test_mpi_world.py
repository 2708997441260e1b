"""Distributed worlds have the bits of one process, for any number of ranks and any distribution."""

import pytest
from mpi_ranks import HERE, needs_mpi, run_ranks

CASES = (
    "gas",
    "containers",
    "rules",
    "nasty",
    "files",
    "errors",
    "pressed",
    "signals",
    "calls",
    "parts",
    "events",
    "forces",
    "given",
    "energy",
    "immovable",
    "merging",
    "settings",
    "calls_of_sleepers",
    "rebalancing",
)


@pytest.mark.ranks
@needs_mpi
@pytest.mark.parametrize("case", CASES)
def test_one_to_four_ranks_have_the_bits_of_one_process(case: str) -> None:
    assert "all bits are right" in run_ranks(4, HERE / "mpi_world.py", case)


@pytest.mark.ranks
@needs_mpi
@pytest.mark.slow
@pytest.mark.parametrize("case", ["scenes", "piles", "sleeping", "edits"])
def test_ranks_with_resting_contacts_have_the_bits_of_one_process(case: str) -> None:
    """A step has hundreds of calls of all ranks."""
    assert "all bits are right" in run_ranks(4, HERE / "mpi_world.py", case)


@pytest.mark.ranks
@needs_mpi
@pytest.mark.slow
def test_larger_worlds_have_the_bits_of_one_process_after_300_steps() -> None:
    assert "all bits are right" in run_ranks(3, HERE / "mpi_world.py", "long")


@pytest.mark.ranks
@needs_mpi
def test_worlds_do_not_use_up_the_communicators() -> None:
    assert "all bits are right" in run_ranks(2, HERE / "mpi_world.py", "many")


@pytest.mark.ranks
@needs_mpi
def test_the_death_of_a_rank_ends_all() -> None:
    run_ranks(3, HERE / "mpi_world.py", "killed", is_right=False)
