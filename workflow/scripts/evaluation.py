"""Stage 9: evaluation of one run."""

from hypernode.config_slices import from_slice
from hypernode.runtime import job

with job(snakemake) as attributes:
    from hypernode.stages import evaluation

    evaluation.run(
        from_slice(snakemake.params.settings),
        snakemake.wildcards.case,
        snakemake.input.measurement,
        snakemake.input.gradient,
        snakemake.input.field,
        snakemake.input.material,
        snakemake.output[0],
        attributes,
        truth_file=snakemake.input.get("truth"),
    )
