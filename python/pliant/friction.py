"""Laws of friction, and the LuGre law alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant import _check
from pliant.errors import translated
from pliant.typing import ArrayLike, FloatArray

__all__ = ["Coulomb", "Friction", "LuGre", "lugre"]


@dataclass(frozen=True)
class Friction:
    """What every law of friction is; use one of those below."""


@dataclass(frozen=True)
class LuGre(Friction):
    """Friction with memory: bristles that bend, slip and recover (Canudas de Wit et al. 1995).

    The friction force is ``f_n (sigma_0 z + sigma_1 z' + sigma_2 v)`` with the deflection z of the bristles,
    ``z' = v - sigma_0 |v| z / mu(v)`` and ``mu(v) = dynamic + (static - dynamic) exp(-|v/v_s|^exponent)``.

    Parameters
    ----------
    static, dynamic : float
        Coefficients of static and of dynamic friction, ``static`` at least ``dynamic``.
    stribeck_velocity : float
        v_s [m/s]. Loads that come suddenly break a contact away below ``static`` where it is small.
    bristle_stiffness : float, optional
        sigma_0 per normal force [1/m]; None: 1000 ``static`` over the radius.
    bristle_damping : float, optional
        sigma_1 per normal force [s/m]; None: a tenth of what is critical under standard gravity.
    viscous : float
        sigma_2 per normal force [s/m].
    exponent : float
        Of the velocity.
    form : {"scaled", "per_length"}
        ``"per_length"``: the sigmas are those of a length of line, [N/m^2] and [N s/m^2], whatever the load;
        stiffness must be given then.
    damping_velocity : float, optional
        v_d [m/s]: sigma_1 fades as ``exp(-(v/v_d)^2)``, for a contact that is made at speed would meet
        ``sigma_1 v`` at once. None: five times v_s; a number beyond all velocities: it stays.

    Examples
    --------
    >>> rubber_on_steel = LuGre(static=0.6, dynamic=0.5)
    >>> rubber_on_steel.stribeck_velocity
    0.01
    """

    static: float
    dynamic: float
    stribeck_velocity: float = 1e-2
    bristle_stiffness: float | None = None
    bristle_damping: float | None = None
    viscous: float = 0.0
    exponent: float = 2.0
    form: str = "scaled"
    damping_velocity: float | None = None

    def __post_init__(self) -> None:
        static = _check.number(self.static, "static", above=0)
        values: dict[str, object] = {
            "static": static,
            "dynamic": _check.number(self.dynamic, "dynamic", above=0, at_most=static),
            "stribeck_velocity": _check.number(self.stribeck_velocity, "stribeck_velocity", above=0),
            "viscous": _check.number(self.viscous, "viscous", at_least=0),
            "exponent": _check.number(self.exponent, "exponent", above=0),
            "form": _check.choice(self.form, "form", ("scaled", "per_length")),
        }
        if self.bristle_stiffness is not None:
            stiffness = _check.number(self.bristle_stiffness, "bristle_stiffness", above=0)
            values["bristle_stiffness"] = stiffness
        elif self.form == "per_length":
            _check.fail("bristle_stiffness", None, 'must be given [N/m^2] with form="per_length"')
        if self.bristle_damping is not None:
            values["bristle_damping"] = _check.number(self.bristle_damping, "bristle_damping", at_least=0)
        if self.damping_velocity is not None:
            values["damping_velocity"] = _check.number(self.damping_velocity, "damping_velocity", above=0)
        for name, value in values.items():
            object.__setattr__(self, name, value)


@dataclass(frozen=True)
class Coulomb(Friction):
    """Friction with one coefficient, regular by an elastic deflection before it slips.

    Parameters
    ----------
    coefficient : float
        Of static and dynamic friction.

    Examples
    --------
    >>> Coulomb(0.3).coefficient
    0.3
    """

    coefficient: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "coefficient", _check.number(self.coefficient, "coefficient", above=0))


def lugre(
    law: LuGre, time: ArrayLike, velocity: ArrayLike, normal_force: ArrayLike, *, rule: str = "midpoint"
) -> tuple[FloatArray, FloatArray]:
    """Step the LuGre law alone along a given history, from bristles at rest.

    Parameters
    ----------
    law : LuGre
        Its ``bristle_stiffness``, ``bristle_damping`` and ``viscous`` are taken as those of a force: [N/m],
        [N s/m], [N s/m], and its damping does not fade.
    time : array_like, shape (n,)
        Increasing [s].
    velocity : array_like, shape (n,), (n, 2) or (n, 3)
        Slip velocity in the plane of contact [m/s].
    normal_force : float or array_like, shape (n,)
        Not negative [N].
    rule : {"midpoint", "end"}
        Velocity of a step: the mean of its ends (second order), or that at its end (first order).

    Returns
    -------
    friction_force, bristle : ndarray, of the shape of ``velocity``
        Force [N], with the sign of the velocity, and deflection of the bristles [m]. The equation of the
        bristles is solved exactly for the velocity of each step, and the deflection clipped to what the
        normal force carries.

    Examples
    --------
    Slow steady slip ends at the static, fast slip at the dynamic coefficient.

    >>> import numpy as np
    >>> law = LuGre(1.5, 1.0, stribeck_velocity=1e-3, bristle_stiffness=1e5, bristle_damping=316.0)
    >>> force, bristle = lugre(law, np.linspace(0, 1, 1001), np.full(1001, 0.1), 2.0)
    >>> bool(abs(force[-1] - 2.0) < 1e-9)
    True
    """
    from pliant import _core

    if not isinstance(law, LuGre):
        _check.fail("law", law, "must be a pliant.LuGre")
    if law.bristle_stiffness is None:
        _check.fail("law.bristle_stiffness", None, "must be given [N/m]: there is no radius here")
    t = _check.array(time, "time", (None,))
    n = len(t)
    if n < 1 or np.any(np.diff(t) <= 0):
        _check.fail("time", time, "must increase")
    columns = np.ndim(velocity)
    v = (
        _check.array(velocity, "velocity", (n,))
        if columns == 1
        else _check.array(velocity, "velocity", (n, None))
    )
    if columns == 2 and not 1 <= v.shape[1] <= 3:
        _check.fail("velocity", velocity, "must be of shape (n,), (n, 2) or (n, 3)")
    if np.ndim(normal_force) == 0:
        load = np.full(n, _check.number(normal_force, "normal_force", at_least=0))
    else:
        load = _check.array(normal_force, "normal_force", (n,))
        if np.any(load < 0):
            _check.fail("normal_force", normal_force, "must not be negative")
    in_space = np.zeros((n, 3))
    in_space.T[: 1 if columns == 1 else v.shape[1]] = v.T
    coefficients = np.array(
        [
            law.static,
            law.dynamic,
            law.stribeck_velocity,
            law.exponent,
            law.bristle_stiffness,
            law.bristle_damping or 0.0,
            law.viscous,
        ]
    )
    end = _check.choice(rule, "rule", ("midpoint", "end")) == "end"
    with translated():
        force, bristle = _core.lugre(coefficients, t, in_space, load, end)
    if columns == 1:
        return force[:, 0].copy(), bristle[:, 0].copy()
    return force[:, : v.shape[1]].copy(), bristle[:, : v.shape[1]].copy()
