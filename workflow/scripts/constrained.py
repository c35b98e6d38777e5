"""Stage 2b: the equilibrium field that explains the measured displacements and forces."""

from hypernode.config.methods import Constrained
from hypernode.pipeline.job import job

with job(snakemake, float64=True) as attributes:
    from hypernode.stages import constrained

    constrained.run(
        Constrained.model_validate(snakemake.params.settings["constrained"]),
        snakemake.wildcards.case,
        snakemake.input[0],
        snakemake.output[0],
        attributes,
    )
