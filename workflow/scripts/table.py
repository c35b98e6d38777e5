"""One table as CSV, Markdown and LaTeX."""

from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.tables import runs as tables

    files = {"csv": snakemake.output.csv, "markdown": snakemake.output.markdown, "latex": snakemake.output.latex}
    tables.write_tables(list(snakemake.input.get("evaluations", [])), snakemake.params.settings, files, attributes)
