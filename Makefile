# Everything happens in a local environment (.venv); nothing else on the machine is touched.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

.PHONY: demo test lint bench clean

demo: $(VENV)/demo.installed  ## run the bundled example
	rm -rf demo
	$(BIN)/restitution check examples/steel.toml
	$(BIN)/restitution run examples/steel.toml -o demo

test: $(VENV)/test.installed  ## run the tests
	DUCC0_NUM_THREADS=1 $(BIN)/pytest -n auto

lint: $(VENV)/test.installed  ## style, format and types
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy

bench: $(VENV)/test.installed  ## time the example curve in units of one convolution
	$(BIN)/python benchmarks/rough_curve.py

clean:  ## remove the environment and the demo
	rm -rf $(VENV) demo

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "restitution needs Python 3.11 or newer: make PYTHON=python3.11")'
	$(PYTHON) -m venv $(VENV)

$(VENV)/demo.installed: pyproject.toml | $(BIN)/python
	@echo "installing (about two minutes)…"
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[measured]"
	@touch $@

$(VENV)/test.installed: pyproject.toml | $(BIN)/python
	@echo "installing (about two minutes)…"
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[measured,test,lint]"
	@touch $@
