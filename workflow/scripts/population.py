"""All sheets of a population in one file."""

from pathlib import Path

from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.storage.collection import write_collection

    write_collection(
        snakemake.output[0], [file for folder in snakemake.input for file in Path(folder).glob("*.nc")], attributes
    )
