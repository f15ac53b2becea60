"""A square sheet falls, pinned at a corner: pliant's shells beside Exudyn's `ANCFThinPlate`.

The sheet (1 m x 1 m x 10 mm, 1 MPa, nu = 0.3, 1000 kg/m^3) starts flat, horizontal and at rest. Both
programs use generalized-alpha with spectral radius 0.9, steps of 1 ms, one thread, and count the CPU time
of the run without assembly. Exudyn's plate has 36 coordinates, as pliant's `"plate"`; pliant's `"bicubic"`
has 48. Exudyn runs in its own environment (`make bench-exudyn`), with full integration and with its reduced
one, which is the faster.

    python benchmarks/falling_sheet.py --exudyn .venv-exudyn/bin/python
"""

import argparse
import json
import math
import platform
import subprocess
import time
from pathlib import Path

from falling_pendulum import table

HERE = Path(__file__).parent
SPECTRAL_RADIUS = 0.9
STEP = 1e-3  # [s]
# Elements along a side, and steps.
RUNS = ((8, 300), (16, 200), (32, 50))
LARGE = 60
EXUDYN_TOLERANCE = 1e-6
EXUDYN_RULES = {"Exudyn, reduced": 1, "Exudyn, full": 0}


def pliant_runs(kind, cases, tightened):
    """Yield a record for each case of shells of this kind."""
    import pliant as pl

    for elements, steps in cases:
        model = pl.Model(gravity=(0, 0, -9.81))
        rubber = pl.SaintVenantKirchhoff(youngs_modulus=1e6, poisson_ratio=0.3, density=1000.0)
        square = pl.Mesh.rectangle(1, 1, divisions=(elements, elements))
        sheet = model.add_shell(square, thickness=0.01, material=rubber, element=kind)
        model.pin(sheet.node(0))

        def timed(steps, model=model):
            start = time.process_time()
            result = pl.simulate(
                model,
                duration=steps * STEP,
                step=STEP,
                spectral_radius=SPECTRAL_RADIUS,
                tolerance=1e-11 if tightened else None,
                output_every=steps,
                threads=1,
                progress=False,
            )
            return time.process_time() - start, result

        # Assembly is left out, as for Exudyn: the cost of one step is subtracted.
        setup, _ = min((timed(1) for _ in range(2)), key=lambda run: run[0])
        seconds, result = timed(steps)
        yield {
            "elements": elements,
            "steps": steps,
            "seconds": max(seconds - setup, 0.0) * steps / max(steps - 1, 1),
            "corner": result.track(sheet.node(-1)).position[-1].tolist(),
            "energy_drift": float(result.energy.total[-1] - result.energy.total[0]),
            "iterations": int(result.statistics.newton_iterations),
            "jacobians": int(result.statistics.factorizations),
            "version": pl.__version__,
        }


def exudyn_runs(python, rule, cases, tightened):
    """Yield the same of Exudyn, all cases in one process of another interpreter."""
    runs = [
        {
            "elements": elements,
            "steps": steps,
            "step": STEP,
            "rule": rule,
            "spectral_radius": SPECTRAL_RADIUS,
            "tolerance": EXUDYN_TOLERANCE / (10 if tightened else 1),
        }
        for elements, steps in cases
    ]
    command = [python, "-W", "ignore", HERE / "peers" / "exudyn_sheet.py", "--runs", json.dumps(runs)]
    output = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    for line in output.splitlines():
        if line.startswith("{"):
            yield json.loads(line)


def parts_of_an_iteration(elements, steps=5):
    """Return coordinates of a bicubic sheet, and milliseconds of parts of an iteration with a new tangent.

    Parts are told by the clock; their sum is scaled to the processor time.
    """
    import pliant as pl

    model = pl.Model(gravity=(0, 0, -9.81))
    rubber = pl.SaintVenantKirchhoff(youngs_modulus=1e6, poisson_ratio=0.3, density=1000.0)
    square = pl.Mesh.rectangle(1, 1, divisions=(elements, elements))
    sheet = model.add_shell(square, thickness=0.01, material=rubber, element="bicubic")
    model.pin(sheet.node(0))
    stepper = pl.Stepper(model, step=STEP, spectral_radius=SPECTRAL_RADIUS, record_every=steps, threads=1)
    before, start = stepper.statistics, time.process_time()
    stepper.advance(steps)
    seconds, after = time.process_time() - start, stepper.statistics
    iterations = after.newton_iterations - before.newton_iterations
    factorizations = after.factorizations - before.factorizations
    passed = {name: after.seconds[name] - before.seconds[name] for name in after.seconds}
    calls = {
        "residual": iterations,
        "tangent": factorizations,
        "factor": factorizations,
        "solve": iterations,
    }
    scale = 1e3 * seconds / sum(passed.values())
    parts = {name: scale * passed[name] / count for name, count in calls.items()}
    return model.dof, {**parts, "together": sum(parts.values())}


def report(records):
    """Return the Markdown table of `{program: [records]}`."""
    own = {r["elements"]: r for r in records["pliant, bicubic"]}
    rows = []
    for name, runs in records.items():
        for r in runs:
            milliseconds = 1e3 * r["seconds"] / r["steps"]
            ours = 1e3 * own[r["elements"]]["seconds"] / own[r["elements"]]["steps"]
            rows.append(
                [
                    name,
                    f"{r['elements']} x {r['elements']}",
                    f"{r['steps']}",
                    f"{milliseconds:.2f}",
                    f"{milliseconds / ours:.1f}",
                    f"{r['iterations'] / r['steps']:.1f}",
                    f"{r['jacobians']}",
                    f"{r['corner'][2]:.5f}",
                    f"{r['newton_error']:.0e}" if "newton_error" in r else "-",
                ]
            )
    header = ["program", "elements", "steps", "ms per step", "times bicubic"]
    header += ["iterations per step", "Jacobians", "height of the corner [m]", "Newton error [m]"]
    return table(header, rows)


def main():
    """Run what is asked for and print the report."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--exudyn", metavar="PYTHON", help="interpreter that has Exudyn")
    parser.add_argument("--largest", type=int, default=32, help="leave finer sheets out")
    parser.add_argument("--newton", action="store_true", help="also tighten Newton's tolerance tenfold")
    parser.add_argument("--write", metavar="NAME", help="also write results/NAME.json and .md")
    options = parser.parse_args()
    cases = [case for case in RUNS if case[0] <= options.largest]
    programs = {
        f"pliant, {kind}": lambda tightened, kind=kind: pliant_runs(kind, cases, tightened)
        for kind in ("bicubic", "plate")
    }
    if options.exudyn:
        for name, rule in EXUDYN_RULES.items():
            programs[name] = lambda tightened, rule=rule: exudyn_runs(options.exudyn, rule, cases, tightened)
    records = {name: list(run(False)) for name, run in programs.items()}
    if options.newton:
        for name, run in programs.items():
            for record, tight in zip(records[name], run(True), strict=True):
                record["newton_error"] = math.dist(record["corner"], tight["corner"])
    dof, parts = parts_of_an_iteration(LARGE)
    text = f"""Falling sheet, steps of 1 ms

{report(records)}

One iteration with a new tangent, {LARGE} x {LARGE} bicubic elements, {dof} coordinates [ms]:
{", ".join(f"{name} {milliseconds:.1f}" for name, milliseconds in parts.items())}
"""
    print(text)
    if options.write:
        folder = HERE / "results"
        folder.mkdir(exist_ok=True)
        data = {"machine": platform.processor() or platform.machine(), "runs": records, "iteration": parts}
        (folder / f"{options.write}.json").write_text(json.dumps(data, indent=1) + "\n")
        (folder / f"{options.write}.md").write_text(text)


if __name__ == "__main__":
    main()
