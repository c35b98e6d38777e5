"""From a displacement field to a material: validate the configuration, then rules in data-flow order."""

import os
import re
import sys
from pathlib import Path

from snakemake.utils import min_version

from hypernode.config.command_line import run_config
from hypernode.config.errors import ConfigError
from hypernode.config.slices import slice_for
from hypernode.pipeline.dag import (
    code_params,
    field_inputs,
    figure_inputs,
    figure_runs,
    image_files,
    method_settings,
    only_pretrained,
    present_cases,
    previous_input,
    printed_input,
    reference_inputs,
    specimen_files,
    stage_file,
    table_inputs,
    table_settings,
    truth_input,
)

min_version("9.27")


container: "docker://python:3.11"


try:
    CONFIG = run_config(
        workflow, config, Path(workflow.basedir) / "config" / "config.yaml"
    )
except ConfigError as error:
    sys.exit(f"The configuration cannot be used.\n{error}")

CASES, LEFT_OUT = present_cases(CONFIG)
for line in LEFT_OUT:
    print(line, file=sys.stderr)
SYNTHETIC = [name for name in CASES if CONFIG.cases[name].specimen is None]
REAL = [name for name in CASES if CONFIG.cases[name].specimen is not None]
RUNS = [(name, method) for name in CASES for method in CONFIG.cases[name].methods]
METHODS = list(dict.fromkeys(method for _, method in RUNS))
BASELINES = [name for name in METHODS if CONFIG.methods[name].baseline]
ONLY_PRETRAINED = [name for name in METHODS if only_pretrained(CONFIG, name)]
FULLY_TRAINED = [name for name in METHODS if name not in (*BASELINES, *ONLY_PRETRAINED)]
FIGURES = figure_runs(CONFIG, CASES)
CODE = code_params(Path(workflow.basedir) / "workflow" / "scripts")


wildcard_constraints:
    case="|".join(map(re.escape, CASES)) or "none",
    method="|".join(map(re.escape, METHODS)) or "none",
    figure="|".join(map(re.escape, FIGURES)) or "none",
    table="|".join(map(re.escape, CONFIG.tables)),


localrules:
    all,


TARGETS = [
    *[f"results/{case}/{method}/evaluation.nc" for case, method in RUNS],
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
]


include: "workflow/rules/forward.smk"
include: "workflow/rules/measurement.smk"
include: "workflow/rules/interpolant.smk"
include: "workflow/rules/inverse.smk"
include: "workflow/rules/evaluation.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/crate.smk"


onstart:
    # Snakemake's limit of submissions a second means nothing on one machine, but with one its scheduler wakes once a
    # second for every job that has ever ended: after hundreds of jobs, a large share of a core.
    workflow.scheduler.job_rate_limiter = None


rule all:
    default_target: True
    input:
        TARGETS,
        "results/ro-crate-metadata.json",
