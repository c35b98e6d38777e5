"""Stage 8: main training."""

from hypernode.config import partial_method
from hypernode.runtime import job

with job(snakemake) as attributes:  # noqa: F821
    from hypernode.stages import training

    training.run(
        partial_method(snakemake.params.settings),  # noqa: F821
        snakemake.wildcards.case,  # noqa: F821
        list(snakemake.input),  # noqa: F821
        snakemake.output[0],  # noqa: F821
        attributes,
    )
