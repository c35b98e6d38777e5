"""The page's own way from its text to stresses, in Python."""

import base64
import json
import re
import zlib
from types import SimpleNamespace

import numpy as np

from hypernode.explorer.formulas import names_of_python
from hypernode.explorer.packing import Arrays


def decoded(entry: dict, arrays: Arrays | bytes) -> np.ndarray:
    """The numbers of an entry, as data.js makes them."""
    stream = zlib.decompress(base64.b64decode(arrays.text)) if isinstance(arrays, Arrays) else arrays
    *axes, points = entry["shape"]
    rows = int(np.prod(axes))
    size = entry["bytes"] * rows * points
    planes = np.frombuffer(stream, np.uint8, size, entry["at"]).reshape(entry["bytes"], rows, points)
    codes = sum(plane.astype(int) << 8 * k for k, plane in enumerate(planes))
    if "levels" in entry:
        values = [np.array(levels)[row] for levels, row in zip(entry["levels"], codes, strict=True)]
    else:
        known = np.array(entry["low"])[:, None] + np.array(entry["step"])[:, None] * codes
        values = np.where(codes == entry["nan"], np.nan, known)
    return np.reshape(values, entry["shape"])


def called(javascript: str):
    """The law of the text of a function (F, p) -> P; statements are Python as they are."""
    lines, results = re.fullmatch(r"\(F,p\)=>\{let (.*);\nreturn\[(.*)\]\}", javascript, re.DOTALL).groups()
    body = compile("\n".join(lines.split(",\n")), "law", "exec")

    def law(F, p):
        names = names_of_python() | {"F": np.ravel(F).tolist(), "p": np.ravel(p).tolist()}
        exec(body, names)
        return np.array([eval(result, names) for result in results.split(",")]).reshape(2, 2)

    return law


def params_at(packed: dict, arrays, cell: int) -> np.ndarray:
    """All parameters of a material at a cell, in their order."""
    rows = [decoded(entry, arrays).reshape(-1, entry["shape"][-1]) for entry in packed["params"]]
    return np.concatenate([each[:, cell if each.shape[1] > 1 else 0] for each in rows])


def page_parts(text: str) -> SimpleNamespace:
    """``data`` and ``stream`` of a page."""
    data, arrays = (re.search(f'id="{name}">(.*?)</script>', text, re.DOTALL).group(1) for name in ("data", "arrays"))
    return SimpleNamespace(data=json.loads(data), stream=zlib.decompress(base64.b64decode(arrays)))
