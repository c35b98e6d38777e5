rule crate:
    input:
        targets=TARGETS,
        definition=DEFINITION,
    output:
        ensure("results/ro-crate-metadata.json", non_empty=True),
        definition=[
            f"results/definition/{path.relative_to(ROOT)}" for path in DEFINITION
        ],
        records=[
            "results/ro-crate-metadata.json.json",
            *(
                f"results/definition/{path.relative_to(ROOT)}.json"
                for path in DEFINITION
            ),
        ],
    log:
        "results/logs/crate.log",
    benchmark:
        "results/benchmarks/crate.jsonl"
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "crate"),
        runtime=runtime(CONFIG, "crate"),
    params:
        code=CODE["crate"],
    script:
        "../scripts/crate.py"
