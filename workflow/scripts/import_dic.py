"""Stage 2 of a specimen test: import of a DIC folder."""

from hypernode.config.slices import from_slice
from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.stages import import_dic

    import_dic.run(
        from_slice(snakemake.params.settings),
        snakemake.wildcards.case,
        snakemake.output[0],
        attributes,
    )
