"""Cross sections along a body, and their stiffnesses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.errors import ModelError
from pliant.sdi.sampling import Along
from pliant.typing import FloatArray

__all__ = ["Layer", "Sections"]


@dataclass(frozen=True)
class Layer:
    """One layer of a cross section.

    Attributes
    ----------
    height : callable
        Thickness along the body [m].
    youngs_modulus : float
        [Pa].
    """

    height: Along
    youngs_modulus: float


@dataclass(frozen=True)
class Sections:
    """Cross sections along a body, all of one shape.

    Attributes
    ----------
    shape : {"rectangle", "circle"}
        Shape.
    height, width : callable
        Height in the plane of bending and width across it [m]; of circles, twice the diameter.
    youngs_modulus : callable
        [Pa]; of layers, that of the width.
    poisson_ratio : float
        Poisson's ratio.
    layers : tuple of Layer
        From the bottom; empty where there is one material.
    """

    shape: str
    height: Along
    width: Along
    youngs_modulus: Along
    poisson_ratio: float
    layers: tuple[Layer, ...] = ()

    @property
    def power(self) -> float:
        """Exponent n of k ~ height^n."""
        return 4.0 if self.shape == "circle" else 3.0

    @property
    def shear_correction(self) -> float:
        """Cowper's shear coefficient."""
        nu = self.poisson_ratio
        if self.shape == "circle":
            return 6.0 * (1.0 + nu) / (7.0 + 6.0 * nu)
        return 10.0 * (1.0 + nu) / (12.0 + 11.0 * nu)

    def area(self, x: FloatArray) -> FloatArray:
        """Area of the cross section [m^2]."""
        full: FloatArray = self.height(x) * self.width(x)
        return full * (np.pi / 4.0) if self.shape == "circle" else full

    def axial_stiffness(self, x: FloatArray) -> FloatArray:
        """EA [N]."""
        if self.layers:
            total = sum(
                (layer.youngs_modulus * layer.height(x) for layer in self.layers), np.zeros(np.shape(x))
            )
            return self.width(x) * total
        return self.youngs_modulus(x) * self.area(x)

    def neutral_axis(self, x: FloatArray) -> FloatArray:
        """Distance of the neutral axis from the bottom [m]."""
        if not self.layers:
            return 0.5 * self.height(x)
        return _transformed(self.layers, x)[0]

    def bending_stiffness(self, x: FloatArray) -> FloatArray:
        """E I about the neutral axis [N m^2]: of layers, the transformed section."""
        if self.layers:
            return self.width(x) * _transformed(self.layers, x)[1]
        share = np.pi / 64.0 if self.shape == "circle" else 1.0 / 12.0
        return share * self.youngs_modulus(x) * self.width(x) * self.height(x) ** 3

    def shear_stiffness(self, x: FloatArray) -> FloatArray:
        """Shear coefficient times G A [N]."""
        return self.axial_stiffness(x) * (self.shear_correction / (2.0 * (1.0 + self.poisson_ratio)))

    def torsional_stiffness(self, x: FloatArray) -> FloatArray:
        """G J about the axis [N m^2]: Saint-Venant's constant of a rectangle to 0.5 %, exact for circles."""
        if self.layers:
            raise ModelError("torsion: the torsion constant of a layered section is not known")
        modulus = self.youngs_modulus(x) / (2.0 * (1.0 + self.poisson_ratio))
        if self.shape == "circle":
            return modulus * (np.pi / 32.0) * self.height(x) ** 4
        long, short = np.maximum(self.height(x), self.width(x)), np.minimum(self.height(x), self.width(x))
        ratio = short / long
        constant: FloatArray = long * short**3 * (1.0 / 3.0 - 0.21 * ratio * (1.0 - ratio**4 / 12.0))
        return modulus * constant

    def transverse_stiffness(self, x: FloatArray) -> FloatArray:
        """Force a length over the squeeze of the section between two plates in the plane of bending [Pa]."""
        if self.layers:
            give = sum(
                (layer.height(x) / layer.youngs_modulus for layer in self.layers), np.zeros(np.shape(x))
            )
            return self.width(x) / give
        if self.shape == "circle":
            raise ModelError("squeezing: a circle between plates has no linear stiffness; take a rectangle")
        return self.youngs_modulus(x) * self.width(x) / self.height(x)


def _transformed(layers: tuple[Layer, ...], x: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Neutral axis from the bottom [m] and E I per width [N m] of the transformed section."""
    zero = np.zeros(np.shape(x))
    heights = [layer.height(x) for layer in layers]
    centers, top = [], zero
    for h in heights:
        centers.append(top + 0.5 * h)
        top = top + h
    rows = list(zip(layers, heights, centers, strict=True))
    EA = sum((layer.youngs_modulus * h for layer, h, _ in rows), zero)
    axis = sum((layer.youngs_modulus * h * y for layer, h, y in rows), zero) / EA
    EI = sum((layer.youngs_modulus * (h**3 / 12.0 + h * (y - axis) ** 2) for layer, h, y in rows), zero)
    return axis, EI
