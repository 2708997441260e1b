"""The vector instructions of the kernels are inlined in the build of `make setup`.

A function that is generic over `Simd` does not have the CPU features of the function that calls
it. If it is not inlined into that function, each of its vector instructions becomes a call, which
makes pairs four times as slow. Closures and `array::map` are the usual cause.
"""

import platform
import shutil
import subprocess
from pathlib import Path

import pytest

LIBRARIES = Path(__file__).parents[3] / "target/local/deps"

# The crates that call kernels from functions with the features of a level.
CRATES = ["jostle_index", "jostle_separate", "jostle_slide", "jostle_space", "jostle_world"]


def names_in(crate: str) -> list[str]:
    """Names in the newest library of a crate, mangled."""
    built = sorted(LIBRARIES.glob(f"lib{crate}-*.rlib"), key=lambda path: path.stat().st_mtime)
    if not built or not shutil.which("nm"):
        pytest.skip("needs the build of `make setup` and nm of binutils")
    listing = subprocess.run(["nm", str(built[-1])], capture_output=True, text=True).stdout
    return [line.split()[-1] for line in listing.splitlines() if line.strip()]


@pytest.mark.skipif(platform.machine() != "x86_64", reason="the kernels are for x86-64")
def test_no_vector_instruction_is_a_call() -> None:
    names = {crate: names_in(crate) for crate in CRATES}
    with_kernels = {crate for crate in CRATES if any("with_avx2" in name for name in names[crate])}
    assert {"jostle_index", "jostle_world"} <= with_kernels
    outlined = {
        crate: [name for name in names[crate] if "core_arch" in name and "_mm" in name]
        for crate in CRATES
    }
    assert not any(outlined.values()), f"vector instructions that are calls: {outlined}"
