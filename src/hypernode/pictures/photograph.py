"""What a camera records of a speckled sheet that is deformed."""

import numpy as np
from jaxtyping import Bool, Float, UInt8
from scipy.ndimage import gaussian_filter

from hypernode.config.pictures import Pictures
from hypernode.fem.interpolation import NodalField
from hypernode.fem.mesh import Mesh
from hypernode.pictures.speckle import Pattern
from hypernode.pictures.view import View

#: Samples a pixel and direction, of which it is the mean: its sensor gathers light over all of its area.
SUB = 2
#: Largest distance of a sample from the point of the sheet that is seen there [pixel].
TOLERANCE = 1e-8
#: Rows of a picture that are computed together, for the sake of memory.
_BLOCK = 64


def followed(mesh: Mesh, u: Float[np.ndarray, "step node 2"]) -> Float[np.ndarray, "step node 2"]:
    """Displacements as seen by a camera that follows the middle of the sheet: no part moves further than it must.

    Machines that pull on both ends keep it where it is.
    """
    middle = 0.5 * (mesh.lower + mesh.upper)[None]
    return u - np.stack([NodalField.of(mesh, each).at(middle) for each in u])


def light(pattern: Pattern, field: NodalField, view: View, settings: Pictures) -> Float[np.ndarray, "row column"]:
    """Grey levels of a picture without noise, not rounded.

    Each sample of a pixel shows the point X of the sheet for which X + u(X) is the place that it sees.

    Args:
        field: displacement of the sheet.

    Raises:
        ValueError: the sheet is folded over.
    """
    fine = np.empty((view.rows * SUB, view.columns * SUB))
    for start in range(0, view.rows, _BLOCK):
        rows = np.arange(start, min(start + _BLOCK, view.rows))
        X = field.sources(view.places(_samples(view, rows, SUB)), TOLERANCE * view.mm_per_pixel)
        inside = _on_sheet(field, X)
        grey = np.full(len(X), settings.background)
        X = (X[inside] - (field.x[0], field.y[0])) / view.mm_per_pixel
        grey[inside] = settings.dark + (settings.bright - settings.dark) * pattern.at(X)
        fine[rows[0] * SUB : (rows[-1] + 1) * SUB] = grey.reshape(-1, view.columns * SUB)
    if settings.defocus:
        fine = gaussian_filter(fine, settings.defocus * SUB, mode="nearest")
    return fine.reshape(view.rows, SUB, view.columns, SUB).mean(axis=(1, 3))


def recorded(grey: Float[np.ndarray, "row column"], settings: Pictures, frame: int) -> UInt8[np.ndarray, "row column"]:
    """A picture as it is stored: with the camera's noise, which each frame has of its own, rounded to eight bits."""
    random = np.random.default_rng(np.random.SeedSequence([settings.seed, frame]))
    noisy = grey + settings.noise * random.normal(size=grey.shape)
    return np.clip(np.round(noisy), 0, 255).astype(np.uint8)


def sheet_mask(field: NodalField, view: View) -> Bool[np.ndarray, "row column"]:
    """Pixels whose centre sees the sheet at rest."""
    places = view.places(_samples(view, np.arange(view.rows), 1))
    return _on_sheet(field, places).reshape(view.rows, view.columns)


def _on_sheet(field: NodalField, X: Float[np.ndarray, "point 2"]) -> Bool[np.ndarray, " point"]:
    low, high = (np.array([field.x[end], field.y[end]]) for end in (0, -1))
    return ((low <= X) & (high >= X)).all(axis=1)


def _samples(view: View, rows: np.ndarray, sub: int) -> Float[np.ndarray, "sample 2"]:
    """(column, row) of the samples of whole rows of pixels, row by row of samples."""
    within = (np.arange(sub) + 0.5) / sub - 0.5
    column = (np.arange(view.columns)[:, None] + within).ravel()
    row = (rows[:, None] + within).ravel()
    return np.stack(np.meshgrid(column, row), axis=-1).reshape(-1, 2)
