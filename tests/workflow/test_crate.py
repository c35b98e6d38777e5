"""The results as a research object: complete, of its profile, and enough to draw a figure again."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

from requests import Response
from rocrate.rocrate import ROCrate
from rocrate.vocabs import RO_CRATE
from rocrate_validator.models import Severity, ValidationSettings
from rocrate_validator.services import validate
from rocrate_validator.utils.http import HttpRequester

from hypernode.storage.netcdf import sha256
from tests.workflow.running import ROOT


def problems_of_crate(folder, monkeypatch):
    """What a crate lacks of what its profile requires."""

    def shipped(_, url, **__):
        assert url.startswith("https://w3id.org/ro/crate/"), f"unexpected request of {url}"
        response = Response()
        response.status_code, response.headers["Content-Type"] = 200, "application/ld+json"
        # The shipped context is that of version 1.3; in 1.1 the words of Bioschemas have another prefix.
        content = json.dumps({"@context": RO_CRATE["@context"]})
        response._content = content.replace("https://bioschemas.org/terms/", "https://bioschemas.org/").encode()
        return response

    monkeypatch.setattr(HttpRequester, "get", shipped, raising=False)
    settings = ValidationSettings(
        rocrate_uri=folder, profile_identifier="workflow-run-crate-0.5", requirement_severity=Severity.REQUIRED
    )
    return [issue.message for issue in validate(settings).get_issues(Severity.REQUIRED)]


def test_a_figure_is_rebuilt_from_the_crate_alone(smoke, tmp_path):
    crate = ROCrate(smoke / "results")
    actions = [e for e in crate.get_entities() if e.id.startswith("#made-")]
    (action,) = (e for e in actions if e["result"].id == "figures/disc.pdf")
    for made_from in action["object"]:
        (tmp_path / made_from.id).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(smoke / "results" / made_from.id, tmp_path / made_from.id)
    names = {Path(o.id).stem: str(tmp_path / o.id) for o in action["object"]}
    settings = json.loads(action["description"])["settings"]
    inputs = {"evaluation": names["evaluation"], "truth": names["true_material"]}
    # In a process of its own: a figure is drawn in single precision, these tests run in double.
    script = "import json, sys; from hypernode.figures.render import render; "
    script += "render(*map(json.loads, sys.argv[1:4]), {})"
    arguments = [json.dumps(a) for a in (inputs, {"pdf": str(tmp_path / "again.pdf")}, settings)]
    subprocess.run([sys.executable, "-c", script, *arguments], check=True)
    assert sha256(tmp_path / "again.pdf") == crate.dereference("figures/disc.pdf")["sha256"]


def test_the_crate_holds_its_workflow_and_keeps_the_workflow_run_profile(smoke, monkeypatch):
    """The context that crates refer to is taken from the library that writes them: nothing is fetched."""
    folder = smoke / "results"
    crate = ROCrate(folder)
    assert (folder / crate.mainEntity.id).read_bytes() == (ROOT / "Snakefile").read_bytes()
    included = "workflow/Snakefile"
    assert (folder / "definition" / included).read_bytes() == (ROOT / included).read_bytes()
    scripts = {p.name for p in (ROOT / "workflow/scripts").glob("*.py")}
    assert {p.name for p in (folder / "definition/workflow/scripts").glob("*.py")} == scripts
    assert problems_of_crate(folder, monkeypatch) == []


def test_the_validator_finds_what_a_crate_lacks(smoke, tmp_path, monkeypatch):
    shutil.copytree(smoke / "results", tmp_path / "results")
    place = tmp_path / "results" / "ro-crate-metadata.json"
    content = json.loads(place.read_text())
    for entity in content["@graph"]:
        if entity["@type"] == "CreateAction":
            del entity["instrument"]
    place.write_text(json.dumps(content))
    assert problems_of_crate(tmp_path / "results", monkeypatch) != []
