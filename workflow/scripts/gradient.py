"""Stage 3: deformation gradients."""

from hypernode.runtime import job

with job(snakemake) as attributes:  # noqa: F821
    from hypernode.stages import gradient

    gradient.run(
        snakemake.params.settings["gradient"],  # noqa: F821
        snakemake.wildcards.case,  # noqa: F821
        snakemake.input[0],  # noqa: F821
        snakemake.output[0],  # noqa: F821
        attributes,
    )
