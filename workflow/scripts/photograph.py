"""Pictures of a synthetic test."""

from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.stages import photograph

    photograph.run(
        snakemake.params.settings,
        snakemake.wildcards.case,
        snakemake.input.forward,
        snakemake.input.speckle,
        snakemake.output[0],
        attributes,
    )
