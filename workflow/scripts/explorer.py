"""Stage 12: one HTML file in which a run is looked at and asked."""

from hypernode.pipeline.job import job

with job(snakemake) as attributes:
    from hypernode.stages import explorer

    inputs = dict(snakemake.input)
    beside = {key.removeprefix("beside_"): path for key, path in inputs.items() if key.startswith("beside_")}
    files = {key: path for key, path in inputs.items() if not key.startswith("beside_")}
    explorer.run(files, beside, snakemake.output[0], attributes)
