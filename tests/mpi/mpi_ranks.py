"""Running programs of the tests on several ranks."""

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
BESIDE_PYTHON = Path(sys.executable).parent

#: The launcher of the installed wheel, else that of the system.
LAUNCHER = shutil.which("mpiexec", path=str(BESIDE_PYTHON)) or shutil.which("mpiexec")

SECONDS = 600

#: What ranks get beside the environment of the tests.
ENVIRONMENT = {
    # Open MPI refuses more ranks than cores, and the root user, unless it is told otherwise.
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    # Ranks that wait let others have their core: there are more ranks than cores.
    "MPIR_CVAR_POLLS_BEFORE_YIELD": "1",
    "PYTHONPATH": str(HERE),
}


def why_not() -> str | None:
    """Why programs cannot run on several ranks here."""
    if LAUNCHER is None:
        return "there is no mpiexec: install an MPI library, for example with pip install mpich"
    return None


needs_mpi = pytest.mark.skipif(why_not() is not None, reason=why_not() or "")


def run_ranks(
    ranks: int,
    *program: str | Path,
    is_right: bool = True,
    folder: Path | None = None,
    seconds: float = SECONDS,
) -> str:
    """Run ``python program...`` on some ranks; returns what they print.

    Fails with the output if the exit status is not 0, or, unless `is_right`, if it is. After some
    `seconds` the launcher and all ranks are killed.
    """
    assert LAUNCHER is not None
    command = [LAUNCHER, "-n", str(ranks), sys.executable, *map(str, program)]
    with subprocess.Popen(
        command,
        env={**os.environ, **ENVIRONMENT},
        cwd=folder,
        text=True,
        errors="replace",
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
    ) as launcher:
        try:
            printed, _ = launcher.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            os.killpg(launcher.pid, signal.SIGKILL)
            printed, _ = launcher.communicate()
            pytest.fail(f"not done after {seconds} s; printed until then:\n{printed}")
        except BaseException:  # Ctrl-C, which processes of another session do not get
            os.killpg(launcher.pid, signal.SIGKILL)
            raise
    assert (launcher.returncode == 0) == is_right, f"status {launcher.returncode}\n{printed}"
    return printed
