"""What Python costs: slicing beside the program, ordering beside Rust. Pairs, in turn.

    PATHWRIGHT=target/release/pathwright python benches/overhead.py slice MODEL … [--pairs 7]
    cargo run --release -p pathwright-benches --bin order -- 10000 > rust.txt; python benches/overhead.py order rust.txt
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

import pathwright as pw


def slicing(models: list[str], pairs: int) -> None:
    """The whole of a run: from the name of a file to its G-code in a file."""
    with tempfile.TemporaryDirectory() as folder:
        out = str(Path(folder) / "a.gcode")
        for model in models:
            shares = []
            for _ in range(pairs):
                began = time.perf_counter()
                run = [os.environ["PATHWRIGHT"], "slice", model, "-o", out, "-q", "--allow-floating"]
                subprocess.run(run, check=True, stderr=subprocess.DEVNULL)
                program = time.perf_counter() - began
                began = time.perf_counter()
                pw.slice(model, allow_floating=True).write(out)
                shares.append((time.perf_counter() - began) / program)
            share = statistics.median(shares) - 1.0
            print(f"{Path(model).name}: {100 * share:+.1f} % of {program:.2f} s (from {100 * min(shares) - 100:+.1f} to {100 * max(shares) - 100:+.1f})", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("models", nargs="+")
    parser.add_argument("--pairs", type=int, default=7)
    given = parser.parse_args()
    slicing(given.models, given.pairs)
