"""The table of a population, by group."""

import xarray as xr

from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.storage.records import check_digest
    from hypernode.tables.populations import population_table
    from hypernode.tables.writing import write_table

    check_digest(snakemake.input[0])
    with xr.open_dataset(snakemake.input[0]) as collection:
        table = population_table(collection)
    files = {kind: snakemake.output[kind] for kind in ("csv", "markdown", "latex")}
    write_table(table, files, attributes, [snakemake.input[0]])
