"""How long Ctrl-C takes: from the signal to `KeyboardInterrupt`, and until no thread of the run is left.

    python benches/cancel.py MODEL … [--times 20] [--works slice,order]

Each kind of work is interrupted at moments that are spread over its whole length, the models taking turns.
"""

from __future__ import annotations

import argparse
import os
import signal
import statistics
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Callable

import numpy as np

import pathwright as pw

#: Interrupts come this late at most, s.
AT_MOST_S = 8.0
#: How long it is waited for what goes on unseen, s.
LONGEST_S = 120.0


def work(name: str, model: str) -> Callable[[], object]:
    """What is interrupted."""
    lines = list(np.random.default_rng(1).random((20_000, 2, 2)) * 300.0)
    if name in ("reorder", "check", "time"):
        gcode = pw.slice(model, allow_floating=True).gcode
        return {
            "reorder": lambda: pw.reorder(gcode),
            "check": lambda: pw.check(gcode, model),
            "time": lambda: pw.time(gcode),
        }[name]
    return {
        "slice": lambda: pw.slice(model, allow_floating=True),
        "fine": lambda: pw.slice(model, allow_floating=True, settings={"layer.height": 0.1, "order.effort": "high"}),
        "certify": lambda: pw.slice(model, allow_floating=True, certify=True),
        "compare": lambda: pw.compare(model),
        "info": lambda: pw.info(model),
        "order": lambda: pw.order(lines),
        "order-high": lambda: pw.order(lines, effort="high"),
        "order-christofides": lambda: pw.order(lines, strategy="christofides"),
        "order-certify": lambda: pw.order(lines[:2000], certify=True),
    }[name]


def length(call: Callable[[], object]) -> float:
    """How long a call takes, s; what takes longer is interrupted while it begins."""
    began = time.monotonic()
    timer = threading.Timer(AT_MOST_S, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    try:
        call()
        timer.cancel()
    except KeyboardInterrupt:
        return AT_MOST_S
    return time.monotonic() - began


def is_working() -> bool:
    """Whether a thread of a run is left."""
    for task in Path("/proc/self/task").iterdir():
        try:
            if (task / "comm").read_text().strip() == "pathwright":
                return True
        except OSError:
            continue
    return False


def interrupted(name: str, model: str, delay_s: float) -> None:
    """Prints how long it took, and until it was quiet; nothing if it was over before."""
    call = work(name, model)
    sent: list[float] = []

    def interrupt() -> None:
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(delay_s, interrupt)
    timer.start()
    try:
        call()
        timer.cancel()
    except KeyboardInterrupt:
        came_s = time.monotonic() - sent[0]
        while is_working() and time.monotonic() - sent[0] < LONGEST_S:
            time.sleep(0.002)
        print(came_s, time.monotonic() - sent[0], flush=True)
    os._exit(0)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("models", nargs="+", metavar="MODEL")
    parser.add_argument("--times", type=int, default=20, help="interrupts of each kind of work")
    parser.add_argument("--works", default="slice,fine,certify,compare,reorder,order,order-high,order-christofides,order-certify")
    parser.add_argument("--one", nargs=2, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.one:
        interrupted(given.one[0], given.models[0], float(given.one[1]))
    for name in given.works.split(","):
        lengths: dict[str, float] = {}
        came, quiet = [], []
        for turn in range(given.times):
            model = given.models[turn % len(given.models)]
            if model not in lengths:
                lengths[model] = length(work(name, model))
            delay_s = lengths[model] * (turn + 0.5) / given.times
            run = [sys.executable, __file__, model, "--one", name, str(delay_s)]
            out = subprocess.run(run, capture_output=True, text=True, check=True).stdout.split()
            if out:
                came.append(1e3 * float(out[0]))
                quiet.append(1e3 * float(out[1]))
        if came:
            print(
                f"{name}: {len(came)} interrupts, median {statistics.median(came):.0f} ms, most {max(came):.0f} ms; "
                f"quiet after {statistics.median(quiet):.0f} ms, at most {max(quiet):.0f} ms",
                flush=True,
            )


if __name__ == "__main__":
    main()
