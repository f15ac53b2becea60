"""Gas that surfaces enclose."""

from __future__ import annotations

from dataclasses import dataclass

from pliant import _check
from pliant.signals import Signal
from pliant.surfaces import Faces

__all__ = ["Chamber", "Gas"]

AIR = 287.05  # J/(kg K)


@dataclass(frozen=True)
class Gas:
    """A gas at the start: its pressure follows its density, ``p = p0 (rho / rho0)**exponent``.

    Parameters
    ----------
    pressure : float
        Absolute pressure p0 [Pa], above 0.
    temperature : float
        Temperature at this pressure [K], above 0; the density is rho0 = p0 / (gas_constant temperature).
    exponent : float
        1.0: isothermal. The ratio of the heat capacities, 1.4 for air: adiabatic. Between the two:
        polytropic.
    gas_constant : float
        Specific gas constant [J/(kg K)]; that of air by default.

    Examples
    --------
    >>> import pliant as pl
    >>> air = pl.Gas(pressure=2e5)
    >>> print(f"{air.density:.3f} kg/m^3")
    2.377 kg/m^3
    """

    pressure: float = 101325.0
    temperature: float = 293.15
    exponent: float = 1.0
    gas_constant: float = AIR

    def __post_init__(self) -> None:
        for name in ("pressure", "temperature", "exponent", "gas_constant"):
            object.__setattr__(self, name, _check.number(getattr(self, name), name, above=0))

    @property
    def density(self) -> float:
        """Density at the start [kg/m^3]."""
        return self.pressure / (self.gas_constant * self.temperature)


@dataclass(frozen=True)
class Chamber:
    """Faces that enclose a gas; ``inflow`` [kg/s], ``ambient``: pressure of the surroundings [Pa]."""

    name: str
    faces: tuple[Faces, ...]
    gas: Gas
    inflow: Signal
    ambient: float

    def __post_init__(self) -> None:
        _check.text(self.name, "name")
        object.__setattr__(self, "faces", tuple(self.faces))
        if not self.faces or not all(isinstance(part, Faces) for part in self.faces):
            _check.fail("faces", self.faces, "must be faces of surfaces")
        if not isinstance(self.gas, Gas):
            _check.fail("gas", self.gas, "must be a pliant.Gas, such as pl.Gas(pressure=101325.0)")
        if not isinstance(self.inflow, Signal) or self.inflow.size != 1:
            _check.fail("inflow", self.inflow, "must be a signal of one component")
        object.__setattr__(self, "ambient", _check.number(self.ambient, "ambient", at_least=0))

    @property
    def flows(self) -> bool:
        """Whether gas ever flows in or out."""
        return not self.inflow.constant or bool(self.inflow(0.0)[0] != 0.0)
