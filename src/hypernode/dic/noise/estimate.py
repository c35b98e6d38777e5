"""The noise of measured displacements, from the displacements themselves."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hypernode.dic.errors import DicError
from hypernode.dic.noise.correlation import independent_factor
from hypernode.dic.noise.local import local_fit
from hypernode.dic.noise.static import frames_at_rest, says_something, static_fit

#: Noise of a reference over that of the other frames, below which it is the picture that they were compared with:
#: noise of a sheet at rest is a tenth of that of a deformed one at least.
_ROUNDING = 0.01
#: Frames at most, spread over the test, whose noise the reference's is compared with.
_COMPARED = 5


@dataclass(frozen=True)
class NoiseEstimate:
    """Noise of displacements, of each component.

    Attributes:
        level: standard deviation in each frame, in the unit of the displacements. NaN for frames with too few points or
            without any displacement, such as the reference.
        correlation_length: standard deviation of the Gaussian that would turn white noise into this noise [grid steps];
            0 for white noise.
        source: ``static frames`` or ``local fit``.
        equivalent: level of independent noise with the same power at wavelengths much longer than the correlation
            length. These wavelengths matter to a smooth field.
    """

    level: Float[np.ndarray, "frame 2"]
    correlation_length: Float[np.ndarray, " 2"]
    source: str
    equivalent: Float[np.ndarray, "frame 2"]

    def __str__(self) -> str:
        lengths = " and ".join(f"{one:.2g}" for one in self.correlation_length)
        return (
            f"noise of displacements by {self.source}: {_ranges(self.level)}; correlated over {lengths} grid steps, it "
            f"counts as independent noise of {_ranges(self.equivalent)}"
        )


def estimate_noise(
    displacement: Float[np.ndarray, "frame row column 2"],
    static: Sequence[int] | None = None,
    length: Float[np.ndarray, " 2"] | None = None,
) -> NoiseEstimate:
    """Measure the noise of displacements on a regular grid.

    Frames of the sheet at rest show all noise except rigid motion and mean gradient (:func:`.static.static_fit`). Their
    level is used for every later frame, and is raised where a later frame has more fine noise. Without such frames,
    differences along grid lines give the noise that is rougher than the deformation (:func:`.local.local_fit`, which
    states its limits).

    Args:
        displacement: of each frame in any unit, NaN where a point was lost. A reference of zeros may be among them.
        static: frames of the sheet at rest. By default they are searched among the first frames; an empty list means
            none.
        length: correlation length of the noise of each component, in grid steps, where it is known.

    Raises:
        DicError: no frame has about 6 x 6 known neighbouring points that moved, or a static frame is empty.
    """
    if static is None:
        displacement = _without_rounding(displacement)
    fine, fine_length = local_fit(displacement, length)
    if not np.isfinite(fine).all(axis=1).any():
        known = int(np.isfinite(displacement).all(axis=-1).sum(axis=(1, 2)).max(initial=0))
        raise DicError(
            f"displacements of {' x '.join(map(str, displacement.shape[1:3]))} points, at most {known} of them known "
            "in a frame and not all at rest, do not tell their noise: 6 x 6 do; give noise_mm or noise_pixels"
        )
    for frame in static or ():
        if not says_something(displacement[frame]):
            raise DicError(
                f"frame {frame}, given as static, has less than 36 points or no displacement at all: "
                "name others, or give noise_mm or noise_pixels"
            )
    at_rest = frames_at_rest(displacement, fine, fine_length) if static is None else list(static)
    if not at_rest:
        return _estimate(fine, fine_length, "local fit")
    level, length = static_fit(displacement, at_rest)
    return _estimate(_of_later_frames(level, at_rest, fine), length, "static frames")


def _without_rounding(displacement: Float[np.ndarray, "frame row column 2"]) -> np.ndarray:
    """The frames, the first of them at rest where its noise is none beside that of the others.

    A picture compared with itself says nothing of the noise of others, nor of its correlation.
    """
    if len(displacement) < 2 or not np.nan_to_num(displacement[0]).any():
        return displacement
    some = displacement[1 :: -(-len(displacement) // _COMPARED)]
    (first,), later = local_fit(displacement[:1])[0], local_fit(some)[0]
    later = later[np.isfinite(later).all(axis=1)]
    if not len(later) or not (first < _ROUNDING * np.median(later, axis=0)).all():
        return displacement
    return np.concatenate([np.where(np.isnan(displacement[:1]), np.nan, 0.0), displacement[1:]])


def _of_later_frames(
    level: Float[np.ndarray, "static 2"], at_rest: list[int], fine: Float[np.ndarray, "frame 2"]
) -> Float[np.ndarray, "frame 2"]:
    """Level of every frame: its own where static, else that of the static ones, raised by the ratio of fine noise."""
    together = np.sqrt((level**2).mean(axis=0))
    fine_together = np.sqrt(np.nanmean(fine[at_rest] ** 2, axis=0))
    ratio = np.divide(fine, fine_together, out=np.ones_like(fine), where=fine_together > 0.0)
    levels = together * np.maximum(1.0, ratio)
    levels[at_rest] = level
    return levels


def _estimate(level: np.ndarray, length: np.ndarray, source: str) -> NoiseEstimate:
    factor = np.array([independent_factor(one) for one in length])
    return NoiseEstimate(level, length, source, level * factor)


def _ranges(level: Float[np.ndarray, "frame 2"]) -> str:
    said = []
    for component, name in enumerate("uv"):
        known = level[np.isfinite(level[:, component]), component]
        low, high = f"{known.min():.3g}", f"{known.max():.3g}"
        said.append(f"{low if low == high else f'{low} to {high}'} in {name}")
    return ", ".join(said)
