"""The results as a research object."""

from pathlib import Path

from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.storage import crate

    inputs = snakemake.input
    crate.write(Path(snakemake.output[0]).parent, inputs.targets, inputs.definition, attributes)
