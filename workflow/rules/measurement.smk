rule measurement:
    input:
        "results/{case}/forward.nc",
    output:
        ensure("results/{case}/measurement.nc", non_empty=True),
        record="results/{case}/measurement.nc.json",
    log:
        "results/logs/{case}/measurement.log",
    benchmark:
        "results/benchmarks/{case}/measurement.jsonl"
    wildcard_constraints:
        case="|".join(map(re.escape, MEASURED)) or "none",
    priority: 3
    group:
        "sheet"
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "measurement"),
        runtime=runtime(CONFIG, "measurement"),
    params:
        code=CODE["measurement"],
        settings=lambda w: slice_for(
            CONFIG, w.case, ("noise",), keys=("noise", "camera")
        ),
    script:
        "../scripts/measurement.py"


rule import_dic:
    input:
        lambda w: specimen_files(CONFIG, w.case),
    output:
        ensure("results/{case}/measurement.nc", non_empty=True),
        record="results/{case}/measurement.nc.json",
    log:
        "results/logs/{case}/import_dic.log",
    benchmark:
        "results/benchmarks/{case}/import_dic.jsonl"
    wildcard_constraints:
        case="|".join(map(re.escape, REAL)) or "none",
    priority: 3
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "import_dic"),
        runtime=runtime(CONFIG, "import_dic"),
    params:
        code=CODE["import_dic"],
        settings=lambda w: slice_for(
            CONFIG, w.case, ("specimens", "geometries"), keys=("specimen", "hole")
        ),
    script:
        "../scripts/import_dic.py"
