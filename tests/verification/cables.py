"""Models shared by the checks of cables."""

import numpy as np
import pliant as pl


def line(axial_stiffness: float, bending_stiffness: float, mass: float = 1.0) -> dict:
    """Section and material of given EA [N], EI [N m^2] and mass per length [kg/m]."""
    section = pl.Section(
        area=axial_stiffness,
        second_moments=(bending_stiffness, bending_stiffness),
        torsion_constant=bending_stiffness,
    )
    material = pl.LinearElastic(youngs_modulus=1.0, poisson_ratio=0.3, density=mass / axial_stiffness)
    return {"section": section, "material": material}


def cantilever(elements: int, axial_stiffness: float, **options) -> tuple[pl.Model, object]:
    """A clamped line of unit length and bending stiffness along x."""
    model = pl.Model()
    arm = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=elements, **line(axial_stiffness, 1.0), **options)
    model.clamp(arm.start)
    return model, arm


def orders(errors, ratio: float = 2.0) -> np.ndarray:
    """Orders of convergence between meshes refined by ``ratio``."""
    errors = np.asarray(errors)
    return np.log(errors[:-1] / errors[1:]) / np.log(ratio)


def pendulum(elements: int, young: float, density: float, section: pl.Section, length: float, **options):
    """A cable pinned at the origin that falls from the horizontal; gravity 9.81 along -y."""
    tau = options.pop("retardation_time", 0.0)
    model = pl.Model(gravity=(0, -9.81, 0))
    material = pl.LinearElastic(young, 0.3, density, retardation_time=tau)
    cable = model.add_cable(
        [(0, 0, 0), (length, 0, 0)], elements=elements, section=section, material=material, **options
    )
    model.pin(cable.start)
    return model, cable


def soft_pendulum(elements: int, **options):
    """The soft pendulum: 9 % static strain under its own weight."""
    section = pl.Section(area=0.0018, second_moments=(1.215e-8, 1.215e-8), torsion_constant=2.43e-8)
    return pendulum(elements, 0.7e6, 5540.0, section, 1.2, **options)


def rubber_pendulum(elements: int, **options):
    """The slender rubber pendulum, radius 5 mm."""
    return pendulum(elements, 1e7, 1000.0, pl.Circle(5e-3), 1.0, **options)
