"""Small motions about a state: frequencies, damping, stability."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant import _check
from pliant._linear import smallest_eigenvalues
from pliant._running import (
    CallableInputs,
    build,
    multipliers,
    require_model,
    require_state,
    start_vectors,
)
from pliant._table import table
from pliant.errors import translated
from pliant.model import Model
from pliant.points import Handle
from pliant.readings import Statistics
from pliant.records import Records, State
from pliant.result import Result
from pliant.statics import growing
from pliant.typing import FloatArray

__all__ = ["Modes", "solve_modes"]

ZERO = 1e-6  # growth relative to the fastest of the modes found, below which it is rounding


@dataclass(frozen=True, eq=False)
class Modes:
    """Modes of small motions ``x exp(s t)``.

    Attributes
    ----------
    frequencies : ndarray, shape (count,)
        Frequencies [Hz], ascending: abs(imag s) / 2 pi (0 for motions that do not swing).
    eigenvalues : ndarray of complex, shape (count,)
        Eigenvalues s [1/s], of pairs the one of positive imaginary part; where the real part is positive the
        motion grows.
    shapes : ndarray, shape (count, coordinates)
        Shapes in the coordinates of the model, mass-normalised, complex where there is damping or a load that
        follows; :meth:`positions` gives them by body.
    stable : bool
        Whether none of these motions grows.
    """

    frequencies: FloatArray
    eigenvalues: Any
    shapes: Any
    stable: bool
    _result: Result

    def __repr__(self) -> str:
        lowest = ", ".join(f"{f:.4g}" for f in self.frequencies[:4])
        more = ", ..." if len(self.frequencies) > 4 else ""
        return f"<Modes: {lowest}{more} Hz, {'stable' if self.stable else 'unstable'}>"

    def _repr_html_(self) -> str:
        pairs = zip(self.frequencies, self.eigenvalues, strict=True)
        rows = [(k, f"{f:.6g} Hz", f"{value:.6g} 1/s") for k, (f, value) in enumerate(pairs)]
        return table("Modes, stable" if self.stable else "Modes, unstable", rows)

    @property
    def damping_ratios(self) -> FloatArray:
        """Damping ratios -real(s) / abs(s), (count,): 1 at and above critical damping, 0 where s is 0."""
        size = np.abs(self.eigenvalues)
        ratio: FloatArray = np.divide(-self.eigenvalues.real, size, out=np.zeros(len(size)), where=size > 0)
        return ratio

    def positions(self, body: Handle | str) -> Any:
        """Shapes as displacements of the nodes of a body, (count, nodes, 3)."""
        return self._result._nodes(body, self.shapes)


PathLike = str | os.PathLike[str]


def solve_modes(model: Model, count: int = 10, about: Result | State | PathLike | None = None) -> Modes:
    """Find the slowest small motions about a state at rest.

    Parameters
    ----------
    model : Model
        The model; it is not changed.
    count : int
        Number of modes: those of the smallest eigenvalues.
    about : Result or State, optional
        State to linearise at, such as an equilibrium with its reactions; by default the start.

    Returns
    -------
    Modes
        ``frequencies`` [Hz], ``shapes``, ``eigenvalues`` [1/s], ``stable``, ``damping_ratios``. Damping of
        the materials and loads that follow the motion (flutter) are part of it, and what touches there, which
        slides without friction.

    Examples
    --------
    >>> import pliant as pl
    >>> model = pl.Model()
    >>> steel = pl.LinearElastic(youngs_modulus=2e11, poisson_ratio=0.3, density=7850.0)
    >>> thick = pl.Circle(radius=1e-2)
    >>> arm = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=8, section=thick, material=steel)
    >>> wall = model.clamp(arm.start)
    >>> print(f"{pl.solve_modes(model, count=2).frequencies[0]:.2f} Hz")
    14.12 Hz
    """
    model = require_model(model)
    count = _check.count(count, "count")
    state = None if about is None else require_state(about, "about", model)
    model = model.copy()
    lowered, system = build(model, state)
    freedoms = system.velocities - system.multipliers + len(lowered.chambers)
    if count > freedoms:
        freedoms += sum(equations for _, equations, _ in system.redundant())
        offsets = system.joint_offsets()
        free = (one["joint"] for one in lowered.document["latches"] if not one["engaged"])
        freedoms += int(sum(offsets[joint, 1] for joint in free))
    if count > freedoms:
        _check.fail("count", count, f"the model has {freedoms} degrees of freedom")
    q, _ = start_vectors(lowered, system, state, model)
    inputs = CallableInputs(lowered, lowered.held_values)
    where: dict[str, Any] = {
        "q": q,
        "lambda_": multipliers(state, system, q),
        "t": state.time if state is not None else 0.0,
        "load_factor": state is not None and state.static,
        "growing": None if state is None else growing(state.model, state.grows),
        "inputs": inputs.callback,
    }
    with inputs.guarded(), translated():
        if system.is_conservative():
            squares, shapes = system.solve_modes(count, **where)
            eigenvalues = np.sqrt(-squares.astype(complex))
            frequencies = np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi)
            floor = 1e-9 * float(np.abs(squares).max(initial=0.0))
            stable = bool(squares.min(initial=0.0) >= -floor)
        else:
            eigenvalues, shapes = smallest_eigenvalues(system.linear(**where), system.velocities, count)
            frequencies = np.abs(eigenvalues.imag) / (2 * np.pi)
            stable = bool(eigenvalues.real.max() <= ZERO * np.abs(eigenvalues).max())
    here = q if q is not None else system.initial_q
    empty = np.zeros((1, len(here)))
    records = Records(
        np.zeros(1),
        here[None],
        empty,
        empty,
        np.zeros((1, system.multipliers)),
        np.zeros((1, 5)),
        np.zeros((1, 0)),
        np.zeros((1, 0)),
    )
    result = Result(model, lowered, records, static=True, statistics=Statistics(), system=system)
    return Modes(frequencies, eigenvalues, shapes, stable, result)
