"""Exudyn's side of falling_sheet.py: in Exudyn's own environment, one JSON line a run on standard output.

Exudyn is shown at its best: its fast module (no range checks, AVX2), sparse LU, modified Newton, one
thread, no files, no sensors, gravity as consistent nodal forces (a mass-proportional load is evaluated by
every element at every iteration), Jacobians kept until Newton contracts badly. Only the run is timed, not
the assembly.
"""

import argparse
import json
import sys
import time

import numpy as np

sys.exudynFast = True

import exudyn as exu  # noqa: E402
import exudyn.itemInterface as item  # noqa: E402, N813

SIDE, THICKNESS, YOUNGS_MODULUS, POISSON_RATIO, DENSITY, GRAVITY = 1.0, 0.01, 1e6, 0.3, 1000.0, 9.81


def section():
    """Return the stiffness matrices of the membrane and of bending, as lists of one."""
    nu = POISSON_RATIO
    plane = YOUNGS_MODULUS / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])
    matrices = []
    for factor in (THICKNESS, THICKNESS**3 / 12):
        matrices.append(exu.Matrix3DList())
        matrices[-1].Append(factor * plane)
    return matrices


def build(elements, rule, element_loads=False):
    """Return container, system and nodes; with `element_loads` gravity is a load of every element."""
    container = exu.SystemContainer()
    mbs = container.AddSystem()
    a = SIDE / elements
    membrane, bending = section()
    nodes = {
        (i, j): mbs.AddNode(
            item.NodePointSlope12(referenceCoordinates=[i * a, j * a, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0])
        )
        for i in range(elements + 1)
        for j in range(elements + 1)
    }
    for i in range(elements):
        for j in range(elements):
            plate = mbs.AddObject(
                item.ObjectANCFThinPlate(
                    thickness=THICKNESS,
                    density=DENSITY,
                    strainCoefficients=membrane,
                    curvatureCoefficients=bending,
                    nodeNumbers=[nodes[i, j], nodes[i + 1, j], nodes[i + 1, j + 1], nodes[i, j + 1]],
                    useReducedOrderIntegration=rule,
                )
            )
            if element_loads:
                marker = mbs.AddMarker(item.MarkerBodyMass(bodyNumber=plate))
                mbs.AddLoad(item.LoadMassProportional(markerNumber=marker, loadVector=[0, 0, -GRAVITY]))
    if not element_loads:
        weight = -DENSITY * THICKNESS * GRAVITY * a**2
        for (i, j), node in nodes.items():
            share = [0.5 if k in (0, elements) else 1.0 for k in (i, j)]
            # Moments of the weight cancel at inner nodes; position, slope in x, slope in y: third components.
            lever = [a / 6 * ((k == 0) - (k == elements)) for k in (i, j)]
            loads = (share[0] * share[1], 0.5 * lever[0] * share[1], 0.5 * lever[1] * share[0])
            for coordinate, load in zip((2, 5, 8), loads, strict=True):
                if load != 0.0:
                    marker = mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
                    mbs.AddLoad(item.LoadCoordinate(markerNumber=marker, load=weight * load))
    fixed = mbs.AddNode(item.NodePointGround())
    fixed_marker = mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=fixed, coordinate=0))
    for c in range(3):
        marker = mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=nodes[0, 0], coordinate=c))
        mbs.AddObject(item.CoordinateConstraint(markerNumbers=[fixed_marker, marker]))
    mbs.Assemble()
    return container, mbs


def run(elements, steps, step, rule, spectral_radius, tolerance, element_loads=False):
    """Return the record of one run."""
    _container, mbs = build(elements, rule, element_loads)
    settings = exu.SimulationSettings()
    integration = settings.timeIntegration
    integration.verboseMode = 0
    integration.numberOfSteps = steps
    integration.endTime = steps * step
    integration.generalizedAlpha.spectralRadius = spectral_radius
    integration.newton.useModifiedNewton = True
    integration.newton.relativeTolerance = tolerance
    integration.newton.absoluteTolerance = tolerance / 100
    settings.parallel.numberOfThreads = 1
    settings.displayStatistics = False
    settings.displayComputationTime = False
    settings.linearSolverType = exu.LinearSolverType.EigenSparse
    settings.solutionSettings.writeSolutionToFile = False
    settings.solutionSettings.sensorsWritePeriod = steps * step
    solver = exu.MainSolverImplicitSecondOrder()
    if not solver.InitializeSolver(mbs, settings):
        raise RuntimeError("Exudyn could not start")
    start = time.process_time()
    finished = solver.SolveSystem(mbs, settings)
    seconds = time.process_time() - start
    # Exudyn's coordinates are displacements from the reference coordinates.
    reference = np.array(mbs.systemData.GetODE2Coordinates(configuration=exu.ConfigurationType.Reference))
    q = np.array(mbs.systemData.GetODE2Coordinates()) + reference
    counts = {
        "iterations": solver.it.newtonStepsCount,
        "jacobians": solver.it.newtonJacobiCount,
        "steps_taken": solver.it.currentStepIndex - 1,
    }
    solver.FinalizeSolver(mbs, settings)
    if not finished:
        raise RuntimeError(f"Exudyn gave up: {elements} elements a side")
    return {
        "elements": elements,
        "steps": steps,
        "seconds": seconds,
        "corner": [float(x) for x in q[-9:-6]],
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
