"""Stage 5: homogenised NODE."""

from hypernode.config import partial_method
from hypernode.runtime import job

with job(snakemake) as attributes:  # noqa: F821
    from hypernode.stages import homogenised

    homogenised.run(
        partial_method(snakemake.params.settings),  # noqa: F821
        snakemake.wildcards.case,  # noqa: F821
        *snakemake.input,  # noqa: F821
        snakemake.output[0],  # noqa: F821
        attributes,
    )
