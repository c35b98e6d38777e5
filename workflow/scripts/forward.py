"""Stage 1: finite-element solution of every load case."""

from hypernode.config import from_slice
from hypernode.runtime import job

with job(snakemake, float64=True) as attributes:  # noqa: F821
    from hypernode.stages import forward

    forward.run(
        from_slice(snakemake.params.settings),  # noqa: F821
        snakemake.wildcards.case,  # noqa: F821
        snakemake.input[0],  # noqa: F821
        snakemake.output[0],  # noqa: F821
        attributes,
    )
