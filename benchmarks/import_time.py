"""What `import pliant` costs beyond numpy's own import, in fresh interpreters, the median of many.

The target is 50 ms, on a quiet machine; the ratio to numpy's import says more on a busy one. `-X importtime`
tells where the rest goes. All modules are compiled beforehand, as installers do; `pliant, all of it` takes
what runs models as well, which is imported when it is asked for first.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time

REPEATS = 15


def seconds(statement, compiled):
    """Return the wall time of a fresh interpreter [s]; `compiled` is where modules are kept."""
    environment = {**os.environ, "PYTHONPYCACHEPREFIX": compiled}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    start = time.perf_counter()
    subprocess.run([sys.executable, "-c", statement], check=True, env=environment)
    return time.perf_counter() - start


def main():
    """Print the comparison."""
    statements = {
        "nothing": "pass",
        "numpy": "import numpy",
        "pliant": "import pliant",
        "pliant, all of it": "import pliant; pliant.simulate",
    }
    # Interleaved, so that a busy moment of the machine meets all of them.
    times = {name: [] for name in statements}
    with tempfile.TemporaryDirectory() as compiled:
        for statement in statements.values():
            seconds(statement, compiled)
        for _ in range(REPEATS):
            for name, statement in statements.items():
                times[name].append(seconds(statement, compiled))
    median = {name: 1e3 * statistics.median(values) for name, values in times.items()}
    numpy = median["numpy"] - median["nothing"]
    print(f"interpreter {median['nothing']:.0f} ms, numpy {numpy:.0f} ms")
    for name in list(statements)[2:]:
        beyond = median[name] - median["numpy"]
        print(f"{name}: {beyond:.0f} ms beyond numpy ({beyond / numpy:.2f} of numpy's)")


if __name__ == "__main__":
    main()
