"""Further indices, ours: the functional on other stiffnesses, and the slope of the stiffness as a criterion.

The publication asks for them and does not define them. Read them as analogues: what the softness distribution
index says of bending, they say of stretching, twisting and squeezing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant import _check
from pliant.errors import ModelError
from pliant.sdi import index as _index
from pliant.sdi.body import Body, require_body
from pliant.sdi.sampling import INSIDE, Along, find_jumps, sample
from pliant.sdi.sections import Sections

__all__ = ["Criteria", "axial_index", "criteria", "squeezing_index", "torsion_index"]


def _sections(body: Body) -> Sections:
    sections = require_body(body).sections
    if sections is None:
        raise ModelError(
            f"body = {body.name}: its cross sections are not known; make it with height= and youngs_modulus="
        )
    return sections


def _index_of(body: Body, stiffness: Along) -> complex:
    jumps = tuple(find_jumps(stiffness, body.length, body.breakpoints)) if body.jumps else ()
    breaks = body.breakpoints
    if jumps:
        stiffness, more, _ = _index.blended(stiffness, body.length, jumps, _index.BLEND * body.length, 1.0)
        breaks = tuple(sorted({*breaks, *more} - set(jumps)))
    return _index.distribution(sample(stiffness, body.length, breaks), body.length).index


def axial_index(body: Body) -> complex:
    """Index of the axial stiffness EA: how stretching is distributed. An analogue of ours.

    Examples
    --------
    >>> import pliant as pl
    >>> body = pl.sdi.cosine_notch(0.1, 0.01, 0.01, 0.02, 0.005, youngs_modulus=1e6)
    >>> print(f"{axial_index(body):.3f}")
    10.000+0.500j
    """
    return _index_of(body, _sections(body).axial_stiffness)


def torsion_index(body: Body) -> complex:
    """Index of the torsional stiffness GJ: how twisting is distributed. An analogue of ours.

    Examples
    --------
    >>> import pliant as pl
    >>> print(f"{torsion_index(pl.sdi.cone(0.2, 0.03, 0.015, youngs_modulus=1e6)):.4f}")
    1.0000+0.0625j
    """
    return _index_of(body, _sections(body).torsional_stiffness)


def squeezing_index(body: Body) -> complex:
    """Index of the stiffness E b/h against squeezing across: where a grip gives way. An analogue of ours.

    A notch is stiffer against squeezing, not softer: its index has a negative real part.

    Examples
    --------
    >>> import pliant as pl
    >>> body = pl.sdi.cosine_notch(0.1, 0.01, 0.01, 0.02, 0.005, youngs_modulus=1e6)
    >>> squeezing_index(body).real < 0
    True
    """
    return _index_of(body, _sections(body).transverse_stiffness)


@dataclass(frozen=True)
class Criteria:
    """What the slope of the stiffness says about common assumptions. Ours.

    Attributes
    ----------
    variation : float
        V = int |k'|/k ds: by how many factors of e the stiffness goes up and down.
    steepness : float
        Mean (h'/2)^2, weighted by the compliance: plane sections stay plane where it is small.
    """

    variation: float
    steepness: float

    def segments(self, tolerance: float) -> int:
        """Arcs that constant curvature needs: V / (2 n) bounds the error of the curvature within an arc.

        The nodes must share V equally (:func:`pliant.sdi.techniques.ancf.graded_nodes` does).

        Examples
        --------
        >>> Criteria(variation=1.0, steepness=0.0).segments(0.1)
        5
        """
        tolerance = _check.number(tolerance, "tolerance", above=0)
        return max(1, int(np.ceil(self.variation / (2 * tolerance) - 1e-9)))


def criteria(body: Body) -> Criteria:
    """Compute criteria for assumptions from the slope of the stiffness. Ours, not the publication's.

    Examples
    --------
    >>> import pliant as pl
    >>> round(criteria(pl.sdi.cone(0.2, 0.03, 0.015, youngs_modulus=1e6)).variation, 3)
    2.773
    """
    body = require_body(body)
    samples = body.samples
    logarithm = np.log(samples.value)
    variation = float(np.abs(np.diff(logarithm)).sum())  # jumps count, too
    inside = INSIDE * body.length
    half = body.half_height(samples.x.clip(inside, body.length - inside))
    step = np.diff(samples.x)
    moving = step > 0
    slope = np.minimum((np.diff(half)[moving] / step[moving]) ** 2, 1.0)
    weight = step[moving] / samples.value[:-1][moving]
    return Criteria(variation, float((slope * weight).sum() / weight.sum()))
