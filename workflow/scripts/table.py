"""One table as CSV, Markdown and LaTeX."""

from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.tables.build import build_table
    from hypernode.tables.writing import write_table

    files = {"csv": snakemake.output.csv, "markdown": snakemake.output.markdown, "latex": snakemake.output.latex}
    results, benchmarks = (list(snakemake.input.get(key, [])) for key in ("results", "benchmarks"))
    table = build_table(benchmarks or results, snakemake.params.settings)
    write_table(table, files, attributes, results, raw_inputs=benchmarks)
