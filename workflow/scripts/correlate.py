"""Displacements of points from pictures."""

from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.stages import correlate

    correlate.run(
        snakemake.params.settings,
        snakemake.wildcards.case,
        snakemake.input[0],
        snakemake.output[0],
        snakemake.threads,
        attributes,
    )
