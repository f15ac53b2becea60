"""Lines of cubic elements: what cables and beams share."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pliant.points import Point
from pliant.typing import FloatArray

if TYPE_CHECKING:
    from pliant.typing import IntArray

__all__ = ["CentreLine", "hermite"]


def hermite(xi: FloatArray, length: FloatArray) -> FloatArray:
    """Hermite functions of (r1, t1, r2, t2), shape (4, ...)."""
    xi, length = np.broadcast_arrays(xi, length)
    return np.stack(
        [
            1 - 3 * xi**2 + 2 * xi**3,
            length * (xi - 2 * xi**2 + xi**3),
            3 * xi**2 - 2 * xi**3,
            length * (xi**3 - xi**2),
        ]
    )


class CentreLine:
    """Positions ``r`` and slopes ``t`` by stress-free arc length at nodes, and elements of ``lengths``."""

    if TYPE_CHECKING:

        @property
        def name(self) -> str:
            """Name of the body."""

        @property
        def r(self) -> FloatArray:
            """Positions, (nodes, 3)."""

        @property
        def t(self) -> FloatArray:
            """Slopes, (nodes, 3)."""

        @property
        def lengths(self) -> FloatArray:
            """Lengths of the elements, (elements,)."""

        @property
        def element_nodes(self) -> IntArray:
            """First node of each element, (elements,)."""

    def node_of(self, element: int, end: int) -> int:
        """Node of the body at an end (0 or 1) of an element."""
        raise NotImplementedError

    def node_point(self, identity: str, node: int) -> Point:
        """Return the node as a material point."""
        raise NotImplementedError

    def inner_point(self, identity: str, element: int, xi: float) -> Point:
        """Return a place in an element as a material point."""
        raise NotImplementedError

    def shape(self, element: int, xi: float) -> tuple[int, FloatArray]:
        """First strand node of the element and the four Hermite functions at xi."""
        length = float(self.lengths[element])
        return int(self.element_nodes[element]), hermite(np.array(xi), np.array(length))

    def tangent(self, element: int, xi: float) -> FloatArray:
        """Tangent dr/ds at the start."""
        length = float(self.lengths[element])
        a = int(self.element_nodes[element])
        r, t = self.r[a : a + 2], self.t[a : a + 2]
        slope: FloatArray = (
            6.0 * xi * (1 - xi) * (r[1] - r[0]) / length
            + (1 - 4 * xi + 3 * xi**2) * t[0]
            + (3 * xi**2 - 2 * xi) * t[1]
        )
        return slope

    def nearest(self, target: FloatArray, identity: str) -> Point:
        """Point of the line nearest to ``target`` at the start."""
        x = np.linspace(0.0, 1.0, 9)
        i = self.element_nodes
        n = hermite(x[None, :], self.lengths[:, None])
        r = (
            n[0][..., None] * self.r[i, None]
            + n[1][..., None] * self.t[i, None]
            + n[2][..., None] * self.r[i + 1, None]
            + n[3][..., None] * self.t[i + 1, None]
        )
        element, k = (
            int(j) for j in np.unravel_index(np.argmin(((r - target) ** 2).sum(axis=2)), r.shape[:2])
        )
        low, high = max(0.0, x[k] - 0.125), min(1.0, x[k] + 0.125)

        def distance(xi: float) -> float:
            first, weights = self.shape(element, xi)
            place = weights @ np.stack([self.r[first], self.t[first], self.r[first + 1], self.t[first + 1]])
            return float(np.linalg.norm(place - target))

        for _ in range(60):
            third = (high - low) / 3.0
            if distance(low + third) < distance(high - third):
                high -= third
            else:
                low += third
        xi = min((0.0, 1.0, 0.5 * (low + high)), key=distance)
        if min(xi, 1 - xi) < 1e-7:
            return self.node_point(identity, self.node_of(element, round(xi)))
        return self.inner_point(identity, element, xi)
