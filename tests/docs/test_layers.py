"""The rules of ARCHITECTURE.md: which part may import which, and what a file may name."""

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).parents[2]
CORE = ROOT / "crates" / "jostle" / "src"
PACKAGE = ROOT / "python" / "jostle"
APP = PACKAGE / "app"


def toml(path: str) -> dict:
    return tomllib.loads((ROOT / path).read_text(encoding="utf-8"))


def names_of(paths: list[Path], base: Path) -> list[str]:
    """Test ids: the paths as seen from a folder."""
    return [path.relative_to(base).as_posix() for path in paths]


# ---- dependencies --------------------------------------------------------------------------------

MAY_DEPEND_ON = {"jostle": {"rayon"}, "jostle-py": {"jostle", "libc", "numpy", "pyo3"}}
MANIFESTS = sorted(ROOT.glob("crates/*/Cargo.toml"))


@pytest.mark.parametrize("manifest", MANIFESTS, ids=lambda path: path.parent.name)
def test_crate_depends_only_on_what_its_layer_allows(manifest: Path) -> None:
    crate = tomllib.loads(manifest.read_text(encoding="utf-8"))
    assert set(crate["dependencies"]) <= MAY_DEPEND_ON[crate["package"]["name"]]
    assert not {"build-dependencies", "target"} & set(crate)


def test_the_core_can_do_without_threads() -> None:
    core = toml("crates/jostle/Cargo.toml")
    assert core["dependencies"]["rayon"]["optional"]
    assert core["features"]["parallel"] == ["dep:rayon"]


def test_the_wheel_needs_numpy_alone() -> None:
    project = toml("pyproject.toml")["project"]
    assert list(map(name_of_requirement, project["dependencies"])) == ["numpy"]


def test_make_run_installs_all_that_the_app_needs() -> None:
    project = toml("pyproject.toml")["project"]
    wanted = {*project["dependencies"], *project["optional-dependencies"]["app"]}
    pinned = (ROOT / "requirements" / "run.txt").read_text(encoding="utf-8").splitlines()
    assert set(map(name_of_requirement, wanted)) <= set(map(name_of_requirement, pinned))


def name_of_requirement(line: str) -> str:
    return re.match(r"[\w.-]*", line)[0]


# ---- the core ------------------------------------------------------------------------------------

FORBIDDEN_IN_CORE = (
    *("pyo3", "numpy", "wasm_bindgen", "web_sys", "js_sys"),
    *("std::time", "std::fs", "std::env", "std::net", "std::process"),
    *("thread::spawn", "thread::sleep", "thread::Builder", "thread::scope"),
    *("print!", "println!", "eprint!", "eprintln!", "dbg!"),
)
SOURCES = sorted(CORE.rglob("*.rs"))
MODULES = re.findall(r"^(?:pub(?:\(crate\))? )?mod (\w+);", (CORE / "lib.rs").read_text(), re.M)


def rust_code(path: Path) -> str:
    """The source without its comments and the text of its strings."""
    token = r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\])*"'
    blank = re.compile(token, re.DOTALL)
    return blank.sub(lambda match: '""' if match[0][0] == '"' else "", path.read_text("utf-8"))


def rust_paths(code: str) -> Iterator[str]:
    """Every `a::b::c` of some code; those of `use a::{b, c::d};` are written out."""
    for tree in re.findall(r"\buse ([^;]*);", code):
        yield from branches("".join(re.sub(r"\bas \w+", "", tree).split()))
    yield from re.findall(r"\w+(?:::\w+)+", re.sub(r"\buse [^;]*;", "", code))


def branches(tree: str) -> Iterator[str]:
    """Writes out `a::{b,c::{d,e}}` as a::b, a::c::d, a::c::e."""
    innermost = re.search(r"(?:^|[{,])([\w:]*)\{([^{}]*)\}", tree)
    if not innermost:
        yield from filter(None, tree.split(","))
        return
    spread = ",".join(innermost[1] + leaf for leaf in innermost[2].split(",") if leaf)
    yield from branches(tree[: innermost.start(1)] + spread + tree[innermost.end() :])


def from_the_root(path: str, file: Path) -> str | None:
    """The path relative to lib.rs, without `crate::`; None if it is outside the crate."""
    parts = path.split("::")
    if parts[0] == "crate":
        return "::".join(parts[1:])
    supers = next((k for k, part in enumerate(parts) if part != "super"), len(parts))
    place = file.relative_to(CORE).with_suffix("").parts
    depth = len(place) - (place[-1] == "mod")
    return "::".join(parts[supers:]) if supers >= depth else None


def test_writes_out_the_paths_of_rust() -> None:
    code = "use a::{b, c::{d as e, f}, self}; use super::g; x = crate::h::i(j::K);"
    written = {"a::b", "a::c::d", "a::c::f", "a::self", "super::g", "crate::h::i", "j::K"}
    assert set(rust_paths(code)) == written


def test_the_modules_of_the_core_are_found() -> None:
    assert {*MODULES, "lib"} == {path.stem for path in CORE.iterdir()}


@pytest.mark.parametrize("source", SOURCES, ids=names_of(SOURCES, CORE))
def test_core_uses_nothing_outside(source: Path) -> None:
    code = rust_code(source)
    said = " ".join([*rust_paths(code), *re.findall(r"\w+!", code)])
    found = [name for name in FORBIDDEN_IN_CORE if re.search(rf"\b{name}(?!\w)", said)]
    assert not found


@pytest.mark.parametrize("module", MODULES)
def test_core_module_uses_only_those_above_it(module: str) -> None:
    above = MODULES[: MODULES.index(module) + 1]
    files = [CORE / f"{module}.rs", *sorted((CORE / module).rglob("*.rs"))]
    for file in filter(Path.exists, files):
        for path in rust_paths(rust_code(file)):
            target = from_the_root(path, file)
            if target is None:
                continue
            head = target.split("::")[0]
            assert head in above or head not in MODULES, f"{file.name}: {path} is below {module}"
            assert head in MODULES or not path.startswith("crate::"), (
                f"{file.name}: {path} goes through lib.rs; name the module that it comes from"
            )


# ---- the Python package --------------------------------------------------------------------------

COMMAND = {"__main__.py", "extras.py", "interrupt.py", "launcher.py", "tables.py", "writing.py"}
ADAPTERS = ["pygame"]  # those that are packages
LIBRARY = [path for path in sorted(PACKAGE.glob("*.py")) if path.name not in COMMAND]
LIBRARY += [path for name in ADAPTERS for path in sorted((PACKAGE / name).glob("*.py"))]


def imports(path: Path) -> Iterator[str]:
    """The full name of everything that a file imports, at any place in the file."""
    package = ["jostle", *path.relative_to(PACKAGE).parts[:-1]]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else []
            home = ".".join([*above, *filter(None, [node.module])])
            yield from (f"{home}.{alias.name}" for alias in node.names)


@pytest.mark.parametrize("path", LIBRARY, ids=names_of(LIBRARY, PACKAGE))
def test_library_never_imports_the_app(path: Path) -> None:
    assert not [
        name
        for name in imports(path)
        if re.match(
            r"jostle\.(app|bench|tune|sweep|mpi|cli|extras|interrupt|launcher|tables|writing)\b",
            name,
        )
    ]


@pytest.mark.parametrize("path", LIBRARY, ids=names_of(LIBRARY, PACKAGE))
def test_library_imports_numpy_alone(path: Path) -> None:
    """An adapter, named after the library that it adapts to, may import that one too."""
    name = path.stem if path.parent == PACKAGE else path.parent.name
    allowed = {"jostle", "numpy", name, *sys.stdlib_module_names}
    assert {name.split(".")[0] for name in imports(path)} <= allowed


def test_importing_jostle_loads_no_part_of_the_app() -> None:
    code = "import sys, jostle, jostle_lab.article; print(*sys.modules)"
    command = [sys.executable, "-c", code]
    loaded = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()
    extra = {"pygame", "rich", "typer", "imageio_ffmpeg", "matplotlib"}
    parts = {f"jostle.{name}" for name in ("app", "bench", "tune", "sweep", "mpi", "tables")}
    assert not {*extra, *parts, "mpi4py"} & set(loaded)


MPI = sorted((PACKAGE / "mpi").glob("*.py"))


@pytest.mark.parametrize("path", MPI, ids=names_of(MPI, PACKAGE))
def test_mpi_uses_the_library_and_mpi4py(path: Path) -> None:
    above = r"jostle\.(app|bench|tune|sweep|cli|interrupt|launcher|tables)\b"
    names = list(imports(path))
    assert not [name for name in names if re.match(above, name)]
    allowed = {"jostle", "numpy", "mpi4py", *sys.stdlib_module_names}
    assert {name.split(".")[0] for name in names} <= allowed


SIBLINGS = ("app", "bench", "sweep", "tune")


@pytest.mark.parametrize("package", SIBLINGS)
def test_siblings_do_not_import_each_other(package: str) -> None:
    others = "|".join({*SIBLINGS, "cli"} - {package})
    above = rf"jostle\.(?:{others})\b"
    for path in sorted((PACKAGE / package).rglob("*.py")):
        assert not [name for name in imports(path) if re.match(above, name)], path.name


def test_only_the_pictures_of_the_tuning_import_matplotlib() -> None:
    importing = {
        path.relative_to(PACKAGE).as_posix()
        for path in PACKAGE.rglob("*.py")
        if any(name.split(".")[0] == "matplotlib" for name in imports(path))
    }
    assert importing == {"tune/pictures.py"}


def test_bench_imports_a_rival_only_when_it_is_measured() -> None:
    code = "import sys, pairs, steps, held; print(*sys.modules)"
    command = [sys.executable, "-c", code]
    loaded = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()
    known = (ROOT / "requirements" / "bench.txt").read_text(encoding="utf-8").splitlines()
    rivals = set(map(name_of_requirement, known)) - {""}
    assert "fastquadtree" in rivals
    assert not {*rivals, "scipy", "matplotlib", "rich", "typer", "jostle_lab"} & set(loaded)


PACKAGES = {path.parent: path for path in sorted(APP.glob("*/__init__.py"))}


def reading_order(package: Path) -> list[str]:
    """The files of a package of the app, as the table in its docstring lists them."""
    words = ast.get_docstring(ast.parse(PACKAGES[package].read_text(encoding="utf-8")))
    rows = re.findall(r"^(\w+(?:, \w+)*) {2,}\S", words, re.M)
    return [name for row in rows for name in row.split(", ")]


@pytest.mark.parametrize("package", PACKAGES, ids=lambda package: package.name)
def test_the_table_of_a_package_lists_each_file_once(package: Path) -> None:
    files = {path.stem for path in package.glob("*.py")} - {"__init__"}
    assert sorted(reading_order(package)) == sorted(files)


@pytest.mark.parametrize("package", PACKAGES, ids=lambda package: package.name)
def test_a_file_uses_only_files_above_it_in_the_table(package: Path) -> None:
    order, home = reading_order(package), f"jostle_lab.{package.name}."
    for place, name in enumerate(order):
        for used in imports(package / f"{name}.py"):
            file = used.removeprefix(home).split(".")[0]
            if used.startswith(home) and file in order:
                assert file in order[:place], f"{name} uses {file}, which is not above it"


# The layers of the app: packages, and modules outside packages.
LAYERS = (
    *("simulate", "draw", "measure", "act", "race", "runner", "storage", "session"),
    *("gui", "panels", "window", "headless", "ranks", "tour"),
)
SIBLINGS_IN_APP = [("draw", "measure"), ("window", "headless")]


def test_the_layers_of_the_app_are_complete() -> None:
    there = {path.stem for path in APP.glob("*.py")} | {package.name for package in PACKAGES}
    assert there - {"__init__"} == set(LAYERS)
    listed = re.findall(r"^(\w+(?:, \w+)*) {2,}\S", (APP / "__init__.py").read_text("utf-8"), re.M)
    assert tuple(name for row in listed for name in row.split(", ")) == LAYERS


@pytest.mark.parametrize("layer", LAYERS)
def test_a_layer_of_the_app_uses_only_layers_below_it(layer: str) -> None:
    """So there are no import cycles; imports for type checkers count, too."""
    below = set(LAYERS[: LAYERS.index(layer) + 1])
    below -= {other for pair in SIBLINGS_IN_APP if layer in pair for other in pair} - {layer}
    files = [APP / f"{layer}.py", *sorted((APP / layer).rglob("*.py"))]
    for file in filter(Path.exists, files):
        for name in imports(file):
            used = re.match(r"jostle\.app\.(\w+)", name)
            assert not used or used[1] in below, f"{file.name} uses {used[1]}, which is above it"


# The modules that determine a state without user input, except the article's own programs.
STATE = ["containers", "emitters", "forces", "start", "wall_segments"]


@pytest.mark.parametrize("name", STATE)
def test_states_come_from_no_function_that_differs_by_machine(name: str) -> None:
    code = (APP / "simulate" / f"{name}.py").read_text(encoding="utf-8")
    assert not re.findall(
        r"\.(?:a?(?:cos|sin|tan)h?|arc\w+|atan2|exp\w*|log\w*|hypot|pow(?:er)?)\(", code
    )


# ---- what no file may name -----------------------------------------------------------------------


def files_of_the_repository() -> list[Path]:
    """The files that git tracks, and those that it does not ignore."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    try:
        listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("there is no git to ask for the files of the repository")
    return [path for path in map(ROOT.joinpath, listed.stdout.splitlines()) if path.is_file()]


# Split, so that this file does not contain them.
HOSTS = [
    "py" + "pi.org",
    "pythonhosted" + ".org",
    "crates" + ".io",
    "npm" + "js.",
    "deb" + "ian.org",
]
PLACES = ["work", "root", "home"]


def test_no_file_names_a_registry_or_a_place_on_one_machine() -> None:
    """Cargo.lock may name the index of its crates, which is the same on every machine."""
    hosts = "|".join(map(re.escape, HOSTS))
    places = "|".join(PLACES)
    named = re.compile(rf"(?:{hosts})(?!-index)|(?<![\w.~])/(?:{places})/")
    found = []
    for path in files_of_the_repository():
        text = path.read_bytes().decode("utf-8", errors="replace")
        found += [f"{path.relative_to(ROOT)}: {match[0]}" for match in named.finditer(text)]
    assert not found
