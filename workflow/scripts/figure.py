"""One figure as PDF and PNG."""

from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    settings = snakemake.params.settings
    from hypernode.figures import anisotropy, comparison, identification, overview, references

    layouts = {
        "anisotropy": anisotropy,
        "comparison": comparison,
        "identification": identification,
        "overview": overview,
        "references": references,
    }
    layouts[settings["kind"]].draw(
        dict(snakemake.input),
        {"pdf": snakemake.output.pdf, "png": snakemake.output.png},
        settings,
        attributes,
    )
