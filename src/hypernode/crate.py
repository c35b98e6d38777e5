"""The results of a run as a Workflow Run RO-Crate: every file, what made it, from what, with which settings."""

import json
from pathlib import Path

from rocrate.model import ContextEntity
from rocrate.rocrate import ROCrate

from hypernode.audit import result_files
from hypernode.storage.netcdf import write_bytes_atomically
from hypernode.storage.records import read_record

NAME = "ro-crate-metadata.json"
PROFILES = (
    "https://w3id.org/ro/wfrun/process/0.5",
    "https://w3id.org/ro/wfrun/workflow/0.5",
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0",
)
FORMATS = {".nc": "application/netcdf", ".pdf": "application/pdf", ".png": "image/png", ".csv": "text/csv"}
FORMATS |= {".md": "text/markdown", ".tex": "application/x-tex"}


def build(folder: Path) -> ROCrate:
    """The crate of a results folder; files are described where they are, not copied.

    One action stands for each file: its instrument is the rule, its objects are the parents and raw
    inputs, and its settings are in the action's description.

    Raises:
        StorageError: a file has no intact record.
    """
    crate = ROCrate(gen_preview=False)
    crate.name = "hypernode results"
    crate.description = "Full-field identification of heterogeneous hyperelastic sheets"
    crate.license = "https://spdx.org/licenses/GPL-3.0-or-later"
    files = [path for path in result_files(folder) if path.name != NAME]
    records = {path: read_record(path) for path in files}
    crate.datePublished = max((r["written"] for r in records.values()), default="1970-01-01")
    profiles = [
        crate.add(ContextEntity(crate, uri, {"@type": "CreativeWork", "name": uri.rsplit("/", 2)[-2]}))
        for uri in PROFILES
    ]
    crate.root_dataset["conformsTo"] = profiles
    workflow = crate.add(
        ContextEntity(
            crate,
            "#workflow",
            {"@type": ["SoftwareSourceCode", "ComputationalWorkflow"], "name": "hypernode Snakefile"},
        )
    )
    rules = {}
    described = {}
    for path, record in records.items():
        name = path.relative_to(folder).as_posix()
        properties = {"sha256": record["sha256"], "contentSize": str(path.stat().st_size)}
        properties |= {"encodingFormat": FORMATS.get(path.suffix, "application/octet-stream")}
        described[path] = crate.add_file(dest_path=name, properties=properties)
    for path, record in records.items():
        rule = record["rule"] or "unknown"
        if rule not in rules:
            described_rule = {"@type": "SoftwareApplication", "name": rule, "softwareVersion": record["code"]}
            rules[rule] = crate.add(ContextEntity(crate, f"#rule-{rule}", described_rule))
        objects = [
            described[(path.parent / p).resolve()]
            for p in record["parents"]
            if (path.parent / p).resolve() in described
        ]
        for raw, digest in sorted(record["raw_inputs"].items()):
            identifier = f"#raw-{digest[:16]}"
            known = crate.dereference(identifier)
            described_raw = {"@type": "CreativeWork", "name": Path(raw).name, "sha256": digest}
            objects.append(known or crate.add(ContextEntity(crate, identifier, described_raw)))
        crate.add_action(
            rules[rule],
            identifier=f"#made-{record['sha256'][:16]}-{path.relative_to(folder).as_posix().replace('/', '-')}",
            object=objects,
            result=described[path],
            properties={
                "name": f"{rule} of {path.relative_to(folder).as_posix()}",
                "endTime": record["written"],
                "description": json.dumps(
                    {"settings": record["settings"], "versions": record["versions"]}, sort_keys=True
                ),
            },
        )
    crate.mainEntity = workflow
    workflow["hasPart"] = [rules[name] for name in sorted(rules)]
    return crate


def write(folder: Path, provenance: dict) -> None:
    """Write the crate's metadata into the results folder."""
    folder = folder.resolve()
    text = json.dumps(build(folder).metadata.generate(), indent=1, sort_keys=True) + "\n"
    write_bytes_atomically(
        folder / NAME, lambda temporary: Path(temporary).write_text(text, encoding="utf-8"), provenance
    )
