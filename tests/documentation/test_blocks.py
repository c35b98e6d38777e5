"""Every block of code in the tutorial, the guides and the READMEs runs; one that cannot says why."""

from pathlib import Path

import pytest
import yaml

from hypernode.config.loading import load_config
from tests.documentation.blocks import CHECKED, RUN, SHOWN, blocks_of
from tests.documentation.copy import ROOT, Copy

PAGES = [
    *(Path(name) for name in ("README.md", "config/README.md", "docs/CONTRIBUTING.md", "docs/examples/README.md")),
    *(Path(f"docs/{name}.md") for name in ("index", "tutorial", "gallery", "experiments", "everything")),
    *sorted(path.relative_to(ROOT) for path in ROOT.glob("docs/how-to/*.md")),
]
BLOCKS = {page: blocks_of(page, ROOT) for page in PAGES}
LEFT_OUT = [
    (block, reason)
    for blocks in BLOCKS.values()
    for block in blocks
    for reason in (block.left_out, block.lines_left_out[1])
    if reason
]


def needs_option(request):
    if not request.config.getoption("--blocks"):
        pytest.skip("the blocks of the documentation run with --blocks")


@pytest.mark.parametrize("page", PAGES, ids=str)
def test_every_block_says_what_it_is(page):
    assert BLOCKS[page], f"{page} shows nothing"
    unknown = [block.where for block in BLOCKS[page] if block.language not in (*RUN, *CHECKED, *SHOWN)]
    assert not unknown
    idle = [block.where for block in BLOCKS[page] if block.lines_left_out[0] and block.code == block.text.rstrip("\n")]
    assert not idle, "no line begins like those that are left out"


def test_every_command_of_the_readme_runs_but_the_tests_themselves():
    left_out = [block for block in BLOCKS[Path("README.md")] if block.left_out]
    lines = [line for block in BLOCKS[Path("README.md")] for line in block.text.splitlines()]
    run = [line for block in BLOCKS[Path("README.md")] for line in block.code.splitlines()]
    assert left_out == [] and len(run) > 10
    assert [line.split(" #")[0].strip() for line in lines if line not in run] == ["make test"]


@pytest.mark.parametrize("page", PAGES, ids=str)
def test_configurations_of_a_page_are_valid_over_those_before_them(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    files = [ROOT / "config/config.yaml"]
    for block in BLOCKS[page]:
        if block.language == "yaml" and not block.left_out:
            files.append(tmp_path / f"line{block.line}.yaml")
            files[-1].write_text(_with_what_it_names(block.text), encoding="utf-8")
            load_config(*files)


def _with_what_it_names(text):
    """A configuration whose images are here, and whose specimens need no folder."""
    config = yaml.safe_load(text)
    for specimen in config.get("specimens", {}).values():
        specimen["optional"] = True
    for geometry in config.get("geometries", {}).values():
        if geometry["shape"] == "image":
            Path(geometry["path"]).parent.mkdir(parents=True, exist_ok=True)
            Path(geometry["path"]).touch()
    return yaml.safe_dump(config)


@pytest.fixture(scope="session")
def cache(tmp_path_factory):
    """What was compiled for one page serves the next."""
    return tmp_path_factory.mktemp("compiled")


@pytest.mark.parametrize("page", PAGES, ids=str)
def test_blocks_of_a_page_run_one_after_the_other(page, request, tmp_path, cache):
    needs_option(request)
    copy = Copy(tmp_path, cache)
    for block in BLOCKS[page]:
        if block.left_out:
            continue
        for command in block.before:
            assert copy.run("sh", command).returncode == 0, f"{block.where}: {command}"
        if block.file:
            (tmp_path / block.file).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / block.file).write_text(block.text, encoding="utf-8")
        elif block.language in RUN:
            done = copy.run(block.language, block.code)
            assert done.returncode == block.exit_code, f"{block.where}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"


@pytest.mark.parametrize(("block", "reason"), LEFT_OUT, ids=lambda each: getattr(each, "where", None))
def test_a_block_that_is_left_out_says_why(block, reason, request):
    needs_option(request)
    pytest.skip(f"{block.where}: {reason}")
