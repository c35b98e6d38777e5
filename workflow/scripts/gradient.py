"""Stage 3: deformation gradients."""

from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.stages import gradient

    gradient.run(
        snakemake.params.settings["gradient"],
        snakemake.wildcards.case,
        snakemake.input.measurement,
        snakemake.output[0],
        attributes,
        constrained_file=snakemake.input.get("constrained"),
    )
