"""What Python adds to a step: `Stepper.advance()`, one step a call, beside the same steps in one call.

A ball on a short cord, the median of many repetitions; the target is 5 us a step.
"""

import statistics
import time

import pliant as pl

STEPS = 2000
REPEATS = 15


def begin():
    """Return a stepper of a small model with an input."""
    model = pl.Model(gravity=(0, 0, -9.81))
    rubber = pl.LinearElastic(youngs_modulus=1e6, poisson_ratio=0.45, density=1000.0)
    cord = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=2, section=pl.Circle(5e-3), material=rubber)
    model.pin(cord.start)
    model.add_force(cord.end, (0, 0, 1) * pl.Input("push"))
    return pl.Stepper(model, step=1e-3, threads=1), cord.end


def seconds(work):
    """Return the wall time of a call [s]."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def main():
    """Print the comparison."""
    stepper, tip = begin()
    first = stepper.state

    def one_by_one():
        for _ in range(STEPS):
            stepper.advance()

    def controlled():
        for _ in range(STEPS):
            stepper.set_input("push", -0.1 * stepper.position(tip)[2])
            stepper.advance()

    ways = {"one call": lambda: stepper.advance(STEPS), "one by one": one_by_one, "controlled": controlled}
    times = {name: [] for name in ways}
    # Interleaved, so that a busy moment of the machine meets all of them.
    for _ in range(REPEATS):
        for name, work in ways.items():
            stepper.reset(first)
            times[name].append(1e6 * seconds(work) / STEPS)
    per = {name: statistics.median(values) for name, values in times.items()}
    base = per["one call"]
    print(
        f"{base:.1f} us a step in one call, {per['one by one'] - base:+.1f} us one by one, "
        f"{per['controlled'] - base:+.1f} us with a position read and an input set"
    )


if __name__ == "__main__":
    main()
