"""What `import pliant` costs beyond numpy's own import, in fresh interpreters, the median of many.

The target is 50 ms, on a quiet machine; the ratio to numpy's import says more on a busy one. `-X importtime`
tells where the rest goes.
"""

import statistics
import subprocess
import sys
import time

REPEATS = 15


def seconds(statement):
    """Return the wall time of a fresh interpreter that runs one statement [s]."""
    start = time.perf_counter()
    subprocess.run([sys.executable, "-c", statement], check=True)
    return time.perf_counter() - start


def main():
    """Print the comparison."""
    statements = {"nothing": "pass", "numpy": "import numpy", "pliant": "import pliant"}
    # Interleaved, so that a busy moment of the machine meets all of them.
    times = {name: [] for name in statements}
    for _ in range(REPEATS):
        for name, statement in statements.items():
            times[name].append(seconds(statement))
    median = {name: 1e3 * statistics.median(values) for name, values in times.items()}
    numpy = median["numpy"] - median["nothing"]
    beyond = median["pliant"] - median["numpy"]
    print(
        f"interpreter {median['nothing']:.0f} ms, numpy {numpy:.0f} ms, "
        f"pliant {beyond:.0f} ms beyond numpy ({beyond / numpy:.2f} of numpy's)"
    )


if __name__ == "__main__":
    main()
