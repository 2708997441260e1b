"""Rules of ARCHITECTURE.md that neither cargo and clippy nor the import-linter check."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from signals import printed_by

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).parents[2]
INDEX = {"jostle-base", "jostle-index"}
WORLD = {*INDEX, "jostle-simd"}
MAY_DEPEND_ON = {
    "jostle-base": {"rayon"},
    "jostle-simd": set(),
    "jostle-index": {"jostle-base", "jostle-simd"},
    "jostle-separate": INDEX,
    "jostle-slide": INDEX,
    "jostle-space": {*INDEX, "jostle-slide"},
    "jostle": {*INDEX, "jostle-separate", "jostle-slide", "jostle-space"},
    "jostle-world": WORLD,
    "jostle-scenes": {*INDEX, "jostle-world"},
}
MAY_DEPEND_ON["jostle-py"] = {*MAY_DEPEND_ON, "libc", "numpy", "pyo3"} - {"jostle"}
MANIFESTS = sorted(ROOT.glob("crates/*/Cargo.toml"))


def toml(path: str | Path) -> dict:
    return tomllib.loads((ROOT / path).read_text(encoding="utf-8"))


def packages(requirements: list) -> set[str]:
    """The names of packages, without those of included groups."""
    return {re.match(r"[\w.-]*", line)[0] for line in requirements if isinstance(line, str)}


def modules_after(code: str, *, whole: bool = False) -> set[str]:
    """The top-level modules that code imports after NumPy, beside the standard library; or all."""
    code = (
        f"import sys, numpy; before = set(sys.modules); {code}; print(*set(sys.modules) - before)"
    )
    names = printed_by("-c", code).split()
    if whole:
        return set(names)
    return {name.split(".")[0] for name in names} - {*sys.stdlib_module_names}


@pytest.mark.parametrize("manifest", MANIFESTS, ids=lambda path: path.parent.name)
def test_crate_depends_only_on_what_its_layer_allows(manifest: Path) -> None:
    crate = toml(manifest)
    assert set(crate.get("dependencies", ())) <= MAY_DEPEND_ON[crate["package"]["name"]]
    assert not {"build-dependencies", "target"} & set(crate)


def test_the_library_needs_numpy_alone_and_imports_no_further_module() -> None:
    assert packages(toml("pyproject.toml")["project"]["dependencies"]) == {"numpy"}
    code = "import jostle, jostle.pyqtree, jostle.sprites, jostle.writing"
    assert modules_after(code) <= {"jostle", "numpy"}
    names = modules_after("import jostle", whole=True)
    assert {name for name in names if not name.startswith("jostle")} <= {
        *("__future__", "numpy.typing", "numpy._typing._add_docstring")
    }


def test_make_run_installs_all_that_the_simulator_needs() -> None:
    groups = toml("pyproject.toml")["dependency-groups"]
    wanted = packages(toml("lab/pyproject.toml")["project"]["dependencies"])
    assert wanted - {"jostle"} <= packages(groups["run"])


def test_bench_imports_a_rival_only_when_it_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(ROOT / "benchmarks"))
    loaded = modules_after("import pairs, steps, held")
    rivals = {
        name.split("-")[0]
        for name in packages(toml("pyproject.toml")["dependency-groups"]["bench"])
    }
    assert "fastquadtree" in rivals
    assert not {*rivals, "scipy", "matplotlib", "rich", "typer"} & loaded


# The modules that determine a state without user input.
@pytest.mark.parametrize("name", ["containers", "forces", "start"])
def test_states_come_from_no_function_that_differs_by_machine(name: str) -> None:
    code = (ROOT / "lab/jostle_lab/simulate" / f"{name}.py").read_text(encoding="utf-8")
    assert not re.findall(
        r"\.(?:a?(?:cos|sin|tan)h?|arc\w+|atan2|exp\w*|log\w*|hypot|pow(?:er)?)\(", code
    )


# Split, so that this file does not contain them.
HOSTS = [
    "py" + "pi.org",
    "pythonhosted" + ".org",
    "crates" + ".io",
    "npm" + "js.",
    "deb" + "ian.org",
]


def test_no_file_names_a_registry_or_a_place_on_one_machine() -> None:
    """Cargo.lock may name the index of its crates, which is the same on every machine."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    try:
        listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("there is no git to ask for the files of the repository")
    hosts = "|".join(map(re.escape, HOSTS))
    named = re.compile(rf"(?:{hosts})(?!-index)|(?<![\w.~])/(?:work|root|home)/")
    for path in filter(Path.is_file, map(ROOT.joinpath, listed.stdout.splitlines())):
        text = path.read_bytes().decode("utf-8", errors="replace")
        assert not (found := named.search(text)), f"{path.relative_to(ROOT)}: {found[0]}"
