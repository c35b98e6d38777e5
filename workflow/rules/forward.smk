rule true_material:
    input:
        lambda w: image_files(CONFIG, w.case),
    output:
        ensure("results/{case}/true_material.nc", non_empty=True),
    log:
        "results/logs/{case}/true_material.log",
    benchmark:
        "results/benchmarks/{case}/true_material.jsonl"
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
    log:
        "results/logs/{case}/forward.log",
    benchmark:
        "results/benchmarks/{case}/forward.jsonl"
    params:
        code=CODE["forward"],
        settings=lambda w: slice_for(CONFIG, w.case, ("loads",), keys=("loads",)),
    script:
        "../scripts/forward.py"
