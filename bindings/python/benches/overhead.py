"""What Python costs: slicing beside the program, ordering beside Rust. In pairs, first one and then the other.

    PATHWRIGHT=target/release/pathwright python benches/overhead.py slice MODEL … [--pairs 7]
    TIME_ORDER=target/release/examples/time_order python benches/overhead.py order 10000 [--pairs 7]
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

import pathwright as pw


def slicing(models: list[str], pairs: int) -> None:
    """The whole of a run: from the name of a file to its G-code in a file."""
    with tempfile.TemporaryDirectory() as folder:
        out = str(Path(folder) / "a.gcode")
        for model in models:
            program, ours, theirs_cpu, ours_cpu = [], [], [], []
            for _ in range(pairs):
                began, cpu = time.perf_counter(), processor(resource.RUSAGE_CHILDREN)
                run = [os.environ["PATHWRIGHT"], "slice", model, "-o", out, "-q", "--allow-floating"]
                subprocess.run(run, check=True, stderr=subprocess.DEVNULL)
                program.append(time.perf_counter() - began)
                theirs_cpu.append(processor(resource.RUSAGE_CHILDREN) - cpu)
                began, cpu = time.perf_counter(), processor(resource.RUSAGE_SELF)
                pw.slice(model, allow_floating=True).write(out)
                ours.append(time.perf_counter() - began)
                ours_cpu.append(processor(resource.RUSAGE_SELF) - cpu)
            told(Path(model).name, program, ours)
            told("  processor time", theirs_cpu, ours_cpu)


def processor(who: int) -> float:
    """Processor time so far, s: where a machine does other things as well, it says more than a clock."""
    used = resource.getrusage(who)
    return used.ru_utime + used.ru_stime


def ordering(count: int, pairs: int) -> None:
    """From an array for each line to the arrays of the order."""
    lines = np.random.default_rng(count).random((count, 2, 2)) * [210.0, 297.0]
    with tempfile.NamedTemporaryFile() as file:
        file.write(lines.astype("<f8").tobytes())
        file.flush()
        polylines = list(lines)
        rust, ours = [], []
        for _ in range(pairs):
            out = subprocess.run([os.environ["TIME_ORDER"], file.name], capture_output=True, check=True).stdout.split()
            rust.append(float(out[0]))
            began = time.perf_counter()
            order = pw.order(polylines)
            ours.append(time.perf_counter() - began)
            assert order.length == float(out[1])
        told(f"{count} lines", rust, ours)


def told(name: str, theirs: list[float], ours: list[float]) -> None:
    """The median of the pairs' shares, and that of what is least disturbed."""
    shares = [100.0 * (b / a - 1.0) for a, b in zip(theirs, ours)]
    least = 100.0 * (min(ours) / min(theirs) - 1.0)
    print(f"{name}: {statistics.median(shares):+.1f} % of {statistics.median(theirs):.3f} s, of the shortest {least:+.1f} %", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("what", choices=["slice", "order"])
    parser.add_argument("of", nargs="+", metavar="MODEL|COUNT")
    parser.add_argument("--pairs", type=int, default=7)
    given = parser.parse_args()
    if given.what == "slice":
        slicing(given.of, given.pairs)
    else:
        ordering(int(given.of[0]), given.pairs)
