"""What is done with a row, in a process of its own that may be killed at any time."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import sys
import threading
from typing import Any

import fsspec

import pathwright as pw

from .. import _pathwright, _tasks
from ._store import opened

#: By what a refusal for lack of memory is known.
_REFUSED = "of memory are needed"


def done(task: dict[str, Any]) -> list[dict[str, Any]]:
    """The rows of the table that a task comes to."""
    try:
        model = _model(task["model"])
        return compared(model, task) if task["about"]["work"] == "compare" else [sliced(model, task)]
    except pw.Error as error:
        kind = "memory" if _REFUSED in str(error) else error.kind
        return [{"error_kind": kind, "error": str(error)}]
    except (OSError, ValueError, TypeError) as error:
        return [{"error_kind": "input", "error": f"{task['model']}: {type(error).__name__}: {error}"}]


def _model(url: str) -> pw.Model:
    fs, path = fsspec.core.url_to_fs(url)
    return pw.Model(fs.cat_file(path), name=path.rsplit("/", 1)[-1])


def sliced(model: pw.Model, task: dict[str, Any]) -> dict[str, Any]:
    """Slices a model and writes its G-code under its key; figures."""
    job = _tasks.task(model, task["options"])
    key, print_ = job.key(False), pw.Print(job.slice(), job.warnings)
    name = f"gcode/{key[:2]}/{key}.gcode"
    opened(task["out"]).put(name, print_.gcode)
    summary = print_.summary
    return {
        "key": key,
        "gcode": name,
        "time_s": summary["total_s"],
        "filament_mm": summary["filament_mm"],
        "filament_g": summary["filament_g"],
        "cost": summary["filament_cost"],
        "print_mm": summary["print_mm"],
        "travel_mm": summary["travel_mm"],
        "link_mm": summary["link_mm"],
        "bound_mm": summary.get("bound_mm"),
        "layers": summary["layer_count"],
        "warnings": print_.warnings,
    }


def compared(model: pw.Model, task: dict[str, Any]) -> list[dict[str, Any]]:
    """Compares strategies; a row for each. Where bounds would take too long, there are none."""
    columns = ("strategy", "paths", "link_mm", "bound_mm", "gap", "travels", "travel_s", "took_s")
    about, options = task["about"], task["options"]
    rows = pw.compare(model, strategies=about["strategies"], **{**options, "certify": False})
    if options["certify"] and rows[0]["paths"] <= (about["bound_paths"] or float("inf")):
        rows = pw.compare(model, strategies=about["strategies"], **options)
    return [{name: row[name] for name in columns} for row in rows]


def main() -> None:
    """Takes tasks as lines of JSON from standard input, and writes what they come to as lines on standard output. Ends when
    whoever asks is gone, whatever it is doing."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    if len(sys.argv) > 1:
        _limit(int(sys.argv[1]))
    tasks: queue.SimpleQueue[dict[str, Any]] = queue.SimpleQueue()

    def read() -> None:
        for line in sys.stdin:
            tasks.put(json.loads(line))
        os._exit(0)

    threading.Thread(target=read, daemon=True).start()
    while True:
        print(json.dumps(done(tasks.get())), file=answers, flush=True)


def _limit(most_bytes: int) -> None:
    _pathwright.allow_memory(most_bytes)
    with contextlib.suppress(ImportError):  # Windows has no such limits
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        # What is allocated faster than it is looked at.
        most = most_bytes + (most_bytes >> 2)
        resource.setrlimit(resource.RLIMIT_DATA, (most, most))


if __name__ == "__main__":
    main()
