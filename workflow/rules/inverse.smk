LEARNING = ("measurement", "field", "homogenised", "constrained")


rule homogenised:
    input:
        unpack(
            lambda w: field_inputs(
                CONFIG, w.case, w.method, "measurement", "field", "constrained"
            )
        ),
    output:
        ensure("results/{case}/{method}/homogenised.nc", non_empty=True),
        record="results/{case}/{method}/homogenised.nc.json",
    log:
        "results/logs/{case}/{method}/homogenised.log",
    benchmark:
        "results/benchmarks/{case}/{method}/homogenised.jsonl"
    priority: 1
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "homogenised"),
        runtime=runtime(CONFIG, "homogenised"),
    params:
        code=CODE["homogenised"],
        platform=CONFIG.platform,
        settings=lambda w: method_settings(CONFIG, w.method, "homogenised"),
    script:
        "../scripts/homogenised.py"


rule initialisation:
    input:
        unpack(
            lambda w: field_inputs(
                CONFIG, w.case, w.method, "measurement", "field", "homogenised"
            )
        ),
    output:
        ensure("results/{case}/{method}/initialised.nc", non_empty=True),
        record="results/{case}/{method}/initialised.nc.json",
    log:
        "results/logs/{case}/{method}/initialisation.log",
    benchmark:
        "results/benchmarks/{case}/{method}/initialisation.jsonl"
    priority: 1
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "initialisation"),
        runtime=runtime(CONFIG, "initialisation"),
    params:
        code=CODE["initialisation"],
        platform=CONFIG.platform,
        settings=lambda w: method_settings(CONFIG, w.method, "initialised"),
    script:
        "../scripts/initialisation.py"


rule pretraining:
    input:
        unpack(lambda w: field_inputs(CONFIG, w.case, w.method, *LEARNING)),
        unpack(lambda w: previous_input(CONFIG, w.case, w.method, "pretrained")),
    output:
        ensure("results/{case}/{method}/pretrained.nc", non_empty=True),
        record="results/{case}/{method}/pretrained.nc.json",
    log:
        "results/logs/{case}/{method}/pretraining.log",
    benchmark:
        "results/benchmarks/{case}/{method}/pretraining.jsonl"
    wildcard_constraints:
        method="|".join(map(re.escape, (*FULLY_TRAINED, *POLISHED))) or "none",
    priority: 1
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "pretraining"),
        runtime=runtime(CONFIG, "pretraining"),
    params:
        code=CODE["pretraining"],
        platform=CONFIG.platform,
        settings=lambda w: method_settings(CONFIG, w.method, "pretrained"),
    script:
        "../scripts/pretraining.py"


# Where nothing trains it further, the pre-trained network is the result.
use rule pretraining as only_pretraining with:
    output:
        ensure("results/{case}/{method}/material.nc", non_empty=True),
        record="results/{case}/{method}/material.nc.json",
    wildcard_constraints:
        method="|".join(map(re.escape, ONLY_PRETRAINED)) or "none",


rule polish:
    input:
        unpack(lambda w: field_inputs(CONFIG, w.case, w.method, *LEARNING)),
        unpack(lambda w: previous_input(CONFIG, w.case, w.method, "material")),
    output:
        ensure("results/{case}/{method}/material.nc", non_empty=True),
        record="results/{case}/{method}/material.nc.json",
    log:
        "results/logs/{case}/{method}/polish.log",
    benchmark:
        "results/benchmarks/{case}/{method}/polish.jsonl"
    wildcard_constraints:
        method="|".join(map(re.escape, POLISHED)) or "none",
    priority: 1
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "polish"),
        runtime=runtime(CONFIG, "polish"),
    params:
        code=CODE["polish"],
        settings=lambda w: method_settings(CONFIG, w.method, "polished"),
    script:
        "../scripts/polish.py"


rule training:
    input:
        unpack(lambda w: field_inputs(CONFIG, w.case, w.method, *LEARNING)),
        unpack(lambda w: previous_input(CONFIG, w.case, w.method, "material")),
    output:
        ensure("results/{case}/{method}/material.nc", non_empty=True),
        record="results/{case}/{method}/material.nc.json",
    log:
        "results/logs/{case}/{method}/training.log",
    benchmark:
        "results/benchmarks/{case}/{method}/training.jsonl"
    wildcard_constraints:
        method="|".join(map(re.escape, FULLY_TRAINED)) or "none",
    priority: 1
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "training"),
        runtime=runtime(CONFIG, "training"),
    params:
        code=CODE["training"],
        platform=CONFIG.platform,
        settings=lambda w: method_settings(CONFIG, w.method, "material"),
    script:
        "../scripts/training.py"


rule baseline:
    input:
        unpack(
            lambda w: field_inputs(
                CONFIG, w.case, w.method, "measurement", "field", "constrained"
            )
        ),
    output:
        ensure("results/{case}/{method}/material.nc", non_empty=True),
        record="results/{case}/{method}/material.nc.json",
    log:
        "results/logs/{case}/{method}/baseline.log",
    benchmark:
        "results/benchmarks/{case}/{method}/baseline.jsonl"
    wildcard_constraints:
        method="|".join(map(re.escape, BASELINES)) or "none",
    priority: 1
    group:
        "field"
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "baseline"),
        runtime=runtime(CONFIG, "baseline"),
    params:
        code=CODE["baseline"],
        settings=lambda w: method_settings(CONFIG, w.method, "baseline"),
    script:
        "../scripts/baseline.py"
