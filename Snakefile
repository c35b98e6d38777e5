"""From a displacement field to a material: validate the configuration, then rules in data-flow order."""

import os
import re
import sys
from pathlib import Path

from snakemake.utils import min_version

from hypernode.config.command_line import configuration_files, run_config
from hypernode.config.errors import ConfigError
from hypernode.config.slices import pictures_for, slice_for
from hypernode.pipeline.dag import (
    field_inputs,
    method_settings,
    only_pretrained,
    present_cases,
    previous_input,
    run_files,
    stage_file,
)
from hypernode.pipeline.forking import fork_jobs
from hypernode.pipeline.nodes import keep_compiled_by_machine, show_run_alive
from hypernode.pipeline.populations import for_batch, planned_populations
from hypernode.pipeline.resources import memory, runtime
from hypernode.pipeline.scheduling import lift_rate_limit, limit_memory
from hypernode.pipeline.shown import (
    explored_runs,
    explorer_inputs,
    figure_inputs,
    figure_runs,
    first_page_settings,
    rules_by_topic,
    table_inputs,
    table_settings,
)
from hypernode.pipeline.sources import (
    code_params,
    image_files,
    printed_input,
    reference_inputs,
    specimen_files,
    truth_input,
)

min_version("9.27")


report: "workflow/report/workflow.rst"


try:
    CONFIG = run_config(
        workflow, config, Path(workflow.basedir) / "config" / "config.yaml"
    )
except ConfigError as error:
    sys.exit(f"The configuration cannot be used.\n{error}")

CASES, LEFT_OUT = present_cases(CONFIG)
for line in LEFT_OUT:
    print(line, file=sys.stderr)
PHOTOGRAPHED = [name for name in CASES if CONFIG.cases[name].photographed]
REAL = [name for name in CASES if CONFIG.cases[name].specimen is not None]
MEASURED = [name for name in CASES if name not in (*PHOTOGRAPHED, *REAL)]
RUNS = [(name, method) for name in CASES for method in CONFIG.cases[name].methods]
METHODS = list(dict.fromkeys(method for _, method in RUNS))
BASELINES = [name for name in METHODS if CONFIG.methods[name].baseline]
ONLY_PRETRAINED = [name for name in METHODS if only_pretrained(CONFIG, name)]
POLISHED = [name for name in METHODS if CONFIG.methods[name].polish]
FULLY_TRAINED = [
    name for name in METHODS if name not in (*BASELINES, *ONLY_PRETRAINED, *POLISHED)
]
FIGURES = figure_runs(CONFIG, CASES)
EXPLORED = explored_runs(CONFIG, CASES)
POPULATIONS = planned_populations(CONFIG)
CODE = code_params(Path(workflow.basedir) / "workflow" / "scripts")


wildcard_constraints:
    case="|".join(map(re.escape, CASES)) or "none",
    method="|".join(map(re.escape, METHODS)) or "none",
    figure="|".join(map(re.escape, FIGURES)) or "none",
    table="|".join(map(re.escape, CONFIG.tables)),
    population="|".join(map(re.escape, POPULATIONS)) or "none",
    batch="[^/]+",


localrules:
    all,
    crate,
    explorer,
    figure,
    population_table,
    first_page,
    table,


SHOWN = [
    *[
        f"results/figures/{figure}.{kind}"
        for figure in FIGURES
        for kind in ("pdf", "png")
    ],
    *[
        f"results/tables/{table}.{kind}"
        for table in CONFIG.tables
        for kind in ("csv", "md", "tex")
    ],
    *[f"results/{case}/{method}/explorer.html" for case, method in EXPLORED],
    *[file for population in POPULATIONS.values() for file in population.outputs],
]
TARGETS = [
    *dict.fromkeys(file for run in RUNS for file in run_files(CONFIG, *run)),
    *SHOWN,
    "results/index.html",
]
# Relative, so that a project that has moved is not another one.
ROOT = Path(os.path.relpath(workflow.basedir))
DEFINITION = [
    ROOT / "Snakefile",
    *sorted(ROOT.glob("workflow/rules/*.smk")),
    *sorted(ROOT.glob("workflow/scripts/*.py")),
]

limit_memory(workflow)
keep_compiled_by_machine(workflow)
show_run_alive(workflow)


include: "workflow/rules/forward.smk"
include: "workflow/rules/pictures.smk"
include: "workflow/rules/measurement.smk"
include: "workflow/rules/interpolant.smk"
include: "workflow/rules/inverse.smk"
include: "workflow/rules/evaluation.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/explorer.smk"
include: "workflow/rules/population.smk"
include: "workflow/rules/first_page.smk"
include: "workflow/rules/crate.smk"


onstart:
    lift_rate_limit(workflow)
    fork_jobs(workflow, Path(workflow.basedir) / "workflow" / "scripts")


onsuccess:
    # Reading results takes packages that no job should wait for.
    from hypernode.tables.verdicts import tally

    if RUNS:
        print(
            tally(
                f"results/{case}/{method}/evaluation.nc" for case, method in RUNS
            ),
            file=sys.stderr,
        )


rule all:
    default_target: True
    input:
        TARGETS,
        # No rule reads a record, and one that is gone is made again only where it is asked for.
        [f"{file}.json" for file in TARGETS],
        "results/ro-crate-metadata.json",
