"""What the launcher of MPI sets in the environment, read before MPI is imported."""

import os

#: Variables of launchers: the number of processes, and the rank of this one.
_SIZES = ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MPI_LOCALNRANKS", "SLURM_STEP_NUM_TASKS")
_RANKS = ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "MPI_LOCALRANKID", "SLURM_PROCID")


def is_started_by_mpi() -> bool:
    """Return whether mpirun, or another launcher, has started several processes."""
    return any(int(os.environ.get(name) or 1) > 1 for name in _SIZES)


def speaks() -> bool:
    """Return whether this process prints messages: one alone, or the first of several."""
    ranks = [os.environ[name] for name in _RANKS if os.environ.get(name)]
    return not is_started_by_mpi() or ranks[:1] in ([], ["0"])
