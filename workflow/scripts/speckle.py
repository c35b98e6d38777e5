"""What is sprayed on a photographed sheet."""

from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.stages import speckle

    speckle.run(snakemake.params.settings, snakemake.wildcards.case, snakemake.output[0], attributes)
