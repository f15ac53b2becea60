"""What contact costs: a crossing, growth with the pairs that touch, a thousand zones in 32,000 elements.

Milliseconds of processor time a step, the least of several runs; contact in the second and third table is
the difference to the same ropes that may not touch, in the same process. There each crossing is pressed
together by a tenth of a newton while the ropes slide. With MuJoCo in an environment of its own
(`make bench-mujoco`) the first table has its row of the same scene, too.

    python benchmarks/contact.py
    python benchmarks/contact.py --only crossing --mujoco .venv-mujoco/bin/python --write crossing
"""

import argparse
import json
import platform
import subprocess
import time
from pathlib import Path

import numpy as np
import pliant as pl

HERE = Path(__file__).parent
RADIUS = 5e-3
PRESSED = 0.1
"""Force at each crossing of the second and third table [N]."""
SUNK = 5e-5
"""How deep the ropes are in each other there at the start: about what that force makes [m]."""
SOFT = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.4, density=1000.0, retardation_time=1e-3)
LAW = pl.LuGre(static=0.5, dynamic=0.4)


def rope(model, line, elements, velocity=(0.0, 0.0, 0.0), load=0.0):
    """Add a rope of 5 mm radius, loaded along z [N/m]."""
    section = pl.Circle(radius=RADIUS)
    cable = model.add_cable(line, elements=elements, section=section, material=SOFT, velocity=velocity)
    if load:
        model.add_line_load(cable, (0, 0, load))
    return cable


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
        load = PRESSED / 0.4 if k < touching else 0.0
        gap = -SUNK if k < touching else 1.0 * RADIUS
        low = rope(model, [(-0.2, k, 0), (0.2, k, 0)], elements, load=load)
        z = 2 * RADIUS + gap
        line = [(0.01, k - 0.2, z), (0.01, k + 0.2, z)]
        high = rope(model, line, elements, velocity=(0.05, 0, 0), load=-load)
        if may_touch:
            model.add_contact(low, high, friction=LAW)
    return model


def mat(n, elements, may_touch=True):
    """Make a mat of n by n ropes in two layers that press on each other where they cross."""
    model = pl.Model()
    size = 0.1 * n
    places = (np.arange(n) + 0.53) * 0.1
    load = PRESSED / 0.1
    low = [rope(model, [(0, y, 0), (size, y, 0)], elements, load=load) for y in places]
    z = 2 * RADIUS - SUNK
    kind = {"velocity": (0.05, 0, 0), "load": -load}
    high = [rope(model, [(x, 0, z), (x, size, z)], elements, **kind) for x in places]
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
        f"{counts['newton_iterations']:.1f} | {counts['factorizations']:.2f} | {counts['rejected']:.2f} |",
        flush=True,
    )


def deepest(elements, step, steps):
    """Return the steps of a crossing that touch, how deep over the radius, and where the thrown rope ends."""
    model = crossing(elements)
    high = model["cable2"]
    stepper = pl.Stepper(model, step=step, threads=1)
    touching, depth = 0, 0.0
    for _ in range(steps):
        stepper.advance(1)
        patches = stepper.contacts
        touching += bool(patches)
        depth = max([depth, *(-patch.gap for patch in patches)])
    return touching, depth / RADIUS, stepper.position(high.end).tolist()


def beside_mujoco(python, sizes, step, steps):
    """Print both programs' rows of the crossing; return them."""
    rows = []
    for elements in sizes:
        cost, counts, _ = measure(crossing(elements), steps, step)
        touching, depth, end = deepest(elements, step, steps)
        rows.append(
            {
                "program": "pliant",
                "elements": elements,
                "ms_a_step": cost,
                "iterations": counts["newton_iterations"],
                "steps_touching": touching,
                "penetration_over_radius": depth,
                "end_of_high_rope": end,
            }
        )
    script = HERE / "peers" / "mujoco_crossing.py"
    command = [
        python,
        str(script),
        "--step",
        str(step),
        "--steps",
        str(steps),
        "--elements",
        *map(str, sizes),
    ]
    lines = subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()
    program = json.loads(lines[0])["program"]
    rows += [{"program": program, **json.loads(line)} for line in lines[1:]]
    ours = {row["elements"]: row["ms_a_step"] for row in rows if row["program"] == "pliant"}
    text = [
        "| program | elements of each rope | ms a step | times pliant's | iterations | steps touching | "
        "deepest penetration over radius | end of the thrown rope [m] |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for row in rows:
        end = ", ".join(f"{x:.3f}" for x in row["end_of_high_rope"])
        text.append(
            f"| {row['program']} | {row['elements']} | {row['ms_a_step']:.3f} | "
            f"{row['ms_a_step'] / ours[row['elements']]:.1f} | {row['iterations']:.1f} | "
            f"{row['steps_touching']:.0f} | {row['penetration_over_radius']:.2f} | {end} |"
        )
    print("\n".join(text), flush=True)
    return rows, text


def main():
    """Run and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", choices=("crossing", "growth", "mat"))
    parser.add_argument("--mat", type=int, default=32, help="ropes in each layer of the mat")
    parser.add_argument("--mujoco", metavar="PYTHON", help="interpreter that has MuJoCo")
    parser.add_argument(
        "--write", metavar="NAME", help="leave MuJoCo's comparison in results/NAME.md and .json"
    )
    given = parser.parse_args()
    only = given.only
    if only in (None, "crossing") and given.mujoco:
        rows, text = beside_mujoco(given.mujoco, (20, 40, 80), 5e-4, 1000)
        if given.write:
            folder = HERE / "results"
            record = {"machine": platform.processor() or platform.machine(), "step": 5e-4, "rows": rows}
            (folder / f"{given.write}.json").write_text(json.dumps(record, indent=1) + "\n")
            (folder / f"{given.write}.md").write_text("\n".join(text) + "\n")
    elif only in (None, "crossing"):
        print("| elements of each rope | ms a step | iterations | factorisations | refused |")
        print("| --- | --- | --- | --- | --- |")
        for elements in (20, 40, 80):
            cost, counts, _ = measure(crossing(elements), 1000, 5e-4)
            print(f"| {elements} | {cost:.3f} | " + " | ".join(f"{c:.3g}" for c in counts.values()) + " |")
    head = "zones | ms without contact | ms with | contact alone | iterations | factorisations | refused |"
    rule = "| --- | --- | --- | --- | --- | --- | --- | --- |"
    if only in (None, "growth"):
        print(f"\n| 128 pairs of ropes of 10 elements, of which touch | {head}\n{rule}")
        for touching in (0, 1, 4, 16, 64, 128):
            show(
                touching, pairs(touching, 128 - touching, 10), pairs(touching, 128 - touching, 10, False), 40
            )
    if only in (None, "mat"):
        print(f"\n| 32,000 elements | {head}\n{rule}")
        show("1000 pairs of ropes", pairs(1000, 0, 16), pairs(1000, 0, 16, False), 10)
        n = given.mat
        elements = 16_000 // n
        show(f"mat of {n} by {n} ropes", mat(n, elements), mat(n, elements, False), 5)


if __name__ == "__main__":
    main()
