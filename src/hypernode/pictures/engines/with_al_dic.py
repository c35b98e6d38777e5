"""Follows points through the pictures of a folder with al-dic: `python with_al_dic.py FOLDER`.

Takes and leaves what with_pyvale.py does. al-dic states no quality and puts something in the place of every lost point.
So what it found is judged here by the zero-normalised cross-correlation of each subset in the two pictures that were
compared. A point that it cannot have seen is lost.
"""

import json
import sys
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
from al_dic import dicpara_default, run_aldic
from al_dic.core.data_structures import GridxyROIRange
from al_dic.mesh.mesh_setup import mesh_setup
from al_dic.solver.seed_auto_place import AutoPlaceConfig, auto_place_seeds_on_mesh
from al_dic.solver.seed_prop_pipeline import build_grid_for_roi
from al_dic.solver.seed_propagation import SeedPropagationError
from al_dic.utils.region_analysis import precompute_node_regions
from scipy.ndimage import gaussian_filter, map_coordinates, minimum_filter
from scipy.spatial import KDTree

#: Change of the parameters below which a subset is at rest [pixel]; al-dic's own 0.01 costs a third of the accuracy.
TOLERANCE = 1e-3
#: Correlation below which a point is lost, and standard deviation of the Gaussian by which pictures are smoothed before
#: it is computed [pixel], both as in pyvale: in pictures as they are, the camera's noise would decide.
LEAST, SMOOTHING = 0.9, 1.0
#: Subsets that are sampled together, for the sake of memory.
TOGETHER = 500
#: Every so many points are looked at for one that the others are followed from; and its least correlation before it
#: deforms, which in pictures of a sheet that is stretched by a fifth is 0.9 at best and 0.3 by chance.
STRIDE, FOUND = 4, 0.5
#: A point and its eight neighbours, whose displacements show how its subset deforms.
NEIGHBOURS = 9


def lattice(present, step: int, half: int) -> tuple[int, int]:
    """First and last place of points along an axis: multiples of the step and half a subset, as pyvale has them."""
    where = np.flatnonzero(present)
    first = max(where[0] - half, 0) // step
    last = (min(where[-1], len(present) - 1 - half) - half) // step
    return int(first * step + half), int(last * step + half)


def gradients(place, displacement):
    """Gradient of the displacement at every point, least squares over its neighbours: (point, component, axis)."""
    near = KDTree(place).query(place, k=NEIGHBOURS)[1]
    arm = place[near] - place[near].mean(1, keepdims=True)
    known = np.nan_to_num(displacement[near])
    arms = np.linalg.pinv(arm)
    return np.swapaxes(arms @ (known - known.mean(1, keepdims=True)), 1, 2)


def subsets(picture, place, displacement, subset: int):
    """Grey values of every point's subset, moved and deformed, each with mean 0 and norm 1: (point, pixel)."""
    half = np.arange(subset) - subset // 2
    arm = np.stack(np.meshgrid(half, half), axis=-1).reshape(-1, 2)
    centre, gradient = place + np.nan_to_num(displacement), gradients(place, displacement)
    grey = np.empty((len(place), len(arm)))
    for some in np.array_split(np.arange(len(place)), len(place) // TOGETHER + 1):
        where = centre[some, None] + arm + np.einsum("pij,kj->pki", gradient[some], arm)
        grey[some] = map_coordinates(picture, [where[..., 1], where[..., 0]], order=3, mode="nearest")
    grey -= grey.mean(1, keepdims=True)
    return grey / np.maximum(np.linalg.norm(grey, axis=1, keepdims=True), 1e-12)


def judged(pictures, place, displacement, settings: dict):
    """Displacements (frame, point, 2) with NaN from where a point is lost on, and correlations (frame, point)."""
    subset = settings["subset"]
    size = np.array(pictures.shape[:0:-1])
    # What is added up is interpolated between points of the earlier picture: the next one may be a step away, and its
    # subset stretched to twice its side.
    margin = settings["step"] + subset
    pictures = [gaussian_filter(picture, SMOOTHING) for picture in pictures]
    before, at = subsets(pictures[0], place, np.zeros_like(displacement[0]), subset), place
    seen = np.ones(len(place), bool)
    correlation = []
    for picture, moved in zip(pictures[1:], displacement, strict=True):
        after = subsets(picture, place, moved, subset)
        correlation.append((before * after).sum(1))
        good = (correlation[-1] >= LEAST) & np.isfinite(moved).all(-1)
        if settings["incremental"]:
            now = place + np.nan_to_num(moved)
            seen &= good & ((np.minimum(at, now) >= margin) & (np.maximum(at, now) <= size - 1 - margin)).all(-1)
            before, at = after, now
        else:
            seen = good
        moved[~seen] = np.nan
    return displacement, np.stack(correlation)


def from_seeds(para, pictures, mask, reach: int):
    """Parameters by which points are followed from one that is found in the first and the last picture.

    Each then begins as its neighbour ended. Looked for one by one, without deforming, points of a stretched sheet are
    taken for others; pictures that are compared with those before hardly differ.
    """
    mesh = mesh_setup(*build_grid_for_roi(para, *mask.shape), para)
    seeds = auto_place_seeds_on_mesh(
        mesh.coordinates_fem,
        mesh.elements_fem,
        precompute_node_regions(mesh.coordinates_fem, mask.astype(float), mask.shape),
        pictures[0],
        pictures[-1],
        mask,
        para.winsize,
        reach,
        AutoPlaceConfig(ncc_threshold=FOUND, stride=STRIDE),
    ).seed_set
    return replace(para, init_guess_mode="seed_propagation", seed_set=seeds) if seeds.seeds else para


def followed(para, pictures, masks):
    """What al-dic finds; from a search for every point where no seed leads through all pictures."""
    with warnings.catch_warnings():
        # It says that the search fits the picture only with less reach, and takes less.
        warnings.filterwarnings("ignore", message="Auto-scaled FFT search region")
        try:
            return run_aldic(para, list(pictures), masks, compute_strain=False)
        except SeedPropagationError:
            para = replace(para, init_guess_mode="fft", seed_set=None)
            return run_aldic(para, list(pictures), masks, compute_strain=False)


def follow(folder: Path) -> dict:
    """The points of every picture after the first, as al-dic finds them."""
    pictures = np.load(folder / "pictures.npy").astype(float)
    mask = np.load(folder / "mask.npy")
    settings = json.loads((folder / "settings.json").read_text())
    subset, step = settings["subset"], settings["step"]
    # Later pictures may show the sheet anywhere but in their outermost pixels; al-dic takes a mask without an edge
    # for none, and then leaves what moves out of the first one's grid to extrapolation.
    anywhere = np.pad(np.ones((mask.shape[0] - 2, mask.shape[1] - 2)), 1)
    para = dicpara_default(
        winsize=subset - 1,
        winstepsize=step,
        winsize_min=min(8, step),
        tol=TOLERANCE,
        gridxy_roi_range=GridxyROIRange(
            gridx=lattice(mask.any(0), step, subset // 2), gridy=lattice(mask.any(1), step, subset // 2)
        ),
        size_of_fft_search_region=settings["reach"],
        reference_mode="incremental" if settings["incremental"] else "accumulative",
        img_ref_mask=mask.astype(float),
        show_plots=False,
    )
    if not settings["incremental"]:
        para = from_seeds(para, pictures, mask, settings["reach"])
    found = followed(para, pictures, [mask.astype(float)] + [anywhere] * (len(pictures) - 1))
    place = np.round(found.dic_mesh.coordinates_fem).astype(int)
    whole = minimum_filter(mask, subset, mode="constant")[place[:, 1], place[:, 0]]
    totals = [frame.U if frame.U_accum is None else frame.U_accum for frame in found.result_disp]
    place, displacement = place[whole], np.stack([total.reshape(-1, 2)[whole] for total in totals])
    displacement, correlation = judged(pictures, place, displacement, settings)
    return {"column": place[:, 0], "row": place[:, 1], "displacement": displacement, "correlation": correlation}


if __name__ == "__main__":
    FOLDER = Path(sys.argv[1])
    np.savez(FOLDER / "correlated.npz", **follow(FOLDER))
