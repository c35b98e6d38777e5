rule figure:
    input:
        unpack(lambda w: figure_inputs(CONFIG, w.figure)),
    output:
        pdf=report(
            "results/figures/{figure}.pdf",
            caption="../report/identification.rst",
            category="Figures",
            labels={"figure": "{figure}", "format": "PDF"},
        ),
        png=report(
            "results/figures/{figure}.png",
            caption="../report/identification.rst",
            category="Figures",
            labels={"figure": "{figure}", "format": "PNG"},
        ),
    log:
        "results/logs/figures/{figure}.log",
    benchmark:
        "results/benchmarks/figures/{figure}.jsonl"
    params:
        code=CODE["figure"],
        settings=lambda w: FIGURES[w.figure].model_dump(mode="json"),
    script:
        "../scripts/figure.py"


rule summary:
    input:
        [f"results/{case}/{method}/evaluation.nc" for case, method in RUNS],
    output:
        csv=report(
            "results/tables/summary.csv",
            caption="../report/summary.rst",
            category="Tables",
            labels={"table": "summary of all runs", "format": "CSV"},
        ),
        markdown="results/tables/summary.md",
    log:
        "results/logs/tables/summary.log",
    benchmark:
        "results/benchmarks/tables/summary.jsonl"
    params:
        code=CODE["summary"],
    script:
        "../scripts/summary.py"
