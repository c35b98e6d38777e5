"""Stage 2: noisy displacements of a synthetic test."""

from hypernode.config import from_slice
from hypernode.runtime import job

with job(snakemake) as attributes:  # noqa: F821
    from hypernode.stages import measurement

    measurement.run(
        from_slice(snakemake.params.settings),  # noqa: F821
        snakemake.wildcards.case,  # noqa: F821
        snakemake.input[0],  # noqa: F821
        snakemake.output[0],  # noqa: F821
        attributes,
    )
