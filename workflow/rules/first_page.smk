rule first_page:
    input:
        evaluations=[f"results/{case}/{method}/evaluation.nc" for case, method in RUNS],
        shown=SHOWN,
    output:
        ensure("results/index.html", non_empty=True),
        record="results/index.html.json",
    log:
        "results/logs/first_page.log",
    benchmark:
        "results/benchmarks/first_page.jsonl"
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "first_page"),
        runtime=runtime(CONFIG, "first_page"),
    params:
        code=CODE["first_page"],
        settings=first_page_settings(
            CONFIG, CASES, configuration_files(workflow), rules_by_topic(DEFINITION)
        ),
    script:
        "../scripts/first_page.py"
