"""What is read from a result: arrays with names."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from pliant.typing import FloatArray, IntArray

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

__all__ = [
    "BeamStrain",
    "ContactPatch",
    "CriticalPoint",
    "Energy",
    "JointMotion",
    "Reaction",
    "SpringForce",
    "Statistics",
    "Strain",
    "SurfaceStrain",
    "TendonForce",
    "Track",
]


@dataclass(frozen=True)
class Track:
    """Motion of a point: position [m], velocity [m/s] and acceleration [m/s^2], each (n, 3).

    Attributes
    ----------
    axes : (n, 3, 3) or None
        Axes of the rigid body, or of the beam's section, that holds the point, one a row.
    """

    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    axes: FloatArray | None = None

    @property
    def orientation(self) -> Rotation:
        """Orientation of a rigid body or a beam's section, n Rotations from its axes to the world."""
        if self.axes is None:
            raise AttributeError("orientation: only points of rigid bodies and beams have one")
        from scipy.spatial.transform import Rotation

        return Rotation.from_matrix(np.swapaxes(self.axes, -1, -2))


@dataclass(frozen=True, eq=False)
class CriticalPoint:
    """A point of a static path where the stiffness is singular.

    Attributes
    ----------
    kind : {"limit", "bifurcation"}
        Whether the load stops rising or falling there, or another branch crosses.
    index : int
        Number of its output.
    load_factor : float
        Its load factor.
    shape : ndarray, shape (coordinates,)
        The motion that costs no force, in the coordinates of the model, mass-normalised.
    """

    kind: str
    index: int
    load_factor: float
    shape: FloatArray


@dataclass(frozen=True)
class JointMotion:
    """Freedom of a joint: angle [rad], unwrapped, or way [m], its rate and all that acts along it, each (n,).

    ``force`` [N m] or [N] is the sum of spring, damper, stops, drives and gears.
    """

    position: FloatArray
    velocity: FloatArray
    force: FloatArray


@dataclass(frozen=True)
class Reaction:
    """What a joint exerts on its first body: force [N] and moment about its point [N m], each (n, 3)."""

    force: FloatArray
    moment: FloatArray


@dataclass(frozen=True)
class SpringForce:
    """A spring: length [m], its rate [m/s], and the force by which it pulls [N], each (n,)."""

    length: FloatArray
    rate: FloatArray
    force: FloatArray


@dataclass(frozen=True)
class TendonForce:
    """A tendon: length [m], tension at the pulled end [N], each (n,), and of each span [N], (n, spans)."""

    length: FloatArray
    tension: FloatArray
    tensions: FloatArray


@dataclass(frozen=True)
class ChamberGas:
    """Gas in a chamber: absolute pressure [Pa], volume [m^3], mass [kg] and temperature [K], each (n,)."""

    pressure: FloatArray
    volume: FloatArray
    mass: FloatArray
    temperature: FloatArray


@dataclass(frozen=True)
class Strain:
    """Strains of cables at mid-element.

    Attributes
    ----------
    axial : (n, elements)
        Axial strain, in the measure of the cable.
    curvature : (n, elements, 3)
        Curvature vector [1/m].
    plastic : (n, elements)
        Part of the axial strain that stays when the cable is unloaded; 0 where the material does not yield.
    """

    axial: FloatArray
    curvature: FloatArray
    plastic: FloatArray


@dataclass(frozen=True)
class BeamStrain:
    """Strains of a beam at mid-element, against its stress-free shape.

    Attributes
    ----------
    axial : (n, elements)
        Green-Lagrange strain of the centre line.
    curvature : (n, elements, 3)
        Twist, curvature about y and about z of the section [1/m].
    shear : (n, elements, 2)
        Shear of the centre line against the section along its y and z.
    """

    axial: FloatArray
    curvature: FloatArray
    shear: FloatArray


@dataclass(frozen=True)
class SurfaceStrain:
    """Strains in the middle of the faces of a surface, in a local frame whose first axis is along u.

    Attributes
    ----------
    membrane : (n, faces, 3)
        Green-Lagrange strain (E11, E22, E12).
    bending : (n, faces, 3)
        Change of curvature (k11, k22, k12) [1/m]; zero in membranes.
    regime : (n, faces)
        0 taut, 1 wrinkled, 2 slack; shells are taut.
    """

    membrane: FloatArray
    bending: FloatArray
    regime: IntArray


@dataclass(frozen=True, eq=False)
class ContactPatch:
    """A place where two bodies touch.

    Attributes
    ----------
    point : ndarray, shape (3,)
        Where the surfaces meet [m].
    normal : ndarray, shape (3,)
        Unit vector along which the two are pressed apart, towards the first body.
    gap : float
        Smallest distance of the surfaces, negative: they overlap [m].
    normal_force : float
        Pressure integrated over the patch [N].
    friction_force : ndarray, shape (3,)
        Friction on the first body [N]; the other feels the opposite.
    bodies : tuple of str
        Names of the two, in the order of :meth:`pliant.Model.add_contact`.
    """

    point: FloatArray
    normal: FloatArray
    gap: float
    normal_force: float
    friction_force: FloatArray
    bodies: tuple[str, str]

    @property
    def force(self) -> FloatArray:
        """Whole force on the first body [N], (3,)."""
        total: FloatArray = self.normal_force * self.normal + self.friction_force
        return total


@dataclass(frozen=True)
class Energy:
    """Energies [J], each (n,); ``total`` stays constant."""

    kinetic: FloatArray
    elastic: FloatArray
    gravitational: FloatArray
    dissipated: FloatArray
    work: FloatArray

    @property
    def total(self) -> FloatArray:
        """Kinetic + elastic + gravitational + dissipated - work [J], (n,)."""
        return self.kinetic + self.elastic + self.gravitational + self.dissipated - self.work


@dataclass(frozen=True)
class Statistics:
    """Counters of a run, seconds by part, and the largest memory of the process [bytes]."""

    steps: int = 0
    rejected: int = 0
    newton_iterations: int = 0
    factorizations: int = 0
    seconds: Mapping[str, float] = field(default_factory=dict)
    peak_memory: int = 0
