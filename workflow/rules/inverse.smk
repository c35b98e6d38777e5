LEARNING = ("measurement", "field", "homogenised", "constrained")


rule homogenised:
    input:
        unpack(lambda w: field_inputs(CONFIG, w.case, w.method, "measurement", "field")),
    output:
        ensure("results/{case}/{method}/homogenised.nc", non_empty=True),
    log:
        "results/logs/{case}/{method}/homogenised.log",
    benchmark:
        "results/benchmarks/{case}/{method}/homogenised.jsonl"
    params:
        code=CODE["homogenised"],
        settings=lambda w: method_settings(
            CONFIG, w.method, ("node", "homogenised", "seed")
        ),
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
    log:
        "results/logs/{case}/{method}/initialisation.log",
    benchmark:
        "results/benchmarks/{case}/{method}/initialisation.jsonl"
    params:
        code=CODE["initialisation"],
        settings=lambda w: method_settings(
            CONFIG, w.method, ("hypernetwork", "initialisation", "seed")
        ),
    script:
        "../scripts/initialisation.py"


rule pretraining:
    input:
        unpack(lambda w: field_inputs(CONFIG, w.case, w.method, *LEARNING)),
        previous="results/{case}/{method}/initialised.nc",
    output:
        ensure("results/{case}/{method}/pretrained.nc", non_empty=True),
    log:
        "results/logs/{case}/{method}/pretraining.log",
    benchmark:
        "results/benchmarks/{case}/{method}/pretraining.jsonl"
    params:
        code=CODE["pretraining"],
        settings=lambda w: method_settings(
            CONFIG, w.method, ("hypernetwork", "pretraining", "prior_weight", "seed")
        ),
    script:
        "../scripts/pretraining.py"


rule training:
    input:
        unpack(lambda w: field_inputs(CONFIG, w.case, w.method, *LEARNING)),
        previous="results/{case}/{method}/pretrained.nc",
    output:
        ensure("results/{case}/{method}/material.nc", non_empty=True),
    log:
        "results/logs/{case}/{method}/training.log",
    benchmark:
        "results/benchmarks/{case}/{method}/training.jsonl"
    params:
        code=CODE["training"],
        settings=lambda w: method_settings(
            CONFIG, w.method, ("hypernetwork", "training", "prior_weight", "seed")
        ),
    script:
        "../scripts/training.py"
