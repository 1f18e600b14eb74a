"""The farm measured: throughput beside two processes in a loop, and what is left after kills.

    python benches/farm.py throughput FOLDER [--rows 1000]   # beside the program, too, where PATHWRIGHT names it
    python benches/farm.py kills FOLDER [--rows 1000]

The catalogue is generated: boxes, rings and screws × settings, of which three in a hundred are broken or never end.
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import ctypes
import hashlib
import json
import multiprocessing
import os
import random
import resource
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, Callable, NamedTuple

import numpy as np
import numpy.typing as npt
import psutil
import pyarrow.parquet

import pathwright as pw
from pathwright._models import _corners, _stl

TIMEOUT_S = 5.0
#: Of `prctl`: processes whose parents have ended become children of this one.
SET_CHILD_SUBREAPER = 36


def prism(corners: npt.NDArray[np.float64], height: float, turn: float, steps: int) -> bytes:
    """A polygon (shape (n, 2)) that is raised and turned; as STL."""
    n = len(corners)
    rings = []
    for step in range(steps + 1):
        sine, cosine = np.sin(turn * step / steps), np.cos(turn * step / steps)
        turned = corners @ np.array([[cosine, sine], [-sine, cosine]])
        rings.append(np.column_stack([turned, np.full(n, height * step / steps)]))
    vertices = np.concatenate([*rings, [[0, 0, 0], [0, 0, height]]])
    low, high = len(vertices) - 2, len(vertices) - 1
    faces = []
    for step in range(steps):
        for i in range(n):
            a, b = step * n + i, step * n + (i + 1) % n
            faces += [[a, b, b + n], [a, b + n, a + n]]
    for i in range(n):
        j = (i + 1) % n
        faces += [[low, j, i], [high, steps * n + i, steps * n + j]]
    return _stl(_corners(vertices, np.array(faces), "prism"))


def catalogue(folder: Path, rows: int) -> Path:
    """Models and the catalogue."""
    models = folder / "models"
    shutil.rmtree(folder, ignore_errors=True)
    models.mkdir(parents=True)
    shapes = []
    for k in range(20):
        n = 3 + k % 7 * 5
        angle = 2 * np.pi * np.arange(n) / n
        radius = 8 + k + 3 * np.cos(angle * (k % 4))
        corners = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
        name = f"prism{k}.stl"
        (models / name).write_bytes(prism(corners, 6 + k % 5, 0.1 * k, 8))
        shapes.append(name)
    path = models / "catalogue.csv"
    with path.open("w", newline="") as file:
        out = csv.writer(file)
        out.writerow(["model", "infill.density", "walls.count", "layer.height"])
        for i in range(rows):
            name = shapes[i % len(shapes)]
            if i % 100 == 33:
                name = f"broken{i}.stl"
                (models / name).write_bytes(b"solid broken\n" * 3)
            elif i % 100 == 50:
                name = f"cut{i}.stl"
                (models / name).write_bytes((models / shapes[3]).read_bytes()[:500])
            elif i % 100 == 67:
                name = f"endless{i}.stl"
                os.mkfifo(models / name)
            out.writerow([name, f"{5 + i // 20}%", 2 + i % 3, 0.2])
    return path


def farm(path: Path, out: Path, *more: str) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "pathwright.farm", "slice", str(path), "--out", str(out), "--workers", "2"]
    log = path.with_name("log.txt").open("ab")
    return subprocess.Popen([*command, "--timeout", str(TIMEOUT_S), *more], stderr=log)


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def loop_of_programs(path: Path, rows: list[dict[str, str]], out: Path) -> None:
    """Starts the program for each row, and kills it when it takes too long."""
    for i, row in enumerate(rows):
        settings = [f"--set={key}={value}" for key, value in row.items() if "." in key]
        target = out / f"{os.getpid()}-{i}.gcode"
        command = [os.environ["PATHWRIGHT"], "slice", str(path.parent / row["model"]), *settings]
        try:
            subprocess.run([*command, "-o", str(target), "--threads", "1", "-q"], timeout=TIMEOUT_S, stderr=subprocess.DEVNULL)
        except subprocess.TimeoutExpired:
            pass


def loop_of_calls(path: Path, rows: list[dict[str, str]], out: Path) -> None:
    """Slices each row in this process; nothing protects it from a model that never ends."""
    for i, row in enumerate(rows):
        settings = {key: value for key, value in row.items() if "." in key}
        try:
            print_ = pw.slice(path.parent / row["model"], settings=settings, threads=1)
        except pw.Error:
            continue
        (out / f"{os.getpid()}-{i}.gcode").write_bytes(print_.gcode)


def two(work: Any, path: Path, rows: list[dict[str, str]], out: Path) -> Spent:
    """Two processes, each with every other row."""
    out.mkdir()

    def run() -> None:
        both = [multiprocessing.Process(target=work, args=(path, rows[first::2], out)) for first in (0, 1)]
        for process in both:
            process.start()
        for process in both:
            process.join()

    return spent(run)


class Spent(NamedTuple):
    """Seconds by the clock, and of processors: where a machine does other things as well, those say more."""

    wall_s: float
    cpu_s: float

    def __str__(self) -> str:
        return f"{self.wall_s:.1f} s ({self.cpu_s:.1f} s of processors)"


def spent(run: Callable[[], object]) -> Spent:
    """What a run and its processes take."""
    began, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
    run()
    wall_s = time.monotonic() - began
    # What is left of it belongs to this process now, and counts once it has been waited for.
    with contextlib.suppress(ChildProcessError):
        while True:
            os.wait()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Spent(wall_s, cpu_s)


def told(what: str, ours: Spent, name: str, theirs: Spent) -> None:
    shares = f"{theirs.wall_s / ours.wall_s:.2f} by the clock, {theirs.cpu_s / ours.cpu_s:.2f} by processors"
    print(f"{what}: farm {ours}, two loops of {name} {theirs}: its throughput is {shares}", flush=True)


def throughput(folder: Path, rows: int, turns: int) -> None:
    ctypes.CDLL(None).prctl(SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    path = catalogue(folder, rows)
    all_rows = rows_of(path)
    ending = [row for row in all_rows if "endless" not in row["model"]]
    only = path.with_name("ending.csv")
    with only.open("w", newline="") as file:
        out = csv.DictWriter(file, list(ending[0]))
        out.writeheader()
        out.writerows(ending)

    def farmed(path: Path, name: str) -> Spent:
        def run() -> None:
            assert farm(path, folder / name).wait() == 0

        return spent(run)

    for turn in range(turns):
        if "PATHWRIGHT" in os.environ:
            ours, theirs = farmed(path, f"farm{turn}"), two(loop_of_programs, path, all_rows, folder / f"loop{turn}")
            told(f"{rows} rows", ours, "the program", theirs)
        ours, theirs = farmed(only, f"good{turn}"), two(loop_of_calls, only, ending, folder / f"calls{turn}")
        told(f"{len(ending)} that end", ours, "pw.slice", theirs)
    print(f"a second run: {farmed(only, 'good0')}")


def results(out: Path) -> dict[str, Any]:
    """What a run came to: each row without what differs from run to run, and the hash of its G-code."""
    found: dict[str, Any] = {}
    for row in pyarrow.parquet.read_table(out / "slice.parquet").to_pylist():
        assert row["id"] not in found, "a row is there twice"
        told = {key: value for key, value in row.items() if key not in ("seconds", "memory_mb", "error")}
        gcode = row["gcode"] and hashlib.sha256((out / row["gcode"]).read_bytes()).hexdigest()
        found[row["id"]] = (json.dumps(told, sort_keys=True), gcode)
    return found


def kills(folder: Path, rows: int) -> None:
    path = catalogue(folder, rows)
    assert farm(path, folder / "quiet").wait() == 0
    chance, killed, most_mb = random.Random(7), 0, 0.0
    out = folder / "killed"
    process = farm(path, out)
    client_killed = False
    began = time.monotonic()
    while process.poll() is None:
        time.sleep(chance.uniform(1.0, 2.5))
        done = len(list(out.glob("slice.rows/*/*.json")))
        try:
            below = psutil.Process(process.pid).children(recursive=True)
            # Workers are forked from a process that is forked from the client.
            servers = {one.pid for one in below if one.ppid() == process.pid}
            workers = [one for one in below if one.ppid() in servers and "forkserver" in " ".join(one.cmdline())]
            most_mb = max([most_mb, *(one.memory_info().rss / 2**20 for one in below)])
        except psutil.Error:
            continue
        if not client_killed and killed >= 5:
            print(f"the client is killed after {done} rows", flush=True)
            process.kill()
            process.wait()
            time.sleep(3.0)
            left = [one for one in below if one.is_running() and one.status() != psutil.STATUS_ZOMBIE]
            print(f"{len(left)} processes of it are left 3 s later")
            client_killed, process = True, farm(path, out)
        elif killed < 10 and workers and done > 0:
            try:
                chance.choice(workers).kill()
                killed += 1
            except psutil.Error:
                continue
    assert process.returncode == 0
    print(f"{killed} workers killed, in {time.monotonic() - began:.0f} s; no process had more than {most_mb:.0f} MB")
    quiet, loud = results(folder / "quiet"), results(out)
    print(f"{len(quiet)} rows, the same in both runs, G-code and all: {quiet == loud}")
    assert quiet == loud
    began = time.monotonic()
    assert farm(path, out).wait() == 0
    print(f"a second run: {time.monotonic() - began:.1f} s")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("what", choices=["throughput", "kills"])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--rows", type=int, default=1000)
    parser.add_argument("--turns", type=int, default=2, help="pairs of runs")
    given = parser.parse_args()
    if given.what == "throughput":
        throughput(given.folder, given.rows, given.turns)
    else:
        kills(given.folder, given.rows)
