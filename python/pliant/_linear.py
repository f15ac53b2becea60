"""Eigenvalues of ``M x'' + C x' + K x + J^T mu = 0``, ``J x = 0`` with any C and K, by an inverse.

With z = (x, s x) the inverse of the linearised problem at the shift sigma takes (x, y) to
(u, x + sigma u), where ``Q u + J^T mu = -(M y + (C + sigma M) x)`` and ``J u = 0``, and
``Q = sigma^2 M + sigma C + K``.

Its largest eigenvalues 1/(s - sigma) are the smallest s, free of the rounding of the fastest motions, which
in slender lines are ten thousand times faster.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from pliant.errors import ConvergenceError
from pliant.typing import FloatArray

__all__ = ["smallest_eigenvalues"]

DENSE = 360  # unknowns up to which the inverse is a dense matrix
MOST_CONDITION = 1e13  # above it the stiffness counts as singular: something moves freely
FREE_SHIFTS = np.array([1e-5, 1e-4, 1e-3])  # where something moves freely, relative to the fastest motion
FREE = 1e-3  # part of the shift below which an eigenvalue is zero
REDUNDANT = 1e-12

Solve = Callable[[FloatArray], FloatArray]


def smallest_eigenvalues(linear: Any, n: int, count: int) -> tuple[Any, Any]:
    """Eigenvalues (count,) with imaginary part not below zero, by frequency, and shapes (count, n)."""
    from scipy import sparse

    rows, columns = np.asarray(linear["rows"]), np.asarray(linear["columns"])
    size = max(int(rows.max(initial=0)) + 1, n)

    def matrix(name: str) -> Any:
        return sparse.csc_matrix(sparse.coo_matrix((linear[name], (rows, columns)), shape=(size, size)))

    mass, damping, stiffness = (matrix(name)[:n, :n] for name in ("mass", "damping", "stiffness"))
    jacobian = matrix("jacobian")[n:, :n]
    borders = sparse.csc_matrix(np.reshape(linear["borders"], (-1, n)))
    pencil = (mass, damping, stiffness, jacobian, borders)
    scale = np.sqrt(abs(stiffness).max() / abs(mass).max()) if stiffness.nnz else 1.0
    found = _at_shift(pencil, 0.0, count)
    free = 0.0
    if found is None:
        for shift in FREE_SHIFTS * scale:
            found = _at_shift(pencil, shift, count)
            if found is not None:
                break
        if found is None:
            raise ConvergenceError("the modes were not found: mass and stiffness are singular together")
        free = FREE * shift
        moving = np.abs(found[0])
        moving = moving[moving > 10 * free]
        if len(moving) and moving.min() < 0.1 * shift:
            shift = float(moving.min())
            found = _at_shift(pencil, shift, count) or found
            free = FREE * shift
    eigenvalues, shapes = _chosen(*found, count, free)
    order = np.lexsort((np.abs(eigenvalues), np.round(np.abs(eigenvalues.imag), 12)))
    return eigenvalues[order], np.array([_normal(shapes[:, k], mass) for k in order])


def _chosen(values: Any, shapes: Any, count: int, free: float) -> tuple[Any, Any]:
    """Keep the smallest, of conjugate pairs the upper one, of motions that nothing restores half.

    Those are double eigenvalues, place and speed, which rounding moves apart by its root.
    """
    size = np.abs(values)
    still = np.flatnonzero(size <= free)
    still = still[: (len(still) + 1) // 2]
    moving = np.flatnonzero((size > free) & (values.imag >= -1e-9 * size))
    chosen = np.concatenate([still, moving[np.argsort(size[moving], kind="stable")]])[:count]
    real = np.abs(values.imag) <= 1e-9 * size
    values = np.where(size <= free, 0.0, np.where(real, values.real, values))
    return values[chosen], shapes[:, chosen]


def _normal(shape: Any, mass: Any) -> Any:
    """Of modal mass 1, the largest entry real."""
    largest = shape[np.argmax(np.abs(shape))]
    shape = shape * (np.conj(largest) / abs(largest))
    return shape / np.sqrt(np.real(np.conj(shape) @ (mass @ shape)))


def _at_shift(pencil: Any, shift: float, count: int) -> tuple[Any, Any] | None:
    """Find eigenvalues near the shift and shapes in columns; None where the matrix is singular there."""
    mass, damping = pencil[:2]
    n = mass.shape[0]
    solve = _dense(pencil, shift) if n <= DENSE else _sparse(pencil, shift)
    if solve is None:
        return None

    def inverse(z: FloatArray) -> FloatArray:
        x, y = z[:n], z[n:]
        u = -solve(mass @ y + damping @ x + shift * (mass @ x))
        return np.concatenate([u, x + shift * u])

    if n <= DENSE:
        values, vectors = np.linalg.eig(inverse(np.eye(2 * n)))
    else:
        from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs

        wanted = min(2 * count + 8, 2 * n - 2)
        operator = LinearOperator((2 * n, 2 * n), matvec=inverse, dtype=float)
        start = inverse(np.sin(1.0 + 0.7 * np.arange(2 * n)))
        try:
            values, vectors = eigs(operator, k=wanted, which="LM", v0=start)
        except ArpackNoConvergence as error:
            raise ConvergenceError(f"the modes were not found: {error}") from None
    real = np.abs(values) > 1e-14 * np.abs(values).max()
    values, vectors = shift + 1.0 / values[real], vectors[:n, real]
    return values, vectors


def _dense(pencil: Any, shift: float) -> Solve | None:
    """Invert on the null space of the constraints."""
    from scipy import linalg

    mass, damping, stiffness, jacobian, borders = pencil
    stiffness = stiffness + borders.T @ borders
    n = mass.shape[0]
    z = np.eye(n)
    if jacobian.shape[0]:
        q, r, _ = linalg.qr(jacobian.toarray().T, pivoting=True)
        diagonal = np.abs(np.diag(r))
        z = q[:, int(np.sum(diagonal > REDUNDANT * diagonal.max(initial=0.0))) :]
    inner = z.T @ ((shift**2 * mass + shift * damping + stiffness) @ z)
    # Beside a shift, what moves freely has no stiffness but that of its mass: units must not count.
    size = np.sqrt(np.abs(np.diag(inner))) if shift else np.ones(len(inner))
    if not inner.size or not size.all():
        return None
    inner = inner / np.outer(size, size)
    if np.linalg.cond(inner) > MOST_CONDITION:
        return None
    factors = linalg.lu_factor(inner)

    def solve(b: FloatArray) -> FloatArray:
        x: FloatArray = z @ (linalg.lu_solve(factors, ((z.T @ b).T / size).T).T / size).T
        return x

    return solve


def _sparse(pencil: Any, shift: float) -> Solve | None:
    """Invert with multipliers; redundant constraints share them."""
    from scipy import sparse
    from scipy.sparse.linalg import splu

    mass, damping, stiffness, jacobian, borders = pencil
    n, m = mass.shape[0], jacobian.shape[0] + borders.shape[0]
    inner = shift**2 * mass + shift * damping + stiffness
    largest = abs(inner).max()
    slack = -REDUNDANT / largest * sparse.identity(jacobian.shape[0])
    one = -sparse.identity(borders.shape[0])
    rows = [[inner, jacobian.T, borders.T], [jacobian, slack, None], [borders, None, one]]
    whole = sparse.bmat(rows) if m else inner
    try:
        factors = splu(sparse.csc_matrix(whole))
    except RuntimeError:
        return None
    probe = np.sin(1.0 + np.arange(n + m))
    probe[n:] = 0.0
    if np.abs(factors.solve(probe)[:n]).max() * largest > MOST_CONDITION:
        return None

    def solve(b: FloatArray) -> FloatArray:
        padded = np.concatenate([b, np.zeros(m)])
        x: FloatArray = factors.solve(padded)[:n]
        return x

    return solve
