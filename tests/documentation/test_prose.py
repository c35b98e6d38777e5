"""Sentences of the README, the guides and the docstrings are short."""

import pytest

from tests.documentation.copy import ROOT
from tests.documentation.prose import docstrings, sentences, words

#: No sentence has more words than the first; fewer than one in twenty have more than the second.
LONGEST, LONG = 30, 25
PAGES = [
    *(ROOT / name for name in ("README.md", "config/README.md")),
    *sorted(page for page in ROOT.glob("docs/**/*.md") if page.parent.name != "decisions"),
]


def test_a_sentence_ends_at_a_stop_or_with_its_item_and_code_and_links_are_what_is_read():
    text = "# Not this\n\nOne `a b c` of [two words](a/b.md), 3.5 % of it. Two\nlines.\n\n- an item: here\n- another\n"
    text += "\n```sh\nnot this either. Nor this.\n```\n\n| a | table |\n"
    assert sentences(text) == ["One code of two words, 3.5 % of it.", "Two lines.", "an item: here", "another"]
    assert [words(each) for each in sentences(text)] == [8, 2, 3, 1]


@pytest.mark.parametrize("page", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_no_sentence_of_a_page_must_be_read_twice(page):
    assert [each for each in sentences(page.read_text()) if words(each) > LONGEST] == []


def test_few_sentences_of_all_pages_are_long():
    lengths = [words(each) for page in PAGES for each in sentences(page.read_text())]
    assert len(lengths) > 500
    assert sum(length > LONG for length in lengths) < len(lengths) / 20


@pytest.fixture(scope="module")
def said():
    """The sentences of all public docstrings."""
    files = sorted((ROOT / "src/hypernode").rglob("*.py"))
    return [each for path in files for _, text in docstrings(path) for each in sentences(text)]


def test_no_sentence_of_a_docstring_must_be_read_twice(said):
    assert [each for each in said if words(each) > LONGEST] == []


def test_few_sentences_of_docstrings_are_long(said):
    lengths = [words(each) for each in said]
    assert len(lengths) > 1000
    assert sum(length > LONG for length in lengths) < len(lengths) / 20
