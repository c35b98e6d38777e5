rule evaluation:
    input:
        unpack(lambda w: truth_input(CONFIG, w.case)),
        unpack(lambda w: printed_input(CONFIG, w.case)),
        unpack(
            lambda w: field_inputs(
                CONFIG, w.case, w.method, "measurement", "field", "constrained"
            )
        ),
        gradient=lambda w: stage_file(CONFIG, w.case, w.method, "gradient"),
        material="results/{case}/{method}/material.nc",
    output:
        ensure("results/{case}/{method}/evaluation.nc", non_empty=True),
        record="results/{case}/{method}/evaluation.nc.json",
    log:
        "results/logs/{case}/{method}/evaluation.log",
    benchmark:
        "results/benchmarks/{case}/{method}/evaluation.jsonl"
    group:
        "judged"
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "evaluation"),
        runtime=runtime(CONFIG, "evaluation"),
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


rule validation:
    input:
        truth="results/{case}/true_material.nc",
        material="results/{case}/{method}/material.nc",
    output:
        ensure("results/{case}/{method}/validation.nc", non_empty=True),
        record="results/{case}/{method}/validation.nc.json",
    log:
        "results/logs/{case}/{method}/validation.log",
    benchmark:
        "results/benchmarks/{case}/{method}/validation.jsonl"
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "validation"),
        runtime=runtime(CONFIG, "validation"),
    params:
        code=CODE["validation"],
        settings=lambda w: slice_for(CONFIG, w.case, ("loads",), keys=("unseen_loads",)),
    script:
        "../scripts/validation.py"


rule references:
    input:
        unpack(lambda w: reference_inputs(CONFIG, w.case)),
        evaluation="results/{case}/{method}/evaluation.nc",
        material="results/{case}/{method}/material.nc",
    output:
        ensure("results/{case}/{method}/references.nc", non_empty=True),
        record="results/{case}/{method}/references.nc.json",
    log:
        "results/logs/{case}/{method}/references.log",
    benchmark:
        "results/benchmarks/{case}/{method}/references.jsonl"
    group:
        "judged"
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "references"),
        runtime=runtime(CONFIG, "references"),
    params:
        code=CODE["references"],
        settings=lambda w: CONFIG.cases[w.case].references,
    script:
        "../scripts/references.py"
