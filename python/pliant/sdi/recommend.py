"""The choice of a technique: the cheapest of small predicted error, and what the map would have said."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from pliant import _check
from pliant.errors import ModelError
from pliant.sdi.body import Body, features, require_body
from pliant.sdi.map import COVERED, NOTCHED
from pliant.sdi.predict import Measures, measures, predicted_errors
from pliant.sdi.techniques import TECHNIQUES, loading
from pliant.typing import ArrayLike

__all__ = ["Estimate", "Recommendation", "recommend"]

CONSIDERED = ("lumped", "matrix", "elastica", "ancf", "finite_element")
UNKNOWNS = {"ancf": 150, "finite_element": 4137}
"""Unknowns of those that are not run to be judged, with their defaults."""
STRAIN_OF_BEAMS = 0.2
"""Strain above which neither beams nor the finite elements' material are to be trusted."""
STEEP_OUTLINE = 0.5
"""Mean steepness above which plane sections are doubtful."""


@dataclass(frozen=True)
class Estimate:
    """What to expect of one technique.

    Attributes
    ----------
    technique : str
        Its name.
    error : float
        Predicted distance of the end from that of finite elements, over the displacement; infinite where the
        technique cannot, with the reason in ``remark``.
    cost : int
        Number of unknowns.
    adequate : bool
        The error is within the tolerance.
    map_error : float or None
        What the error map promises: 0.1 or 0.2, or more (infinite); None where it says nothing.
    remark : str
        Why it cannot.
    """

    technique: str
    error: float
    cost: int
    adequate: bool
    map_error: float | None = None
    remark: str = ""


@dataclass(frozen=True)
class Recommendation:
    """Which technique to take.

    Attributes
    ----------
    technique : str
        The cheapest adequate one.
    table : list of Estimate
        One entry a technique, the cheapest first.
    index : complex
        Softness distribution index.
    map_technique : str
        What the error map alone would have said.
    measures : Measures
        What the techniques leave out, by quadratures.
    warnings : list of str
        What to be careful about.
    """

    technique: str
    table: list[Estimate]
    index: complex
    map_technique: str
    measures: Measures
    tolerance: float
    warnings: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        lines = [f"index {self.index:.4g}, wanted: {100 * self.tolerance:g} % of the displacement", ""]
        lines.append(f"{'technique':20s} {'error':>7s} {'unknowns':>9s}  map")
        for row in self.table:
            error = "-" if row.error == float("inf") else f"{100 * row.error:.1f}%"
            said = "" if row.map_error is None else f"< {100 * row.map_error:g} %"
            said = "> 20 %" if row.map_error == float("inf") else said
            mark = "  <- take this" if row.technique == self.technique else ""
            lines.append(f"{row.technique:20s} {error:>7s} {row.cost:9d}  {said:7s}{mark}".rstrip())
        lines += [""] + [f"careful: {warning}" for warning in self.warnings]
        return "\n".join(lines).rstrip()


def recommend(
    body: Body,
    *,
    moment: float | None = None,
    force: ArrayLike | None = None,
    tolerance: float = 0.1,
    techniques: Any = CONSIDERED,
    options: dict[str, dict[str, Any]] | None = None,
) -> Recommendation:
    """Predict the error of each technique and name the cheapest one that is good enough.

    Parameters
    ----------
    body : Body
        The body.
    moment : float, optional
        Moment on its end [N m].
    force : array_like, shape (2,), optional
        Force on its end [N].
    tolerance : float
        Distance of the end from its true place, over its displacement, that is good enough.
    techniques : sequence of str
        Which are considered; ``"hybrid"`` and ``"constant_curvature"`` may be added.
    options : dict, optional
        Options of the techniques: ``{"matrix": {"elements": 12}}``.

    Returns
    -------
    Recommendation
        With ``technique``, ``table``, ``index`` and ``warnings``; print it.

    Notes
    -----
    Finite elements are the reference and not run. Milliseconds: every cheap technique is bent and compared
    with an elastica that is as soft as the solid would be.

    Examples
    --------
    >>> import pliant as pl
    >>> body = pl.sdi.cosine_notch(0.1, 0.01, 0.01, 0.06, 0.003, youngs_modulus=1e6)
    >>> advice = pl.sdi.recommend(body, moment=1e-3, tolerance=0.05)
    >>> advice.technique
    'matrix'
    >>> print(advice)
    index 2.413+0.027j, wanted: 5 % of the displacement
    <BLANKLINE>
    technique              error  unknowns  map
    lumped                  7.6%         1  < 20 %
    matrix                  2.9%        18  < 10 %   <- take this
    elastica                1.6%       216  < 10 %
    ancf                    1.6%       150  < 10 %
    finite_element          0.0%      4137
    <BLANKLINE>
    careful: the error map alone would have said finite_element: it knows the index only
    """
    body = require_body(body)
    load = loading(moment, force)
    tolerance = _check.number(tolerance, "tolerance", above=0)
    names = [_check.choice(name, "techniques", TECHNIQUES) for name in techniques]
    if not names:
        _check.fail("techniques", techniques, "must name at least one")
    order = [name for name in TECHNIQUES if name in names]
    predicted = predicted_errors(body, load, order, options or {})
    index = body.distribution.index
    table = []
    for name in order:
        error, shape, remark = predicted[name]
        cost = shape.parameters if shape is not None else UNKNOWNS.get(name, 0)
        table.append(Estimate(name, error, cost, error <= tolerance, _from_map(name, index), remark))
    adequate = [row.technique for row in table if row.adequate]
    finest = order[-1]
    found = measures(body, load)
    notes = _warnings(body, index, found)
    if not adequate:
        notes.insert(
            0, f"no technique is within {100 * tolerance:g} %; {finest} is the most accurate of them"
        )
    promised = [row.technique for row in table if row.map_error is not None and row.map_error <= tolerance]
    map_technique = promised[0] if promised else finest
    choice = adequate[0] if adequate else finest
    if map_technique != choice:
        notes.append(f"the error map alone would have said {map_technique}: it knows the index only")
    return Recommendation(choice, table, index, map_technique, found, tolerance, notes)


def _from_map(technique: str, index: complex) -> float | None:
    """Return the error that the map of the notched bodies promises."""
    key = "elastica" if technique == "ancf" else technique
    if key in ("lumped", "hybrid") and not COVERED[0] <= index.real <= COVERED[1]:
        return None
    levels = sorted(level for name, level in NOTCHED if name == key)
    for level in levels:
        if NOTCHED[key, level].holds(index):
            return level
    return float("inf") if levels else None


def _warnings(body: Body, index: complex, found: Measures) -> list[str]:
    notes = []
    if body.jumps:
        notes.append("the stiffness jumps: the real part of the index depends on how the steps are blended")
    try:
        parts = features(body)
    except ModelError:
        parts = []
    if len(parts) > 1 and all(
        abs(part.index.real - index.real) > 0.05 * abs(part.index.real) for part in parts
    ):
        notes.append(
            "the index measures from one notch to another; see pliant.sdi.features(body) for each of them"
        )
    if body.sections is None:
        notes.append(
            "the cross sections are not known: the heights behind strain and steepness are those of a "
            "strip of "
            "a twentieth of the length"
        )
    if found.strain > STRAIN_OF_BEAMS:
        notes.append(
            f"the surface is strained by {found.strain:.2f}: the material's law matters, and finite "
            "elements with "
            "Saint Venant-Kirchhoff's may find no equilibrium"
        )
    if found.steepness > STEEP_OUTLINE:
        notes.append(
            f"the outline is steep (mean (h'/2)^2 = {found.steepness:.2f}): plane sections are doubtful"
        )
    for notch in body.notches:
        high = 2.0 * float(body.half_height(max(notch.start - 1e-9 * body.length, 0.0)))
        if notch.end - notch.start < high:
            notes.append(
                f"the notch at {0.5 * (notch.start + notch.end):.3g} m is shorter than the body is "
                "high: no beam "
                "describes it well"
            )
            break
    return notes
