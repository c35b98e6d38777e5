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
        records=multiext("results/figures/{figure}", ".pdf.json", ".png.json"),
    log:
        "results/logs/figures/{figure}.log",
    benchmark:
        "results/benchmarks/figures/{figure}.jsonl"
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "figure"),
        runtime=runtime(CONFIG, "figure"),
    params:
        code=CODE["figure"],
        settings=lambda w: FIGURES[w.figure].model_dump(mode="json"),
    script:
        "../scripts/figure.py"


rule table:
    input:
        unpack(lambda w: table_inputs(CONFIG, w.table, CASES)),
    output:
        csv=report(
            "results/tables/{table}.csv",
            caption="../report/table.rst",
            category="Tables",
            labels={"table": "{table}", "format": "CSV"},
        ),
        markdown="results/tables/{table}.md",
        latex="results/tables/{table}.tex",
        records=multiext("results/tables/{table}", ".csv.json", ".md.json", ".tex.json"),
    log:
        "results/logs/tables/{table}.log",
    benchmark:
        "results/benchmarks/tables/{table}.jsonl"
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "table"),
        runtime=runtime(CONFIG, "table"),
    params:
        code=CODE["table"],
        settings=lambda w: table_settings(CONFIG, w.table),
    script:
        "../scripts/table.py"
