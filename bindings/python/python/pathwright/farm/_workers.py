"""The cluster that does the work: of Dask, somewhere, or workers on this machine."""

from __future__ import annotations

import multiprocessing
import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Optional

if TYPE_CHECKING:
    import distributed

#: How often workers on this machine are counted, s.
_LOST_S = 5.0
#: What workers on this machine are forked with.
_PRELOADED = ["distributed", "distributed.nanny", f"{__package__}._forked"]


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def prepare() -> None:
    """Lets a process import what workers on this machine need, while this one imports what it needs itself."""
    if _method() == "forkserver":
        from multiprocessing import forkserver

        multiprocessing.set_forkserver_preload(_PRELOADED)
        forkserver.ensure_running()


def _method() -> str:
    return "forkserver" if "forkserver" in multiprocessing.get_all_start_methods() else "spawn"


@contextmanager
def client(scheduler: Optional[str], workers: int) -> Iterator[distributed.Client]:
    """A client of the cluster at an address, or of one of so many workers on this machine."""
    import dask
    import distributed

    if scheduler is not None:
        with distributed.Client(scheduler) as client:
            yield client
        return
    dask.config.set(
        {
            # Rows are not to blame for workers that are lost: they run in processes of their own.
            "distributed.scheduler.allowed-failures": 1000,
            "distributed.worker.multiprocessing-method": _method(),
            # Workers wait for processes that do the work: there is little to look at.
            "distributed.worker.profile.enabled": False,
            "distributed.worker.memory.monitor-interval": "1s",
            "distributed.admin.system-monitor.interval": "5s",
            "distributed.admin.tick.interval": "1s",
            "distributed.scheduler.work-stealing": False,
            "distributed.scheduler.active-memory-manager.start": False,
        }
    )
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
    import distributed

    try:
        return distributed.LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None)
    except RuntimeError:
        if starts == 1:
            raise
    return _cluster(workers, starts - 1)
