"""The page that results are entered by."""

from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.stages import first_page

    evaluations = list(snakemake.input.evaluations)
    first_page.run(evaluations, snakemake.params.settings, snakemake.output[0], attributes)
