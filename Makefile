# Each target does its own set-up once; `make` alone lists the targets.
#
#   make run ARGS="pile -n 2000"       arguments for the program that a target runs
#   make setup PYTHON=/path/to/python  the interpreter for a new .venv

ARGS ?=
PYTHON ?=

VENV := .venv
BIN := $(VENV)/bin
ARCADE := $(VENV)-arcade
WHEELS := target/wheels
RUST_NEEDED := $(shell sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)

# One interpreter for every call of cargo; otherwise PyO3 would be built again each time.
export PYO3_PYTHON := $(abspath $(BIN)/python)
export PIP_DISABLE_PIP_VERSION_CHECK := 1

# The packages are installed without bytecode. If it may not be written, each process compiles
# all modules that it imports again, for matplotlib about two seconds.
unexport PYTHONDONTWRITEBYTECODE

# Of the compiled core, with the folders, so that removed files count as a change. Modules in Python are
# used where they are: an edit of a line needs no build.
CORE := Cargo.toml $(wildcard Cargo.lock) pyproject.toml $(wildcard crates/*/Cargo.toml) \
  $(shell find crates/*/src -print 2>/dev/null)
MODULES := $(shell find python lab -name __pycache__ -prune -o -name "_core.*.so" -prune -o -print 2>/dev/null)

.DEFAULT_GOAL := help
.NOTPARALLEL:
.PHONY: help setup run test full search arcade lint bench docs web wheel clean

help:  ## list the targets
	@echo "make TARGET, where TARGET is one of"
	@sed -n 's/^\([a-z]*\):.*  ## /  \1	/p' Makefile

setup: $(VENV)/lab $(VENV)/dev  ## build everything into .venv

run: $(VENV)/lab  ## start the simulator; ARGS="pile -n 2000" chooses a scene and its size
	$(BIN)/jostle run $(ARGS)

test: setup  ## run every test: Rust, Python and the examples in the documents
	$(need_rust)
	cargo test --workspace --exclude jostle-py
	$(if $(ARGS),,$(BIN)/python -m pytest tests/mpi)
	$(BIN)/python -m pytest $(or $(ARGS),--ignore tests/mpi --numprocesses auto --dist worksteal)

full: setup  ## what takes too long for every change: searches, measurements, 1,000 examples of each property
	$(need_rust)
	JOSTLE_CASES=20 JOSTLE_OPERATIONS=100000 cargo test --workspace --exclude jostle-py --test all -- \
	  --include-ignored --skip list_stages
	$(BIN)/python tests/random_scenes.py
	$(BIN)/python -m pytest -m "full or hypothesis" --hypothesis-profile=full --numprocesses auto --dist worksteal

search: setup  ## search 1,000 random scenes for discs that hang in the air (ARGS=10000: more; ARGS=polygons: see CONTRIBUTING)
	$(if $(filter polygons,$(ARGS)),$(POLYGONS),$(BIN)/python tests/random_scenes.py $(ARGS))

arcade: $(WHEELS)/built  ## test the adapter to arcade and the examples with windows, in $(ARCADE)
	@if $(MAKE) --no-print-directory $(ARCADE)/wheel; then $(ARCADE)/bin/python -m pytest \
	  $(or $(ARGS),tests/adapters/test_arcade*.py tests/docs/test_window_examples.py tests/docs/test_docstrings.py \
	  -k "arcade or pyglet or raylib"); \
	else echo "arcade cannot be installed here, so its adapter and the examples are not tested."; fi

lint: setup  ## check format, style and types
	$(need_rust)
	cargo fmt --all --check
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/python docs/check_types.py
	$(BIN)/python docs/stub.py --check
	$(BIN)/python docs/settings.py --check
	$(BIN)/python docs/check_docstrings.py
	$(BIN)/lint-imports --no-cache --no-logo
	$(BIN)/python -m mypy.stubtest jostle._core
	cargo clippy --workspace --all-targets -- -D warnings
	cargo clippy --package jostle --package jostle-scenes --no-default-features -- -D warnings

bench: setup $(VENV)/bench  ## measure against the rivals; ARGS="pairs native" chooses parts
	$(if $(call asked,$(filter-out native,$(ARGS))),$(BIN)/python benchmarks/run.py $(filter-out native,$(ARGS)))
	$(if $(call asked,$(filter native,$(ARGS))),$(NATIVE))

docs: setup  ## draw the pictures of the documents again
	$(BIN)/python docs/pictures.py $(ARGS)

web:
	@echo "There is no web page yet: jostle runs in Python and in Rust."

wheel: $(VENV)/run  ## build optimised wheels of the library and the simulator to distribute into dist
	$(need_rust)
	$(BIN)/maturin build --release --interpreter $(BIN)/python --out dist
	$(call lab_wheel,dist)

clean:  ## remove everything that was built
	rm -rf $(VENV) $(ARCADE) target benchmarks/native/target out dist .pytest_cache .hypothesis .mypy_cache .ruff_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# Twice 100,000 random polygons of walls, which no disc may leave.
POLYGONS = cargo test --package jostle --test all many_polygons -- --ignored

# All parts of the benchmarks, if no part is named.
asked = $(or $(1),$(if $(ARGS),,all))

# The rivals in Rust and C. NDEBUG switches off the assertions of Box2D's wrapper.
NATIVE = @if cargo --version >/dev/null 2>&1; then for part in pairs step; do CFLAGS="-O3 -DNDEBUG" \
  cargo run --release --manifest-path benchmarks/native/Cargo.toml -- $$part || exit; done; \
  else echo "The rivals in Rust and C are skipped: there is no cargo."; fi

# Prerequisites. Each file marks a completed step.

$(VENV)/created:
	$(need_rust)
	$(or $(find_python),$(error $(no_python))) -m venv --clear $(VENV)
	$(BIN)/python -m pip install --quiet $(PIP)
	@touch $@

# Bytecode is compiled on first import, not for every module of every package.
$(VENV)/run: $(VENV)/created pyproject.toml
	$(BIN)/python -m pip install --quiet --no-compile --group run
	@touch $@

$(VENV)/dev: $(VENV)/run
	$(BIN)/python -m pip install --quiet --no-compile --group develop
	@touch $@

$(VENV)/bench: $(VENV)/dev
	$(BIN)/python -m pip install --quiet --group bench
	@touch $@

$(VENV)/library: $(VENV)/run $(CORE)
	$(need_rust)
	@touch $@.begun  # so that an edit made during the build is built the next time
	$(BIN)/maturin develop --quiet --profile local
	@mv $@.begun $@

$(VENV)/lab: $(VENV)/library lab/pyproject.toml
	$(BIN)/python -m pip install --quiet --no-deps --no-build-isolation --editable lab
	@touch $@

$(WHEELS)/built: $(VENV)/library $(MODULES)
	rm -rf $(WHEELS)
	$(BIN)/maturin build --quiet --profile local --interpreter $(BIN)/python --out $(WHEELS)
	$(call lab_wheel,$(WHEELS))
	@touch $@

$(ARCADE)/installed: $(VENV)/run
	$(BIN)/python -m venv --clear $(ARCADE)
	$(ARCADE)/bin/python -m pip install --quiet $(PIP)
	$(ARCADE)/bin/python -m pip install --quiet --no-compile --group arcade
	@touch $@

$(ARCADE)/wheel: $(ARCADE)/installed $(WHEELS)/built
	$(ARCADE)/bin/python -m pip install --quiet --no-deps --force-reinstall $(WHEELS)/jostle-*.whl
	@touch $@

lab_wheel = $(BIN)/python -m pip wheel --quiet --no-deps --no-build-isolation --wheel-dir $(1) ./lab

# The oldest that knows dependency groups is 25.1.
PIP := "pip>=25.1"

# Required programs. Each is run, because a name in PATH may be a broken link.

PYTHONS := python3 python3.14 python3.13 python3.12 python3.11 python3.10 python
find_python = $(shell for python in $(or $(PYTHON),$(PYTHONS) $$HOME/.pyenv/versions/*/bin/python3); do \
  "$$python" -c "import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 10))" >/dev/null 2>&1 \
  && echo "$$python" && break; done)
no_python = $(or $(PYTHON),jostle) $(if $(PYTHON),is not,needs) Python 3.10 or newer with its venv module: \
  install it from https://www.python.org or your system's packages (Debian: apt install python3 python3-venv), \
  or name one with make PYTHON=/path/to/python

need_rust = $(if $(rust_fits),,$(error jostle is built with Rust $(RUST_NEEDED) or newer, and \
  $(or $(rust_version),none) was found: install it from https://rustup.rs, or run "rustup update", \
  then open a new shell))$(if $(shell command -v cc 2>&1),,$(error Rust needs a C compiler to link with, \
  and "cc" was not found: install one (Debian: apt install gcc; macOS: xcode-select --install)))
rust_version = $(shell cargo --version >/dev/null 2>&1 && rustc --version 2>/dev/null | cut -d " " -f 2)
rust_fits = $(shell echo "$(RUST_NEEDED) $(rust_version)" | awk '{ split($$1, need, "."); split($$2, have, "."); \
  if (have[1] > need[1] || have[1] == need[1] && have[2] >= need[2]) print "yes" }')
