rule measurement:
    input:
        "results/{case}/forward.nc",
    output:
        ensure("results/{case}/measurement.nc", non_empty=True),
    log:
        "results/logs/{case}/measurement.log",
    benchmark:
        "results/benchmarks/{case}/measurement.jsonl"
    wildcard_constraints:
        case="|".join(map(re.escape, SYNTHETIC)) or "none",
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
    log:
        "results/logs/{case}/import_dic.log",
    benchmark:
        "results/benchmarks/{case}/import_dic.jsonl"
    wildcard_constraints:
        case="|".join(map(re.escape, REAL)) or "none",
    params:
        code=CODE["import_dic"],
        settings=lambda w: slice_for(CONFIG, w.case, ("specimens",), keys=("specimen",)),
    script:
        "../scripts/import_dic.py"
