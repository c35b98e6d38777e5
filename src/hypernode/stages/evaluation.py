"""Stage 9: how good an identified material is, on one scale for every run."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from hypernode.config.geometries import Image
from hypernode.config.model import Config
from hypernode.config.specimens import Specimen
from hypernode.data.measurement import mesh_of
from hypernode.dic.array_files import SUFFIXES
from hypernode.dic.labels import labelled_shape
from hypernode.evaluation.criteria import judge_run
from hypernode.evaluation.doubt import doubts
from hypernode.evaluation.judge import judge, shape_stretch
from hypernode.evaluation.judgement import Judgement
from hypernode.evaluation.level_budget import level_beside_samples, table
from hypernode.evaluation.refuted import refuted
from hypernode.evaluation.shape import PrintedShape
from hypernode.evaluation.suspects import evidence_of, with_suspects
from hypernode.evaluation.thresholds import SETTINGS
from hypernode.mechanics.modes import MODES
from hypernode.storage.netcdf import read, sha256, units_of, write
from hypernode.synthetic.geometry import make_shape


def run(config: Config, name: str, files: Mapping[str, str], output: str, attributes: dict) -> None:
    """Judge one run and write every number and field that figures and tables show.

    Args:
        files: paths of ``measurement``, ``gradient``, ``field`` (interpolant or gradient), ``material``,
            ``constrained`` where the method has one, ``truth`` where it is known, and ``printed``, the image of a
            specimen's shape.
    """
    files = dict(files)
    printed = files.pop("printed", None)
    case = config.cases[name]
    # The field is the gradient itself where the method has no interpolant: read each file once.
    opened = {path: read(path) for path in dict.fromkeys(files.values())}
    data = {key: opened[path] for key, path in files.items()}
    measurement = data["measurement"]
    kind = config.loads[case.loads[0]].kind if case.loads else config.specimens[case.specimen].load
    first = measurement["load_case"].values == 0
    stretches = np.array(case.judged_stretches or measurement["stretch"].values[first])
    shape = None
    if printed:
        corners = np.array(json.loads(measurement.attrs["field_corners"]))
        shape = PrintedShape(*_printed(printed, config.specimens[case.specimen], corners))
    judged = judge(data, kind, stretches, shape)
    budget = judged.budget
    largest = float(measurement["stretch"].values.max())
    doubt = doubts(data, mesh_of(measurement).centres, largest, level_beside_samples(budget))
    constrained = data.get("constrained")
    where = refuted(measurement, constrained)
    if where is not None:
        judged |= Judgement({"refuted_by": where.size, "refuted": where.counts(SETTINGS).astype(np.int8)})
    verdict = judge_run(judged.summary, measurement, constrained, SETTINGS, budget, doubt, where)
    evidence = evidence_of(judged.summary, judged.variables, measurement, constrained, budget)
    verdict = with_suspects(verdict, evidence)
    summary = {"case": name, "verdict": verdict.label, **judged.summary}
    weights = _trained_weights(data["material"])
    write(
        output,
        judged.variables,
        f"evaluation of {name}",
        {
            **attributes,
            "units": units_of(measurement),
            "thickness": float(measurement.attrs["thickness"]),
            "modes": MODES,
            "load": kind,
            "shape_stretch": shape_stretch(measurement),
            "raw_inputs": {printed: sha256(printed)} if printed else {},
            "summary": summary | ({"parameters": weights} if weights else {}),
            "verdict": verdict.stored(),
            "level_budget": [] if budget is None else table(budget),
            "doubt": [each.stored() for each in doubt],
        },
        parents=opened,
    )


def _printed(path: str, specimen: Specimen, corners: np.ndarray) -> tuple[Callable, np.ndarray, bool]:
    """What is known of a printed shape: by an image, or by labels of points, which lie as the points do."""
    if Path(path).suffix.lower() not in SUFFIXES:
        return make_shape(Image(shape="image", path=path)), corners, specimen.shape_flipped
    test = specimen.all_tests[0]
    return labelled_shape(Path(path), test.arrays.model_dump(), test.y_points != "down"), corners, False


def _trained_weights(file) -> int:
    """Number of trained weights of an identified material; zero where it has no networks."""
    return int(sum(file[v].size for v in file if v.startswith("hypernetwork.") and "frequencies" not in v))
