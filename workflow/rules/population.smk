rule population_batch:
    output:
        # A folder, since how many sheets a job has is not in its name; each has a record beside it.
        directory("results/populations/{population}/{batch}"),
    log:
        "results/logs/populations/{population}/{batch}.log",
    benchmark:
        "results/benchmarks/populations/{population}/{batch}.jsonl"
    threads: 1
    resources:
        mem_mb=for_batch(POPULATIONS, "memory"),
        runtime=for_batch(POPULATIONS, "runtime"),
    params:
        code=CODE["population_batch"],
        settings=lambda w: POPULATIONS[w.population].settings(w.batch),
    script:
        "../scripts/population_batch.py"


rule population:
    input:
        lambda w: POPULATIONS[w.population].folders,
    output:
        ensure("results/populations/{population}.nc", non_empty=True),
        record="results/populations/{population}.nc.json",
    log:
        "results/logs/populations/{population}.log",
    benchmark:
        "results/benchmarks/populations/{population}.jsonl"
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "population"),
        runtime=runtime(CONFIG, "population"),
    params:
        code=CODE["population"],
    script:
        "../scripts/population.py"


rule population_table:
    input:
        "results/populations/{population}.nc",
    output:
        csv=report(
            "results/populations/{population}.csv",
            caption="../report/table.rst",
            category="Tables",
            labels={"table": "{population}", "format": "CSV"},
        ),
        markdown="results/populations/{population}.md",
        latex="results/populations/{population}.tex",
        records=multiext(
            "results/populations/{population}", ".csv.json", ".md.json", ".tex.json"
        ),
    log:
        "results/logs/populations/{population}_table.log",
    benchmark:
        "results/benchmarks/populations/{population}_table.jsonl"
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "population_table"),
        runtime=runtime(CONFIG, "population_table"),
    params:
        code=CODE["population_table"],
    script:
        "../scripts/population_table.py"
