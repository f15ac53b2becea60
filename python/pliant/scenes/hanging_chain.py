"""A hanging chain swings in its first three modes at once."""

from __future__ import annotations

import numpy as np
from scipy.optimize import least_squares
from scipy.special import j0, jn_zeros

from pliant.model import Model
from pliant.modes import solve_modes
from pliant.result import Result
from pliant.scenes.scene import Expected, Scene, energy_drift, line
from pliant.statics import solve_static
from pliant.typing import FloatArray

__all__ = ["hanging_chain"]


def hanging_chain(
    length: float = 1.0,
    mass: float = 0.1,
    axial_stiffness: float = 2e3,
    bending_stiffness: float = 1e-8,
    amplitude: float = 1e-3,
    elements: int = 60,
    gravity: float = 9.81,
    duration: float = 10.0,
    step: float = 5e-3,
) -> Scene:
    """Build the scene: a chain hangs by one end; its modes are Bessel functions.

    Daniel Bernoulli's modes J0(j_n sqrt(z/L)), z from the free end, of frequencies j_n/2 sqrt(g/L), j_n the
    zeros of J0. The chain starts from rest with the velocities of the first three, together.

    Parameters
    ----------
    length, mass : float
        Length [m] and mass per length [kg/m].
    axial_stiffness, bending_stiffness : float
        EA [N] and EI [N m^2]; an ideal chain has neither stretch nor bending stiffness.
    amplitude : float
        Amplitude of each mode at the free end, over the length.
    elements : int
        Number of elements. The tension vanishes at the free end: with much coarser meshes or less bending
        stiffness the last slope flaps on its own with low frequencies.
    gravity : float
        Gravity [m/s^2].
    duration, step : float
        Time to simulate and step [s].

    Returns
    -------
    Scene
        It starts from the hanging equilibrium.
    """
    zeros = jn_zeros(0, 3)
    omega = zeros / 2 * np.sqrt(gravity / length)

    def velocity(points: FloatArray) -> FloatArray:
        root = np.sqrt(np.clip(1 + points[:, 2] / length, 0, 1))
        speed = amplitude * length * sum(w * j0(zero * root) for w, zero in zip(omega, zeros, strict=True))
        return np.stack([speed, 0 * speed, 0 * speed], axis=1)

    model = Model(gravity=(0, 0, -gravity))
    chain = model.add_cable(
        [(0, 0, 0), (0, 0, -length)],
        elements=elements,
        strain="biot",
        velocity=velocity,
        name="chain",
        **line(axial_stiffness, bending_stiffness, mass, 3e-3),
    )
    model.pin(chain.start)

    def begin() -> Result:
        return solve_static(model)

    def heard(result: Result) -> FloatArray:
        """Frequencies of three sines that fit the way of the free end best."""
        way, t = result.track(chain.end).position[:, 0], result.time

        def basis(frequencies: FloatArray) -> FloatArray:
            phase = t[:, None] * frequencies
            return np.concatenate([np.sin(phase), np.cos(phase)], axis=1)

        def rest(frequencies: FloatArray) -> FloatArray:
            columns = basis(frequencies)
            return np.asarray((way - columns @ np.linalg.lstsq(columns, way, rcond=None)[0]) / amplitude)

        return np.asarray(least_squares(rest, omega, x_scale=omega, xtol=1e-12, ftol=1e-14).x)

    def measures(result: Result) -> dict[str, float]:
        found = 2 * np.pi * solve_modes(model, count=6, about=begin()).frequencies[::2]
        swung = heard(result)
        numbers = {f"mode {n + 1}": float(found[n]) for n in range(3)}
        numbers |= {f"swing {n + 1}": float(swung[n]) for n in range(3)}
        return {**numbers, "energy drift": energy_drift(result)}

    stretch = mass * gravity * length / axial_stiffness
    free = (bending_stiffness / (mass * gravity)) ** (1 / 3) / length  # layer at the free end
    expected = {}
    for n, w in enumerate(omega):
        # Fourth order in the element beside the free end, where the mode varies with z.
        tolerance = float(w * (stretch + free**2 + (zeros[n] ** 2 / elements / 8) ** 4))
        expected[f"mode {n + 1}"] = Expected(float(w), tolerance, "zeros of J0 (D. Bernoulli)")
        # Frequencies of the scheme are low by (omega h)^2/12, and a finite swing is slower.
        late = w * ((w * step) ** 2 / 8 + (3 * amplitude) ** 2) + tolerance
        expected[f"swing {n + 1}"] = Expected(float(w), float(late), "the same, and the step")
    expected["energy drift"] = Expected(0.0, 0.01, "conserved")
    return Scene(
        name="hanging_chain",
        title="a hanging chain swings in its first three modes",
        model=model,
        settings={"duration": duration, "step": step},
        expected=expected,
        measures=measures,
        begin=begin,
    )
