"""Stage 2: noisy displacements of a synthetic test."""

from hypernode.config.slices import from_slice
from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.stages import measurement

    measurement.run(
        from_slice(snakemake.params.settings),
        snakemake.wildcards.case,
        snakemake.input[0],
        snakemake.output[0],
        attributes,
    )
