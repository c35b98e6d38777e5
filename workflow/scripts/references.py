"""Stage 11: homogeneous sheets with the identified phases."""

from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.stages import references

    references.run(
        snakemake.wildcards.case,
        snakemake.params.settings,
        dict(snakemake.input),
        snakemake.output[0],
        attributes,
    )
