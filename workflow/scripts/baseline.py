"""Stage 8b: a material without networks."""

from hypernode.config.slices import partial_method
from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.stages import baseline

    baseline.run(
        partial_method(snakemake.params.settings),
        snakemake.wildcards.case,
        dict(snakemake.input),
        snakemake.output[0],
        attributes,
    )
