"""Design: links that reach a point, and notches that reach a height under bounds on the index."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant import _check
from pliant.errors import ConvergenceError, ModelError
from pliant.progress import progress_bar
from pliant.sdi.body import Body
from pliant.sdi.predict import solid_elastica
from pliant.sdi.shapes import cosine_notch, stepped
from pliant.sdi.techniques import Loading, bend, loading
from pliant.sdi.techniques.lumped import Flexure, chain
from pliant.sdi.techniques.matrix import local_stiffness, march
from pliant.typing import ArrayLike, FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Design", "Landscape", "landscape", "link", "notch"]

OBJECTIVE = 1e2
"""Scale of the objective: the optimiser's own scaling suits values near 1."""
FINEST = 1e-12
"""The optimiser's tolerance of the scaled objective."""


@dataclass(frozen=True)
class Design:
    """An optimised body.

    Attributes
    ----------
    body : Body
        The body.
    variables : dict of float
        What was varied [m], or as a ratio.
    objective : float
        Squared distance from the target over the squared length.
    tip : (float, float)
        End of the body by the technique of the optimisation [m].
    exact : (float, float)
        End by the elastica [m].
    error : float
        Distance between the two, over the displacement.
    index : complex
        Softness distribution index, steps blended over L/50.
    load : dict
        ``moment`` [N m] and ``force`` [N]: ``bend(design.body, **design.load)`` bends it again.
    evaluations : int
        How often the objective was evaluated.
    seconds : float
        Time it took.
    """

    body: Body
    variables: dict[str, float]
    objective: float
    tip: tuple[float, float]
    exact: tuple[float, float]
    error: float
    index: complex
    load: dict[str, Any]
    evaluations: int
    seconds: float
    message: str = ""


def _minimise(
    objective: Callable[[FloatArray], float],
    start: FloatArray,
    bounds: list[tuple[float, float]],
    constraints: list[Callable[[FloatArray], float]],
) -> tuple[FloatArray, int, str]:
    """Sequential least squares quadratic programming on variables in units of their start."""
    from scipy.optimize import minimize

    low, high = np.array(bounds).T
    unit = np.clip(start, low, high)
    count = 0

    def scaled(u: FloatArray) -> float:
        nonlocal count
        count += 1
        return OBJECTIVE * objective(np.clip(unit * u, low, high))

    found = minimize(
        scaled,
        np.ones(len(unit)),
        method="SLSQP",
        bounds=list(zip(low / unit, high / unit, strict=True)),
        constraints=[
            {"type": "ineq", "fun": lambda u, g=g: g(np.clip(unit * u, low, high))} for g in constraints
        ],
        options={"maxiter": 300, "ftol": FINEST},
    )
    best = np.clip(unit * found.x, low, high)
    violated = min((g(best) for g in constraints), default=0.0)
    if violated < -1e-6:
        raise ConvergenceError(
            f"design: no body within the constraints found ({found.message}); the worst is missed by "
            f"{-violated:.3g}. "
            "Try another start or wider bounds"
        )
    return best, count, str(found.message)


def link(
    target: ArrayLike,
    *,
    moment: float | None = None,
    force: ArrayLike | None = None,
    length: float = 0.1,
    diameters: tuple[float, float] = (2e-3, 10e-3),
    youngs_modulus: float = 1e6,
    technique: str = "lumped",
    start: dict[str, float] | Design | None = None,
    margin: float = 0.05,
    largest_real: float | None = None,
    smallest_imaginary: float | None = None,
    **options: Any,
) -> Design:
    """Find a round link, thin somewhere in between, whose end reaches a point.

    Parameters
    ----------
    target : array_like, shape (2,)
        Where the end shall be [m].
    moment, force
        Loads on the end [N m], [N].
    length : float
        Length [m].
    diameters : (float, float)
        Smallest and largest diameter [m]; the ends of the link have the largest.
    youngs_modulus : float
        [Pa].
    technique : {"lumped", "matrix"}
        Model of the optimisation. ``"lumped"``: a flexure, variables ``diameter``, ``flexure_length``,
        ``flexure_start``. ``"matrix"``: five elements, the inner three with diameters ``diameter1`` to 3 and
        lengths ``length1`` to 3, from ``flexure_start``.
    start : dict or Design, optional
        Where the search begins; for ``"matrix"`` also a design by ``"lumped"``.
    margin : float
        Thick part kept at the end [length].
    largest_real, smallest_imaginary : float, optional
        Bounds on the index.
    **options
        ``variant="paper"`` and ``geometric``, ``steps`` of the techniques.

    Returns
    -------
    Design

    Examples
    --------
    >>> found = link((0.092, 0.033), moment=1e-4, force=(0, 2e-4))
    >>> {name: round(1e3 * value, 1) for name, value in found.variables.items()}
    {'diameter': 3.4, 'flexure_length': 33.8, 'flexure_start': 20.4}
    """
    point = _check.array(target, "target", (2,))
    load = loading(moment, force)
    L = _check.number(length, "length", above=0)
    thin, thick = (float(d) for d in _check.array(diameters, "diameters", (2,)))
    if not 0 < thin < thick:
        _check.fail("diameters", diameters, "must be 0 < smallest < largest")
    E = _check.number(youngs_modulus, "youngs_modulus", above=0)
    _check.choice(technique, "technique", ("lumped", "matrix"))
    margin = _check.number(margin, "margin", above=0, below=1)
    allowed = {"lumped": ("variant",), "matrix": ("variant", "geometric", "steps")}[technique]
    for option, value in options.items():
        if option not in allowed:
            _check.fail(option, value, f'is no option of "{technique}" here; it has {", ".join(allowed)}')
    if np.hypot(*point) > L:
        _check.fail("target", target, f"is {np.hypot(*point):.4g} m away, and the link {L:g} m long")
    variant = _check.choice(options.get("variant", "paper"), "variant", ("paper", "consistent"))
    known = dict(start.variables) if isinstance(start, Design) else dict(start or {})
    if technique == "lumped":
        names = ["diameter", "flexure_length", "flexure_start"]
        defaults = {"diameter": 0.04 * L, "flexure_length": 0.2 * L, "flexure_start": 0.3 * L}
        bounds = [(thin, thick), (0.01 * L, L), (0.01 * L, L)]
    else:
        names = ["diameter1", "diameter2", "diameter3", "length1", "length2", "length3", "flexure_start"]
        d, soft = known.get("diameter", 0.04 * L), known.get("flexure_length", 0.3 * L)
        defaults = {f"diameter{i}": d for i in (1, 2, 3)} | {f"length{i}": soft / 3 for i in (1, 2, 3)}
        defaults["flexure_start"] = known.get("flexure_start", 0.3 * L)
        bounds = [(thin, thick)] * 3 + [(0.01 * L, L)] * 4
        known = {name: value for name, value in known.items() if name in names}
    for name, value in known.items():
        if name not in names:
            _check.fail("start", name, f"must name {', '.join(names)}")
        defaults[name] = _check.number(value, f"start[{name!r}]", above=0)
    spans = [i for i, name in enumerate(names) if "length" in name or name == "flexure_start"]

    def tip(v: FloatArray) -> tuple[float, float]:
        if technique == "lumped":
            spring = Flexure(v[2], v[1], E * np.pi * v[0] ** 4 / 64)
            kind, deformed = ("chord", False) if variant == "paper" else ("arc", True)
            x, y, _ = chain(L, [spring], load, kind, deformed)
        else:
            lengths = np.array([v[6], *v[3:6], L - v[6] - v[3:6].sum()])
            d = np.array([thick, *v[:3], thick])
            geometric = bool(options.get("geometric", variant != "paper"))
            steps = _check.count(options.get("steps", 100), "steps")
            local = local_stiffness(lengths, E * np.pi * d**4 / 64, E * np.pi * d**2 / 4, np.zeros(5))
            x, y, _ = march(lengths, local, load, steps, geometric)
        return float(x[-1]), float(y[-1])

    def objective(v: FloatArray) -> float:
        return float(((np.array(tip(v)) - point) ** 2).sum()) / L**2

    def made(v: FloatArray) -> Body:
        if technique == "lumped":
            pieces, across = [v[2], v[1]], [thick, v[0]]
        else:
            pieces, across = [v[6], *v[3:6]], [thick, *v[:3]]
        # While the optimiser strays, the last piece keeps a little length.
        last = max(L - sum(pieces), 1e-3 * L)
        return stepped([*pieces, last], [*across, thick], E)

    before = time.perf_counter()
    guess = np.array([defaults[name] for name in names])
    constraints: list[Callable[[FloatArray], float]] = [lambda v: (1 - margin) - float(v[spans].sum()) / L]
    constraints += _index_bounds(made, largest_real, smallest_imaginary)
    best, count, message = _minimise(objective, guess, bounds, constraints)
    seconds = time.perf_counter() - before
    body = made(best)
    body.name = f"link by {technique}"
    return _design(
        body,
        dict(zip(names, best.tolist(), strict=True)),
        objective(best),
        tip(best),
        load,
        count,
        seconds,
        message,
    )


def _design(
    body: Body,
    variables: dict[str, float],
    objective: float,
    tip: tuple[float, float],
    load: Loading,
    count: int,
    seconds: float,
    message: str,
) -> Design:
    given: dict[str, Any] = {"moment": load.moment, "force": load.force}
    exact = bend(body, technique="elastica", **given).tip
    moved = float(np.hypot(exact[0] - body.length, exact[1]))
    error = float(np.hypot(tip[0] - exact[0], tip[1] - exact[1])) / moved
    index = body.distribution.index
    return Design(body, variables, objective, tip, exact, error, index, given, count, seconds, message)


def notch(
    height: float,
    *,
    moment: float,
    start: tuple[float, float] = (0.015, 0.4),
    lengths: tuple[float, float] = (0.01, 0.1),
    depths: tuple[float, float] = (0.2, 0.9),
    largest_real: float | None = None,
    smallest_imaginary: float | None = None,
    body: Callable[[float, float], Body] | None = None,
) -> Design:
    """Find a cosine notch whose end rises to a height, under bounds on the index.

    Parameters
    ----------
    height : float
        Where the end shall be across the body [m].
    moment : float
        Moment on the end [N m].
    start : (float, float)
        Length of the notch [m] and height left over the full one, where the search begins.
    lengths, depths : (float, float)
        Their limits.
    largest_real, smallest_imaginary : float, optional
        Bounds on the index: where the technique is to be trusted.
    body : callable, optional
        ``body(notch_length, depth)`` makes the body; by default a strip of 0.1 x 0.01 x 0.01 m of 1 MPa.

    Returns
    -------
    Design
        ``error`` is the predicted distance of the elastica from the solid.

    Examples
    --------
    >>> found = notch(0.035, moment=2e-3, largest_real=3.0, smallest_imaginary=0.06)
    >>> bool(found.objective < 1e-12 and found.index.real <= 3.0 and found.index.imag >= 0.06)
    True
    """
    y = _check.number(height, "height")
    load = loading(moment, None)
    make = _strip if body is None else body
    bounds = [_limits(lengths, "lengths"), _limits(depths, "depths")]
    guess = _check.array(start, "start", (2,))
    constraints = _index_bounds(lambda v: _make(make, v), largest_real, smallest_imaginary)

    def objective(v: FloatArray) -> float:
        one = _make(make, v)
        return ((bend(one, moment=load.moment).tip[1] - y) / one.length) ** 2

    before = time.perf_counter()
    best, count, message = _minimise(objective, guess, bounds, constraints)
    seconds = time.perf_counter() - before
    found = _make(make, best)
    tip = bend(found, moment=load.moment).tip
    design = _design(
        found,
        {"notch_length": float(best[0]), "depth": float(best[1])},
        objective(best),
        tip,
        load,
        count,
        seconds,
        message,
    )
    solid = solid_elastica(found, load)
    moved = float(np.hypot(solid[0] - found.length, solid[1]))
    error = float(np.hypot(solid[0] - tip[0], solid[1] - tip[1])) / moved
    return Design(**{**vars(design), "error": error})


def _index_bounds(
    made: Callable[[FloatArray], Body], largest_real: Any, smallest_imaginary: Any
) -> list[Callable[[FloatArray], float]]:
    """Return the constraints that keep the index within bounds."""
    constraints: list[Callable[[FloatArray], float]] = []
    if largest_real is not None:
        re = _check.number(largest_real, "largest_real")
        constraints.append(lambda v: (re - made(v).distribution.index.real) / max(abs(re), 1.0))
    if smallest_imaginary is not None:
        im = _check.number(smallest_imaginary, "smallest_imaginary", above=0, below=1)
        constraints.append(lambda v: made(v).distribution.index.imag - im)
    return constraints


def _limits(value: Any, name: str) -> tuple[float, float]:
    low, high = _check.array(value, name, (2,))
    if not 0 < low < high:
        _check.fail(name, value, "must be 0 < lower < upper")
    return float(low), float(high)


def _strip(notch_length: float, depth: float) -> Body:
    return cosine_notch(0.1, 0.01, 0.01, notch_length, 0.01 * depth, 1e6)


def _make(make: Callable[[float, float], Body], v: FloatArray) -> Body:
    body = make(float(v[0]), float(v[1]))
    if not isinstance(body, Body):
        raise ModelError("body: must return a pliant.sdi body")
    return body


@dataclass(frozen=True)
class Landscape:
    """The objective of :func:`notch` over its two variables.

    Attributes
    ----------
    lengths, depths : (n,), (m,)
        Variables: length of the notch [m], height left over the full one.
    tip : (n, m)
        Where the end is across the body [m].
    objective : (n, m)
        Squared distance from the wanted height over the squared length.
    error : (n, m)
        Predicted error of the elastica.
    index : (n, m) complex
        Softness distribution index.
    """

    height: float
    lengths: FloatArray
    depths: FloatArray
    tip: FloatArray
    objective: FloatArray
    error: FloatArray
    index: np.ndarray[Any, np.dtype[np.complex128]]
    solutions: list[Design] = field(default_factory=list)

    def plot(self, solutions: Any = (), bounds: tuple[float, float] | None = None) -> Figure:
        """Draw the objective, its valley, and solutions in it (matplotlib).

        Parameters
        ----------
        solutions : sequence of Design
            Marked and numbered.
        bounds : (float, float), optional
            Largest real and smallest imaginary part: their limits are drawn.
        """
        from pliant.sdi.plots import plot_landscape

        return plot_landscape(self, list(solutions), bounds)


def landscape(
    height: float,
    *,
    moment: float,
    lengths: tuple[float, float] = (0.01, 0.1),
    depths: tuple[float, float] = (0.2, 0.9),
    points: tuple[int, int] = (31, 29),
    body: Callable[[float, float], Body] | None = None,
    progress: bool | None = None,
) -> Landscape:
    """Compute the objective of :func:`notch` on a grid.

    Parameters
    ----------
    height, moment, lengths, depths, body
        As for :func:`notch`.
    points : (int, int)
        Points along both variables.
    progress : bool, optional
        Show a progress bar; by default on a terminal.

    Examples
    --------
    >>> valley = landscape(0.035, moment=2e-3, points=(4, 3), progress=False)
    >>> valley.objective.shape
    (4, 3)
    """
    y = _check.number(height, "height")
    load = loading(moment, None)
    make = _strip if body is None else body
    (a, b), (c, d) = _limits(lengths, "lengths"), _limits(depths, "depths")
    n, m = (int(i) for i in _check.integers(points, "points", (2,)))
    if min(n, m) < 2:
        _check.fail("points", points, "must be at least 2 each")
    w, depth = np.linspace(a, b, n), np.linspace(c, d, m)
    tip, error = np.empty((n, m)), np.empty((n, m))
    index = np.empty((n, m), dtype=np.complex128)
    size = 1.0
    with progress_bar(progress, n) as advance:
        for i in range(n):
            for j in range(m):
                one = _make(make, np.array([w[i], depth[j]]))
                size = one.length
                x_end, tip[i, j] = bend(one, moment=load.moment).tip
                solid = solid_elastica(one, load)
                off = np.hypot(solid[0] - x_end, solid[1] - tip[i, j])
                error[i, j] = off / np.hypot(solid[0] - one.length, solid[1])
                index[i, j] = one.distribution.index
            advance(1)
    return Landscape(y, w, depth, tip, ((tip - y) / size) ** 2, error, index)
