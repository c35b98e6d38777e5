# `make` regenerates every result; `make test` checks everything. Both build .venv by themselves.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
CORES ?= 2

.PHONY: all test lint unit smoke report bench clean

all: $(VENV)/run
	$(BIN)/snakemake --cores $(CORES)

test: lint unit smoke

lint: $(VENV)/dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/snakefmt --check Snakefile workflow
	$(BIN)/snakemake --lint

unit: $(VENV)/dev
	$(BIN)/python -m pytest -q tests

smoke: $(VENV)/dev
	$(BIN)/python -m pytest -q tests/workflow --smoke

report: $(VENV)/run
	$(BIN)/snakemake --report results/report.zip

bench: $(VENV)/run
	$(BIN)/python benchmarks/training_step.py

$(VENV)/run: requirements.txt constraints.txt pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements.txt
	touch $@

$(VENV)/dev: requirements-dev.txt $(VENV)/run
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements-dev.txt
	touch $@

clean:
	rm -rf results .cache
