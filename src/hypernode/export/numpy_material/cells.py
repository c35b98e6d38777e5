"""The cell in which a position lies: that whose centre is nearest."""

import numpy as np

#: Positions that are compared with all cells at a time.
TOGETHER = 256


def nearest_cell(data, X):
    """Number of the cell whose centre is nearest to each position X (n, 2).

    Args:
        data: ``centre_x``, ``centre_y``: lines on which the centres lie; ``cell_at``: number of the cell at each
            crossing (y, x), -1 where there is none.
    """
    x, y, cell_at = data["centre_x"], data["centre_y"], data["cell_at"]
    column, row = (np.searchsorted(0.5 * (line[1:] + line[:-1]), X[:, k]) for k, line in enumerate((x, y)))
    found = cell_at[row, column]
    rows, columns = np.nonzero(cell_at >= 0)
    # Where the nearest crossing holds no cell, every cell is looked at.
    for without in np.array_split(np.flatnonzero(found < 0), max(1, np.sum(found < 0) // TOGETHER)):
        distance = (X[without, :1] - x[columns]) ** 2 + (X[without, 1:] - y[rows]) ** 2
        nearest = np.argmin(distance, axis=1) if len(without) else []
        found[without] = cell_at[rows[nearest], columns[nearest]]
    return found
