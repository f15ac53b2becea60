"""Laws of materials."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from pliant import _check

__all__ = [
    "BilinearPlastic",
    "LinearElastic",
    "Material",
    "NeoHookean",
    "SaintVenantKirchhoff",
    "require_law",
    "youngs_modulus_from_shore_a",
]

HARDENINGS = ("isotropic", "kinematic")


@dataclass(frozen=True)
class Material:
    """What every material has; use one of the laws below."""

    youngs_modulus: float
    poisson_ratio: float
    density: float
    retardation_time: float = 0.0

    def __post_init__(self) -> None:
        for name, value in (
            ("youngs_modulus", _check.number(self.youngs_modulus, "youngs_modulus", above=0)),
            ("poisson_ratio", self._checked_poisson_ratio()),
            ("density", _check.number(self.density, "density", above=0)),
            ("retardation_time", _check.number(self.retardation_time, "retardation_time", at_least=0)),
        ):
            object.__setattr__(self, name, value)

    def _checked_poisson_ratio(self) -> float:
        return _check.number(self.poisson_ratio, "poisson_ratio", above=-1, below=0.5)

    @property
    def shear_modulus(self) -> float:
        """Shear modulus [Pa]."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poisson_ratio))


@dataclass(frozen=True)
class LinearElastic(Material):
    """Linear elastic material.

    Parameters
    ----------
    youngs_modulus : float
        Young's modulus [Pa], above 0.
    poisson_ratio : float
        Poisson's ratio, above -1 and below 0.5.
    density : float
        Mass per volume [kg/m^3], above 0.
    retardation_time : float
        Kelvin-Voigt damping: stress is E (strain + retardation_time * strain rate) [s].

    Examples
    --------
    >>> rubber = LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
    >>> round(rubber.shear_modulus)
    3448276
    """


@dataclass(frozen=True)
class SaintVenantKirchhoff(Material):
    """Saint Venant-Kirchhoff material: stress linear in the Green-Lagrange strain.

    Same parameters as :class:`LinearElastic`. On cables both are the same law: there ``strain`` decides.

    Examples
    --------
    >>> SaintVenantKirchhoff(youngs_modulus=2e9, poisson_ratio=0.3, density=1400.0).density
    1400.0
    """


@dataclass(frozen=True)
class NeoHookean(Material):
    """Rubber: mu/2 (I1 - 3) - mu ln J + lambda/4 (J^2 - 1) - lambda/2 ln J, in plane stress on surfaces.

    Parameters
    ----------
    youngs_modulus : float
        Young's modulus at small strain [Pa], above 0.
    poisson_ratio : float
        Poisson's ratio at small strain, above -1 and at most 0.5, which is incompressible.
    density : float
        Mass per volume [kg/m^3], above 0.
    retardation_time : float
        Kelvin-Voigt damping of the small-strain law [s].

    Examples
    --------
    >>> NeoHookean(youngs_modulus=3e6, poisson_ratio=0.5, density=1000.0).shear_modulus
    1000000.0
    """

    def _checked_poisson_ratio(self) -> float:
        return _check.number(self.poisson_ratio, "poisson_ratio", above=-1, at_most=0.5)


@dataclass(frozen=True)
class BilinearPlastic(Material):
    """Metal that yields: elastic up to a yield stress, then softer; for cables and nets of cables.

    Parameters
    ----------
    youngs_modulus : float
        Young's modulus [Pa], above 0.
    poisson_ratio : float
        Poisson's ratio, above -1 and below 0.5.
    density : float
        Mass per volume [kg/m^3], above 0.
    yield_stress : float
        Stress at which the new material yields [Pa], above 0.
    tangent_modulus : float
        Stress per strain beyond [Pa], from 0, which is ideally plastic, and below Young's modulus.
    hardening : {"isotropic", "kinematic"}
        What the hardened material does when the load turns. ``"isotropic"``: the elastic range has grown to
        both sides. ``"kinematic"``: it has the size it had and has moved, so that the material yields early
        the other way (the Bauschinger effect).
    retardation_time : float
        Kelvin-Voigt damping beside all that yields [s]; keyword only.

    Notes
    -----
    Only stretching yields; bending stays elastic, which is right for cables, whose bending carries next to no
    load. Stress is the one that goes with the strain measure of the cable: by original area for
    ``strain="biot"``, the second Piola-Kirchhoff stress, smaller by the stretch, for ``"green_lagrange"``.

    Examples
    --------
    >>> steel = BilinearPlastic(
    ...     youngs_modulus=2e11, poisson_ratio=0.3, density=7850.0, yield_stress=2.5e8, tangent_modulus=2e10
    ... )
    >>> steel.yield_strain
    0.00125
    >>> round(steel.hardening_modulus / 1e9, 3)
    22.222
    """

    yield_stress: float
    tangent_modulus: float
    hardening: str = "isotropic"
    retardation_time: float = field(default=0.0, kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        modulus = _check.number(self.tangent_modulus, "tangent_modulus", at_least=0)
        if modulus >= self.youngs_modulus:
            _check.fail(
                "tangent_modulus",
                self.tangent_modulus,
                f"must be below youngs_modulus, {self.youngs_modulus:g}",
            )
        for name, value in (
            ("yield_stress", _check.number(self.yield_stress, "yield_stress", above=0)),
            ("tangent_modulus", modulus),
            ("hardening", _check.choice(self.hardening, "hardening", HARDENINGS)),
        ):
            object.__setattr__(self, name, value)

    @property
    def yield_strain(self) -> float:
        """Strain at which the new material yields."""
        return self.yield_stress / self.youngs_modulus

    @property
    def hardening_modulus(self) -> float:
        """Growth of the yield stress by plastic strain [Pa], E Et / (E - Et)."""
        return self.youngs_modulus * self.tangent_modulus / (self.youngs_modulus - self.tangent_modulus)


BODIES: dict[type[Material], str] = {
    LinearElastic: "every flexible body",
    SaintVenantKirchhoff: "every flexible body",
    NeoHookean: "shells and membranes",
    BilinearPlastic: "cables and nets of cables",
}


def require_law(material: Any, body: str, laws: tuple[type[Material], ...]) -> None:
    """Refuse a material that a kind of body cannot carry, and tell which bodies can."""
    if isinstance(material, laws):
        return
    names = [f"pliant.{law.__name__}" for law in laws]
    reason = f"{body} takes {', '.join(names[:-1])} or {names[-1]}"
    for law, where in BODIES.items():
        if isinstance(material, law):
            reason += f"; pliant.{law.__name__} is for {where}"
    _check.fail("material", material, reason)


def youngs_modulus_from_shore_a(hardness: float) -> float:
    """Young's modulus [Pa] of a rubber from its Shore A hardness, by Gent's relation.

    Parameters
    ----------
    hardness : float
        Shore A hardness (durometer reading), above 0 and below 100; the relation is good from 20 to 80.

    Returns
    -------
    float
        Young's modulus at small strain [Pa].

    Notes
    -----
    A. N. Gent, Rubber Chemistry and Technology 31 (1958) 896: the relation of a linear elastic half-space
    under the frustum of the durometer, E = 0.0981 (56 + 7.62336 S) / (0.137505 (254 - 2.54 S)) MPa.

    Examples
    --------
    >>> round(youngs_modulus_from_shore_a(30) / 1e6, 2)
    1.14
    """
    s = _check.number(hardness, "hardness", above=0, below=100)
    return 0.0981e6 * (56.0 + 7.62336 * s) / (0.137505 * (254.0 - 2.54 * s))
