"""Rows → tasks on a Dask cluster → the table."""

from __future__ import annotations

import sys
import time
from collections import Counter, deque
from dataclasses import dataclass
from typing import Any, Optional

import distributed

from . import _catalogue, _guard, _workers
from ._store import Store
from ._table import Table

#: How often a row is tried whose worker is lost: each time it may have been another row's fault.
_TRIES = 20
#: Batches that are at the scheduler for each thread of a worker.
_WAITING = 3
#: How long a batch takes, about, s, and the most rows in it.
_BATCH_S = 2.0
_BATCH = 50
#: How often the threads of the cluster are counted, s.
_COUNT_S = 5.0


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
    wanted = _catalogue.identified(job.rows, about)
    again = {identity for identity in wanted if table.known.get(identity) in job.retry - {""}}
    if again:
        table.drop(again)
    tasks = [_task(job, identity, row) for identity, row in wanted.items() if identity not in table.known]
    try:
        if tasks:
            with _workers.client(scheduler, workers) as client:
                _Feeder(client, tasks, job.limits, table).run()
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


class _Feeder:
    """Keeps workers busy: no more waits at the scheduler than they do in a moment."""

    def __init__(self, client: distributed.Client, tasks: list[dict[str, Any]], limits: _guard.Limits, table: Table) -> None:
        self._client, self._limits, self._table = client, limits, table
        self._left = deque(tasks)
        #: How often the worker of a row was lost.
        self._lost: Counter[str] = Counter()
        self._waiting: dict[str, list[dict[str, Any]]] = {}
        self._running = distributed.as_completed()
        self._threads, self._counted = 1, float("-inf")
        self._row_s: Optional[float] = None
        self._bar = _Bar(len(tasks))

    def run(self) -> None:
        """Until there is a row of each."""
        self._fill()
        while self._waiting:
            future = next(self._running)
            tasks = self._waiting.pop(future.key)
            if future.status == "finished":
                for rows in future.result():
                    self._add(rows)
            else:
                self._again(tasks, future.exception())
            future.release()
            self._fill()
        self._bar.end()

    def _fill(self) -> None:
        if time.monotonic() - self._counted > _COUNT_S:
            self._threads, self._counted = max(sum(self._client.nthreads().values()), 1), time.monotonic()
        while self._left and len(self._waiting) < _WAITING * self._threads:
            first = self._left[0]["id"]
            # One that may be to blame goes alone.
            size = 1 if self._lost[first] else self._batch()
            tasks = [self._left.popleft() for _ in range(size)]
            key = f"{first}-{self._lost[first]}"
            self._waiting[key] = tasks
            self._running.add(self._client.submit(_guard.work, tasks, self._limits, key=key, pure=False))

    def _batch(self) -> int:
        """Rows that go together: so many that the scheduler is asked every other second, and few when few are left."""
        if self._row_s is None:
            return 1
        most = min(_BATCH_S / max(self._row_s, 1e-3), len(self._left) / (_WAITING * self._threads), _BATCH)
        return max(int(most), 1)

    def _add(self, rows: list[dict[str, Any]]) -> None:
        self._table.add(rows)
        took_s = float(rows[0].get("seconds") or 0.0)
        self._row_s = took_s if self._row_s is None else 0.9 * self._row_s + 0.1 * took_s
        self._bar.step()

    def _again(self, tasks: list[dict[str, Any]], error: Any) -> None:
        """What is to be done about tasks whose worker was lost."""
        for task in tasks:
            if (rows := self._table.recorded(task["id"])) is not None:
                self._add(rows)
                continue
            self._lost[task["id"]] += 1
            if self._lost[task["id"]] < _TRIES:
                self._left.appendleft(task)
            else:
                lost = {"error_kind": "lost", "error": f"its worker was lost {_TRIES} times: {error}"}
                self._add([{"id": task["id"], **task["row"], **lost}])


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

    def end(self) -> None:
        if self._is_shown:
            print(file=sys.stderr)
