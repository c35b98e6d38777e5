rule evaluation:
    input:
        unpack(lambda w: truth_input(CONFIG, w.case)),
        measurement="results/{case}/measurement.nc",
        gradient="results/{case}/{method}/gradient.nc",
        interpolant="results/{case}/{method}/interpolant.nc",
        material="results/{case}/{method}/material.nc",
    output:
        ensure("results/{case}/{method}/evaluation.nc", non_empty=True),
    log:
        "results/logs/{case}/{method}/evaluation.log",
    benchmark:
        "results/benchmarks/{case}/{method}/evaluation.jsonl"
    params:
        code=CODE["evaluation"],
        settings=lambda w: slice_for(
            CONFIG,
            w.case,
            ("loads", "specimens"),
            keys=("loads", "specimen", "judged_stretches"),
        ),
    script:
        "../scripts/evaluation.py"
