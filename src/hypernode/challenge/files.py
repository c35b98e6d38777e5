"""One test of the challenge as its file holds it: what is wrong with it, and what of it is used."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from hypernode.challenge.errors import ChallengeError

#: Array -> its number of axes; ``label`` may be absent.
ARRAYS = {"DIC_X": 3, "DIC_disp": 4, "instron_disp": 1, "instron_force": 1}
#: Side of every sheet of the challenge [mm].
SIDE = 40.0
#: Relative difference of the largest displacement and the crosshead's way that is one of rounding: the scale is theirs.
SAME = 1e-6
#: Share of the largest force below which a later frame is of a sheet that tears.
TORN = 0.97


@dataclass(frozen=True, kw_only=True)
class ChallengeTest:
    """A test whose arrays fit.

    Attributes:
        X: positions (nx, ny, 2) [mm], of a sheet of :data:`SIDE` where the file's millimetres are the crosshead's.
        u: displacements of the frames before the sheet tears (frame, nx, ny, 2) [mm].
        crosshead, force: of these frames (frame,) [mm], [N].
        label: material of each point (nx, ny); None where the file has none.
        down: axis of the arrays along which y goes.
        remarks: sentences on what was found out about the file.
    """

    X: Float[np.ndarray, "nx ny 2"]
    u: Float[np.ndarray, "frame nx ny 2"]
    crosshead: Float[np.ndarray, " frame"]
    force: Float[np.ndarray, " frame"]
    label: Int[np.ndarray, "nx ny"] | None
    down: int
    remarks: list[str]


def challenge_test(arrays: Mapping[str, np.ndarray], source: str) -> ChallengeTest:
    """Check the arrays of a file.

    Args:
        arrays: by name.
        source: name of the file, for messages.

    Raises:
        ChallengeError: an array is absent or does not fit the others.
    """
    _check(arrays, source)
    X, u = arrays["DIC_X"].astype(float), arrays["DIC_disp"].astype(float)
    crosshead, force = (arrays[name].astype(float) for name in ("instron_disp", "instron_force"))
    ranges = [np.ptp(X[..., 1].mean(axis=1 - axis)) for axis in (0, 1)]
    down, remarks = int(np.argmax(ranges)), []
    last = _before_it_tears(force)
    if last < len(force):
        remarks.append(f"the force falls after frame {last - 1}: the {len(force) - last} frames after it are left out")
    scale = _scale(X, u, crosshead, remarks)
    label = arrays["label"].astype(int) if "label" in arrays else None
    return ChallengeTest(
        X=scale * X,
        u=scale * u[:last],
        crosshead=crosshead[:last],
        force=force[:last],
        label=label,
        down=down,
        remarks=remarks,
    )


def _check(arrays: Mapping[str, np.ndarray], source: str) -> None:
    for name, axes in ARRAYS.items():
        if name not in arrays:
            raise ChallengeError(f"{source}: has no array {name}; a test of the challenge has {', '.join(ARRAYS)}")
        if arrays[name].ndim != axes:
            raise ChallengeError(f"{source}: {name} has the shape {arrays[name].shape}, and {axes} axes are expected")
    grid, frames = arrays["DIC_X"].shape[:2], len(arrays["DIC_disp"])
    wanted = {
        "DIC_X": (*grid, 2),
        "DIC_disp": (frames, *grid, 2),
        "instron_disp": (frames,),
        "instron_force": (frames,),
        "label": grid,
    }
    for name, shape in wanted.items():
        if name in arrays and arrays[name].shape != shape:
            raise ChallengeError(f"{source}: {name} has the shape {arrays[name].shape}, and {shape} fits the others")


def _before_it_tears(force: Float[np.ndarray, " frame"]) -> int:
    """How many frames there are before the force falls for good."""
    largest = int(np.argmax(force))
    fallen = np.flatnonzero(force[largest:] < TORN * force[largest])
    return largest + int(fallen[0]) if len(fallen) else len(force)


def _scale(X, u, crosshead, remarks: list[str]) -> float:
    """Factor by which the file's millimetres are those of the sheet."""
    travel, largest = abs(crosshead[-1] - crosshead[0]), np.nanmax(np.abs(u[..., 1]))
    if abs(travel - largest) > SAME * travel:
        return 1.0
    width = float(np.ptp(X[..., 0]))
    remarks.append(
        f"its millimetres are such that the largest displacement is the crosshead's way, {travel:.4g} mm, as if clamps "
        f"gave way by nothing: the field is {width:.4g} mm wide, and counts as {SIDE:g}"
    )
    return SIDE / width
