# `make repro` rebuilds every result, `make test` runs every check; `make ablation` and `make results` take hours and may
# be stopped and started again. All set up what they need first.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
export DVC_NO_ANALYTICS := 1

.PHONY: setup repro test lint ablation results

setup: $(VENV)/.ready

$(VENV)/.ready: pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "physpipe needs Python 3.11 or newer: make PYTHON=python3.11 ..."; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --editable '.[dev]'
	@touch $@

repro: setup
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/dvc repro
	$(BIN)/python -m experiments.readme

ablation results: setup
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m experiments.$@ $(if $(JOBS),--jobs $(JOBS))

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/lint-imports --no-cache

test: lint
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/dvc repro --dry --allow-missing --quiet
	@# Two files of tests at a time, the longest ones, of the pipeline, first
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m pytest -n 2 --dist loadfile --no-loadscope-reorder tests/pipeline tests
