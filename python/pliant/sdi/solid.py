"""Finite elements of a slender solid at large deflection: Saint Venant-Kirchhoff, total Lagrangian.

The mesh is a lattice mapped onto the body: 9-node quadrilaterals in plane stress, or 20-node hexahedra with
2x2x2 points over half the width. Nodes are numbered section by section, so the tangent is a narrow band whose
Cholesky factors cost n b^2. The clamped end is held fully, the free end moves rigidly with a master point (U,
theta):

    u_i = U + (R(theta) - I) (X_i - C)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded, solve_banded

from pliant.errors import ConvergenceError
from pliant.typing import FloatArray, IntArray

__all__ = ["Lattice", "Solid", "hexahedron", "quadrilateral"]


@dataclass(frozen=True)
class Kind:
    """An element: its nodes as steps in the lattice, shape functions and their gradients at the points.

    Attributes
    ----------
    steps : (m, d)
        Place of each node in the lattice of an element, 0 to 2.
    values : (q, m)
        Shape functions at the points.
    gradients : (q, m, d)
        Their derivatives by the reference coordinates.
    weights : (q,)
        Weights of the points.
    """

    steps: IntArray
    values: FloatArray
    gradients: FloatArray
    weights: FloatArray


def _points(order: int, dimension: int) -> tuple[FloatArray, FloatArray]:
    z, w = np.polynomial.legendre.leggauss(order)
    points = np.array(list(product(z, repeat=dimension)))
    weights = np.prod(np.array(list(product(w, repeat=dimension))), axis=1)
    return points, weights


def quadrilateral() -> Kind:
    """Nine nodes, 3 x 3 points."""
    points, weights = _points(3, 2)
    steps = np.array(list(product(range(3), repeat=2)))

    def parabolas(z: FloatArray) -> tuple[FloatArray, FloatArray]:
        return (
            np.stack([z * (z - 1) / 2, 1 - z**2, z * (z + 1) / 2], axis=1),
            np.stack([z - 0.5, -2 * z, z + 0.5], axis=1),
        )

    (a, da), (b, db) = parabolas(points[:, 0]), parabolas(points[:, 1])
    i, j = steps.T
    gradients = np.stack([da[:, i] * b[:, j], a[:, i] * db[:, j]], axis=2)
    return Kind(steps, a[:, i] * b[:, j], gradients, weights)


def hexahedron() -> Kind:
    """Twenty nodes (serendipity), 2 x 2 x 2 points."""
    points, weights = _points(2, 3)
    steps = np.array([s for s in product(range(3), repeat=3) if sum(c == 1 for c in s) <= 1])
    values, gradients = np.empty((8, 20)), np.empty((8, 20, 3))
    for n, step in enumerate(steps):
        z = step - 1.0
        factors = np.where(z == 0, 1 - points**2, 1 + points * z)
        slopes = np.where(z == 0, -2 * points, z * np.ones_like(points))
        corner = bool(np.all(z != 0))
        tail = points @ z - 2.0 if corner else np.ones(len(points))
        scale = 0.125 if corner else 0.25
        whole = factors.prod(axis=1)
        values[:, n] = scale * whole * tail
        for c in range(3):
            others = np.delete(factors, c, axis=1).prod(axis=1)
            gradients[:, n, c] = scale * (slopes[:, c] * others * tail + (whole * z[c] if corner else 0.0))
    return Kind(steps, values, gradients, weights)


@dataclass(frozen=True)
class Lattice:
    """A mesh of a slender body: nodes section by section.

    Attributes
    ----------
    kind : Kind
        Element.
    nodes : (n, d)
        Stress-free positions [m]; the first coordinate runs along the body.
    elements : (e, m)
        Nodes of each element.
    place : (n, d)
        Place of each node in the lattice.
    row : (e,)
        Number of each element across the body.
    """

    kind: Kind
    nodes: FloatArray
    elements: IntArray
    place: IntArray
    row: IntArray

    @classmethod
    def of(cls, kind: Kind, size: tuple[int, ...], position: object) -> Lattice:
        """Fill a lattice of ``size`` elements; ``position`` maps places (n, d) to positions (n, d)."""
        used = np.zeros(tuple(2 * n + 1 for n in size), dtype=np.int64)
        cells = np.array(list(product(*(range(n) for n in size))))
        corners = 2 * cells[:, None] + kind.steps
        used[tuple(corners.reshape(-1, len(size)).T)] = 1
        place = np.argwhere(used)
        number = np.full(used.shape, -1)
        number[tuple(place.T)] = np.arange(len(place))
        elements = number[tuple(np.moveaxis(corners, -1, 0))]
        return cls(kind, position(place), elements, place, cells[:, 1])  # type: ignore[operator]


class Solid:
    """A clamped solid with a rigid free end.

    Parameters
    ----------
    lattice : Lattice
        Mesh.
    lame : (e, q, 2)
        Lame's constants at the points of each element [Pa], that of plane stress in two dimensions.
    thickness : (e, q)
        Thickness at the points [m]; of a half body in three dimensions, 2.
    """

    def __init__(self, lattice: Lattice, lame: FloatArray, thickness: FloatArray) -> None:
        self.lattice = lattice
        nodes, elements, kind = lattice.nodes, lattice.elements, lattice.kind
        self.d = d = nodes.shape[1]
        jacobian = np.einsum("qmk,emi->eqik", kind.gradients, nodes[elements])
        det = np.linalg.det(jacobian)
        if det.min() <= 0:
            raise ConvergenceError("finite_element: the mesh folds over; the outline is too steep for it")
        inverse = np.linalg.inv(jacobian)
        self.gradients = np.einsum("qmk,eqki->eqmi", kind.gradients, inverse)
        self.weights = kind.weights * det * thickness
        self.lame = lame
        dofs = d * elements[:, :, None] + np.arange(d)
        self.dofs = dofs.reshape(len(elements), -1)
        n = d * len(nodes)
        first, last = lattice.place[:, 0] == 0, lattice.place[:, 0] == lattice.place[:, 0].max()
        held = np.zeros((len(nodes), d), dtype=bool)
        held[first] = True
        if d == 3:
            held[lattice.place[:, 2] == 0, 2] = True  # the plane of symmetry
        end = np.zeros((len(nodes), d), dtype=bool)
        end[last] = True
        self.free = np.flatnonzero(~(held | end).ravel())
        self.end_nodes = np.flatnonzero(last)
        self.number = np.full(n, -1)
        self.number[self.free] = np.arange(len(self.free))
        self.center = np.zeros(d)
        self.center[0] = nodes[:, 0].max()
        self.touching = np.flatnonzero(np.isin(elements, self.end_nodes).any(axis=1))

    @cached_property
    def _band(self) -> tuple[int, IntArray, IntArray]:
        """Width of the band, where the entries of the elements go in it, and which of them go there."""
        numbers = self.number[self.dofs]
        i, j = np.broadcast_arrays(numbers[:, :, None], numbers[:, None, :])
        inside = (i >= j) & (j >= 0)
        width = int((i - j)[inside].max())
        chosen = np.flatnonzero(inside.ravel())
        row, column = i.ravel()[chosen], j.ravel()[chosen]
        return width, (row - column) * len(self.free) + column, chosen

    # Forces

    def internal(self, u: FloatArray, tangent: bool) -> tuple[FloatArray, FloatArray | None]:
        """Return internal forces (n, d), and stiffness matrices of the elements (e, md, md)."""
        d, e = self.d, len(self.dofs)
        G, w = self.gradients, self.weights
        H = np.einsum("emi,eqmj->eqij", u[self.lattice.elements], G, optimize=True)
        F = H + np.eye(d)
        E = 0.5 * (H + H.swapaxes(-1, -2) + H.swapaxes(-1, -2) @ H)
        trace = np.trace(E, axis1=-2, axis2=-1)
        lam, mu = self.lame[..., 0], self.lame[..., 1]
        S = 2 * mu[..., None, None] * E + (lam * trace)[..., None, None] * np.eye(d)
        Sw = S * w[..., None, None]
        forces = np.einsum("eqmj,eqij->emi", G, F @ Sw, optimize=True)
        total: FloatArray = np.asarray(
            np.bincount(self.dofs.ravel(), forces.ravel(), d * len(u)), dtype=np.float64
        ).reshape(-1, d)
        if not tangent:
            return total, None
        pairs = [(a, b) for a in range(d) for b in range(a, d)]
        m, q = G.shape[2], G.shape[1]
        # B_ab (virtual E_ab, twice it off the diagonal): rows of Voigt, columns (node, component).
        B = np.empty((e, q, len(pairs), m, d))
        for row, (a, b) in enumerate(pairs):
            B[:, :, row] = F[:, :, None, :, a] * G[..., b, None]
            if a != b:
                B[:, :, row] += F[:, :, None, :, b] * G[..., a, None]
        CB = np.empty_like(B)
        diagonal = [row for row, (a, b) in enumerate(pairs) if a == b]
        volume = sum(B[:, :, row] for row in diagonal)
        for row, (a, b) in enumerate(pairs):
            CB[:, :, row] = (mu * w * (2.0 if a == b else 1.0))[..., None, None] * B[:, :, row]
            if a == b:
                CB[:, :, row] += (lam * w)[..., None, None] * volume
        size = q * len(pairs)
        K = B.reshape(e, size, m * d).swapaxes(1, 2) @ CB.reshape(e, size, m * d)
        GS = (G @ Sw).swapaxes(1, 2).reshape(e, m, q * d)
        geometric = GS @ G.swapaxes(2, 3).reshape(e, q * d, m)
        K = K.reshape(e, m, d, m, d)
        for c in range(d):
            K[:, :, c, :, c] += geometric
        return total, np.asarray(K.reshape(e, m * d, m * d), dtype=np.float64)

    # The free end

    def end(self, master: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the end's displacements (k, d), their derivatives (k, d, 3), second ones by theta (k, d)."""
        arm = self.lattice.nodes[self.end_nodes] - self.center
        c, s = np.cos(master[2]), np.sin(master[2])
        turned = np.zeros_like(arm)
        turned[:, 0], turned[:, 1] = c * arm[:, 0] - s * arm[:, 1], s * arm[:, 0] + c * arm[:, 1]
        u = np.zeros_like(arm)
        u[:, :2] = master[:2] + turned[:, :2] - arm[:, :2]
        rate = np.zeros((*arm.shape, 3))
        rate[:, 0, 0] = rate[:, 1, 1] = 1.0
        rate[:, 0, 2], rate[:, 1, 2] = -turned[:, 1], turned[:, 0]
        bend = np.zeros_like(arm)
        bend[:, :2] = -turned[:, :2]
        return u, rate, bend

    # Equilibrium

    def solve(
        self, u: FloatArray, master: FloatArray, load: FloatArray, tolerance: float, iterations: int = 30
    ) -> tuple[FloatArray, FloatArray, list[float]]:
        """Newton's method from a guess of displacements (n, d) and of the end (3,), with a line search.

        Returns displacements, the end, and the residuals relative to the largest internal force.
        """
        u, master = u.copy(), master.copy()
        lengths = np.array([1.0, 1.0, float(np.abs(self.lattice.nodes[:, 1]).max())])
        history: list[float] = []
        stalled = 0

        def residual(v: FloatArray, q: FloatArray) -> tuple[FloatArray, FloatArray, float]:
            v[self.end_nodes], rate, _ = self.end(q)
            forces, _ = self.internal(v, tangent=False)
            on_end = np.einsum("ki,kij->j", forces[self.end_nodes], rate) - load
            r = forces.ravel()[self.free]
            size = max(float(np.abs(forces).max()), 1e-300)
            return r, on_end, float(np.sqrt(r @ r + ((on_end / lengths) ** 2).sum()) / size)

        r, on_end, error = residual(u, master)
        for _ in range(iterations):
            history.append(error)
            if not np.isfinite(error):
                break
            if error < tolerance:
                return u, master, history
            du, dq = self._newton_step(u, master, r, on_end)
            step = 1.0
            while True:
                v, q = u.copy(), master + step * dq
                v.ravel()[self.free] += step * du
                r_new, end_new, error_new = residual(v, q)
                if error_new < (1 - 0.1 * step) * error or step < 0.05 or error_new < tolerance:
                    break
                step *= 0.5
            stalled = stalled + 1 if error_new > 0.9 * error else 0
            u, master, r, on_end, error = v, q, r_new, end_new, error_new
            if stalled == 6:
                break
        raise ConvergenceError("Newton's method stalls", residuals=history)

    def _newton_step(
        self, u: FloatArray, master: FloatArray, r: FloatArray, on_end: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Solve the tangent bordered by the three freedoms of the end."""
        forces, K = self.internal(u, tangent=True)
        assert K is not None
        width, target, chosen = self._band
        n = len(self.free)
        band = np.bincount(target, K.ravel()[chosen], (width + 1) * n).reshape(width + 1, n)
        _, rate, bend = self.end(master)
        # Derivatives of the displacements of the elements at the end by its three freedoms.
        T = np.zeros((self.d * len(u), 3))
        T.reshape(-1, self.d, 3)[self.end_nodes] = rate
        near, dofs = K[self.touching], self.dofs[self.touching]
        KT = near @ T[dofs]
        border = np.zeros((self.d * len(u), 3))
        np.add.at(border, dofs, KT)
        corner = np.einsum("eai,eaj->ij", T[dofs], KT)
        corner[2, 2] += float((forces[self.end_nodes] * bend).sum())
        border = border[self.free]
        right = np.column_stack([border, r])
        try:
            x = cho_solve_banded((cholesky_banded(band, lower=True, check_finite=False), True), right)
        except LinAlgError:  # not positive definite on the way
            full = np.zeros((2 * width + 1, n))
            full[width:] = band
            for k in range(1, width + 1):
                full[width - k, k:] = band[k, : n - k]
            x = solve_banded((width, width), full, right, check_finite=False)
        dq = np.linalg.solve(corner - border.T @ x[:, :3], border.T @ x[:, 3] - on_end)
        return -x[:, 3] - x[:, :3] @ dq, dq
