"""What a large model costs before its first step.

A square net of 32,000 cable elements, pinned around; a net of single cables that pins join; a chain of
1000 rigid bodies and hinges; a planar frame of 1000 bodies whose every mesh repeats equations of others.
Seconds of processor time, the least of a few runs: `describe` calls the methods of the model, `lower` is
the part of `Stepper` in Python, `Stepper` all that comes before the first step.
"""

import argparse
import itertools
import time

import numpy as np
import pliant as pl


def net(side):
    """Return a square net with `side` meshes a side, 8 elements a cable, its edge pinned [m]."""
    x, y = np.meshgrid(np.arange(side + 1.0), np.arange(side + 1.0))
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    number = np.arange(x.size).reshape(side + 1, side + 1)
    edges = np.vstack(
        [
            np.column_stack([number[:, :-1].ravel(), number[:, 1:].ravel()]),
            np.column_stack([number[:-1].ravel(), number[1:].ravel()]),
        ]
    )
    model = pl.Model(gravity=(0, 0, -9.81))
    steel = pl.LinearElastic(youngs_modulus=2.1e11, poisson_ratio=0.3, density=7850.0)
    cables = model.add_cable_net(
        points, edges, elements=8, section=pl.Circle(radius=1e-3), material=steel, pretension=100.0
    )
    for i in np.flatnonzero((x.ravel() % side == 0) | (y.ravel() % side == 0)):
        model.pin(cables.node(int(i)))
    return model


def pinned(side):
    """Return a square net of single cables, joined by pins."""
    model = pl.Model(gravity=(0, 0, -9.81))
    steel = pl.LinearElastic(youngs_modulus=2.1e11, poisson_ratio=0.3, density=7850.0)
    section = pl.Circle(radius=1e-3)
    ends = {}
    for i, j in itertools.product(range(side + 1), repeat=2):
        for across in (0, 1):
            other = (i + 1 - across, j + across)
            if max(other) > side:
                continue
            line = [(float(i), float(j), 0.0), (float(other[0]), float(other[1]), 0.0)]
            cable = model.add_cable(line, elements=8, section=section, material=steel, pretension=100.0)
            for place, end in (((i, j), cable.start), (other, cable.end)):
                if place in ends:
                    model.pin(end, ends[place])
                else:
                    ends[place] = end
                    if {0, side} & set(place):
                        model.pin(end)
    return model


def frame(meshes):
    """Return a row of square meshes: beams above and below, posts between them, hinges with parallel axes."""
    model = pl.Model(gravity=(0, -9.81, 0))
    beam, post = pl.Box((1.0, 0.1, 0.1)), pl.Box((0.1, 1.0, 0.1))
    rows = [
        [model.add_rigid_body(mass=1.0, shape=beam, position=(k + 0.5, y, 0)) for k in range(meshes)]
        for y in (0.0, 1.0)
    ]
    posts = [model.add_rigid_body(mass=1.0, shape=post, position=(k, 0.5, 0)) for k in range(meshes + 1)]
    model.hinge(posts[0].at((0, -0.5, 0)))
    for k, y, side in itertools.product(range(meshes), (0, 1), (0, 1)):
        model.hinge(posts[k + side].at((0, y - 0.5, 0)), rows[y][k])
    return model


def chain(bodies):
    """Return a chain of rigid bodies that hinges join."""
    model = pl.Model(gravity=(0, 0, -9.81))
    shape = pl.Box((1.0, 0.1, 0.1))
    links = [
        model.add_rigid_body(density=1000.0, shape=shape, position=(k + 0.5, 0, 0)) for k in range(bodies)
    ]
    model.hinge(links[0].at((-0.5, 0, 0)), axis=(0, 1, 0))
    for one, other in itertools.pairwise(links):
        model.hinge(one.at((0.5, 0, 0)), other.at((-0.5, 0, 0)), axis=(0, 1, 0))
    return model


def measured(describe, repeats):
    """Return the least processor time [s] of each part."""
    best = {}

    def note(name, start):
        taken = time.process_time() - start
        best[name] = min(taken, best.get(name, np.inf))

    for _ in range(repeats):
        start = time.process_time()
        model = describe()
        note("describe", start)
        start = time.process_time()
        _ = model.dof
        note("lower", start)
        start = time.process_time()
        stepper = pl.Stepper(model, step=1e-3, threads=1)
        note("Stepper", start)
        start = time.process_time()
        stepper.advance()
        note("one step", start)
    return best


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--small", action="store_true", help="a tenth of the size")
    arguments = parser.parse_args()
    part = 10 if arguments.small else 1
    side, bodies = round(44.2 / part**0.5), 1000 // part
    cases = {
        f"net of {16 * side * (side + 1)} elements": lambda: net(side),
        f"{side * (side // 2 + 1)} pinned cables": lambda: pinned(side // 2),
        f"{bodies} rigid bodies and hinges": lambda: chain(bodies),
        f"frame of {bodies // 3 * 3 + 1} rigid bodies": lambda: frame(bodies // 3),
    }
    for name, describe in cases.items():
        best = measured(describe, arguments.repeats)
        ready = best["describe"] + best["Stepper"]
        parts = ", ".join(f"{key} {value:.3f}" for key, value in best.items())
        print(f"{name}: ready to step after {ready:.2f} s ({parts})", flush=True)


if __name__ == "__main__":
    main()
