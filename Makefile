# Everything a fresh machine needs is git, cargo, python3.11 and make; `.venv` holds the rest.

PYTHON ?= python3.11
# How the extension is built; `MATURIN_FLAGS=` takes the profile of the tests, which saves a second build of all crates.
MATURIN_FLAGS ?= --release
VENV   := .venv
BIN    := $(VENV)/bin

# The virtual environment of whoever calls make is none of ours; cargo finds Python through ours.
unexport CONDA_PREFIX PYTHONPATH PYTHONHOME
export VIRTUAL_ENV := $(CURDIR)/$(VENV)
export PYO3_PYTHON := $(CURDIR)/$(BIN)/python
# What pyo3 would ask that Python for: maturin writes such a file for itself, and with it here cargo shares its crates.
export PYO3_CONFIG_FILE := $(CURDIR)/$(VENV)/pyo3.txt

# Test binaries of the feature `python` call no Python, so they need no libpython to link against.
CARGO_PY := PYO3_BUILD_EXTENSION_MODULE=1 cargo

RUST := Cargo.toml Cargo.lock pyproject.toml python/Cargo.toml python/extension.rs $(shell find src -type f)

.PHONY: demo test test-rust lint-then-python test-python fuzz bench lint clean

## Press the built-in finger on two products: figures printed, files and pictures in demo-output/.
demo: $(VENV)/installed
	$(BIN)/quasirigid demo --out demo-output

## Everything that must hold before a change lands.
# Two halves side by side: while one installs, reads types or runs a test on one core, the other takes the second.
test: $(VENV)/pyo3.txt
	+$(MAKE) --no-print-directory --jobs 2 test-rust lint-then-python

lint-then-python:
	+$(MAKE) --no-print-directory --jobs 1 lint test-python

test-rust: $(VENV)/pyo3.txt
	# The feature adds a private module and no test; with it, tests and extension share what is compiled.
	# Unit tests are small: not optimised, they cost 60 s in place of 125 s.
	$(CARGO_PY) test --quiet --features python --lib --config profile.dev.package.quasirigid.opt-level=0
	$(CARGO_PY) test --quiet --features python --test '*'
	$(CARGO_PY) test --quiet --features python --doc
	RUSTDOCFLAGS="-D warnings" cargo doc --no-deps --quiet

test-python: $(VENV)/installed $(VENV)/tools
	$(BIN)/python -m mypy.stubtest quasirigid._core
	$(BIN)/pytest --numprocesses auto --dist worksteal

## Random problems, meshes, files and presses with new seeds for that long.
MINUTES ?= 10
fuzz: $(VENV)/installed $(VENV)/tools
	$(BIN)/python tests/fuzz/run.py $(MINUTES)

## Formatting, lints and types, warnings as errors.
lint: $(VENV)/installed $(VENV)/tools
	cargo fmt --all --check
	# All targets with the feature `python`, then the crate without it.
	$(CARGO_PY) clippy --quiet --workspace --all-targets --features python -- -D warnings
	cargo clippy --quiet -- -D warnings
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy

## Criterion benches: distance, response, body, LCP, whole press.
bench:
	cargo bench

clean:
	rm -rf target $(VENV) demo-output dist python/quasirigid/_core*.so
	find python tests -name __pycache__ -type d -prune -exec rm -rf {} +

$(VENV)/made:
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade "pip>=25.1"
	touch $@

$(VENV)/pyo3.txt: $(VENV)/made
	printf '%s\n' implementation=CPython version=3.11 target_abi=CPython-abi3-3.11 shared=true > $@

# The wheel, editable: Python files are used in place, the extension is built when Rust files change.
$(VENV)/installed: $(VENV)/pyo3.txt $(RUST)
	$(BIN)/python -m pip install --quiet --group build
	PIP_QUIET=1 $(BIN)/maturin develop $(MATURIN_FLAGS) --quiet --extras plot,cli
	touch $@

$(VENV)/tools: $(VENV)/made pyproject.toml
	$(BIN)/python -m pip install --quiet --group check
	touch $@
