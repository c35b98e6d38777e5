"""What provenance and verification cost, as a share of the jobs' own time, for a finished results folder.

For every result the work is done again that its job did for provenance alone: hashing the script and its
modules, the commit, the file, its parents and its record, and, for every file that the job read, the checks of
digest and ancestry. The sum is compared with the wall time of the jobs in ``results/benchmarks``.

Usage: python benchmarks/provenance.py [results]
"""

import json
import sys
import time
from pathlib import Path

from hypernode.pipeline.sources import code_params
from hypernode.storage.netcdf import ancestry
from hypernode.storage.provenance import describe
from hypernode.storage.records import check_digest, make_record, read_record, sha256, source_state


def repeated(path: Path, record: dict) -> None:
    """What one job did to record its result and to trust its inputs."""
    source_state.cache_clear()
    parents = [path.parent / parent for parent in record["parents"]]
    for parent in parents:
        check_digest(parent)
        for ancestor in read_record(parent)["parents"]:
            sha256(parent.parent / ancestor)
    described = describe(record["rule"], record["run"], record["settings"], record["code"])
    make_record(sha256(path), described, ancestry(path, parents))


def main():
    """Print and store the share."""
    results = Path(sys.argv[1] if len(sys.argv) > 1 else "results")
    spent, files = 0.0, 0
    for place in sorted(results.rglob("*.json")):
        path = place.with_suffix("")
        if not path.is_file():
            continue
        record = read_record(path)
        begun = time.perf_counter()
        repeated(path, record)
        spent += time.perf_counter() - begun
        files += 1
    timed = [json.loads(p.read_text().splitlines()[-1])["s"] for p in (results / "benchmarks").rglob("*.jsonl")]
    if not timed:
        sys.exit(f"error: {results} holds no finished run")
    # The Snakefile hashes the code of every rule, once for the run and once in each job's own process.
    begun = time.perf_counter()
    code_params(Path("workflow/scripts"))
    spent += (time.perf_counter() - begun) * (len(timed) + 1)
    row = {"files": files, "provenance_s": spent, "jobs_s": sum(timed), "share": spent / sum(timed)}
    print(f"{files} files: {spent:.1f} s of {sum(timed):.0f} s, {100 * row['share']:.1f} %")
    (results / "benchmarks" / "provenance.json").write_text(json.dumps(row, indent=1) + "\n")


if __name__ == "__main__":
    main()
