"""The results of a run as a Workflow Run RO-Crate: what made every file, from what, with which settings and code."""

import json
import shutil
from collections.abc import Iterable, Sequence
from pathlib import Path

from rocrate.model import ContextEntity
from rocrate.rocrate import ROCrate

from hypernode.storage.netcdf import write_bytes_atomically
from hypernode.storage.records import CRATE, ancestry_of

#: Where in a results folder the rules and scripts that made it are kept, as they were.
DEFINITION = "definition"
MAIN_WORKFLOW = f"{DEFINITION}/Snakefile"
#: Version of RO-Crate that the profiles below build on.
VERSION = "1.1"
PROFILES = (
    "https://w3id.org/ro/wfrun/process/0.5",
    "https://w3id.org/ro/wfrun/workflow/0.5",
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0",
)
FORMATS = {
    ".nc": "application/netcdf",
    ".pdf": "application/pdf",
    ".png": "image/png",
    ".csv": "text/csv",
    ".html": "text/html",
}


FORMATS |= {".md": "text/markdown", ".tex": "application/x-tex", ".py": "text/x-python", ".smk": "text/plain"}


def build(folder: Path, targets: Iterable[Path]) -> ROCrate:
    """The crate of a run: its targets and their ancestors; files stay where they are.

    One action stands for each file. Its instrument is the rule with the code that made it. Its objects are the parents
    and raw inputs. Its settings, versions and flags are in the action's description.

    Args:
        folder: the results folder, an absolute path.
        targets: what the run was asked for, and the definition of the workflow in the folder.

    Raises:
        StorageError: a file has no intact record.
    """
    records = {path: record for path, record in ancestry_of(targets).items() if path.is_relative_to(folder)}
    crate = _empty(ended=max((r["written"] for r in records.values()), default="1970-01-01"))
    described = {path: _described_file(crate, folder, path, record) for path, record in records.items()}
    language = {"@type": "ComputerLanguage", "name": "Snakemake", "url": {"@id": "https://snakemake.readthedocs.io"}}
    workflow = described[folder / MAIN_WORKFLOW]
    workflow["programmingLanguage"] = crate.add(
        ContextEntity(crate, "https://w3id.org/workflowhub/workflow-ro-crate#snakemake", language)
    )
    rules = {}
    for path, record in records.items():
        rule = _rule(crate, record)
        rules[rule.id] = rule
        _add_action(crate, folder, path, record, rule, described)
    crate.add_action(
        workflow,
        identifier="#run",
        result=list(described.values()),
        properties={"name": "run of the workflow", "endTime": crate.datePublished.isoformat()},
    )
    crate.mainEntity = workflow
    workflow["hasPart"] = [rules[name] for name in sorted(rules)]
    return crate


def _empty(ended: str) -> ROCrate:
    """A crate that says what it is, and follows which profiles, but holds nothing yet."""
    crate = ROCrate(gen_preview=False, version=VERSION)
    crate.name = "hypernode results"
    crate.description = "Full-field identification of heterogeneous hyperelastic sheets"
    crate.license = "https://spdx.org/licenses/GPL-3.0-or-later"
    crate.datePublished = ended
    crate.root_dataset["conformsTo"] = [
        crate.add(ContextEntity(crate, uri, {"@type": "CreativeWork", "name": uri.rsplit("/", 2)[-2]}))
        for uri in PROFILES
    ]
    return crate


def _rule(crate: ROCrate, record: dict):
    """The entity of a rule with the code that it had: files of one rule may have been made by different code."""
    identifier = f"#rule-{record['rule'] or 'unknown'}-{record['code'][:16]}"
    properties = {"@type": "SoftwareApplication", "name": record["rule"] or "unknown"}
    properties["softwareVersion"] = record["code"] or "unknown"
    return crate.dereference(identifier) or crate.add(ContextEntity(crate, identifier, properties))


def _described_file(crate: ROCrate, folder: Path, path: Path, record: dict):
    """The entity of one result file."""
    name = path.relative_to(folder).as_posix()
    properties = {"sha256": record["sha256"], "contentSize": str(path.stat().st_size)}
    properties |= {"encodingFormat": FORMATS.get(path.suffix, "application/octet-stream")}
    if name == MAIN_WORKFLOW:
        properties |= {"@type": ["File", "SoftwareSourceCode", "ComputationalWorkflow"], "name": "hypernode"}
    return crate.add_file(dest_path=name, properties=properties)


def _add_action(crate: ROCrate, folder: Path, path: Path, record: dict, rule, described: dict) -> None:
    """The action that made one result file from its parents and raw inputs."""
    parents = [(path.parent / parent).resolve() for parent in record["parents"]]
    objects = [described[parent] for parent in parents if parent in described]
    for raw, digest in sorted(record["raw_inputs"].items()):
        identifier = f"#raw-{digest[:16]}"
        known = crate.dereference(identifier)
        described_raw = {"@type": "CreativeWork", "name": Path(raw).name, "sha256": digest}
        objects.append(known or crate.add(ContextEntity(crate, identifier, described_raw)))
    name = path.relative_to(folder).as_posix()
    made_with = {key: record.get(key, {}) for key in ("settings", "code", "versions", "compiler")}
    crate.add_action(
        rule,
        identifier=f"#made-{record['sha256'][:16]}-{name.replace('/', '-')}",
        object=objects,
        result=described[path],
        properties={
            "name": f"{record['rule'] or 'unknown'} of {name}",
            "endTime": record["written"],
            "description": json.dumps(made_with, sort_keys=True),
        },
    )


def write(folder: Path, targets: Iterable[str], definition: Sequence[str], provenance: dict) -> None:
    """Write the workflow's definition and the crate's metadata into the results folder.

    Args:
        folder: the results folder.
        targets: what the run was asked for; the crate holds them and their ancestors, and nothing else that lies there.
        definition: the Snakefile, first, and the files below its folder that belong to it.
        provenance: what the job says of itself, for the records.
    """
    folder, root = folder.resolve(), Path(definition[0]).resolve().parent
    copies = [folder / DEFINITION / Path(source).resolve().relative_to(root) for source in definition]
    for source, copy in zip(definition, copies, strict=True):
        write_bytes_atomically(copy, lambda temporary, source=source: shutil.copyfile(source, temporary), provenance)
    crate = build(folder, [*map(Path, targets), *copies])
    text = json.dumps(crate.metadata.generate(), indent=1, sort_keys=True) + "\n"
    write_bytes_atomically(
        folder / CRATE, lambda temporary: Path(temporary).write_text(text, encoding="utf-8"), provenance
    )
