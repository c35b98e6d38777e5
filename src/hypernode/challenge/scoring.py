"""The challenge's score, and how a label lies on the sheet."""

import numpy as np
from jaxtyping import Int

#: Gain of the score from which another orientation of a label is the likelier one: chance shapes differ by less.
CLEARLY = 0.1


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
    """The orientation of the label that fits a prediction clearly better, or "" where none does."""
    scores = {name: dice(each, predicted) for name, each in orientations(label, down).items()}
    best = max(scores, key=scores.get)
    return best if scores[best] > scores["as it is"] + CLEARLY else ""
