"""Stage 9: evaluation of one run."""

from hypernode.config import from_slice
from hypernode.runtime import job

with job(snakemake) as attributes:  # noqa: F821
    from hypernode.stages import evaluation

    evaluation.run(
        from_slice(snakemake.params.settings),  # noqa: F821
        snakemake.wildcards.case,  # noqa: F821
        snakemake.input.measurement,  # noqa: F821
        snakemake.input.gradient,  # noqa: F821
        snakemake.input.interpolant,  # noqa: F821
        snakemake.input.material,  # noqa: F821
        snakemake.output[0],  # noqa: F821
        attributes,
        truth_file=snakemake.input.get("truth"),  # noqa: F821
    )
