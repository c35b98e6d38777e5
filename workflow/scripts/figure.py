"""One figure as PDF and PNG."""

from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.figures.render import render

    files = {"pdf": snakemake.output.pdf, "png": snakemake.output.png}
    render(dict(snakemake.input), files, snakemake.params.settings, attributes)
