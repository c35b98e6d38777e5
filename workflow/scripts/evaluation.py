"""Stage 9: evaluation of one run."""

from hypernode.config.slices import from_slice
from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.stages import evaluation

    evaluation.run(
        from_slice(snakemake.params.settings),
        snakemake.wildcards.case,
        dict(snakemake.input),
        snakemake.output[0],
        attributes,
    )
