"""One folder with every page of the site: those of the repository as they are, and those that are made."""

import json
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from docs.generator import commands, configuration, decisions, gallery, interface
from docs.generator.navigation import menus


def assemble(root: Path, target: Path, command: Sequence[str], results: Path) -> None:
    """Fill a folder, laid out as the repository is, so that links between its pages hold in both.

    Args:
        root: of the repository.
        target: a folder, which is emptied.
        command: words that start ``hypernode``.
        results: a results folder, which may be absent.
    """
    shutil.rmtree(target, ignore_errors=True)
    shutil.copytree(root / "docs", target / "docs", ignore=shutil.ignore_patterns("generator", "__pycache__"))
    (target / "config").mkdir()
    shutil.copyfile(root / "config" / "README.md", target / "config" / "README.md")
    made, folder = target / "docs", root / "docs" / "decisions"
    index = (made / "index.md").read_text(encoding="utf-8")
    schema = subprocess.run([*command, "schema", "config"], capture_output=True, text=True, check=True).stdout
    pages = {
        "index.md": index + menus(),
        "reference/configuration.md": configuration.page(json.loads(schema)),
        "reference/commands.md": commands.page(command),
        "reference/interface.md": interface.page(root / "src" / "hypernode"),
        "decisions/index.md": decisions.page(folder) + decisions.menu(folder),
        "gallery.md": gallery.page(
            (made / "gallery.md").read_text(encoding="utf-8"), results, made / "results_figures"
        ),
    }
    for name, text in pages.items():
        (made / name).parent.mkdir(parents=True, exist_ok=True)
        (made / name).write_text(text, encoding="utf-8")
