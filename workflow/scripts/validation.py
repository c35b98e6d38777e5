"""Stage 10: loads that were not in the test."""

from hypernode.config.slices import from_slice
from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.stages import validation

    validation.run(
        from_slice(snakemake.params.settings),
        snakemake.wildcards.case,
        snakemake.input.truth,
        snakemake.input.material,
        snakemake.output[0],
        attributes,
    )
