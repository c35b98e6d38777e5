rule speckle:
    output:
        ensure("results/{case}/speckle.nc", non_empty=True),
        record="results/{case}/speckle.nc.json",
    log:
        "results/logs/{case}/speckle.log",
    benchmark:
        "results/benchmarks/{case}/speckle.jsonl"
    wildcard_constraints:
        case="|".join(map(re.escape, PHOTOGRAPHED)) or "none",
    priority: 3
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "speckle"),
        runtime=runtime(CONFIG, "speckle"),
    params:
        code=CODE["speckle"],
        settings=lambda w: pictures_for(CONFIG, w.case, "speckle"),
    script:
        "../scripts/speckle.py"


rule photograph:
    input:
        forward="results/{case}/forward.nc",
        speckle="results/{case}/speckle.nc",
    output:
        ensure("results/{case}/pictures.nc", non_empty=True),
        record="results/{case}/pictures.nc.json",
    log:
        "results/logs/{case}/photograph.log",
    benchmark:
        "results/benchmarks/{case}/photograph.jsonl"
    wildcard_constraints:
        case="|".join(map(re.escape, PHOTOGRAPHED)) or "none",
    priority: 3
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "photograph"),
        runtime=runtime(CONFIG, "photograph"),
    params:
        code=CODE["photograph"],
        settings=lambda w: pictures_for(CONFIG, w.case, "photograph"),
    script:
        "../scripts/photograph.py"


rule correlate:
    input:
        "results/{case}/pictures.nc",
    output:
        ensure("results/{case}/correlated.nc", non_empty=True),
        record="results/{case}/correlated.nc.json",
    log:
        "results/logs/{case}/correlate.log",
    benchmark:
        "results/benchmarks/{case}/correlate.jsonl"
    wildcard_constraints:
        case="|".join(map(re.escape, PHOTOGRAPHED)) or "none",
    priority: 3
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "correlate"),
        runtime=runtime(CONFIG, "correlate"),
    params:
        code=CODE["correlate"],
        settings=lambda w: pictures_for(CONFIG, w.case, "correlate"),
    script:
        "../scripts/correlate.py"


rule photographed:
    input:
        forward="results/{case}/forward.nc",
        correlated="results/{case}/correlated.nc",
    output:
        ensure("results/{case}/measurement.nc", non_empty=True),
        record="results/{case}/measurement.nc.json",
    log:
        "results/logs/{case}/photographed.log",
    benchmark:
        "results/benchmarks/{case}/photographed.jsonl"
    wildcard_constraints:
        case="|".join(map(re.escape, PHOTOGRAPHED)) or "none",
    priority: 3
    threads: 1
    resources:
        mem_mb=memory(CONFIG, "photographed"),
        runtime=runtime(CONFIG, "photographed"),
    params:
        code=CODE["photographed"],
        settings=lambda w: slice_for(
            CONFIG, w.case, ("noise", "loads"), keys=("noise", "loads", "camera")
        ),
    script:
        "../scripts/photographed.py"
