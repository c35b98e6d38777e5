"""Stage 2b: the equilibrium field that explains the measured displacements and forces."""

from hypernode.config.methods import Constrained
from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.stages import constrained

    constrained.run(
        Constrained.model_validate(snakemake.params.settings["constrained"]),
        snakemake.wildcards.case,
        snakemake.input[0],
        snakemake.output[0],
        attributes,
    )
