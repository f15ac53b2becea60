"""Cost against size: time and memory of a falling cable from 10^3 to 10^6 coordinates.

A pinned cable falls for a few steps. Each size runs in its own process, so that its peak memory is its own.
The exponents are slopes of least squares in logarithms; 1 means proportional to size. The target is 1.05.

    python benchmarks/scaling.py --largest 1000000
"""

import argparse
import json
import math
import resource
import subprocess
import sys
import time

SIZES = (1_000, 3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000)  # coordinates
STEPS = 30  # the same for all: the first steps are dearer than later ones


def run(coordinates, threads):
    """Return time [s] and peak memory [bytes] of one size, in this process."""
    import pliant as pl

    model = pl.Model(gravity=(0, 0, -9.81))
    rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
    # Elements of one size: the physics of an element stays the same while the cable grows.
    elements = coordinates // 6 - 1
    length = 0.025 * elements
    rope = model.add_cable(
        [(0, 0, 0), (length, 0, 0)], elements=elements, section=pl.Circle(radius=5e-3), material=rubber
    )
    model.pin(rope.start)

    def simulate(steps):
        wall, cpu = time.perf_counter(), time.process_time()
        pl.simulate(
            model, duration=steps * 1e-3, step=1e-3, output_every=steps, threads=threads, progress=False
        )
        return time.perf_counter() - wall, time.process_time() - cpu

    # The quietest of several runs.
    repeats = 3 if coordinates > 30_000 else 10
    setup_wall, setup_cpu = map(min, zip(*(simulate(1) for _ in range(repeats)), strict=True))
    wall, cpu = map(min, zip(*(simulate(STEPS + 1) for _ in range(repeats)), strict=True))
    return {
        "coordinates": model.dof,
        "ready": setup_wall,
        "wall": max(wall - setup_wall, 1e-9) / STEPS,
        "cpu": max(cpu - setup_cpu, 1e-9) / STEPS,
        "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024,
    }


def slope(x, y):
    """Return the exponent of y against x."""
    a, b = [math.log(v) for v in x], [math.log(v) for v in y]
    mean_a, mean_b = sum(a) / len(a), sum(b) / len(b)
    over = sum((p - mean_a) * (q - mean_b) for p, q in zip(a, b, strict=True))
    return over / sum((p - mean_a) ** 2 for p in a)


def main():
    """Run all sizes and print table and exponents."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--largest", type=int, default=1_000_000)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--one", type=int, help="run one size in this process and print its record as JSON")
    options = parser.parse_args()
    if options.one is not None:
        print(json.dumps(run(options.one, options.threads)))
        return
    records = []
    print(
        "| coordinates | ready [s] | wall time of a step [ms] | CPU time [us per coordinate] | memory [MB] |"
    )
    print("| --- | --- | --- | --- | --- |")
    for size in (size for size in (0, *SIZES) if size <= options.largest):
        # Size 0 stands for the smallest model: what the interpreter and its libraries take.
        command = [sys.executable, __file__, "--one", str(max(size, 18)), "--threads", str(options.threads)]
        record = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        records.append(record)
        print(
            f"| {record['coordinates']} | {record['ready']:.3f} | {1e3 * record['wall']:.3f} "
            f"| {1e6 * record['cpu'] / record['coordinates']:.3f} | {record['memory'] / 1e6:.0f} |",
            flush=True,
        )
    base, *records = records
    # Small models drown in the noise of the interpreter's own memory.
    large = [r for r in records if r["coordinates"] >= 10_000]
    exponent = slope([r["coordinates"] for r in records], [r["cpu"] for r in records])
    print(f"\nexponent of CPU time {exponent:.3f}")
    if len(large) > 1:
        extra = [max(r["memory"] - base["memory"], 1.0) for r in large]
        exponent = slope([r["coordinates"] for r in large], extra)
        print(f"exponent of memory beyond the smallest model {exponent:.3f}")


if __name__ == "__main__":
    main()
