"""Stage 4: continuous deformation gradient."""

from hypernode.config import Interpolant
from hypernode.runtime import job

with job(snakemake) as attributes:  # noqa: F821
    from hypernode.stages import interpolant

    interpolant.run(
        Interpolant.model_validate(snakemake.params.settings["interpolant"]),  # noqa: F821
        snakemake.params.settings["seed"],  # noqa: F821
        snakemake.wildcards.case,  # noqa: F821
        snakemake.input[0],  # noqa: F821
        snakemake.output[0],  # noqa: F821
        attributes,
    )
