"""A cable pendulum falls: pliant beside Exudyn, at equal element count and at equal error.

The cable (1 m long, radius 5 mm, 10 MPa, 1000 kg/m^3) starts straight, horizontal and at rest, pinned at one
end. Both programs use the Biot strain, generalized-alpha with spectral radius 0.9, one thread, and count the
CPU time of the run without assembly. Exudyn runs in its own environment (`make bench-exudyn`) with its 3D
element, and with its faster planar one.

    python benchmarks/falling_pendulum.py --exudyn .venv-exudyn/bin/python
"""

import argparse
import json
import math
import platform
import subprocess
import time
from itertools import product
from pathlib import Path

HERE = Path(__file__).parent
SPECTRAL_RADIUS = 0.9
STEP = 1e-3  # [s]

# Long runs of short chains, short runs of long ones: (elements, duration [s]).
SIZES = [(40, 0.3), (100, 0.2), (400, 0.1), (1000, 0.05), (4000, 0.01), (10_000, 0.01)]

# Tip at 0.3 s by an independent refinement (order 8 in time), error 1e-8.
TIP, TIP_TIME = (0.79987748, -0.42373659), 0.3
SCAN_ELEMENTS = (10, 14, 20, 28, 40)
SCAN_STEPS = tuple(TIP_TIME / n for n in (75, 100, 150, 200, 300, 400, 600, 1200))
TARGETS = (1e-3, 1e-4, 1e-5)  # [m]

# The loosest Newton tolerances that move the tip by less than 1e-9 m when tightened tenfold (see the table).
EXUDYN_TOLERANCE = 1e-6
EXUDYN_RULES = {"Exudyn 3D": ("3d", 1), "Exudyn 2D": ("2d", 2)}


class Pliant:
    """Runs of pliant through its public face."""

    name = "pliant"

    def run(self, cases):
        """Yield a record for each (elements, duration, step, tightening of Newton's tolerance)."""
        import pliant as pl

        for elements, duration, step, tightened in cases:
            model = pl.Model(gravity=(0, -9.81, 0))
            rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
            rope = model.add_cable(
                [(0, 0, 0), (1, 0, 0)],
                elements=elements,
                section=pl.Circle(radius=5e-3),
                material=rubber,
                strain="biot",
            )
            model.pin(rope.start)
            steps = round(duration / step)

            def timed(steps, model=model, step=step, tightened=tightened):
                start = time.process_time()
                result = pl.simulate(
                    model,
                    duration=steps * step,
                    step=step,
                    spectral_radius=SPECTRAL_RADIUS,
                    tolerance=1e-11 if tightened else None,
                    output_every=steps,
                    threads=1,
                    progress=False,
                )
                return time.process_time() - start, result

            # Assembly is left out, as for Exudyn: the cost of one step is subtracted.
            setup, _ = min((timed(1) for _ in range(3)), key=lambda run: run[0])
            seconds, result = min((timed(steps) for _ in range(3)), key=lambda run: run[0])
            tip = result.track(rope.end).position[-1]
            total = result.energy.total
            yield {
                "elements": elements,
                "steps": steps,
                "step": step,
                "seconds": max(seconds - setup, 0.0) * steps / max(steps - 1, 1),
                "tip": [float(tip[0]), float(tip[1])],
                "energy_drift": float(total[-1] - total[0]),
                "iterations": int(result.statistics.newton_iterations),
                "jacobians": int(result.statistics.factorizations),
                "steps_taken": int(result.statistics.steps),
                "version": pl.__version__,
            }


class Exudyn:
    """Runs of Exudyn in another interpreter, all cases in one process."""

    def __init__(self, name, python):
        self.name = name
        self.python = python
        self.dimension, self.rule = EXUDYN_RULES[name]

    def run(self, cases):
        """Yield a record for each (elements, duration, step, tightening of Newton's tolerance)."""
        runs = [
            {
                "elements": elements,
                "duration": duration,
                "step": step,
                "dimension": self.dimension,
                "rule": self.rule,
                "spectral_radius": SPECTRAL_RADIUS,
                "tolerance": EXUDYN_TOLERANCE / (10 if tightened else 1),
            }
            for elements, duration, step, tightened in cases
        ]
        command = [self.python, HERE / "peers" / "exudyn_pendulum.py", "--runs", json.dumps(runs)]
        output = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        for line in output.splitlines():
            if line.startswith("{"):
                yield json.loads(line)


def distance(a, b):
    """Distance of two tips [m]."""
    return math.dist(a, b)


def equal_size(programs, sizes):
    """Return records {program: [record of each size]}, each with the effect of a tighter Newton iteration."""
    records = {}
    for program in programs:
        runs = list(program.run([(n, duration, STEP, False) for n, duration in sizes]))
        tight = list(program.run([(n, duration, STEP, True) for n, duration in sizes]))
        for run, check in zip(runs, tight, strict=True):
            run["newton_error"] = distance(run["tip"], check["tip"])
            run["microseconds"] = 1e6 * run["seconds"] / run["steps"] / run["elements"]
        records[program.name] = runs
    return records


def equal_error(programs):
    """Return the cheapest trustworthy run below each target, {program: {target: record or None}}.

    A run counts only if all runs of the scan that are finer in both respects are below the target, too: some
    coarse ones hit it by cancellation of their errors in space and in time.
    """
    cheapest = {}
    for program in programs:
        pairs = list(product(SCAN_ELEMENTS, SCAN_STEPS))
        runs = list(program.run([(n, TIP_TIME, h, False) for n, h in pairs]))
        for run in runs:
            run["error"] = distance(run["tip"], TIP)

        def trustworthy(run, target, runs=runs):
            finer = (r for r in runs if r["elements"] >= run["elements"] and r["step"] <= run["step"])
            return all(r["error"] <= target for r in finer)

        cheapest[program.name] = {
            target: min(
                (run for run in runs if trustworthy(run, target)),
                key=lambda run: run["seconds"],
                default=None,
            )
            for target in TARGETS
        }
    return cheapest


def table(header, rows):
    """Return a Markdown table."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def report(by_size, by_error):
    """Return the Markdown report."""
    ours = {r["elements"]: r for r in by_size.get(Pliant.name, [])}
    rows = []
    for name, records in by_size.items():
        for r in records:
            own = ours.get(r["elements"])
            ratio = f"{r['microseconds'] / own['microseconds']:.1f}" if own else "-"
            rows.append(
                [
                    name,
                    f"{r['elements']}",
                    f"{r['steps']} ({r['steps_taken']})",
                    f"{r['microseconds']:.2f}",
                    ratio,
                    f"{r['iterations'] / r['steps']:.1f}",
                    f"{r['jacobians']}",
                    f"{r['energy_drift']:.1e}",
                    f"{r['newton_error']:.0e}",
                ]
            )
    header = [
        "program",
        "elements",
        "steps (taken)",
        "us per element and step",
        "times pliant's",
        "iterations per step",
        "Jacobians",
        "energy drift [J]",
        "Newton error [m]",
    ]
    parts = ["Equal element count, steps of 1 ms", table(header, rows)]
    rows = []
    for name, by_target in by_error.items():
        for target, r in by_target.items():
            own = by_error.get(Pliant.name, {}).get(target)
            if r is None:
                rows.append([name, f"{target:.0e}", *["-"] * 6])
                continue
            rows.append(
                [
                    name,
                    f"{target:.0e}",
                    f"{r['elements']}",
                    f"{1e3 * r['step']:g}",
                    f"{1e3 * r['seconds']:.2f}",
                    f"{r['seconds'] / own['seconds']:.1f}" if own else "-",
                    f"{r['error']:.1e}",
                    f"{r['energy_drift']:.1e}",
                ]
            )
    header = [
        "program",
        "error wanted [m]",
        "elements",
        "step [ms]",
        "CPU time [ms]",
        "times pliant's",
        "error reached [m]",
        "energy drift [J]",
    ]
    parts += ["Equal error of the tip at 0.3 s", table(header, rows)]
    return "\n\n".join(parts) + "\n"


def main():
    """Run what is asked for and print the report."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--exudyn", metavar="PYTHON", help="interpreter that has Exudyn")
    parser.add_argument("--without-pliant", action="store_true")
    parser.add_argument("--largest", type=int, default=10_000, help="leave longer chains out")
    parser.add_argument("--write", metavar="NAME", help="also write results/NAME.json and .md")
    options = parser.parse_args()
    programs = [] if options.without_pliant else [Pliant()]
    if options.exudyn:
        programs += [Exudyn(name, options.exudyn) for name in EXUDYN_RULES]
    by_size = equal_size(programs, [size for size in SIZES if size[0] <= options.largest])
    by_error = equal_error(programs)
    text = report(by_size, by_error)
    print(text)
    if options.write:
        folder = HERE / "results"
        folder.mkdir(exist_ok=True)
        data = {"machine": platform.processor() or platform.machine(), "size": by_size, "error": by_error}
        (folder / f"{options.write}.json").write_text(json.dumps(data, indent=1) + "\n")
        (folder / f"{options.write}.md").write_text(text)


if __name__ == "__main__":
    main()
