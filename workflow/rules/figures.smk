rule figure:
    input:
        unpack(lambda w: figure_inputs(CONFIG, w.figure)),
    output:
        pdf=report(
            "results/figures/{figure}.pdf",
            caption="../report/figure.rst",
            category="Figures",
            labels={"figure": "{figure}", "format": "PDF"},
        ),
        png=report(
            "results/figures/{figure}.png",
            caption="../report/figure.rst",
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


rule table:
    input:
        lambda w: table_inputs(CONFIG, w.table, RUNS, CASES),
    output:
        csv=report(
            "results/tables/{table}.csv",
            caption="../report/table.rst",
            category="Tables",
            labels={"table": "{table}", "format": "CSV"},
        ),
        markdown="results/tables/{table}.md",
        latex="results/tables/{table}.tex",
    log:
        "results/logs/tables/{table}.log",
    benchmark:
        "results/benchmarks/tables/{table}.jsonl"
    params:
        code=CODE["table"],
        settings=lambda w: table_settings(CONFIG, w.table),
    script:
        "../scripts/table.py"
