"""The sheet as an unstructured grid of VTK with named arrays, and a page that says what they are."""

import tempfile
from pathlib import Path

import meshio
import numpy as np

from hypernode.export.fields import cell_fields, point_fields
from hypernode.export.run import Run


def vtu_files(run: Run) -> dict[str, bytes]:
    """{name: content} of ``sheet.vtu`` and ``sheet.md``."""
    cells, points = cell_fields(run), point_fields(run)
    grid = meshio.Mesh(
        np.pad(run.mesh.nodes, ((0, 0), (0, 1))),
        [("quad", run.mesh.cells)],
        point_data={name: field.values for name, field in points.items()},
        cell_data={name: [np.ascontiguousarray(field.values)] for name, field in cells.items()},
    )
    # meshio writes to paths alone.
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "sheet.vtu"
        meshio.vtu.write(path, grid)
        content = path.read_bytes()
    return {"sheet.vtu": content, "sheet.md": _page(run, {**cells, **points}).encode()}


def _page(run: Run, fields) -> str:
    """What every array means, in which unit, and the verdict in words."""
    verdict = run.verdict
    return "\n".join(
        [
            f"# Arrays of sheet.vtu, {run.name}",
            "",
            f"Lengths are in {run.material.units['length']}. Verdict on the run: {verdict.label}.",
            *(f"- {sentence}" for sentence in verdict.words),
            "",
            "| array | unit | meaning |",
            "|---|---|---|",
            *(f"| `{name}` | {field.unit} | {field.meaning} |" for name, field in fields.items()),
            "",
        ]
    )
