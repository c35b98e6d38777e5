"""What the site is made of is complete and leads somewhere."""

import ast
import json
import re
from pathlib import Path

import pytest

from docs.generator import configuration, constants, decisions, gallery
from docs.generator.navigation import NAVIGATION

ROOT = Path(__file__).resolve().parents[2]
SCHEMA = json.loads((ROOT / "config/schema.json").read_text())
#: Pages of the site that are made when it is built.
MADE = ("reference/configuration", "reference/commands", "reference/interface")
PAGES = [ROOT / name for name in ("README.md", "config/README.md")] + sorted(ROOT.glob("docs/**/*.md"))


def test_the_reference_has_every_key_with_its_meaning():
    page = configuration.page(SCHEMA)
    for name, entry in SCHEMA["$defs"].items():
        if name.startswith("Changed"):
            assert f"### {name}" not in page
            continue
        section = page.split(f"### {name}\n")[1].split("\n### ")[0]
        rows = dict(re.findall(r"^\| `(\w+)` \|.*\|.*\| (.*) \|$", section, re.MULTILINE))
        assert set(rows) == set(entry.get("properties", {})), name
        nameless = [
            key for key, value in entry.get("properties", {}).items() if value.get("description") and not rows[key]
        ]
        assert not nameless


def test_every_entry_that_is_linked_to_is_there():
    page = configuration.page(SCHEMA)
    linked = set(re.findall(r"\(#(config-\w+)\)", page))
    assert linked and linked <= set(re.findall(r"^\((config-\w+)\)=$", page, re.MULTILINE))


def test_what_a_key_may_be_is_said_in_words():
    entry = {"type": "object", "required": ["a"], "properties": {
        "a": {"type": "number", "exclusiveMinimum": 0, "maximum": 2},
        "b": {"anyOf": [{"enum": ["x", "y"]}, {"type": "null"}], "default": None},
        "c": {"type": "array", "prefixItems": [{"type": "integer"}, {"type": "integer"}], "default": [1, 2]},
    }}  # fmt: skip
    page = configuration.page({"properties": {}, "$defs": {"Thing": entry}})
    assert "| `a` | number above 0 and at most 2 | must be given |" in page
    assert "| `b` | `x` or `y` or null | `null` |" in page
    assert "| `c` | list of 2: whole number | `[1, 2]` |" in page


def test_the_index_of_the_decisions_is_that_of_their_files():
    """Where this fails: ``python -m docs.generator.decisions > docs/decisions/index.md``."""
    assert (ROOT / "docs/decisions/index.md").read_text() == decisions.page(ROOT / "docs/decisions")


def test_the_page_of_the_constants_is_that_of_their_modules():
    """Where this fails: ``python -m docs.generator.constants > docs/constants.md``."""
    assert (ROOT / "docs/constants.md").read_text() == constants.page(ROOT / "src/hypernode/identification")


def test_a_constant_has_the_comment_above_it_as_its_reason_and_without_one_is_refused():
    text = '"""What."""\n\n# Some.\n#: One\n#: reason.\nA = 1.0 / 2.0\n#: Another.\nB = (1, 2)\n'
    found = constants.constants(text)
    assert [(each.name, each.value, each.reason, each.group) for each in found] == [
        ("A", "1.0 / 2.0", "One reason.", "Some."),
        ("B", "(1, 2)", "Another.", "Some."),
    ]
    with pytest.raises(ValueError, match="C has no reason and a group"):
        constants.constants(f"{text}C = 3\n")


def test_the_index_has_every_decision_once_under_its_topic(tmp_path):
    (tmp_path / "0001-a.md").write_text("# 1. A\n\nStatus: superseded in part by 0002. Topic: noise.\n")
    (tmp_path / "0002-b.md").write_text("# 2. B\n\nStatus: accepted. Topic: laws. Supersedes in part: 0001.\n")
    sections = dict(part.split("\n", 1) for part in decisions.page(tmp_path).split("\n## ")[1:])
    assert "| 1 | [A](0001-a.md) | superseded in part by 2 |" in sections["Noise"]
    assert "| 2 | [B](0002-b.md) | accepted |" in sections["Laws"]
    assert "[A]" not in sections["Laws"]


@pytest.mark.parametrize(
    ("files", "said"),
    [
        ({"0001-a.md": "# 2. A\n\nStatus: accepted. Topic: laws."}, "and not with '# 1. Title'"),
        ({"0001-a.md": "# 1. A\n\nWhy."}, "0001-a.md: line 3 is 'Why.'; write 'Status: accepted. Topic: T.'"),
        ({"0001-a.md": "# 1. A\n\nStatus: accepted. Topic: whales."}, "with T one of measurements, "),
        (
            dict.fromkeys(("0001-a.md", "0001-b.md"), "# 1. A\n\nStatus: accepted. Topic: laws."),
            "0001-b.md and 0001-a.md have one number",
        ),
        (
            {
                "0001-a.md": "# 1. A\n\nStatus: accepted. Topic: laws.",
                "0002-b.md": "# 2. B\n\nStatus: accepted. Topic: laws. Supersedes: 0001.",
            },
            "0001 and 0002 do not agree that the second supersedes the first",
        ),
    ],
)
def test_a_decision_without_status_or_with_one_that_another_contradicts_is_refused(tmp_path, files, said):
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    with pytest.raises(ValueError, match=re.escape(said)):
        decisions.page(tmp_path)


def test_the_gallery_shows_every_figure_of_the_repository_with_a_sentence_and_a_command():
    sections = (ROOT / "docs/gallery.md").read_text().split("\n## ")[1:]
    shown = [re.findall(r"!\[[^\]]+\]\((\S+)\)", section) for section in sections]
    assert all(len(figures) == 1 for figures in shown)
    committed = {path.name for path in [*ROOT.glob("docs/*.png"), *ROOT.glob("docs/figures/*")]}
    assert {Path(figure).name for (figure,) in shown} == committed
    for section in sections:
        assert re.search(r"^[A-Z].*\.$", section, re.MULTILINE) and "```sh\n" in section


def test_the_gallery_shows_figures_with_the_runs_they_are_of_or_says_that_there_are_none(tmp_path):
    assert "# Gallery\n\n## Fig" in gallery.page("# Gallery\n", tmp_path / "results", tmp_path / "figures")
    assert "without results" in gallery.page("", tmp_path / "results", tmp_path / "figures")
    folder = tmp_path / "results/figures"
    folder.mkdir(parents=True)
    (folder / "leaf.png").write_bytes(b"png")
    said = {"parents": {"../leaf/hypernode/evaluation.nc": "0"}, "settings": {"kind": "identification"}}
    (folder / "leaf.png.json").write_text(json.dumps(said))
    page = gallery.page("", tmp_path / "results", tmp_path / "figures")
    assert "![leaf](figures/leaf.png)" in page and "Kind `identification`, of `leaf/hypernode`." in page
    assert (tmp_path / "figures/leaf.png").read_bytes() == b"png"


def test_every_page_is_in_the_menu_and_every_entry_of_the_menu_is_a_page():
    listed = {name for pages in NAVIGATION.values() for name in pages}
    written = {str(path.relative_to(ROOT / "docs").with_suffix("")) for path in ROOT.glob("docs/**/*.md")}
    alone = {name for name in written if not name.startswith("decisions/")} - {"index"}
    assert alone <= listed
    assert not [name for name in listed - set(MADE) if not (ROOT / "docs" / f"{name}.md").is_file()]


@pytest.mark.parametrize("page", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_between_files_lead_somewhere(page):
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    links = re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", text)
    assert not [link for link in links if "://" not in link and not (page.parent / link).exists()]


PACKAGE = ROOT / "src/hypernode"
ROOMS = "|".join(sorted(path.stem for path in PACKAGE.iterdir() if not path.name.startswith("_")))


@pytest.mark.parametrize("page", ["equations", "how-identification-decides", "glossary"])
def test_every_place_that_the_mathematics_names_is_in_the_code(page):
    text = (ROOT / f"docs/{page}.md").read_text()
    places = re.findall(rf"`((?:{ROOMS})(?:\.\w+)+)`", text)
    assert len(places) >= 5
    assert [place for place in places if not (is_file(place) or is_defined(place))] == []


def is_file(place):
    """Whether a name such as ``measurement.nc`` is that of a result."""
    return place.endswith(".nc")


def is_defined(place):
    """Whether a dotted name is a package, a module, or what a module or a class defines."""
    folder, *names = place.split(".")
    path = PACKAGE / folder
    while names and path.is_dir():
        path /= names.pop(0)
    if path.is_dir():
        return True
    if not (path := path.with_suffix(".py")).is_file():
        return False
    body = ast.parse(path.read_text()).body
    for name in names:
        found = [node for node in body if name in (getattr(node, "name", ""), *assigned(node))]
        if not found:
            return False
        body = getattr(found[0], "body", [])
    return True


def assigned(node):
    return [target.id for target in getattr(node, "targets", ()) if isinstance(target, ast.Name)]


def test_a_place_that_is_gone_is_told_from_one_that_is_there():
    assert is_defined("identification.strategy") and is_defined("identification.strategy.identify")
    assert is_defined("verdict.Ending.CONVERGED") and not is_defined("verdict.Ending.GONE")
    assert not is_defined("identification.gone") and not is_defined("identification.strategy.perturbed")


def test_what_the_page_on_decisions_names_of_a_file_is_in_its_schema():
    page, schema = ((ROOT / f"docs/{name}.md").read_text() for name in ("how-identification-decides", "schema"))
    named = re.findall(r"`([a-z]+_[a-z_]+)`", page)
    assert len(named) >= 2 and [name for name in named if f"`{name}`" not in schema] == []


def test_the_page_on_decisions_leads_to_the_modules_that_decide():
    page = (ROOT / "docs/how-identification-decides.md").read_text()
    modules = {path.stem for path in (PACKAGE / "identification").glob("*.py")}
    named = set(re.findall(r"`identification\.(\w+)`", page))
    assert {"interface_search", "law_search", "candidate", "interface_answer", "strategy", "choice", "score"} <= named
    assert named <= modules
