"""One figure as PDF and PNG."""

from hypernode.runtime import job

with job(snakemake):  # noqa: F821
    from hypernode.figures import identification

    identification.draw(
        dict(snakemake.input),  # noqa: F821
        {"pdf": snakemake.output.pdf, "png": snakemake.output.png},  # noqa: F821
        snakemake.params.settings["step"],  # noqa: F821
    )
