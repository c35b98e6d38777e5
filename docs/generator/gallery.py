"""The gallery: the figures of the repository, and those of a results folder, where there is one."""

import json
import shutil
from pathlib import Path

_NONE = "This site was built without results. `make` makes the figures of `config/config.yaml`; build it again then."


def page(written: str, results: Path, folder: Path) -> str:
    """The page in Markdown; figures of the results are copied beside it.

    Args:
        written: the page of the repository.
        results: a results folder, which may be absent.
        folder: where the figures of the results go.
    """
    lines = [written.rstrip("\n"), "", "## Figures of the results", ""]
    figures = sorted((results / "figures").glob("*.png"))
    if not figures:
        return "\n".join([*lines, _NONE, ""])
    lines += ["Figures of the results beside which this site was built.", ""]
    folder.mkdir(parents=True, exist_ok=True)
    for figure in figures:
        shutil.copyfile(figure, folder / figure.name)
        lines += [f"### {figure.stem}", "", f"![{figure.stem}]({folder.name}/{figure.name})", "", _caption(figure), ""]
    return "\n".join(lines)


def _caption(figure: Path) -> str:
    """What the figure's record says of it."""
    record = figure.with_name(figure.name + ".json")
    if not record.is_file():
        return ""
    said = json.loads(record.read_text(encoding="utf-8"))
    runs = sorted(
        {"/".join(Path(parent).parts[-3:-1]) for parent in said["parents"] if parent.endswith("evaluation.nc")}
    )
    kind = said["settings"].get("kind", "figure")
    return f"Kind `{kind}`, of {', '.join(f'`{run}`' for run in runs)}." if runs else ""
