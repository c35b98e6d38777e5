"""A camera that moved is told by held edges and taken out; a sheet that moves is left alone."""

import numpy as np
import pytest
from scipy.ndimage import uniform_filter

from hypernode.dic.camera_motion import camera_motion, without
from hypernode.mechanics.loads import CONSTRAINED, make_load

STEP = 20.0
X, Y = STEP * np.arange(24.0), STEP * np.arange(18.0)
POSITION = np.stack(np.meshgrid(X, Y), axis=-1)
#: Load -> mean displacement gradient of its edges.
# What a general test does to a sheet, no kind of load says.
KINDS = [kind for kind in CONSTRAINED if kind != "general"]
H = {kind: make_load(kind, [[1.2, 1.1]] if kind == "biaxial" else [1.2]).H[0] for kind in KINDS}


def sheet(kind, uneven):
    """Displacement under a load: edges that are held move evenly, the others and the inside as they like."""
    u = POSITION @ H[kind].T
    xi, eta = POSITION[..., 0] / X[-1], POSITION[..., 1] / Y[-1]
    inside = np.sin(np.pi * xi) * np.sin(np.pi * eta)
    held = {component for _, component in CONSTRAINED[kind]}
    free = [0.0 if component in held else 20.0 * (xi**2 - eta) for component in (0, 1)]
    return u + uneven * np.stack([15.0 * inside + free[0], -8.0 * inside * xi + free[1]], axis=-1)


def at_rest(u, kind):
    """With zero mean of what no edge holds."""
    held = {component for _, component in CONSTRAINED[kind]}
    mean = u.mean(axis=(0, 1))
    return u - [0.0 if component in held else mean[component] for component in (0, 1)]


def moved(u, degrees, shift=(3.0, -2.0)):
    """As a camera sees it that has turned and shifted."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return (POSITION + u) @ np.array([[c, -s], [s, c]]).T + shift - POSITION


def close(u, expected):
    np.testing.assert_allclose(u, expected, rtol=0, atol=1e-12 * np.nanmax(np.abs(expected)))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("uneven", [0.0, 1.0])
@pytest.mark.parametrize("degrees", [0.0, 1.0, -1.0, 10.0])
def test_a_sheet_seen_by_a_moved_camera_comes_back_to_rounding(kind, uneven, degrees):
    u = at_rest(sheet(kind, uneven), kind)
    seen = moved(u, degrees)
    motion = camera_motion(X, Y, seen, CONSTRAINED[kind])
    assert motion.angle == pytest.approx(np.radians(degrees), abs=1e-14) and motion.significant == (degrees != 0.0)
    close(motion.translation, [3.0, -2.0])
    close(without(motion, X, Y, seen), u)


def test_a_shear_turns_the_sheet_and_is_not_taken_for_the_camera():
    u = sheet("shear", 0.0)
    assert np.gradient(u[..., 0], Y, axis=0).min() > 0.19
    motion = camera_motion(X, Y, u, CONSTRAINED["shear"])
    assert motion.angle == 0.0 and not motion.significant
    close(without(motion, X, Y, u), u)


@pytest.mark.parametrize("kind", KINDS)
def test_noise_leaves_the_angle_within_its_uncertainty(kind):
    u, false_alarms, stated = at_rest(sheet(kind, 1.0), kind), 0, []
    for seed in range(50):
        noise = 1e-3 * STEP * np.random.default_rng(seed).standard_normal(u.shape)
        motion = camera_motion(X, Y, moved(u, 1.0) + noise, CONSTRAINED[kind])
        assert abs(motion.angle - np.radians(1.0)) <= 3.0 * motion.angle_uncertainty and motion.significant
        stated.append(motion.angle_uncertainty)
        false_alarms += camera_motion(X, Y, u + noise, CONSTRAINED[kind]).significant
    assert false_alarms <= 1
    # As uncertain as two independent lines along the shorter side, and a fifth for the correlation that chance shows.
    assert np.median(stated) < 1.2 * 1e-3 * STEP * np.sqrt(12.0 / (2 * len(Y))) / Y[-1]


def test_noise_of_overlapping_subsets_is_no_motion():
    alarms = 0
    for seed in range(50):
        noise = uniform_filter(np.random.default_rng(seed).standard_normal(POSITION.shape), (3, 3, 1))
        alarms += camera_motion(X, Y, 1e-3 * STEP * noise, CONSTRAINED["biaxial"]).significant
    assert alarms <= 1


@pytest.mark.parametrize("kind", ["uniaxial_x", "clamped_y"])
def test_bent_lines_of_a_grid_cut_out_of_the_sheet_are_no_motion_but_hide_none(kind):
    along = 1 if kind == "uniaxial_x" else 0
    share = POSITION[..., along] / POSITION[..., along].max()
    u = POSITION @ H[kind].T
    # Half a step, more on one side than on the other and alike on both edges: their mean slope is not zero.
    u[..., 1 - along] += 0.5 * STEP * np.sin(np.pi * share**1.3)
    still = camera_motion(X, Y, u, CONSTRAINED[kind])
    assert abs(still.angle) > 1e-3 and not still.significant
    turned = camera_motion(X, Y, moved(u, 5.0), CONSTRAINED[kind])
    assert turned.significant and abs(turned.angle - np.radians(5.0)) <= 3.0 * turned.angle_uncertainty


def test_edges_that_disagree_make_the_angle_as_uncertain():
    u = sheet("clamped_y", 0.0)
    u[-1, :, 1] += 0.01 * X
    motion = camera_motion(X, Y, u, CONSTRAINED["clamped_y"])
    assert motion.angle_uncertainty == pytest.approx(np.arctan(0.01 / 1.0) / 2.0, rel=1e-9) and not motion.significant


def test_lost_points_stay_lost_and_change_nothing_else():
    u = sheet("clamped_y", 1.0)
    lost = np.random.default_rng(2).uniform(size=u.shape[:2]) < 0.2
    u[lost] = np.nan
    seen = moved(u, 10.0)
    close(without(camera_motion(X, Y, seen, CONSTRAINED["clamped_y"]), X, Y, seen), u)


def test_an_edge_that_is_mostly_lost_says_nothing_and_without_any_nothing_is_known():
    u = sheet("clamped_y", 0.0)
    u[-1, :, 1] += 0.01 * X
    u[-1, 11:] = np.nan
    motion = camera_motion(X, Y, moved(u, 1.0), CONSTRAINED["clamped_y"])
    assert motion.angle == pytest.approx(np.radians(1.0), abs=1e-14) and motion.significant
    u[0, 5:] = np.nan
    motion = camera_motion(X, Y, moved(u, 1.0), CONSTRAINED["clamped_y"])
    assert motion.angle == 0.0 and motion.angle_uncertainty == np.inf and not motion.significant
    u[:] = np.nan
    assert not camera_motion(X, Y, u, CONSTRAINED["clamped_y"]).translation.any()


def test_a_mirror_turns_the_angle_around():
    noise = np.random.default_rng(3).standard_normal(POSITION.shape)
    seen = moved(sheet("biaxial", 1.0), 2.0) + 0.01 * noise
    motion = camera_motion(X, Y, seen, CONSTRAINED["biaxial"])
    mirrored = camera_motion(X, Y, seen[:, ::-1] * [-1.0, 1.0], CONSTRAINED["biaxial"])
    assert mirrored.angle == pytest.approx(-motion.angle, rel=1e-9)
    assert mirrored.angle_uncertainty == pytest.approx(motion.angle_uncertainty, rel=1e-9)
