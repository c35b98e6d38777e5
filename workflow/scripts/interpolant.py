"""Stage 4: continuous deformation gradient."""

from hypernode.config.methods import Interpolant
from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.stages import interpolant

    interpolant.run(
        Interpolant.model_validate(snakemake.params.settings["interpolant"]),
        snakemake.params.settings["seed"],
        snakemake.wildcards.case,
        snakemake.input[0],
        snakemake.output[0],
        attributes,
        snakemake.params.settings["normalised"],
    )
