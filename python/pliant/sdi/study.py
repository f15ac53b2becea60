"""The studies of the publication as one run: every table and figure again, in minutes.

``python -m pliant.sdi.study FOLDER`` leaves tables (CSV) and figures (PNG) there and prints the tables.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from pliant import _check
from pliant.errors import ConvergenceError, ModelError
from pliant.progress import progress_bar
from pliant.sdi import design
from pliant.sdi.body import Body
from pliant.sdi.map import error_map, notched_bodies
from pliant.sdi.recommend import recommend
from pliant.sdi.shapes import (
    bump,
    cone,
    cosine_notch,
    cosine_taper,
    elliptic_notch,
    exponential,
    layered,
    notches,
    uniform,
)
from pliant.sdi.tables import Study, Table, text_of
from pliant.sdi.techniques import Shape, bend

__all__ = ["Study", "Table", "bodies_not_fitted", "run"]

E = 1e6
STRIP = {"length": 0.1, "height": 0.01, "width": 0.01, "youngs_modulus": E}
ELLIPSES = (
    ((0.010, 0.010), 0.002),
    ((0.010, 0.020), 0.003),
    ((0.015, 0.015), 0.004),
    ((0.020, 0.030), 0.003),
    ((0.025, 0.025), 0.006),
    ((0.030, 0.020), 0.002),
    ((0.040, 0.040), 0.0045),
)
"""Semi-axes and height left of seven elliptic notches [m]."""
ROUND = (20, 4, 2)
"""Mesh of round bodies."""
COARSE = (24, 4)
"""Mesh of strips where only a few bodies are shown, quickly."""


def turning(body: Body, rotation: float = 1.0) -> float:
    """End moment that turns the elastica of a body by a rotation [N m]."""
    return rotation / bend(body, moment=1.0).tip_angle


def _solid(body: Body, moment: float, quick: bool) -> Shape:
    """Bend a body by finite elements."""
    if body.sections is not None and body.sections.shape == "circle":
        mesh: tuple[int, ...] = (6, 2, 1) if quick else ROUND
        return bend(body, moment=moment, technique="finite_element", dimension=3, elements=mesh)
    return bend(body, moment=moment, technique="finite_element", elements=COARSE if quick else None)


CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "EA": ("elastica", {}),
    "NMSA paper": ("matrix", {"variant": "paper"}),
    "NMSA": ("matrix", {}),
    "NMSA exact": ("matrix", {"sampling": "exact"}),
    "LPM paper": ("lumped", {"variant": "paper"}),
    "LPM": ("lumped", {}),
}
"""Columns of the tables of errors: technique and options."""


def _errors(
    body: Body, moment: float, truth: Shape, cases: dict[str, tuple[str, dict[str, Any]]] = CASES
) -> list[float]:
    found = []
    for technique, options in cases.values():
        try:
            found.append(100 * bend(body, moment=moment, technique=technique, **options).error(truth))
        except (ModelError, ConvergenceError):
            found.append(float("nan"))
    return found


def run(*, quick: bool = False, only: Sequence[str] | None = None, progress: bool | None = None) -> Study:
    """Run the studies.

    Parameters
    ----------
    quick : bool
        A few bodies of each study only, in seconds.
    only : sequence of str, optional
        Which: ``"index_of_notches"``, ``"notched"``, ``"amplitude"``, ``"elliptic"``, ``"conical"``,
        ``"particular"``, ``"multi_material"``, ``"links"``, ``"constrained"``, ``"recommender"``; else all.
    progress : bool, optional
        Show a progress bar; by default on a terminal.

    Returns
    -------
    Study
        With ``tables``, ``figures``, ``save(folder)``; print it.

    Examples
    --------
    >>> print(run(quick=True, only=["multi_material"], progress=False).tables["multi_material"].columns[0])
    E2/E1
    """
    names = list(PARTS) if only is None else [_check.choice(name, "only", PARTS) for name in only]
    study = Study()
    with progress_bar(progress, len(names)) as advance:
        for name in names:
            PARTS[name](study, quick)
            advance(1)
    return study


def _index_of_notches(study: Study, quick: bool) -> None:
    """Real and imaginary part over length and depth of the notch."""
    from pliant.sdi.plots import _plain, new_figure

    lengths = np.linspace(0.01, 0.1, 4 if quick else 19)
    figure = new_figure(8.4, 3.6)
    left, right = figure.subplots(1, 2)
    rows = []
    for depth in (0.1, 0.3, 0.6, 0.9):
        index = [body.index for body in notched_bodies(lengths, (depth,))]
        left.plot(1e3 * lengths, [z.real for z in index], "-", label=f"h_m/h_0 = {depth:g}")
        rows += [(1e3 * w, depth, z) for w, z in zip(lengths.tolist(), index, strict=True)]
    depths = np.linspace(0.05, 0.95, 4 if quick else 19)
    right.semilogy(depths, [body.index.imag for body in notched_bodies((0.04,), depths)])
    left.legend(frameon=False, fontsize=8.5)
    _plain(left, "length of the notch [mm]", "Re SDI", "the shorter, the greater")
    _plain(right, "height left / height", "Im SDI", "the deeper, the smaller: any length")
    study.figures["index_of_notches"] = figure
    study.tables["index_of_notches"] = Table("Index of cosine notches", ("w [mm]", "h_m/h_0", "SDI"), rows)


def _notched(study: Study, quick: bool) -> None:
    """21 notched bodies and the map."""
    from pliant.sdi.plots import draw_shapes, new_figure

    bodies = notched_bodies((0.02, 0.06), (0.3, 0.75)) if quick else notched_bodies()
    labels = {"lumped paper": {"variant": "paper"}, "matrix paper": {"variant": "paper"}}
    others = ("lumped", "matrix", "elastica", "hybrid", "constant_curvature", "ancf")
    options: dict[str, dict[str, Any]] = {**labels, "finite_element": {"elements": COARSE if quick else None}}
    every = error_map(bodies, techniques=(*labels, *others), options=options, progress=False)
    published, ours = every.only([*labels, "elastica"]), every.only(others)
    study.figures["map_published"] = published.plot(together=True)
    study.figures["map"] = ours.plot()
    columns = every.errors
    rows = [
        (body.name, complex(z), *(100 * float(e[i]) for e in columns.values()))
        for i, (body, z) in enumerate(zip(every.bodies, every.index, strict=True))
    ]
    study.tables["notched"] = Table(
        "Notched bodies turned by 1 rad: error of the end [%]", ("body", "SDI", *columns), rows
    )
    regions = [
        (label, f"{100 * level:g} %", "inside" if r.inside else "outside", *r.re, *r.im, r.accuracy)
        for (label, level), r in every.regions.items()
    ]
    study.tables["regions"] = Table(
        "Rectangles of the map",
        ("technique", "error", "good", "Re from", "to", "Im from", "to", "right"),
        regions,
    )
    body = cosine_notch(**STRIP, notch_length=0.04, notch_height=0.003)
    moment = turning(body)
    shapes = [
        bend(body, moment=moment, technique=name, **options)
        for name, options in (
            ("finite_element", {"elements": COARSE} if quick else {}),
            ("elastica", {}),
            ("matrix", {"variant": "paper"}),
            ("lumped", {"variant": "paper"}),
            ("hybrid", {}),
        )
    ]
    figure = new_figure(6.4, 4.4)
    draw_shapes(figure.subplots(), shapes)
    figure.axes[0].set_title(
        "a notched body by five techniques, NMSA and LPM as published", fontsize=10.5, loc="left"
    )
    study.figures["shapes"] = figure


def _amplitude(study: Study, quick: bool) -> None:
    """Raise the moment: the higher the displacement, the higher the error."""
    from pliant.sdi.plots import COLORS, _plain, new_figure

    body = cosine_notch(**STRIP, notch_length=0.06, notch_height=0.0045)
    rows = []
    for rotation in (0.5,) if quick else (0.05, 0.1, 0.2, 0.4, 0.7, 1.0, 1.4, 1.8):
        moment = turning(body, rotation)
        truth = _solid(body, moment, quick)
        moved = float(np.hypot(truth.tip[0] - body.length, truth.tip[1])) / body.length
        rows.append((rotation, moved, *_errors(body, moment, truth)))
    study.tables["amplitude"] = Table(
        f"Growing moment ({body.name}): error of the end [%]",
        ("rotation [rad]", "displacement [L]", *CASES),
        rows,
    )
    figure = new_figure(5.4, 3.8)
    axes = figure.subplots()
    for i, (label, (technique, _)) in enumerate(CASES.items()):
        style = "--" if label.endswith("paper") else "-"
        axes.plot(
            [r[1] for r in rows],
            [r[2 + i] for r in rows],
            style,
            color=COLORS[technique],
            marker="o",
            markersize=3,
            label=label,
        )
    axes.set_yscale("log")
    axes.legend(frameon=False, fontsize=8.5, ncols=2)
    _plain(axes, "displacement of the end [L]", "error [% of the displacement]", body.name)
    study.figures["amplitude"] = figure


def _elliptic(study: Study, quick: bool) -> None:
    """Seven elliptic notches, and how much the lumped coefficient matters."""
    cases = {
        **CASES,
        "LPM 0.25": ("lumped", {"variant": "paper", "coefficient": 0.25}),
    }
    rows = []
    for axes, left in ELLIPSES[2:3] if quick else ELLIPSES:
        body = elliptic_notch(0.1, 0.01, 0.01, axes, left, E)
        moment = turning(body)
        try:
            truth = _solid(body, moment, quick)
        except ConvergenceError:
            moment *= 0.5
            truth = _solid(body, moment, quick)
        rows.append(
            (
                f"{body.name}, {1e3 * left:g} left",
                body.index,
                truth.tip_angle,
                *_errors(body, moment, truth, cases),
            )
        )
    study.tables["elliptic"] = Table(
        "Elliptic notches: error of the end [%]", ("body", "SDI", "rotation [rad]", *cases), rows
    )


def _conical(study: Study, quick: bool) -> None:
    """Twelve cones and an exponential body; one real part for all of them."""
    from pliant.sdi.plots import BLUE, RED, _plain, new_figure

    ratios = (0.5,) if quick else tuple(float(r) for r in np.linspace(0.9, 1 / 6, 12))
    cases = {name: case for name, case in CASES.items() if not name.startswith("LPM")}
    rows = []
    for ratio in ratios:
        body = cone(0.2, 0.03, 0.03 * ratio, E)
        truth = _solid(body, turning(body), quick)
        rows.append((body.name, body.index, *_errors(body, turning(body), truth, cases)))
    for ratio in () if quick else (1 / 2, 1 / 3):
        body = exponential(0.2, 0.03, 0.03 * ratio, E)
        truth = _solid(body, turning(body), quick)
        rows.append((body.name, body.index, *_errors(body, turning(body), truth, cases)))
    study.tables["conical"] = Table(
        "Cones and exponential bodies: error of the end [%]", ("body", "SDI", *cases), rows
    )
    figure = new_figure(5.2, 3.6)
    axes = figure.subplots()
    end = np.linspace(1 / 6, 0.98, 5 if quick else 30)
    for make, color, width, label in ((cone, RED, 5.0, "cones"), (exponential, BLUE, 1.4, "exponential")):
        index = [make(0.2, 0.03, 0.03 * r, E).index for r in end]
        look: dict[str, Any] = {"color": color, "linewidth": width, "alpha": 0.35 if width > 2 else 1.0}
        axes.plot(end, [z.real for z in index], "--", label=f"Re, {label}", **look)
        axes.plot(end, [z.imag for z in index], "-", label=f"Im, {label}", **look)
    axes.legend(frameon=False, fontsize=8.5)
    _plain(axes, "diameter at the end / at the clamp", "SDI", "one real part, one curve of the imaginary one")
    study.figures["conical"] = figure


def _uniform_and_bumps(study: Study, quick: bool) -> None:
    """Particular bodies: a uniform arm, a bump, a taper, two notches."""
    bodies = [
        (uniform(**STRIP), 1.5),
        (bump(0.1, 0.006, 0.01, 0.04, 0.01, E), 1.0),
        (cosine_taper(0.1, 0.01, 0.006, 0.01, E), 1.0),
        (cosine_taper(0.1, 0.01, 0.009, 0.01, E), 1.0),
        (notches(0.1, 0.01, 0.01, [(0.03, 0.02, 0.004), (0.07, 0.02, 0.004)], E), 1.0),
    ]
    cases = {**CASES, "hybrid": ("hybrid", {})}
    rows = []
    for body, rotation in bodies[1:2] if quick else bodies:
        moment = turning(body, rotation)
        truth = _solid(body, moment, quick)
        rows.append((body.name, body.index, *_errors(body, moment, truth, cases)))
    study.tables["particular"] = Table(
        "Particular bodies: error of the end [%]", ("body", "SDI", *cases), rows
    )
    study.figures["bump"] = bodies[1][0].plot()
    study.figures["taper"] = bodies[2][0].plot()


def _multi_material(study: Study, quick: bool) -> None:
    """Two materials, one upon the other: the transformed section against a mesh of both."""
    stiff = [5.0] if quick else [1.0, 2.0, 5.0, 10.0, 20.0]
    rows = []
    for ratio in stiff:
        body = layered(0.1, 0.01, [(0.004, E), (0.002, ratio * E)])
        moment = turning(body)
        truth = _solid(body, moment, quick)
        axis = float(body.sections.neutral_axis(np.array(0.0))) if body.sections else 0.0
        errors = _errors(body, moment, truth, {"EA": CASES["EA"], "NMSA": CASES["NMSA"]})
        rows.append((ratio, 1e3 * axis, float(body.stiffness(0.0)), truth.tip_angle, *errors))
    columns = ("E2/E1", "neutral axis [mm]", "EI [N m^2]", "rotation of the solid [rad]", "EA", "NMSA")
    study.tables["multi_material"] = Table(
        "Strips of two materials turned by 1 rad: error of the end [%]", columns, rows
    )


def _links(study: Study, quick: bool) -> None:
    """Optimise a link by lumped and by matrix models, and one where the lumped model suffices."""
    from pliant.sdi.plots import draw_outline, new_figure

    near: dict[str, Any] = {"moment": 3e-4, "force": (0.0, 3e-3)}
    far: dict[str, Any] = {"moment": 1e-4, "force": (0.0, 2e-4)}
    A = design.link((0.07, 0.055), **near)
    cases = [("A, lumped", A)]
    if not quick:
        B = design.link((0.07, 0.055), technique="matrix", start=A, **near)
        B2 = design.link((0.07, 0.055), technique="matrix", start=A, variant="consistent", **near)
        cases += [("B, matrix as published", B), ("B, matrix with geometric terms", B2)]
    short = {"diameter": 2.8e-3, "flexure_length": 14e-3, "flexure_start": 25e-3}
    cases.append(("C, lumped, another target", design.link((0.092, 0.033), start=short, **far)))
    rows = [
        (
            name,
            d.index,
            1e3 * d.exact[0],
            1e3 * d.exact[1],
            100 * d.error,
            len(d.variables),
            d.evaluations,
            d.seconds,
        )
        for name, d in cases
    ]
    columns = (
        "link",
        "SDI",
        "x by EA [mm]",
        "y by EA [mm]",
        "error [%]",
        "variables",
        "evaluations",
        "seconds",
    )
    study.tables["links"] = Table(
        "Links designed to reach a point: how far the elastica ends from it", columns, rows
    )
    figure = new_figure(8.4, 1.6 * len(cases) + 0.4)
    for axes, (name, d) in zip(
        np.atleast_1d(figure.subplots(len(cases), 1, sharex=True)), cases, strict=True
    ):
        draw_outline(axes, d.body)
        axes.set_aspect("equal", adjustable="datalim")
        axes.set_title(f"{name}: {text_of(d.index)}, error {100 * d.error:.1f} %", fontsize=9.5, loc="left")
        axes.set_ylabel("[mm]")
    axes.set_xlabel("x [mm]")
    study.figures["links"] = figure


def _constrained(study: Study, quick: bool) -> None:
    """Find notches that reach a height: several, of which bounds on the index choose a trustworthy one."""
    moment = 2e-3
    bounds: dict[str, Any] = {"largest_real": 3.0, "smallest_imaginary": 0.06}
    found = [
        ("free, from 15 mm and 0.4", design.notch(0.035, moment=moment)),
        ("Re <= 3, Im >= 0.06", design.notch(0.035, moment=moment, **bounds)),
        ("free, from 90 mm and 0.6", design.notch(0.035, moment=moment, start=(0.09, 0.6))),
    ]
    rows = []
    for name, d in found:
        truth = _solid(d.body, moment, quick)
        actual = 100 * bend(d.body, moment=moment).error(truth)
        w, depth = d.variables["notch_length"], d.variables["depth"]
        rows.append((name, 1e3 * w, depth, d.index, d.objective, 100 * d.error, actual))
    columns = (
        "start and bounds",
        "w [mm]",
        "h_m/h_0",
        "SDI",
        "objective",
        "predicted error [%]",
        "error to FEA [%]",
    )
    study.tables["constrained"] = Table("Notches that lift the end to 35 mm (elastica)", columns, rows)
    valley = design.landscape(0.035, moment=moment, points=(7, 6) if quick else (46, 36), progress=False)
    study.figures["landscape"] = valley.plot([d for _, d in found], bounds=(3.0, 0.06))


def bodies_not_fitted(quick: bool = False) -> list[tuple[Body, float]]:
    """Bodies, and their rotations, that neither predictors nor map were fitted on.

    Examples
    --------
    >>> len(bodies_not_fitted())
    32
    """
    found = [(elliptic_notch(0.1, 0.01, 0.01, axes, left, E), 1.0) for axes, left in ELLIPSES[1:]]
    found += [
        (notches(0.1, 0.01, 0.01, [(0.03, 0.02, 0.005), (0.07, 0.02, 0.005)], E), 1.0),
        (notches(0.1, 0.01, 0.01, [(0.03, 0.02, 0.003), (0.07, 0.04, 0.004)], E), 1.0),
        (notches(0.1, 0.01, 0.01, [(0.2e-1 * i + 0.01, 0.02, 0.003) for i in range(5)], E), 1.0),
        (bump(0.1, 0.006, 0.01, 0.04, 0.01, E), 1.0),
        (cosine_taper(0.1, 0.01, 0.006, 0.01, E), 1.0),
        (cosine_taper(0.1, 0.01, 0.003, 0.01, E), 1.0),
        (uniform(**STRIP), 1.5),
        (cosine_notch(**STRIP, notch_length=0.03, notch_height=0.004, center=0.025), 1.0),
        (cosine_notch(**STRIP, notch_length=0.04, notch_height=0.002, center=0.07), 1.0),
        (cosine_notch(**STRIP, notch_length=0.04, notch_height=0.003, center=0.07), 0.3),
        (layered(0.1, 0.01, [(0.004, E), (0.002, 5 * E)]), 1.0),
        (layered(0.1, 0.01, [(lambda x: 0.006 - 0.02 * x, E), (0.002, 4 * E)]), 1.0),
    ]
    thick = {**STRIP, "height": 0.015}
    found += [
        (cosine_notch(**thick, notch_length=w, notch_height=0.015 * r), 1.0)
        for w in (0.03, 0.04, 0.06, 0.08)
        for r in (0.2, 0.45, 0.75)
    ]
    found += [(cosine_notch(**thick, notch_length=0.02, notch_height=0.009), 0.5)]
    found += [(cosine_notch(0.2, 0.01, 0.01, 0.03, 0.003, E), 1.0)]
    return found[:2] if quick else found


def _recommender(study: Study, quick: bool) -> None:
    """How often the predictors and the map tell whether a technique is within 10 % and 20 %."""
    techniques = ("lumped", "matrix", "elastica", "hybrid", "constant_curvature")
    rows, disagreements = [], []
    right = {
        (who, t, level): [0, 0] for who in ("predictors", "map") for t in techniques for level in (0.1, 0.2)
    }
    worst = dict.fromkeys(techniques, 0.0)
    chosen = {0.1: [0, 0, 0], 0.2: [0, 0, 0]}
    for body, rotation in bodies_not_fitted(quick):
        moment = turning(body, rotation)
        try:
            truth = _solid(body, moment, quick)
        except ConvergenceError:
            continue
        actual = {}
        for name in techniques:
            try:
                actual[name] = bend(body, moment=moment, technique=name).error(truth)
            except ModelError:
                actual[name] = float("inf")
        for level in (0.1, 0.2):
            advice = recommend(
                body, moment=moment, tolerance=level, techniques=(*techniques, "finite_element")
            )
            for row in advice.table:
                if row.technique == "finite_element" or not np.isfinite(row.error):
                    continue
                good = actual[row.technique] <= level
                count = right["predictors", row.technique, level]
                count[0] += (row.error <= level) == good
                count[1] += 1
                worst[row.technique] = max(worst[row.technique], abs(row.error - actual[row.technique]))
                if row.map_error is None:
                    continue
                count = right["map", row.technique, level]
                said = row.map_error <= level
                count[0] += said == good
                count[1] += 1
                if said != (row.error <= level):
                    truthful = "map" if said == good else "predictors"
                    disagreements.append(
                        (
                            body.name,
                            advice.index,
                            row.technique,
                            f"{100 * level:g} %",
                            100 * row.error,
                            100 * actual[row.technique],
                            truthful,
                        )
                    )
            best = next((t for t in advice_order(advice) if actual.get(t, 0.0) <= level), "finite_element")
            chosen[level][0] += advice.technique == best
            chosen[level][1] += actual.get(advice.technique, 0.0) <= level
            chosen[level][2] += 1
    for who in ("predictors", "map"):
        for name in techniques:
            hits = [right[who, name, level] for level in (0.1, 0.2)]
            rows.append(
                (
                    who,
                    name,
                    *(f"{a}/{b}" for a, b in hits),
                    100 * worst[name] if who == "predictors" else float("nan"),
                )
            )
    for label, place in (("recommended is the cheapest adequate", 0), ("recommended is adequate", 1)):
        rows.append(
            (
                "recommender",
                label,
                *(f"{chosen[level][place]}/{chosen[level][2]}" for level in (0.1, 0.2)),
                float("nan"),
            )
        )
    columns = ("who", "technique", "right at 10 %", "right at 20 %", "largest miss [points]")
    study.tables["recommender"] = Table("Verdicts on bodies that nothing was fitted on", columns, rows)
    study.tables["disagreements"] = Table(
        "Where the map and the predictors disagree",
        ("body", "SDI", "technique", "level", "predicted [%]", "error [%]", "who is right"),
        disagreements,
    )


def advice_order(advice: Any) -> list[str]:
    """Techniques of a recommendation, the cheapest first."""
    return [row.technique for row in advice.table]


PARTS: dict[str, Callable[[Study, bool], None]] = {
    "index_of_notches": _index_of_notches,
    "notched": _notched,
    "amplitude": _amplitude,
    "elliptic": _elliptic,
    "conical": _conical,
    "particular": _uniform_and_bumps,
    "multi_material": _multi_material,
    "links": _links,
    "constrained": _constrained,
    "recommender": _recommender,
}
"""The studies by name, in their order."""


def main(arguments: list[str] | None = None) -> None:
    """Run all studies, print the tables, and leave them and the figures in a folder."""
    given = sys.argv[1:] if arguments is None else arguments
    folder = given[0] if given else "out/sdi"
    study = run()
    print(study)
    paths = study.save(folder)
    print(f"\n{len(paths)} files in {folder}")


if __name__ == "__main__":
    main()
