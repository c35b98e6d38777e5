"""The results as a research object."""

from pathlib import Path

from hypernode.runtime import job

with job(snakemake) as attributes:
    from hypernode import crate

    crate.write(Path(snakemake.output[0]).parent, snakemake.input.definition, attributes)
