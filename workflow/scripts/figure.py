"""One figure as PDF and PNG."""

from hypernode.runtime import job

with job(snakemake):
    from hypernode.figures import identification

    identification.draw(
        dict(snakemake.input),
        {"pdf": snakemake.output.pdf, "png": snakemake.output.png},
        snakemake.params.settings["step"],
    )
