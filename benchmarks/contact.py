"""What contact costs: a crossing, growth with the pairs that touch, a thousand zones in 32,000 elements.

Milliseconds of processor time a step, the least of several runs; contact in the second and third table is the
difference to the same ropes that may not touch, in the same process.

    python benchmarks/contact.py
    python benchmarks/contact.py --only crossing
"""

import argparse
import time

import numpy as np
import pliant as pl

RADIUS = 5e-3
SOFT = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.4, density=1000.0, retardation_time=1e-3)
LAW = pl.LuGre(static=0.5, dynamic=0.4)


def rope(model, line, elements, velocity=(0.0, 0.0, 0.0)):
    """Add a rope of 5 mm radius."""
    section = pl.Circle(radius=RADIUS)
    return model.add_cable(line, elements=elements, section=section, material=SOFT, velocity=velocity)


def measure(model, steps, step, warm=0, repeats=3):
    """Return processor time of a step [ms] after some first ones, and what the steps took."""
    best = np.inf
    for _ in range(repeats):
        stepper = pl.Stepper(model, step=step, threads=1)
        if warm:
            stepper.advance(warm)
        before = stepper.statistics
        start = time.process_time()
        stepper.advance(steps)
        best = min(best, time.process_time() - start)
    after = stepper.statistics
    counts = {
        name: (getattr(after, name) - getattr(before, name)) / steps
        for name in ("newton_iterations", "factorizations", "rejected")
    }
    return 1e3 * best / steps, counts, stepper


def crossing(elements):
    """Two ropes of a metre, one held at its ends, the other thrown across it: half a second."""
    model = pl.Model(gravity=(0, 0, -9.81))
    low = rope(model, [(0, 0, 0), (1, 0, 0)], elements)
    for end in (low.start, low.end):
        model.pin(end)
    high = rope(model, [(0.47, -0.52, 0.05), (0.47, 0.48, 0.05)], elements, velocity=(0.3, 0, -1.0))
    model.add_contact(low, high, friction=LAW)
    return model


def pairs(touching, apart, elements, may_touch=True):
    """Make pairs of crossing ropes, some pressing on each other, the others a little too far apart."""
    model = pl.Model()
    for k in range(touching + apart):
        gap = -0.1 * RADIUS if k < touching else 1.0 * RADIUS
        low = rope(model, [(-0.2, k, 0), (0.2, k, 0)], elements)
        z = 2 * RADIUS + gap
        high = rope(model, [(0.01, k - 0.2, z), (0.01, k + 0.2, z)], elements, velocity=(0.05, 0, 0))
        if may_touch:
            model.add_contact(low, high, friction=LAW)
    return model


def mat(n, elements, may_touch=True):
    """Make a mat of n by n ropes in two layers that press on each other where they cross."""
    model = pl.Model()
    size = 0.1 * n
    places = (np.arange(n) + 0.53) * 0.1
    low = [rope(model, [(0, y, 0), (size, y, 0)], elements) for y in places]
    z = 1.9 * RADIUS
    high = [rope(model, [(x, 0, z), (x, size, z)], elements, velocity=(0.05, 0, 0)) for x in places]
    if may_touch:
        for a in low:
            for b in high:
                model.add_contact(a, b, friction=LAW)
    return model


def show(name, model, plain, steps, warm=2, step=5e-4):
    """Print a row: cost with contact, without, and the zones."""
    with_contact, counts, stepper = measure(model, steps, step, warm, repeats=2)
    without, _, _ = measure(plain, steps, step, warm, repeats=2)
    zones = len(stepper.contacts)
    print(
        f"| {name} | {zones} | {without:.2f} | {with_contact:.2f} | {with_contact - without:.2f} | "
        f"{counts['newton_iterations']:.1f} | {counts['factorizations']:.2f} |",
        flush=True,
    )


def main():
    """Run and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", choices=("crossing", "growth", "mat"))
    parser.add_argument("--mat", type=int, default=32, help="ropes in each layer of the mat")
    only = parser.parse_args().only
    if only in (None, "crossing"):
        print("| elements of each rope | ms a step | iterations | factorisations | refused |")
        print("| --- | --- | --- | --- | --- |")
        for elements in (20, 40, 80):
            cost, counts, _ = measure(crossing(elements), 1000, 5e-4)
            print(f"| {elements} | {cost:.3f} | " + " | ".join(f"{c:.3g}" for c in counts.values()) + " |")
    head = "zones | ms without contact | ms with | contact alone | iterations | factorisations |"
    rule = "| --- | --- | --- | --- | --- | --- | --- |"
    if only in (None, "growth"):
        print(f"\n| 128 pairs of ropes of 10 elements, of which touch | {head}\n{rule}")
        for touching in (0, 1, 4, 16, 64, 128):
            show(
                touching, pairs(touching, 128 - touching, 10), pairs(touching, 128 - touching, 10, False), 40
            )
    if only in (None, "mat"):
        print(f"\n| 32,000 elements | {head}\n{rule}")
        show("1000 pairs of ropes", pairs(1000, 0, 16), pairs(1000, 0, 16, False), 10)
        n = parser.parse_args().mat
        elements = 16_000 // n
        show(f"mat of {n} by {n} ropes", mat(n, elements), mat(n, elements, False), 5)


if __name__ == "__main__":
    main()
