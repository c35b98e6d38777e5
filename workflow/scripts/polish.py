"""Stage 8: the pre-trained hyper-network under the finite-element constraint."""

from hypernode.config.slices import partial_method
from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.stages import polish

    polish.run(
        partial_method(snakemake.params.settings),
        snakemake.wildcards.case,
        dict(snakemake.input),
        snakemake.output[0],
        attributes,
    )
