"""ANCF: the body as a cable of the library's engine, its nodes closer where the stiffness changes."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant import _check
from pliant.errors import ModelError
from pliant.sdi.body import Body
from pliant.sdi.sampling import INSIDE
from pliant.sdi.techniques import Loading
from pliant.typing import ArrayLike, FloatArray

if TYPE_CHECKING:
    from pliant.model import Model
    from pliant.points import Cable

__all__ = ["add_cable", "graded_nodes", "solve"]

ELEMENTS = 24
EVEN = 0.5
"""Share of the node density that is spread evenly."""
# The derivative of a cubic at four equidistant places of an element, times its length.
_ENDS = np.array([[-5.5, 9.0, -4.5, 1.0], [-1.0, 4.5, -9.0, 5.5]])


def graded_nodes(body: Body, elements: int) -> FloatArray:
    """Places of nodes [m], closer where the stiffness changes: density |k'|/k, part of it spread evenly.

    Jumps of the stiffness are nodes.

    Examples
    --------
    >>> import pliant as pl
    >>> body = pl.sdi.cosine_notch(0.1, 0.01, 0.01, 0.02, 0.003, youngs_modulus=1e6)
    >>> [float(s) for s in graded_nodes(body, 6).round(3)]
    [0.0, 0.042, 0.046, 0.05, 0.054, 0.058, 0.1]
    """
    samples = body.samples
    rate = np.abs(samples.slope) / samples.value
    step = np.diff(samples.x)
    change = np.concatenate([[0.0], np.cumsum(0.5 * (rate[:-1] + rate[1:]) * step)])
    even = EVEN * samples.x / body.length
    density = even if change[-1] < 1e-9 else change / change[-1] + even
    inside = np.concatenate([[True], step > 0])
    nodes = np.interp(np.linspace(0.0, density[-1], elements + 1), density[inside], samples.x[inside])
    nodes[0], nodes[-1] = 0.0, body.length
    free = list(range(1, elements))
    for jump in body.jumps:
        if not free:
            raise ModelError(
                f"elements = {elements}: must be at least {len(body.jumps) + 1}, one for each step"
            )
        nearest = min(free, key=lambda i: abs(nodes[i] - jump))
        nodes[nearest] = jump
        free.remove(nearest)
    nodes.sort()
    gap = 1e-6 * body.length
    if np.diff(nodes).min() < gap:  # two came together at a jump: spread what is between the jumps
        fixed = np.array([0.0, *body.jumps, body.length])
        share = np.interp(fixed, nodes, np.arange(elements + 1.0))
        counts = np.maximum(1, np.round(np.diff(share))).astype(int)
        while counts.sum() > elements:
            counts[np.argmax(counts)] -= 1
        while counts.sum() < elements:
            counts[np.argmax(np.diff(fixed) / counts)] += 1
        pieces = [
            np.linspace(a, b, n, endpoint=False)
            for a, b, n in zip(fixed[:-1], fixed[1:], counts, strict=True)
        ]
        nodes = np.append(np.concatenate(pieces), body.length)
    return np.asarray(nodes)


def add_cable(
    body: Body,
    model: Model,
    *,
    technique: str = "ancf",
    elements: int | None = None,
    start: ArrayLike = (0.0, 0.0, 0.0),
    direction: ArrayLike = (1.0, 0.0, 0.0),
    up: ArrayLike = (0.0, 0.0, 1.0),
    density: float = 1000.0,
    retardation_time: float = 0.0,
    name: str | None = None,
    exact_axial: bool = False,
    nodes: FloatArray | None = None,
) -> Cable:
    """Add a body to a model as a cable; see :meth:`Body.add_to`."""
    from pliant.materials import LinearElastic
    from pliant.model import Model
    from pliant.sections import Section

    if not isinstance(model, Model):
        _check.fail("model", model, "must be a pliant.Model")
    if technique == "rod":
        _check.fail("technique", technique, 'there are no rods yet; take "ancf", alike in both planes')
    _check.choice(technique, "technique", ("ancf",))
    count = ELEMENTS if elements is None else _check.count(elements, "elements", at_most=10**6)
    start = _check.vector(start, "start")
    direction = _check.vector(direction, "direction")
    up = _check.vector(up, "up")
    if not direction.any():
        _check.fail("direction", direction, "must not be zero")
    direction = direction / np.linalg.norm(direction)
    if np.linalg.norm(np.cross(direction, up)) < 1e-9 * max(1.0, float(np.linalg.norm(up))):
        _check.fail("up", up, "must not be along direction")
    if body.sections is None and not exact_axial:
        raise ModelError(
            f"body = {body.name}: its cross sections are not known, hence nor its mass; make it with height= "
            "and youngs_modulus="
        )
    density = _check.number(density, "density", above=0)
    inside = INSIDE * body.length
    fine = body.samples.x.clip(inside, body.length - inside)
    if body.sections is None:
        modulus = 1.0
    else:
        # Of several materials: mass and bending as they are, stretching of the stiffest.
        modulus = float((body.axial_stiffness(fine) / body.sections.area(fine)).max())
    poisson = 0.3 if body.sections is None else body.sections.poisson_ratio
    material = LinearElastic(modulus, poisson, density, retardation_time)
    places = graded_nodes(body, count) if nodes is None else nodes

    def section(s: float) -> Section:
        x = np.array(min(max(s, inside), body.length - inside))
        second = float(body.stiffness(x)) / modulus
        if exact_axial or body.sections is None:
            area = float(body.axial_stiffness(x)) / modulus
        else:
            area = float(body.sections.area(x))
        return Section(area=area, second_moments=(second, second), radius=float(body.half_height(x)))

    line = start + places[:, None] * direction
    return model.add_cable(line, elements=len(places) - 1, section=section, material=material, name=name)


def solve(
    body: Body,
    load: Loading,
    *,
    elements: int = ELEMENTS,
    graded: bool = True,
    load_steps: int | None = None,
) -> tuple[FloatArray, FloatArray, FloatArray, int, dict[str, Any]]:
    """Bend a cable of the engine; ``graded=False``: elements of one length."""
    from pliant.model import Model
    from pliant.statics import solve_static

    count = _check.count(elements, "elements", at_most=10**5)
    even = np.linspace(0.0, body.length, count + 1)
    nodes = graded_nodes(body, count) if _check.flag(graded, "graded") else even
    model = Model()
    cable = add_cable(body, model, nodes=nodes, exact_axial=True, name="body")
    model.clamp(cable.start)
    if load.moment:
        model.add_moment(cable.end, (0.0, 0.0, load.moment))
    if any(load.force):
        model.add_force(cable.end, (*load.force, 0.0))
    steps = 4 if load_steps is None else _check.count(load_steps, "load_steps", at_most=10**6)
    result = solve_static(model, load_steps=steps, progress=False)
    x, y = result.positions(cable)[-1, :, :2].T
    inner = [
        [result.track(cable.at(float(a + f * (b - a)))).position[-1, :2] for f in (1 / 3, 2 / 3)]
        for a, b in itertools.pairwise(nodes)
    ]
    r = np.stack([x, y], axis=1)
    cubic = np.concatenate([r[:-1, None], np.array(inner), r[1:, None]], axis=1)
    slopes = np.concatenate([_ENDS[:1] @ cubic[0], np.einsum("k,ekj->ej", _ENDS[1], cubic)])
    angle = np.unwrap(np.arctan2(slopes[:, 1], slopes[:, 0]))
    return x, y, angle, model.dof, {"s": nodes, "model": model}
