"""Of which material a point of a cell is, by the lines that cut the cell.

In a cell a line is straight: it has the slope of the distances at the corners, and their mean in the middle.
"""

import numpy as np


def cut_cells(distances):
    """Which cells a line cuts (cell,).

    Args:
        distances: signed distance from every line at the corners of every cell, counter-clockwise from the lower left
            (line, cell, 4).
    """
    positive = distances > 0.0
    return (positive.any(axis=2) & ~positive.all(axis=2)).any(axis=0)


def like_its_point(own, place, distances, labels):
    """Number of a cell of the material at each point: its own one, unless a line of that cell lies between (point,).

    Args:
        own: cell of each point (point,).
        place: from the middle of that cell, over its sides (point, 2).
        distances: as of :func:`cut_cells`; a line is that of the material of its number and one.
        labels: the material that most of every cell is of (cell,).
    """
    label = np.zeros(len(own), int)
    for k, each in enumerate(distances[:, own], start=1):
        across = 0.5 * (each[:, 1] - each[:, 0] + each[:, 2] - each[:, 3])
        up = 0.5 * (each[:, 3] - each[:, 0] + each[:, 2] - each[:, 1])
        label[each.mean(axis=1) + across * place[:, 0] + up * place[:, 1] > 0.0] = k
    # A material that has most of no cell is nowhere.
    example = np.full(len(distances) + 1, -1)
    example[labels] = np.arange(len(labels))
    other = example[label]
    return np.where(cut_cells(distances)[own] & (label != labels[own]) & (other >= 0), other, own)
