"""Stage 0: mesh and true material of a synthetic case."""

from hypernode.config.slices import from_slice
from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.stages import true_material

    true_material.run(from_slice(snakemake.params.settings), snakemake.wildcards.case, snakemake.output[0], attributes)
