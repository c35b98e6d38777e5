rule gradient:
    input:
        "results/{case}/measurement.nc",
    output:
        ensure("results/{case}/{method}/gradient.nc", non_empty=True),
    log:
        "results/logs/{case}/{method}/gradient.log",
    benchmark:
        "results/benchmarks/{case}/{method}/gradient.jsonl"
    params:
        code=CODE["gradient"],
        settings=lambda w: method_settings(CONFIG, w.method, ("gradient",)),
    script:
        "../scripts/gradient.py"


rule interpolant:
    input:
        "results/{case}/{method}/gradient.nc",
    output:
        ensure("results/{case}/{method}/interpolant.nc", non_empty=True),
    log:
        "results/logs/{case}/{method}/interpolant.log",
    benchmark:
        "results/benchmarks/{case}/{method}/interpolant.jsonl"
    params:
        code=CODE["interpolant"],
        settings=lambda w: method_settings(CONFIG, w.method, ("interpolant", "seed")),
    script:
        "../scripts/interpolant.py"
