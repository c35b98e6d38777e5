"""Stage 1: finite-element solution of every load case."""

from hypernode.config.slices import from_slice
from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.stages import forward

    forward.run(
        from_slice(snakemake.params.settings),
        snakemake.wildcards.case,
        snakemake.input[0],
        snakemake.output[0],
        attributes,
    )
