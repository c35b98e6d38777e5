"""Stage 2 of a photographed sheet: its correlated points as a measurement."""

from hypernode.config.slices import from_slice
from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.stages import photographed

    photographed.run(
        from_slice(snakemake.params.settings),
        snakemake.wildcards.case,
        snakemake.input.forward,
        snakemake.input.correlated,
        snakemake.output[0],
        attributes,
    )
