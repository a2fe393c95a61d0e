# make report | test | test-all | lint | bench | lock | clean
# Another Python, beside the usual one:  make test PYTHON=python3.11 VENV=.venv311

VENV ?= .venv
PYTHON ?=
JOBS ?= 2
TESTS ?= tests
UV ?= uv

export JAX_PLATFORMS ?= cpu

PYTEST = $(VENV)/bin/python -m pytest
PARALLEL = -n $(JOBS) --dist worksteal

.PHONY: help venv report test test-all lint bench lock clean

help:
	@echo "make report    generate the bundled materials, verify and fit them, write reports/latest/index.html"
	@echo "make test      the fast tests"
	@echo "make test-all  the long tests: those marked slow, and the property tests with ten times the examples"
	@echo "make lint      ruff and pyright"
	@echo "make bench     speed, as ratios to a plain NumPy peer"
	@echo "make lock      resolve requirements.lock anew (needs uv and a network)"
	@echo "make clean     remove what the above wrote, but not $(VENV)"

venv:
	@.ci/venv "$(VENV)" "$(PYTHON)"

report: venv
	@$(VENV)/bin/axffit demo --out reports/latest

test: venv
	$(PYTEST) $(PARALLEL) -m "not slow" $(TESTS)

test-all: venv
	AXFFIT_HYPOTHESIS_PROFILE=all $(PYTEST) $(PARALLEL) -m "slow or hypothesis" $(TESTS)

lint: venv
	$(VENV)/bin/ruff check .
	$(VENV)/bin/pyright --pythonpath $(VENV)/bin/python

# Without the run-time type checks of the tests, and one process: they would be what is measured.
bench: venv
	$(PYTEST) -o addopts="--import-mode=importlib" --benchmark-columns=min,median,ops --benchmark-sort=name benchmarks/bench_*.py

lock:
	@command -v $(UV) >/dev/null || { echo "axffit: make lock needs uv (or UV=/path/to/uv)" >&2; exit 1; }
	$(UV) pip compile pyproject.toml --all-extras --group dev --universal --python-version 3.11 --upgrade \
	    --generate-hashes --no-header --no-annotate --no-emit-index-url --output-file requirements.lock

clean:
	rm -rf .cache .pytest_cache .ruff_cache .benchmarks .hypothesis build dist reports/latest
	find . -name __pycache__ -not -path './.venv*' -type d -prune -exec rm -rf {} +
