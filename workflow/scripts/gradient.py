"""Stage 3: deformation gradients."""

from hypernode.runtime import job

with job(snakemake) as attributes:
    from hypernode.stages import gradient

    gradient.run(
        snakemake.params.settings["gradient"],
        snakemake.wildcards.case,
        snakemake.input[0],
        snakemake.output[0],
        attributes,
    )
