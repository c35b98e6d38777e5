"""Stage 0: mesh and true material of a synthetic case."""

from hypernode.config_slices import from_slice
from hypernode.runtime import job

with job(snakemake) as attributes:
    from hypernode.stages import truth

    truth.run(from_slice(snakemake.params.settings), snakemake.wildcards.case, snakemake.output[0], attributes)
