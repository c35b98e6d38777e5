"""The page is one file that needs nothing else, says what it shows, and stays small."""

import json
import re

import pytest

from hypernode.explorer import page
from hypernode.explorer.errors import ExplorerError
from hypernode.explorer.page import LARGEST, explorer_page
from tests.explorer.decoding import page_parts
from tests.explorer.files import run_files


def plain(method: str = "m") -> dict:
    """A run whose material is quickly packed."""
    files = run_files(3, "fail", method)
    return {key: files[key] for key in ("evaluation", "measurement")} | {"material": files["truth"]}


@pytest.fixture(scope="module")
def text():
    return explorer_page(plain(), plain("other"))


def test_a_page_asks_for_nothing(text):
    markup = re.sub(r"<script.*?</script>", "", text, flags=re.DOTALL)
    assert re.findall(r"""(?:src|href)=["']([^"']*)""", markup) == ["data:,", "#sheet"]
    assert "@import" not in text and "url(" not in re.sub(r"url\(#side-", "", text)
    assert not re.search(r"\b(fetch|XMLHttpRequest|WebSocket|importScripts|sendBeacon)\b", text)
    assert set(re.findall(r"https?://[^\s\"'`]+", text)) == {"http://www.w3.org/2000/svg"}, "the name of SVG"
    assert "default-src 'none'" in text


def test_every_placeholder_is_filled(text):
    assert not re.search(r"\{\{\w+\}\}", text)


def test_two_runs_stand_in_one_page_and_share_the_text_of_their_laws(text):
    data = page_parts(text).data
    assert [run["name"] for run in data["runs"]] == ["half/m", "half/other"]
    assert [run["identified"]["law"] for run in data["runs"]] == [0, 0]
    assert text.count("(F,p)=>") == 1


def test_the_same_run_is_the_same_page(text):
    assert explorer_page(plain(), plain("other")) == text


@pytest.mark.slow
def test_a_sheet_of_fifty_by_fifty_cells_takes_less_than_two_megabytes():
    text = explorer_page(run_files(50))
    assert len(text.encode()) < 2_000_000 < LARGEST == 5_000_000


def test_a_page_that_grows_too_large_is_refused(monkeypatch):
    monkeypatch.setattr(page, "LARGEST", 10_000)
    with pytest.raises(ExplorerError, match=r"the page would take 0\.\d MB, .* too fine to be explored"):
        explorer_page(plain())
    with pytest.raises(ExplorerError, match="name one run alone"):
        explorer_page(plain(), plain("other"))


def test_runs_of_other_units_are_not_laid_beside_one_another():
    other = plain("other")
    units = json.dumps({"length": "mm", "stress": "MPa", "force": "N", "energy": "MPa"})
    other = other | {"evaluation": other["evaluation"].assign_attrs(units=units)}
    with pytest.raises(ExplorerError, match="other units"):
        explorer_page(plain(), other)


def test_text_of_a_file_cannot_end_the_element_that_holds_it():
    files = plain()
    cases = json.dumps(["</script><b>bold</b>"])
    text = explorer_page(files | {"measurement": files["measurement"].assign_attrs(load_cases=cases)})
    assert "</script><b>" not in text
    assert page_parts(text).data["runs"][0]["steps"][0].startswith("</script><b>bold</b>")
