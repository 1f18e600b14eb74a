"""`pw.order` beside vpype's `linesort`, plain and with `--two-opt`: pen-up travel and time, on real drawings and random lines.

    python benches/linesort.py --folder target/drawings [--random 100,1000,10000,20000] > table.md

Drawings that are not in the folder are fetched into it. Columns: travel in mm as drawn, by linesort, by linesort with two-opt;
by `pw.order` with all paths as open ones, which is what linesort takes them for, with `effort="high"`, and with loops begun at
any vertex, for which the bound is; then the seconds of these five.
"""

from __future__ import annotations

import argparse
import logging
import sys
import time
import urllib.request
from pathlib import Path
from typing import Callable, Optional

import numpy as np
import vpype as vp
from vpype_cli import execute

import pathwright as pw

GITHUB = "https://raw.githubusercontent.com"
SKETCHES = f"{GITHUB}/abey79/sketches/71140bcd10edb9847fc533e50ebb61e261d29f27"
VPYPE = f"{GITHUB}/abey79/vpype/8dad3ec678e8298145b4533dffe8acfca3c70005/tests/data/test_svg"
AXIDRAW = f"{GITHUB}/evil-mad/axidraw/a0df054f41f8e3ae8d408e08e7b2656968e375f1"
NANOSVG = f"{GITHUB}/memononen/nanosvg/66579081d84b613daa49a64f76357ce65925e13b"
#: Drawings by plotter artists and makers of plotters, and test drawings of vpype's own.
DRAWINGS = [
    f"{SKETCHES}/circular_patterns/output/circular_patterns_liked_1.svg",
    f"{SKETCHES}/bez_grid/output/bez_grid_sketch_final_A_a3.svg",
    f"{SKETCHES}/machine_typography/output/machine_typography_14_2.svg",
    f"{VPYPE}/benchmark/7k_lines.svg",
    f"{VPYPE}/benchmark/multi_skull.svg",
    f"{VPYPE}/issue_58/a49n.svg",
    f"{VPYPE}/issue_58/circlelines_3.svg",
    f"{VPYPE}/issue_58/voronoi_working.svg",
    f"{VPYPE}/issue_59/halftone_1600487839466.svg",
    f"{VPYPE}/issue_124/plotter.svg",
    f"{NANOSVG}/example/23.svg",
]
MM_PER_PIXEL = 25.4 / 96.0
#: Bounds of more paths take minutes.
CERTIFIED = 3000


def main() -> None:
    """Prints a table in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--folder", type=Path, default=Path("target/drawings"))
    parser.add_argument("--random", default="100,1000,10000,20000", help="numbers of random lines")
    parser.add_argument("--two-opt-up-to", type=int, default=40_000, help="paths above which two-opt is left out")
    given = parser.parse_args()
    logging.disable(logging.INFO)
    print("| drawing | paths | as drawn | linesort | two-opt | open | open, high | loops | bound | s | s | s | s | s |")
    print("|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|")
    for url in DRAWINGS:
        path = given.folder / url.rsplit("/", 1)[-1]
        if not path.exists():
            given.folder.mkdir(parents=True, exist_ok=True)
            urllib.request.urlretrieve(url, path)  # noqa: S310
        lines = vp.read_svg(str(path), quantization=0.1)[0]
        row(path.stem, lines, given.two_opt_up_to)
    for count in map(int, filter(None, given.random.split(","))):
        ends = np.random.default_rng(count).random((count, 2, 2)) * [210.0, 297.0] / MM_PER_PIXEL
        row(f"{count} random lines", vp.LineCollection([line[:, 0] + 1j * line[:, 1] for line in ends]), given.two_opt_up_to)


def row(name: str, lines: vp.LineCollection, two_opt_up_to: int) -> None:
    """A row of the table: lengths in mm, then seconds."""
    results: list[Optional[tuple[float, float]]] = [
        timed(lambda: execute("linesort", vp.Document(lines)).layers[1].pen_up_length()[0] * MM_PER_PIXEL),
        timed(lambda: execute("linesort --two-opt", vp.Document(lines)).layers[1].pen_up_length()[0] * MM_PER_PIXEL)
        if len(lines) <= two_opt_up_to
        else None,
        timed(lambda: pw.order([line * MM_PER_PIXEL for line in lines]).length),
        timed(lambda: pw.order([line * MM_PER_PIXEL for line in lines], effort="high").length),
        timed(lambda: ordered(lines).length),
    ]
    bound = ordered(lines, certify=True).bound if len(lines) <= CERTIFIED else None
    before = lines.pen_up_length()[0] * MM_PER_PIXEL
    lengths = [before, *(result and result[0] for result in results), bound]
    cells = ["–" if length is None else f"{length:.0f}" for length in lengths]
    seconds = ["–" if result is None else f"{result[1]:.2f}" for result in results]
    print(f"| {name} | {len(lines)} | {' | '.join(cells + seconds)} |", flush=True)
    theirs = (results[1] or results[0] or (0.0, 0.0))[0]
    for result, how in zip(results[2:4], ("", " with effort high")):
        if result is not None and result[0] > theirs - 1e-3:
            print(f"{name}: not shorter{how}: {result[0]:.3f} mm, linesort {theirs:.3f} mm", file=sys.stderr)


def ordered(lines: vp.LineCollection, certify: bool = False) -> pw.Order:
    """Paths that end where they begin are loops."""
    closed = [len(line) > 3 and line[0] == line[-1] for line in lines]
    loops = [line[:-1] * MM_PER_PIXEL if is_closed else line * MM_PER_PIXEL for line, is_closed in zip(lines, closed)]
    return pw.order(loops, closed=closed, certify=certify)


def timed(work: Callable[[], float]) -> tuple[float, float]:
    """A result, and the seconds that it took."""
    began = time.perf_counter()
    result = work()
    return result, time.perf_counter() - began


if __name__ == "__main__":
    main()
