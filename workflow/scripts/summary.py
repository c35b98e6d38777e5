"""The table of every run."""

from hypernode.runtime import job

with job(snakemake):
    from hypernode.figures import summary

    summary.write_tables(list(snakemake.input), snakemake.output.csv, snakemake.output.markdown)
