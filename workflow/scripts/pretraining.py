"""Stage 7: uniform-stress pre-training."""

from hypernode.config.slices import partial_method
from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.stages import pretraining

    pretraining.run(
        partial_method(snakemake.params.settings),
        snakemake.wildcards.case,
        dict(snakemake.input),
        snakemake.output[0],
        attributes,
    )
