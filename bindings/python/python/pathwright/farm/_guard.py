"""A process that does one row after the other, and is killed when one takes too much."""

from __future__ import annotations

import atexit
import contextlib
import json
import os
import queue
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections import deque
from collections.abc import Generator, Iterable
from dataclasses import dataclass
from typing import Any, Optional

import psutil

from ._store import opened

#: How often memory is looked at, s.
_EVERY_S = 0.05
#: After so many rows a process is replaced, so that what it leaks is bounded.
_MOST = 1000
#: Dask sets it for workers that hold data. Here memory would be given back and asked for again with every layer, which makes
#: slicing a tenth slower.
_TRIM = "MALLOC_TRIM_THRESHOLD_"


@dataclass(frozen=True)
class Limits:
    """What a row may take."""

    timeout_s: float
    memory_bytes: int


#: Tasks and the rows that each comes to.
Done = Generator[tuple[dict[str, Any], list[dict[str, Any]]], None, None]


class Guard:
    """A process that waits for rows, as tasks."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._child: Optional[psutil.Popen] = None
        self._answers: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._errors: Any = None
        self._done = 0

    def run(self, tasks: Iterable[dict[str, Any]]) -> Done:
        """Tasks, each as soon as it is done, with the rows that it comes to; one with an error, if its process ends, or takes too
        much. The process has all of them from the start, so that it never waits."""
        waiting = deque(tasks)
        if self._done >= _MOST or (self._child is not None and self._child.poll() is not None):
            self.close()
        told: Optional[psutil.Popen] = None
        try:
            while waiting:
                child = self._ready()
                if child is not told:
                    told = child
                    _tell(child, waiting)
                rows = self._answer(child)
                self._done += 1
                yield waiting.popleft(), rows
        finally:
            # Nobody asks for what is left.
            if waiting:
                self.close()

    def _answer(self, child: psutil.Popen) -> list[dict[str, Any]]:
        """The rows of the task that the process is at."""
        began, most_bytes = time.monotonic(), 0
        while True:
            try:
                answer = self._answers.get(timeout=_EVERY_S)
            except queue.Empty:
                answer = None
            with contextlib.suppress(psutil.Error):
                most_bytes = max(most_bytes, child.memory_info().rss)
            took_s = time.monotonic() - began
            if answer:
                rows: list[dict[str, Any]] = json.loads(answer)
            elif answer == "":
                rows = [self._ended()]
            elif most_bytes > self._limits.memory_bytes:
                rows = [self._killed("memory", f"more than {self._limits.memory_bytes >> 20} MB of memory are needed")]
            elif took_s > self._limits.timeout_s:
                rows = [self._killed("timeout", f"not done after {self._limits.timeout_s:g} s")]
            else:
                continue
            return [{**row, "seconds": took_s, "memory_mb": most_bytes / 2**20} for row in rows]

    def close(self) -> None:
        """Ends the process."""
        if self._child is not None:
            self._child.kill()
            self._child.wait()
            self._child = None

    def _ready(self) -> psutil.Popen:
        if self._child is None:
            self._done = 0
            self._errors = tempfile.TemporaryFile("w+", errors="replace")
            command = [sys.executable, "-m", f"{__package__}._work", str(self._limits.memory_bytes)]
            pipe = subprocess.PIPE
            environment = {name: value for name, value in os.environ.items() if name != _TRIM}
            child = psutil.Popen(
                command, stdin=pipe, stdout=pipe, stderr=self._errors, encoding="utf-8", env=environment
            )
            self._child, self._answers = child, queue.SimpleQueue()
            threading.Thread(target=_listen, args=(child, self._answers), daemon=True).start()
        return self._child

    def _killed(self, kind: str, error: str) -> dict[str, Any]:
        self.close()
        return {"error_kind": kind, "error": error}

    def _ended(self) -> dict[str, Any]:
        """How a process ended by itself."""
        child, self._child = self._child, None
        assert child is not None
        code = child.wait()
        self._errors.seek(0)
        last = self._errors.read()[-500:].strip()
        if "memory allocation of" in last or "MemoryError" in last:
            return {"error_kind": "memory", "error": last}
        how = signal.Signals(-code).name if code < 0 else f"code {code}"
        return {"error_kind": "crash", "error": f"its process ended with {how}: {last}".rstrip(": ")}


def _tell(child: psutil.Popen, tasks: Iterable[dict[str, Any]]) -> None:
    with contextlib.suppress(OSError):  # It has ended, which its answers tell as well.
        child.stdin.write("".join(json.dumps(task) + "\n" for task in tasks))
        child.stdin.flush()


def _listen(child: psutil.Popen, answers: queue.SimpleQueue[str]) -> None:
    for line in child.stdout:
        answers.put(line)
    answers.put("")


_GUARDS: dict[tuple[int, Limits], Guard] = {}


@atexit.register
def _close() -> None:
    for guard in _GUARDS.values():
        guard.close()


def work(tasks: list[dict[str, Any]], limits: Limits) -> list[list[dict[str, Any]]]:
    """Does tasks in the process of this thread, and records the rows of each at once."""
    guard = _GUARDS.setdefault((threading.get_ident(), limits), Guard(limits))
    done = []
    with contextlib.closing(guard.run(tasks)) as answers:
        for task, rows in answers:
            rows = [{"id": task["id"], **task["row"], **row} for row in rows]
            opened(task["out"]).record(task["about"]["work"], task["id"], rows)
            done.append(rows)
    return done
