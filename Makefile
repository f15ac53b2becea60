# The front door. `make help` lists what there is; `make setup` is all a fresh machine needs.

PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
PY     := $(BIN)/python

export PATH := $(PATH):$(HOME)/.cargo/bin
export PIP_DISABLE_PIP_VERSION_CHECK := 1
export MPLBACKEND := Agg
# The interpreter the binding is built for.
export PYO3_PYTHON := $(CURDIR)/$(PY)

RUST_SOURCES := Cargo.toml Cargo.lock $(shell find crates -name '*.rs' -o -name Cargo.toml)
NEXTEST := $(shell PATH="$(PATH)" command -v cargo-nextest 2>/dev/null)

.DEFAULT_GOAL := help
.PHONY: help setup demo test test-rust test-python validate lint bench bench-exudyn bench-mujoco docs fuzz clean
.NOTPARALLEL:

help: ## this list
	@grep -hE '^[a-z-]+:.*## ' Makefile | sed -E 's/^([a-z-]+):.*## /  make \1\t/' | expand -t 22

setup: $(VENV)/.built ## .venv with tools, extras and the extension in release mode
	@echo "Ready: $(BIN)/python, $(BIN)/pliant"

demo: setup ## a falling rope: a picture and an interactive page in out/
	$(BIN)/pliant demo falling_rope
	@echo; echo "Look at:"; ls -1 out/*.png out/*.html

test: test-rust test-python ## everything short: Rust, doc tests, Python

test-rust:
ifdef NEXTEST
	cargo nextest run --no-tests=pass
	cargo test --quiet --doc
else
	cargo test --quiet
endif

test-python: setup
	$(PY) -m pytest -m "not slow"

validate: setup ## the long checks; rewrites docs/validation.md and its pictures
	$(PY) -m pytest --timeout 3600 --validation-report target/validation.json
	cargo test --quiet -p pliant-dae -- --nocapture > target/validation-rust.txt
	$(PY) docs/build_shells.py
	$(PY) docs/build_validation.py target/validation.json target/validation-rust.txt

lint: setup ## formatting, clippy, ruff, mypy, floors
	cargo fmt --all --check
	cargo clippy --quiet --workspace --all-targets -- -D warnings
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: setup bench-exudyn bench-mujoco ## speed: Rust kernels, scaling, import time, beside Exudyn and MuJoCo
	cargo bench
	$(PY) benchmarks/import_time.py
	$(PY) benchmarks/stepper.py
	$(PY) benchmarks/model_building.py
	$(PY) benchmarks/scaling.py
	$(PY) benchmarks/falling_pendulum.py --exudyn .venv-exudyn/bin/python
	$(PY) benchmarks/falling_sheet.py --exudyn .venv-exudyn/bin/python
	$(PY) benchmarks/contact.py --mujoco .venv-mujoco/bin/python

bench-exudyn: .venv-exudyn/.ready

bench-mujoco: .venv-mujoco/.ready

docs: setup ## rewrites docs/reference.md from the docstrings; Rust documentation in target/doc
	$(PY) docs/build_reference.py
	cargo doc --quiet --workspace --no-deps

fuzz: setup ## hunts with many random cases, as long as it takes
	PROPTEST_CASES=20000 cargo test --quiet --release
	$(PY) -m pytest tests/robustness --timeout 0 --hypothesis-profile fuzz

clean: ## removes what was built
	rm -rf $(VENV) .venv-exudyn .venv-mujoco out dist target

# The package is installed in place: Python sources need no rebuild, Rust sources and dependencies do.
$(VENV)/.built: $(VENV)/.maturin pyproject.toml README.md $(RUST_SOURCES)
	VIRTUAL_ENV=$(CURDIR)/$(VENV) $(BIN)/maturin develop --release --extras all,dev
	@touch $@

$(VENV)/.maturin:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10))' || { echo "pliant needs Python 3.10 or newer: make PYTHON=python3.12 setup"; exit 1; }
	@command -v cargo >/dev/null || { echo "pliant needs a stable Rust toolchain (cargo is not on the PATH)"; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(PY) -m pip install --quiet 'maturin>=1.16,<2'
	@touch $@

.venv-exudyn/.ready:
	$(PYTHON) -m venv .venv-exudyn
	.venv-exudyn/bin/python -m pip install --quiet exudyn numpy
	@touch $@

# The `cable` composite is not in MuJoCo 4.
.venv-mujoco/.ready:
	$(PYTHON) -m venv .venv-mujoco
	.venv-mujoco/bin/python -m pip install --quiet 'mujoco<4' numpy
	@touch $@
