"""A process that does one task after the other, and is killed when one takes too much."""

from __future__ import annotations

import atexit
import json
import queue
import signal
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass
from typing import Any, Optional

import psutil

from ._store import Store

#: How often memory is looked at, s.
_EVERY_S = 0.05
#: After so many tasks a process is replaced, so that what it leaks is bounded.
_TASKS = 1000


@dataclass(frozen=True)
class Limits:
    """What a row may take."""

    timeout_s: float
    memory_bytes: int


class Guard:
    """A process that waits for tasks."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._child: Optional[subprocess.Popen[str]] = None
        self._answers: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._errors: Any = None
        self._tasks = 0

    def run(self, task: dict[str, Any]) -> list[dict[str, Any]]:
        """The rows that a task comes to; one with an error, if its process ends, or takes too much."""
        began, most_bytes = time.monotonic(), 0
        child = self._ready()
        process = psutil.Process(child.pid)
        assert child.stdin is not None
        try:
            child.stdin.write(json.dumps(task) + "\n")
            child.stdin.flush()
        except OSError:
            return [self._ended()]
        while True:
            try:
                answer = self._answers.get(timeout=_EVERY_S)
            except queue.Empty:
                answer = None
            try:
                most_bytes = max(most_bytes, process.memory_info().rss)
            except psutil.Error:
                pass
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
            self._tasks += 1
            return [{**row, "seconds": took_s, "memory_mb": most_bytes / 2**20} for row in rows]

    def close(self) -> None:
        """Ends the process."""
        if self._child is not None:
            self._child.kill()
            self._child.wait()
            self._child = None

    def _ready(self) -> subprocess.Popen[str]:
        if self._tasks >= _TASKS or (self._child is not None and self._child.poll() is not None):
            self.close()
        if self._child is None:
            self._tasks = 0
            self._errors = tempfile.TemporaryFile("w+", errors="replace")
            command = [sys.executable, "-m", f"{__package__}._work", str(self._limits.memory_bytes)]
            pipe = subprocess.PIPE
            child = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=self._errors, encoding="utf-8")
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


def _listen(child: subprocess.Popen[str], answers: queue.SimpleQueue[str]) -> None:
    assert child.stdout is not None
    for line in child.stdout:
        answers.put(line)
    answers.put("")


_GUARDS: dict[tuple[int, Limits], Guard] = {}


@atexit.register
def _close() -> None:
    for guard in _GUARDS.values():
        guard.close()


def work(task: dict[str, Any], limits: Limits) -> list[dict[str, Any]]:
    """Does a task in the process of this thread, and records its rows."""
    guard = _GUARDS.setdefault((threading.get_ident(), limits), Guard(limits))
    rows = [{"id": task["id"], **task["row"], **row} for row in guard.run(task)]
    Store(task["out"]).record(task["about"]["work"], task["id"], rows)
    return rows
