"""Stage 5: homogenised NODE."""

from hypernode.config.slices import partial_method
from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.stages import homogenised

    homogenised.run(
        partial_method(snakemake.params.settings),
        snakemake.wildcards.case,
        dict(snakemake.input),
        snakemake.output[0],
        attributes,
    )
