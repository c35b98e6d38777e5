rule explorer:
    input:
        unpack(lambda w: explorer_inputs(CONFIG, w.case, w.method, CASES)),
    output:
        report(
            "results/{case}/{method}/explorer.html",
            caption="../report/explorer.rst",
            category="Explorers",
            labels={"case": "{case}", "method": "{method}"},
        ),
        record="results/{case}/{method}/explorer.html.json",
    log:
        "results/logs/{case}/{method}/explorer.log",
    benchmark:
        "results/benchmarks/{case}/{method}/explorer.jsonl"
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "explorer"),
        runtime=runtime(CONFIG, "explorer"),
    params:
        code=CODE["explorer"],
        settings=lambda w: {"beside": EXPLORED.get((w.case, w.method))},
    script:
        "../scripts/explorer.py"
