# `make` regenerates every result; `make test` checks everything; `make help` lists the rest. All build .venv themselves.

PYTHON ?= python3
VENV := .venv
DOCS := .venv-docs
BIN := $(VENV)/bin
CORES ?= 2
# What a module system puts there is of another Python. Tests of a copy of the project name its own source instead.
ifdef HYPERNODE_SOURCE
export PYTHONPATH := $(HYPERNODE_SOURCE)
else
unexport PYTHONPATH
endif
# Every process would compile the project anew.
unexport PYTHONDONTWRITEBYTECODE
# One thread for linear algebra, as jobs have: tests run side by side, and more only wait for one another.
unit types laws held smoke: export OMP_NUM_THREADS := 1

.PHONY: all help example resume verdict test lint unit types laws held cost gpu felupe engines pyvale-env al-dic-env smoke browser accuracy ablations sweep endurance cluster \
    slurm wheel pythons docs doctest release report bench profile next-test strangers family extremes challenge peers clean

# On a cluster: make PROFILE=profiles/slurm
RUN := $(BIN)/snakemake $(if $(PROFILE),--profile $(PROFILE),--cores $(CORES))

## Results

# Every result of config/config.yaml.
all: $(VENV)/run
	$(RUN)

# This list.
help:
	@awk '/^## /{printf "%s%s\n", sep, substr($$0,4); sep="\n"} /^# /{if (doc == "") doc=substr($$0,3)} /^$$/{doc=""} \
	  /^[a-z-]+:/{split($$0,t,":"); if (doc) printf "  make %-10s %s\n", t[1], doc; doc=""}' Makefile

# One small sheet with its figure and its page, into results/: two minutes.
example: $(VENV)/run
	$(RUN) --configfile config/example.yaml
	@echo 'look at results/figures/example.png and results/example/hypernode/explorer.html'

# After a crash or a kill: unlocks, but only where no run is going on, on any machine, and finishes what is missing.
resume: $(VENV)/run
	$(BIN)/python -m hypernode idle
	$(BIN)/snakemake --unlock
	$(RUN) --rerun-incomplete

# How far each run can be believed, the worst first; fails where a run does.
verdict: $(VENV)/run
	$(BIN)/python -m hypernode verdict results

# Ablations, seeds and other functions that neither the paper nor the README needs, into results/.
ablations: $(VENV)/run
	$(RUN) --configfile config/ablations.yaml

# What the published loss reaches on its own sheets, in results/tables/sweep.md: half an hour of processor.
sweep: $(VENV)/run
	$(RUN) --configfile config/ablations.yaml -- results/tables/sweep.md

# All results on one page, results/index.html: made aside, then filed among them with a record as they have.
report: $(VENV)/run
	mkdir -p .cache
	$(BIN)/snakemake --report .cache/report.zip
	$(BIN)/python -m hypernode audit report .cache/report.zip results
	@echo 'begin with results/index.html'

## Tests

# Lint, unit tests and a small run of the whole pipeline.
test: lint unit smoke

lint: $(VENV)/dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/snakefmt --check Snakefile workflow
	$(BIN)/python -m pytest -q --noconftest tests/workflow/test_lint.py

unit: $(VENV)/dev
	$(BIN)/python -m pytest -q -n $(CORES) --dist loadfile -m "not slow" tests --ignore tests/workflow

# Shapes and types of arguments and results, as their annotations promise them, at every call of tests.
TYPED := hypernode.mechanics,hypernode.material,hypernode.fem,hypernode.identification
CHECKED := deflated_cg errors force_course interfaces laminates left_out local_misfit observations partition projected_newton \
    regulariser terms
types: $(VENV)/dev
	$(BIN)/python -m pytest -q -n $(CORES) --dist loadfile -m "not slow" --jaxtyping-packages=$(TYPED),beartype.beartype \
	    tests/mechanics tests/material tests/fem $(CHECKED:%=tests/identification/test_%.py)

# Laws that take whole identifications, whole figures or a workflow of their own.
laws: $(VENV)/dev
	$(BIN)/python -m pytest -q -n $(CORES) --dist worksteal -m slow tests --smoke

# Of these, the accuracy of four small sheets of strangers: two minutes.
held: $(VENV)/dev
	$(BIN)/python -m pytest -q -n $(CORES) --dist worksteal -m slow tests/benchmarks/test_small_strangers.py

## Tests with more in the environment, or of minutes

# An identified sheet in felupe against the project's own finite elements; installs felupe: a minute.
felupe: $(VENV)/dev
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements/felupe.txt
	$(BIN)/python -m pytest -q tests/export/test_felupe.py

# Engines of image correlation on pictures of a known stretch; makes their environments, 3.6 GB: five minutes.
engines: $(VENV)/dev pyvale-env al-dic-env
	$(BIN)/python -m pytest -q tests/pictures/test_engines.py tests/pictures/test_transfer.py

pyvale-env: .venv-pyvale/run
al-dic-env: .venv-al-dic/run

smoke: $(VENV)/dev
	$(BIN)/python -m pytest -q -n $(CORES) --dist worksteal -m "not slow" tests/workflow --smoke --ignore tests/workflow/test_lint.py

# The explorer in Chromium, which the system must have: apt-get install chromium.
browser: $(VENV)/browser
	$(BIN)/python -m pytest -q tests/explorer/test_browser.py

# Ten kills in the middle of a run, and full disks at every stage: a quarter of an hour.
endurance: $(VENV)/dev
	$(BIN)/python -m pytest -q tests/workflow/test_endurance.py --endurance

# A few jobs through a queue of this machine that kills for memory as a cluster does: 3 minutes.
cluster: $(VENV)/cluster
	$(BIN)/python -m pytest -q tests/workflow/test_cluster.py --cluster

# The same through a Slurm of one node, started and taken down by itself; as root, 7 minutes.
slurm: $(VENV)/cluster
	command -v slurmctld >/dev/null && command -v munged >/dev/null || \
	    (apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends slurm-wlm munge)
	$(BIN)/python -m pytest -q tests/workflow/test_cluster.py --slurm

# A wheel in new environments without the repository, bare and with the pipeline: 5 minutes.
wheel: $(VENV)/dev
	$(BIN)/python -m pytest -q tests/packaging --wheel

# Laws of materials and configurations with every Python from 3.11 on that is here: 3 minutes each.
pythons: $(VENV)/dev
	$(BIN)/python -m pytest -q -rs tests/packaging/test_pythons.py --pythons

## Documentation

# The documentation in site/; a warning is an error. Figures are those of results/, where it is there.
docs: $(VENV)/run $(DOCS)/run
	$(DOCS)/bin/python -m docs.generator --command "$(abspath $(BIN))/hypernode"

# Every block of code in tutorial, guides and README, in copies of the repository: a quarter of an hour.
doctest: $(VENV)/dev
	$(BIN)/python -m pytest -q -rs tests/documentation --blocks

# What a release carries: the wheel in dist/, and the documentation in site/.
release: $(VENV)/run docs
	$(BIN)/python -m pip wheel --quiet --disable-pip-version-check --no-deps --wheel-dir dist .

## Accuracy and speed

# Many noisy tests of known sheets, without networks, into results/: over an hour. Fails beyond stated bounds.
accuracy: $(VENV)/dev
	$(BIN)/snakemake --cores $(CORES) --configfile config/accuracy.yaml
	$(BIN)/python -m pytest -q tests/workflow/test_accuracy.py --accuracy

# The further test that is advised against a random one, on ten small sheets: a quarter of an hour.
next-test: $(VENV)/dev
	$(BIN)/python benchmarks/next_test.py 10

# Known sheets of other finite elements and laws, identified from files: two hours. Sheets with a score are not run again.
# SEEDS="1 2 3" for others than those of the tables.
strangers: SEEDS ?= $(shell seq 1001 1024)
strangers: $(VENV)/dev
	$(BIN)/python -m benchmarks.strangers $(SEEDS) --cores $(CORES)

# Twenty sheets of one family, of which one is identified and all others are predicted: half an hour.
family: $(VENV)/dev
	$(BIN)/python benchmarks/family.py

# Sheets at the ends of what peers publish: contrast 200 at a stretch of 2, plane strain, E and nu: six minutes.
extremes: $(VENV)/dev
	$(BIN)/python benchmarks/extremes.py

# A rehearsal of the 2025 Mechanical MNIST Challenge on virtual sheets, by its own score: a quarter of an hour.
challenge: $(VENV)/run
	$(BIN)/python -m benchmarks.challenge

# Sets that peers published, identified and scored by the peers' own measure, into docs/peers.md: ten minutes.
# PEERS=FOLDER names the folder with those that you have.
peers: PEERS ?= external
peers: $(VENV)/run
	$(BIN)/python -m benchmarks.peers $(PEERS)

# Times of single steps: training, whole cases, forward problems, import, records.
bench: $(VENV)/run
	$(BIN)/python benchmarks/training_step.py
	$(BIN)/python benchmarks/whole_case.py X P_soft ring_low
	$(BIN)/python benchmarks/forward_size.py
	$(BIN)/python benchmarks/import_frames.py
	$(BIN)/python benchmarks/provenance.py

# Time, memory and counted work of the constrained field against cells, steps, terms, sheets and cores: five minutes.
# BENCH="--cells 25 50 100 200" for real grids, BENCH="--against COMMIT" beside another commit.
cost: $(VENV)/run
	$(BIN)/python benchmarks/cost.py $(BENCH)

# Processor seconds of the run in results/ by rule and by what its jobs did, beside its records: seconds.
profile: $(VENV)/run
	$(BIN)/python benchmarks/run_profile.py results

# Training and the forward problem on a device of CUDA against the CPU, after pip install -r requirements/gpu.txt.
gpu: $(VENV)/run
	$(BIN)/python benchmarks/on_gpu.py

$(VENV)/run: requirements.txt requirements/constraints.txt pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements.txt
	touch $@

$(VENV)/dev: requirements/dev.txt $(VENV)/run
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements/dev.txt
	touch $@

$(VENV)/cluster: requirements/cluster.txt $(VENV)/dev
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements/cluster.txt
	touch $@

$(VENV)/browser: requirements/browser.txt $(VENV)/dev
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements/browser.txt
	touch $@

$(DOCS)/run: requirements/docs.txt requirements/constraints.txt
	$(PYTHON) -m venv $(DOCS)
	$(DOCS)/bin/python -m pip install --quiet --disable-pip-version-check -r requirements/docs.txt
	touch $@

.venv-%/run: requirements/%.txt
	$(PYTHON) -m venv $(@D)
	$(@D)/bin/python -m pip install --quiet --disable-pip-version-check -r $<
	touch $@

clean:
	rm -rf results .cache site dist build
