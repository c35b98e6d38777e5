"""One table as CSV, Markdown and LaTeX."""

from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.tables.build import build_table
    from hypernode.tables.writing import write_table

    files = {"csv": snakemake.output.csv, "markdown": snakemake.output.markdown, "latex": snakemake.output.latex}
    sources = list(snakemake.input)
    write_table(build_table(sources, snakemake.params.settings), files, attributes, sources)
