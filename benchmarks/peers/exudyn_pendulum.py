"""Exudyn's side of falling_pendulum.py: in Exudyn's own environment, one JSON line a run on standard output.

Exudyn is shown at its best: its fast module (no range checks, AVX2), sparse LU, modified Newton, one thread,
no files, no sensors, gravity as consistent nodal forces (a mass-proportional load is evaluated by every
element at every iteration), Jacobians kept until Newton contracts badly (its default; a new one each step
costs 2.5 times as much), its default reduction of steps that fail. Only the run is timed, not the assembly.
"""

import argparse
import json
import sys
import time
from itertools import pairwise

import numpy as np

sys.exudynFast = True

import exudyn as exu  # noqa: E402
import exudyn.itemInterface as item  # noqa: E402, N813

LENGTH, RADIUS, YOUNGS_MODULUS, DENSITY, GRAVITY = 1.0, 5e-3, 1e7, 1000.0, 9.81
AREA = np.pi * RADIUS**2
AXIAL_STIFFNESS = YOUNGS_MODULUS * AREA
BENDING_STIFFNESS = YOUNGS_MODULUS * np.pi * RADIUS**4 / 4
MASS_PER_LENGTH = DENSITY * AREA

# Axial and bending points of each rule, on [0, 1]: the energy is audited with the rule of the run.
LOBATTO_3 = (np.array([0.0, 0.5, 1.0]), np.array([1.0, 4.0, 1.0]) / 6)


def gauss(points):
    x, w = np.polynomial.legendre.leggauss(points)
    return (1 + x) / 2, w / 2


RULES = {
    ("3d", 0): (gauss(5), gauss(3)),
    ("3d", 1): (gauss(4), gauss(2)),
    ("2d", 0): (gauss(5), gauss(3)),
    ("2d", 1): (gauss(4), gauss(2)),
    ("2d", 2): (LOBATTO_3, gauss(2)),
}


def build(elements, dimension, rule):
    container = exu.SystemContainer()
    mbs = container.AddSystem()
    h = LENGTH / elements
    in_plane = dimension == "2d"
    node_type = item.NodePoint2DSlope1 if in_plane else item.NodePointSlope1
    cable_type = item.ObjectANCFCable2D if in_plane else item.ObjectANCFCable
    zero = [] if in_plane else [0.0]
    nodes = [
        mbs.AddNode(node_type(referenceCoordinates=[k * h, 0.0, *zero, 1.0, 0.0, *zero]))
        for k in range(elements + 1)
    ]
    for a, b in pairwise(nodes):
        mbs.AddObject(
            cable_type(
                length=h,
                massPerLength=MASS_PER_LENGTH,
                bendingStiffness=BENDING_STIFFNESS,
                axialStiffness=AXIAL_STIFFNESS,
                nodeNumbers=[a, b],
                useReducedOrderIntegration=rule,
            )
        )

    # Consistent weight: every node carries that of its halves, the moments of inner nodes cancel.
    weight = -MASS_PER_LENGTH * GRAVITY * h
    for k, node in enumerate(nodes[1:], start=1):
        marker = mbs.AddMarker(item.MarkerNodePosition(nodeNumber=node))
        share = 0.5 if k == elements else 1.0
        mbs.AddLoad(item.Force(markerNumber=marker, loadVector=[0.0, share * weight, 0.0]))
    slope_y = 3 if in_plane else 4
    for node, sign in ((nodes[0], 1), (nodes[-1], -1)):
        marker = mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=node, coordinate=slope_y))
        mbs.AddLoad(item.LoadCoordinate(markerNumber=marker, load=sign * weight * h / 12))

    fixed = mbs.AddNode(item.NodePointGround())
    fixed_marker = mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=fixed, coordinate=0))
    for c in range(2 if in_plane else 3):
        marker = mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=c))
        mbs.AddObject(item.CoordinateConstraint(markerNumbers=[fixed_marker, marker]))
    mbs.Assemble()
    return container, mbs


def energy(r, t, r_dot, t_dot, rule):
    """Kinetic + elastic (Biot strain, material curvature) + gravitational energy [J] of the nodes' state."""
    (x_axial, w_axial), (x_bending, w_bending) = rule
    elements = len(r) - 1
    h = LENGTH / elements

    def field(r, t, shape, x):
        weights = shape(x)
        parts = (r[:-1], t[:-1], r[1:], t[1:])
        return sum(w[:, None, None] * p for w, p in zip(weights, parts, strict=True))

    def position(x):
        return (
            1 - 3 * x**2 + 2 * x**3,
            h * (x - 2 * x**2 + x**3),
            3 * x**2 - 2 * x**3,
            h * (x**3 - x**2),
        )

    def slope(x):
        return (6 * (x**2 - x) / h, 1 - 4 * x + 3 * x**2, 6 * (x - x**2) / h, 3 * x**2 - 2 * x)

    def second(x):
        return ((12 * x - 6) / h**2, (6 * x - 4) / h, (6 - 12 * x) / h**2, (6 * x - 2) / h)

    x, w = gauss(4)
    velocity = field(r_dot, t_dot, position, x)
    kinetic = MASS_PER_LENGTH / 2 * h * np.einsum("g,gei,gei->", w, velocity, velocity)
    height = MASS_PER_LENGTH * GRAVITY * h * np.einsum("g,ge->", w, field(r, t, position, x)[..., 1])
    strain = np.linalg.norm(field(r, t, slope, x_axial), axis=-1) - 1
    axial = AXIAL_STIFFNESS / 2 * h * np.einsum("g,ge->", w_axial, strain**2)
    v, u = field(r, t, slope, x_bending), field(r, t, second, x_bending)
    a = np.einsum("gei,gei->ge", v, v)
    x_squared = a * np.einsum("gei,gei->ge", u, u) - np.einsum("gei,gei->ge", v, u) ** 2
    bending = BENDING_STIFFNESS / 2 * h * np.einsum("g,ge->", w_bending, x_squared / a**2)
    return float(kinetic + height + axial + bending)


def run(elements, duration, step, dimension, rule, spectral_radius, tolerance):
    _container, mbs = build(elements, dimension, rule)
    settings = exu.SimulationSettings()
    integration = settings.timeIntegration
    integration.verboseMode = 0
    integration.numberOfSteps = round(duration / step)
    integration.endTime = duration
    integration.generalizedAlpha.spectralRadius = spectral_radius
    integration.newton.useModifiedNewton = True
    integration.newton.relativeTolerance = tolerance
    integration.newton.absoluteTolerance = tolerance / 100
    settings.parallel.numberOfThreads = 1
    settings.displayStatistics = False
    settings.displayComputationTime = False
    settings.linearSolverType = exu.LinearSolverType.EigenSparse
    settings.solutionSettings.writeSolutionToFile = False
    settings.solutionSettings.sensorsWritePeriod = duration
    solver = exu.MainSolverImplicitSecondOrder()
    if not solver.InitializeSolver(mbs, settings):
        raise RuntimeError("Exudyn could not start")
    start = time.process_time()
    finished = solver.SolveSystem(mbs, settings)
    seconds = time.process_time() - start
    size = 2 if dimension == "2d" else 3
    # Exudyn's coordinates are displacements from the reference coordinates.
    reference = np.array(mbs.systemData.GetODE2Coordinates(configuration=exu.ConfigurationType.Reference))
    q = np.array(mbs.systemData.GetODE2Coordinates()) + reference
    v = np.array(mbs.systemData.GetODE2Coordinates_t())
    counts = {
        "iterations": solver.it.newtonStepsCount,
        "jacobians": solver.it.newtonJacobiCount,
        "steps_taken": solver.it.currentStepIndex - 1,
    }
    solver.FinalizeSolver(mbs, settings)
    if not finished:
        raise RuntimeError(f"Exudyn gave up: {elements} elements, step {step}")
    state = q.reshape(elements + 1, 2, size)
    rates = v.reshape(elements + 1, 2, size)
    final = energy(state[:, 0], state[:, 1], rates[:, 0], rates[:, 1], RULES[dimension, rule])
    tip = state[-1, 0]
    return {
        "elements": elements,
        "steps": round(duration / step),
        "step": step,
        "seconds": seconds,
        "tip": [float(tip[0]), float(tip[1])],
        "energy_drift": final,  # the start has none: straight, at rest, at height zero
        "version": exu.__version__,
        **counts,
    }


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=json.loads, required=True, help="list of objects: arguments of run()")
    for arguments in parser.parse_args().runs:
        print(json.dumps(run(**arguments)), flush=True)


if __name__ == "__main__":
    main()
