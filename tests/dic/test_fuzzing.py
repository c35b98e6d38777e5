"""Files that are damaged or written otherwise: each is refused with file and line, or every number of it is right."""

import re

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hypernode.dic.errors import DicError
from hypernode.dic.forces.record import read_force_record
from hypernode.dic.reading import read_series

SIDE = 6
POINTS = np.stack(np.meshgrid(500.0 * np.arange(SIDE), 500.0 * np.arange(SIDE)), axis=-1).reshape(-1, 2)
MOVED = [k * np.stack([np.sin(POINTS[:, 1] / 900.0), 1.0 + POINTS[:, 1] / 7.0], axis=1) for k in range(4)]
TIME = np.arange(0.0, 30.0)
WAY, FORCE = 61.7 * TIME, 113.43 * TIME - 0.0123 * TIME**2
HEADERS = ("x [um],y [um],u [um],v [um]", "X(um),Y(um),U(um),V(um)", "x_um,y_um,ux_um,uy_um")
RECORDS = ("Time (s),Displacement (um),Force (mN)", '"Time","Displacement","Force"\n"(s)","(um)","(mN)"')
#: Words that stand for a number, none, or half of one.
JUNK = (
    *("", "nan", "-", "1e400", "-inf", "1_000", "0x10", "--1", "1.2.3", "1,2,3", "x3", "1e", "+", "1 2", '"', "'7"),
    *("\x00", "é"),
)


def text_of(header, columns, digits):
    rows = (",".join(f"{value:.{digits}f}" for value in row) for row in zip(*columns, strict=True))
    return "\n".join([header, *rows]) + "\n"


def groups(digits):
    """Signs of thousands that no reader takes for a decimal sign, in numbers of so many decimals."""
    return [",", " ", "'", chr(0x202F)] + (["."] if digits else [])


@st.composite
def damage(draw, text, groups):
    """A text after one to three changes: some keep what it says, the others break it."""
    kinds = ["sign", "decimal", "comma", "group", "junk", "cell", "line", "cut", "blank", "quote", "end", "head"]
    separator, changed = ",", set()
    for _ in range(draw(st.integers(1, 3))):
        lines = text.split("\n")
        at = draw(st.integers(0, len(lines) - 1))
        if lines[at] in changed:
            # Two changes of one line may make another one that is whole.
            continue
        cells = lines[at].split(separator)
        k = draw(st.integers(0, len(cells) - 1))
        kind = draw(st.sampled_from(kinds))
        if kind == "sign" and draw(st.booleans()):
            new = draw(st.sampled_from(";\t|, "))
            text, separator = text.replace(separator, new), new
        elif kind == "sign":
            lines[at] = lines[at].replace(separator, draw(st.sampled_from(";\t ")))
            text = "\n".join(lines)
        elif kind == "decimal" and separator == ",":
            text, separator = text.replace(",", ";").replace(".", ","), ";"
        elif kind == "comma":
            cells[k] = cells[k].replace(".", ",")
        elif kind == "group":
            cells[k] = re.sub(r"^(-?\d{1,3})(\d{3})(?!\d)", rf"\1{draw(st.sampled_from(groups))}\2", cells[k])
        elif kind == "junk":
            cells[k] = draw(st.sampled_from(JUNK))
        elif kind == "cell":
            cells = cells[:k] + cells[k + 1 :] if draw(st.booleans()) else [*cells, "more"]
        elif kind == "line":
            others = [[*lines[:at], *lines[at + 1 :]], [*lines[:at], "", *lines[at:]], ["# made by", *lines]]
            text = "\n".join(draw(st.sampled_from(others)))
        elif kind == "cut":
            text = text[: draw(st.integers(0, len(text)))]
        elif kind == "blank":
            cells[k] = f"  {cells[k]} "
        elif kind == "quote":
            cells = [f'"{cell}"' for cell in cells]
        elif kind == "end":
            text = text.replace("\n", draw(st.sampled_from(["\r\n", "\r"])))
        elif kind == "head":
            text = text.upper() if draw(st.booleans()) else text.replace("[", "(").replace("]", ")")
        if kind in ("group", "junk", "cell", "blank", "quote", "comma"):
            changed.add(separator.join(cells))
            text = "\n".join([*lines[:at], separator.join(cells), *lines[at + 1 :]])
    return text


def encoded(draw, text):
    return text.encode(draw(st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "cp1252"])), errors="replace")


SETTINGS = settings(
    max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture], derandomize=True
)


@SETTINGS
@given(st.data())
def test_a_damaged_frame_is_refused_or_right(tmp_path_factory, data):
    folder = tmp_path_factory.mktemp("frames")
    header, digits = data.draw(st.sampled_from(HEADERS)), data.draw(st.sampled_from([0, 3, 4]))
    texts = [text_of(header, (*POINTS.T, *moved.T), digits) for moved in MOVED]
    broken = data.draw(damage(texts[2], groups(digits)))
    for k, text in enumerate(texts):
        (folder / f"frame{k:04d}.csv").write_bytes(text.encode())
    (folder / "frame0002.csv").write_bytes(encoded(data.draw, broken))
    try:
        series = read_series(folder)
    except DicError as error:
        assert str(folder) in str(error)
        return
    for frame in series.frames:
        true = MOVED[frame.number].reshape(SIDE, SIDE, 2) / 1e3
        known = np.isfinite(frame.displacement)
        np.testing.assert_allclose(frame.displacement[known], true[known], atol=0.6e-3 if digits == 0 else 1e-6)


@SETTINGS
@given(st.data())
def test_a_damaged_record_is_refused_or_right(tmp_path_factory, data):
    path = tmp_path_factory.mktemp("record") / "force_disp.csv"
    digits = data.draw(st.sampled_from([0, 2, 4]))
    broken = data.draw(damage(text_of(data.draw(st.sampled_from(RECORDS)), (TIME, WAY, FORCE), digits), groups(digits)))
    path.write_bytes(encoded(data.draw, broken))
    try:
        record = read_force_record(path)
    except DicError as error:
        assert str(path) in str(error)
        return
    near = np.abs(record.time[:, None] - TIME).argmin(axis=1)
    np.testing.assert_allclose(record.time, TIME[near], atol=1e-9)
    np.testing.assert_allclose(record.force[:, 0], FORCE[near] / 1e3, atol=0.6e-3 if digits == 0 else 1e-5)
