"""Whether lines passed through each other: from points along them alone, not from what the core knows."""

from __future__ import annotations

import itertools

import numpy as np


def passages(before: np.ndarray, after: np.ndarray, pairs: np.ndarray) -> int:
    """Count pairs of straight pieces that went through each other while all corners moved evenly.

    Parameters
    ----------
    before, after : ndarray, shape (n, 2, 3)
        Ends of the pieces.
    pairs : ndarray of int, shape (m, 2)
        Which pieces to look at.

    Returns
    -------
    int
        Number of passages.
    """
    a, b = pairs[:, 0], pairs[:, 1]
    # Four corners lie in a plane where their volume vanishes: a cubic in time.
    p, q = before[a], before[b]
    dp, dq = after[a] - p, after[b] - q
    edges = [p[:, 1] - p[:, 0], q[:, 0] - p[:, 0], q[:, 1] - p[:, 0]]
    rates = [dp[:, 1] - dp[:, 0], dq[:, 0] - dp[:, 0], dq[:, 1] - dp[:, 0]]

    def volume(t: float) -> np.ndarray:
        u, v, w = (e + t * r for e, r in zip(edges, rates, strict=True))
        return np.einsum("ij,ij->i", u, np.cross(v, w))

    values = np.array([volume(t) for t in (0.0, 1 / 3, 2 / 3, 1.0)])
    thirds = np.array([[1, 0, 0, 0], [-5.5, 9, -4.5, 1], [9, -22.5, 18, -4.5], [-4.5, 13.5, -13.5, 4.5]])
    cubic = thirds @ values
    # Bernstein's coefficients of one sign: no root.
    bernstein = np.stack(
        [cubic[0], cubic[0] + cubic[1] / 3, cubic[0] + (2 * cubic[1] + cubic[2]) / 3, cubic.sum(axis=0)]
    )
    count = 0
    for k in np.flatnonzero((bernstein.min(axis=0) <= 0) & (bernstein.max(axis=0) >= 0)):
        roots = np.roots(cubic[::-1, k])
        for t in roots[np.abs(roots.imag) < 1e-9].real:
            if not 0.0 <= t < 1.0:
                continue
            first, second = p[k] + t * dp[k], q[k] + t * dq[k]
            # In that plane: where the two lines cross, counted along each.
            ways = np.stack([first[1] - first[0], second[0] - second[1]], axis=1)
            place, *_ = np.linalg.lstsq(ways, second[0] - first[0], rcond=None)
            count += bool(np.all((place >= 0) & (place < 1)))
    return count


def passages_of_run(lines: list[np.ndarray], within: float) -> int:
    """Count how often lines went through each other or themselves in a run.

    Parameters
    ----------
    lines : list of ndarray, shape (frames, points, 3)
        Points along each line at each output.
    within : float
        Pieces of one line closer than this along it are left out [m].

    Returns
    -------
    int
        Number of passages.
    """
    pieces = np.concatenate([np.stack([x[:, :-1], x[:, 1:]], axis=2) for x in lines], axis=1)
    owner = np.repeat(np.arange(len(lines)), [x.shape[1] - 1 for x in lines])
    along = np.concatenate([np.linalg.norm(np.diff(x[0], axis=0), axis=1).cumsum() for x in lines])
    i, j = np.triu_indices(len(owner), 1)
    same = (owner[i] == owner[j]) & (np.abs(along[i] - along[j]) < within)
    i, j = i[~same], j[~same]
    count = 0
    for before, after in itertools.pairwise(pieces):
        ends = np.concatenate([before, after], axis=1)
        low, high = ends.min(axis=1), ends.max(axis=1)
        near = np.all((low[i] <= high[j]) & (low[j] <= high[i]), axis=1)
        if near.any():
            count += passages(before, after, np.stack([i[near], j[near]], axis=1))
    return count
