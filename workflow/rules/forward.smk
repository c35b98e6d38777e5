rule true_material:
    input:
        lambda w: image_files(CONFIG, w.case),
    output:
        ensure("results/{case}/true_material.nc", non_empty=True),
        record="results/{case}/true_material.nc.json",
    log:
        "results/logs/{case}/true_material.log",
    benchmark:
        "results/benchmarks/{case}/true_material.jsonl"
    priority: 3
    group:
        "sheet"
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "true_material"),
        runtime=runtime(CONFIG, "true_material"),
    params:
        code=CODE["true_material"],
        settings=lambda w: slice_for(
            CONFIG,
            w.case,
            ("geometries", "materials"),
            keys=(
                "geometry",
                "inclusion",
                "matrix",
                "layers",
                "hole",
                "cells",
                "size",
                "thickness",
                "spacing",
            ),
        ),
    script:
        "../scripts/true_material.py"


rule forward:
    input:
        "results/{case}/true_material.nc",
    output:
        ensure("results/{case}/forward.nc", non_empty=True),
        record="results/{case}/forward.nc.json",
    log:
        "results/logs/{case}/forward.log",
    benchmark:
        "results/benchmarks/{case}/forward.jsonl"
    priority: 3
    group:
        "sheet"
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "forward"),
        runtime=runtime(CONFIG, "forward"),
    params:
        code=CODE["forward"],
        settings=lambda w: slice_for(
            CONFIG, w.case, ("loads",), keys=("loads", "thickness")
        ),
    script:
        "../scripts/forward.py"
