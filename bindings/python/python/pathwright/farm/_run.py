"""Rows → tasks on a Dask cluster → the table."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Optional

import dask
import distributed

from . import _catalogue, _guard
from ._store import Store
from ._table import Table

#: How often a row is tried whose worker is lost: each time it may have been another row's fault.
_TRIES = 20
#: How often workers on this machine are counted, s.
_LOST_S = 5.0
#: Tasks that wait at the scheduler for each thread of a worker.
_WAITING = 3


@dataclass(frozen=True)
class Job:
    """What is done with a catalogue."""

    rows: list[_catalogue.Row]
    #: Path or URL.
    out: str
    #: What is done with every row: it is part of the identity of a result.
    about: dict[str, Any]
    #: What is the same for every row, below what the row says.
    common: dict[str, Any]
    limits: _guard.Limits
    #: Kinds of errors that are tried again.
    retry: frozenset[str] = frozenset()


def run(job: Job, scheduler: Optional[str], workers: int) -> tuple[Table, Counter[str]]:
    """Does what is not done yet. The table, and how many rows ended how (`""`: well)."""
    store = Store(job.out)
    table = Table(job.about["work"], store)
    table.load()
    # What all rows share is told with them.
    about = {**job.about, "common": job.common}
    wanted = dict(_catalogue.identified(job.rows, about))
    again = {identity for identity in wanted if table.known.get(identity) in job.retry - {""}}
    if again:
        table.drop(again)
    tasks = [_task(job, identity, row) for identity, row in wanted.items() if identity not in table.known]
    try:
        if tasks:
            with _client(scheduler, workers) as client:
                _work(client, tasks, job.limits, table)
    finally:
        if tasks or not store.exists(f"{job.about['work']}.parquet"):
            table.save()
    return table, Counter(table.known[identity] for identity in wanted)


def _task(job: Job, identity: str, row: _catalogue.Row) -> dict[str, Any]:
    options: dict[str, Any] = {**job.common}
    options |= {name: value for name in ("printer", "print", "filament") if (value := getattr(row, name))}
    if row.profiles:
        options["profiles"] = [*job.common.get("profiles", []), *row.profiles]
    options["settings"] = {**job.common.get("settings", {}), **row.settings}
    return {
        "id": identity,
        "model": row.model,
        "row": row.columns(),
        "out": job.out,
        "about": job.about,
        "options": options,
    }


@contextmanager
def _client(scheduler: Optional[str], workers: int) -> Iterator[distributed.Client]:
    if scheduler is not None:
        with distributed.Client(scheduler) as client:
            yield client
        return
    # Rows are not to blame for workers that are lost: they run in processes of their own.
    dask.config.set({"distributed.scheduler.allowed-failures": 1000})
    over = threading.Event()
    with _cluster(workers) as cluster, distributed.Client(cluster) as client:

        def keep() -> None:
            # A worker that is lost while it starts is not started again by itself.
            while not over.wait(_LOST_S):
                cluster.scale(workers)

        threading.Thread(target=keep, daemon=True).start()
        try:
            yield client
        finally:
            over.set()


def _cluster(workers: int, starts: int = 3) -> distributed.LocalCluster:
    """Workers on this machine. Where one is lost while it starts, all are started again."""
    try:
        return distributed.LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None)
    except RuntimeError:
        if starts == 1:
            raise
    return _cluster(workers, starts - 1)


def _work(client: distributed.Client, tasks: list[dict[str, Any]], limits: _guard.Limits, table: Table) -> None:
    """Keeps the workers busy: no more waits at the scheduler than they do in a moment."""
    tries: Counter[str] = Counter()
    left = iter(tasks)
    waiting: dict[str, dict[str, Any]] = {}
    running = distributed.as_completed()
    bar = _Bar(len(tasks))

    def submit(task: dict[str, Any]) -> None:
        key = f"{task['id']}-{tries[task['id']]}"
        waiting[key] = task
        running.add(client.submit(_guard.work, task, limits, key=key, pure=False))

    def fill() -> None:
        room = _WAITING * max(sum(client.nthreads().values()), 1)
        while len(waiting) < room and (task := next(left, None)) is not None:
            submit(task)

    fill()
    while waiting:
        future = next(running)
        task = waiting.pop(future.key)
        if future.status == "finished":
            table.add(future.result())
            bar.step()
        else:
            tries[task["id"]] += 1
            if tries[task["id"]] < _TRIES:
                submit(task)
            else:
                error = f"its worker was lost {_TRIES} times: {future.exception()}"
                table.add([{"id": task["id"], **task["row"], "error_kind": "lost", "error": error}])
                bar.step()
        future.release()
        if len(waiting) < _WAITING * 2 or bar.is_due():
            fill()
    bar.end()


class _Bar:
    """How far it is, on a terminal."""

    def __init__(self, total: int) -> None:
        self._total, self._done = total, 0
        self._began = self._told = time.monotonic()
        self._is_shown = sys.stderr.isatty()

    def step(self) -> None:
        self._done += 1
        if self._is_shown and time.monotonic() - self._told > 0.5:
            self._told = time.monotonic()
            rate = self._done / (self._told - self._began)
            left = (self._total - self._done) / rate
            print(f"\r{self._done} of {self._total} rows, {rate:.1f}/s, {left:.0f} s left ", end="", file=sys.stderr)

    def is_due(self) -> bool:
        return self._done % 4 == 0

    def end(self) -> None:
        if self._is_shown:
            print(file=sys.stderr)


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
