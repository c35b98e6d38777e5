rule constrained:
    input:
        "results/{case}/measurement.nc",
    output:
        ensure("results/{case}/{method}/constrained.nc", non_empty=True),
        record="results/{case}/{method}/constrained.nc.json",
    log:
        "results/logs/{case}/{method}/constrained.log",
    benchmark:
        "results/benchmarks/{case}/{method}/constrained.jsonl"
    priority: 2
    group:
        "field"
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "constrained"),
        runtime=runtime(CONFIG, "constrained"),
    params:
        code=CODE["constrained"],
        settings=lambda w: method_settings(CONFIG, w.method, "constrained"),
    script:
        "../scripts/constrained.py"


rule gradient:
    input:
        unpack(
            lambda w: field_inputs(
                CONFIG, w.case, w.method, "measurement", "constrained"
            )
        ),
    output:
        ensure("results/{case}/{method}/gradient.nc", non_empty=True),
        record="results/{case}/{method}/gradient.nc.json",
    log:
        "results/logs/{case}/{method}/gradient.log",
    benchmark:
        "results/benchmarks/{case}/{method}/gradient.jsonl"
    priority: 1
    group:
        "field"
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "gradient"),
        runtime=runtime(CONFIG, "gradient"),
    params:
        code=CODE["gradient"],
        settings=lambda w: method_settings(CONFIG, w.method, "gradient"),
    script:
        "../scripts/gradient.py"


rule interpolant:
    input:
        lambda w: stage_file(CONFIG, w.case, w.method, "gradient"),
    output:
        ensure("results/{case}/{method}/interpolant.nc", non_empty=True),
        record="results/{case}/{method}/interpolant.nc.json",
    log:
        "results/logs/{case}/{method}/interpolant.log",
    benchmark:
        "results/benchmarks/{case}/{method}/interpolant.jsonl"
    priority: 1
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "interpolant"),
        runtime=runtime(CONFIG, "interpolant"),
    params:
        code=CODE["interpolant"],
        platform=CONFIG.platform,
        settings=lambda w: method_settings(CONFIG, w.method, "interpolant"),
    script:
        "../scripts/interpolant.py"
