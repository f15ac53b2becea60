"""An iced line gallops in the wind."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from pliant.model import Model
from pliant.modes import solve_modes
from pliant.result import Result
from pliant.scenes.scene import Expected, Scene, energy_drift, line
from pliant.statics import solve_static
from pliant.typing import FloatArray

__all__ = ["galloping_line"]


def galloping_line(
    span: float = 100.0,
    mass: float = 1.6,
    diameter: float = 0.028,
    frequency: float = 0.35,
    damping_ratio: float = 0.005,
    drag: float = 1.0,
    lift_slope: float = -2.5,
    wind: float = 3.0,
    density: float = 1.225,
    axial_stiffness: float = 3e7,
    bending_stiffness: float = 100.0,
    amplitude: float = 0.1,
    elements: int = 20,
    duration: float = 500.0,
    step: float = 4e-2,
) -> Scene:
    """Build the scene: a taut line with ice on it, in steady wind across it.

    Ice gives lift that falls with the angle of attack, ``C_L = slope sin(2 alpha)/2``. Motion across the wind
    feels the damping ``rho U D/2 (C_D + dC_L/dalpha)`` per length and grows where that outweighs the line's
    own (J. P. Den Hartog, Trans. AIEE 51, 1074, 1932): above
    ``U = 4 m zeta omega/(-rho D (C_D + dC_L/dalpha))``. It grows into a limit cycle, as lift gives out at
    large angles.

    The line is taut by a tension that gives its lowest frequency; sag is left out, as in the closed form. Its
    own damping resists every velocity alike.

    Parameters
    ----------
    span, mass, diameter : float
        Length [m], mass per length [kg/m], diameter [m].
    frequency, damping_ratio : float
        Lowest frequency [Hz] and the share of critical damping at it.
    drag, lift_slope : float
        Drag coefficient and slope of lift over the angle of attack at zero.
    wind, density : float
        Velocity of the wind [m/s] and density of the air [kg/m^3].
    axial_stiffness, bending_stiffness : float
        EA [N] and EI [N m^2].
    amplitude : float
        Amplitude of the motion with which it starts [m].
    elements : int
        Number of elements.
    duration, step : float
        Time to simulate and step [s].

    Returns
    -------
    Scene
        It starts from the line blown aside by the wind.
    """
    omega = 2 * np.pi * frequency
    tension = mass * (2 * span * frequency) ** 2

    def lift(angle: float) -> float:
        return lift_slope * float(np.sin(2 * angle)) / 2

    def velocity(points: FloatArray) -> FloatArray:
        speed = amplitude * omega * np.sin(np.pi * points[:, 0] / span)
        return np.stack([0 * speed, 0 * speed, speed], axis=1)

    def build(speed: float) -> Model:
        model = Model()
        wire = model.add_cable(
            [(0, 0, 0), (span, 0, 0)],
            elements=elements,
            strain="biot",
            pretension=tension,
            velocity=velocity,
            name="line",
            **line(axial_stiffness, bending_stiffness, mass, diameter / 2),
        )
        model.pin(wire.start)
        model.pin(wire.end)
        share = span / elements
        for k in range(1, elements):
            damper = 2 * mass * damping_ratio * omega * share
            model.add_spring(wire.node(k), (k * share, 0, 0), 0.0, damper, length=0.0)
        model.add_wind(wire, (0, speed, 0), density, drag, lift=lift)
        return model

    def growth(speed: float) -> float:
        """Rate at which the first mode across the wind grows [1/s]: the fastest, near the onset."""
        model = build(speed)
        values = solve_modes(model, count=2, about=solve_static(model)).eigenvalues
        return float(values.real.max())

    slope = drag + lift_slope
    onset = 4 * mass * damping_ratio * omega / (-density * diameter * slope) if slope < 0 else np.inf

    def cycle() -> float:
        """Amplitude across the wind of one mode in each direction under quasi-steady forces [m]."""
        x = (np.arange(16) + 0.5) / 16
        shape = np.sin(np.pi * x)
        half, hardening = density * diameter / 2, axial_stiffness * (np.pi / span) ** 4 / 4

        def rates(_t: float, state: FloatArray) -> FloatArray:
            place, speed = state[:2], state[2:]
            flow = np.array([wind - speed[0] * shape, -speed[1] * shape])
            size = np.hypot(*flow)
            lifting = lift_slope * np.sin(2 * np.arctan2(flow[1], flow[0])) / 2
            force = half * size * (drag * flow + lifting * np.array([-flow[1], flow[0]]))
            pushed = 2 * (force * shape).mean(axis=1)
            stiff = mass * omega**2 + hardening * (place @ place)
            return np.concatenate(
                [speed, (pushed - stiff * place) / mass - 2 * damping_ratio * omega * speed]
            )

        solved = solve_ivp(
            rates, (0, duration), (0, amplitude, 0, 0), rtol=1e-6, atol=1e-7, dense_output=True
        )
        late = np.linspace(duration - 10 / frequency, duration, 2000)
        return float(np.abs(solved.sol(late)[1]).max())

    model = build(wind)
    wire = model["line"]

    def measures(result: Result) -> dict[str, float]:
        late = result.time > result.time[-1] - 10 / frequency
        way = np.abs(result.track(wire.node(elements // 2)).position[late, 2])
        return {
            "onset": float(brentq(growth, 0.5 * onset, 1.5 * onset, xtol=1e-4 * onset)),
            "growth rate": growth(wind),
            "limit cycle": float(way.max() / cycle()),
            "energy drift": energy_drift(result),
        }

    rate = -damping_ratio * omega - density * diameter * wind * slope / (4 * mass)
    expected = {
        "onset": Expected(float(onset), 1e-3 * float(onset), "Den Hartog"),
        "growth rate": Expected(float(rate), 1e-3 * float(abs(rate)), "Den Hartog"),
        "limit cycle": Expected(1.0, 0.01, "over that of one quasi-steady mode, by solve_ivp"),
        "energy drift": Expected(0.0, 0.01, "work of the wind against what is dissipated"),
    }
    return Scene(
        name="galloping_line",
        title="an iced line gallops in the wind",
        model=model,
        settings={"duration": duration, "step": step},
        expected=expected,
        measures=measures,
        begin=lambda: solve_static(model),
    )
