"""The challenge's score, and how a label lies on the sheet."""

import numpy as np
from jaxtyping import Int

#: Share of the points where two orientations of a label differ that must speak for the other one. A shape that is found
#: is wrong along its rim, on either side; two thirds are beyond what is left to chance there.
CLEARLY = 2.0 / 3.0


def dice(label: Int[np.ndarray, "nx ny"], predicted: Int[np.ndarray, "nx ny"]) -> float:
    """Mean over the classes that are present in either map of Dice's coefficient, 2 |A and B| / (|A| + |B|)."""
    classes = np.unique(np.concatenate([np.ravel(label), np.ravel(predicted)]))
    both = [2.0 * np.sum((label == c) & (predicted == c)) for c in classes]
    either = [np.sum(label == c) + np.sum(predicted == c) for c in classes]
    return float(np.mean(np.divide(both, either)))


def orientations(label: Int[np.ndarray, "nx ny"], down: int) -> dict[str, Int[np.ndarray, "nx ny"]]:
    """The label as it is and turned, by name.

    Args:
        down: axis of the array along which y goes.
    """
    return {
        "as it is": label,
        "turned up-down": np.flip(label, down),
        "turned left-right": np.flip(label, 1 - down),
        "turned by half a turn": np.flip(label),
    }


def turned(label: Int[np.ndarray, "nx ny"], predicted: Int[np.ndarray, "nx ny"], down: int) -> str:
    """The orientation of the label that fits a prediction clearly better, or "" where none does.

    Only points at which it differs from the label as it is tell them apart. A shape that is nearly its own mirror image
    has few of them, and its score hardly changes.
    """
    fits = {}
    for name, each in orientations(label, down).items():
        differs = each != label
        if differs.any() and np.mean(each[differs] == predicted[differs]) > CLEARLY:
            fits[name] = dice(each, predicted)
    return max(fits, key=fits.get, default="")
