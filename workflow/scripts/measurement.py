"""Stage 2: noisy displacements of a synthetic test."""

from hypernode.config_slices import from_slice
from hypernode.runtime import job

with job(snakemake) as attributes:
    from hypernode.stages import measurement

    measurement.run(
        from_slice(snakemake.params.settings),
        snakemake.wildcards.case,
        snakemake.input[0],
        snakemake.output[0],
        attributes,
    )
