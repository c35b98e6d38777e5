rule true_material:
    output:
        ensure("results/{case}/true_material.nc", non_empty=True),
    params:
        code=CODE["true_material"],
        settings=lambda w: slice_for(
            CONFIG,
            w.case,
            ("geometries", "materials"),
            keys=("geometry", "inclusion", "matrix", "cells", "size"),
        ),
    log:
        "results/logs/{case}/true_material.log",
    benchmark:
        "results/benchmarks/{case}/true_material.jsonl"
    script:
        "../scripts/true_material.py"


rule forward:
    input:
        "results/{case}/true_material.nc",
    output:
        ensure("results/{case}/forward.nc", non_empty=True),
    params:
        code=CODE["forward"],
        settings=lambda w: slice_for(CONFIG, w.case, ("loads",), keys=("loads",)),
    log:
        "results/logs/{case}/forward.log",
    benchmark:
        "results/benchmarks/{case}/forward.jsonl"
    script:
        "../scripts/forward.py"
