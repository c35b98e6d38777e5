rule crate:
    input:
        TARGETS,
    output:
        ensure("results/ro-crate-metadata.json", non_empty=True),
    log:
        "results/logs/crate.log",
    benchmark:
        "results/benchmarks/crate.jsonl"
    params:
        code=CODE["crate"],
    script:
        "../scripts/crate.py"
