"""Sheets of a population, from their geometry to their evaluation, one after the other in one process."""

from hypernode.config.slices import from_slice
from hypernode.pipeline.job import job
from hypernode.pipeline.populations import sheet_settings

with job(snakemake) as attributes:
    from hypernode.stages.population import run_batch

    run_batch(from_slice(snakemake.params.settings), snakemake.output[0], attributes, sheet_settings)
