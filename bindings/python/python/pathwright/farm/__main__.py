"""``python -m pathwright.farm``."""

from __future__ import annotations

import argparse
import sys
from typing import Optional

from .._slicing import STRATEGIES
from . import _workers

DONE, USAGE, INPUT, OUTPUT, INTERRUPTED = 0, 2, 3, 6, 130


def arguments() -> argparse.ArgumentParser:
    """The command line."""
    parser = argparse.ArgumentParser(
        prog="python -m pathwright.farm",
        description="Slices or compares every model of a catalogue. What is done already is not done again.",
        epilog="Exit codes: 0 done (models that fail are rows), 2 usage, 3 the catalogue cannot be read, "
        "6 results cannot be written, 130 interrupted.",
    )
    works = parser.add_subparsers(dest="work", required=True, metavar="slice|compare")
    common = argparse.ArgumentParser(add_help=False)
    common.add_argument("catalogue", help="CSV, Parquet, or a folder of models; a path or URL")
    common.add_argument("--out", required=True, metavar="URL", help="where results go: a folder, s3://bucket/prefix, …")
    common.add_argument("--scheduler", metavar="ADDR", help="a Dask cluster (tcp://host:8786); default: this machine")
    common.add_argument("--workers", type=int, metavar="N", help="worker processes on this machine; default: a core each")
    common.add_argument("--timeout", type=float, default=600.0, metavar="S", help="seconds for a model (600)")
    common.add_argument("--memory", type=_size, default="2G", metavar="SIZE", help="memory for a model (2G)")
    common.add_argument("--retry", default="", metavar="KINDS", help="try these again: timeout,memory,crash,lost,…")
    common.add_argument("--presets", action="append", default=[], metavar="PATH", help="presets, as workers find them")
    common.add_argument("--profile", action="append", default=[], metavar="NAME", help="for every row, below its own")
    common.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="for every row, below its own")
    slicing = works.add_parser("slice", parents=[common], help="G-code by content hash, and a table")
    slicing.add_argument("--certify", action="store_true", help="compute bounds")
    comparing = works.add_parser("compare", parents=[common], help="all strategies, and a table")
    comparing.add_argument("--strategies", default=",".join(STRATEGIES), metavar="A,B")
    comparing.add_argument("--no-bound", action="store_true", help="compute no bounds, which take the longest")
    about_bounds = "compute none for models with more paths than this (10000); 0: for all"
    comparing.add_argument("--bound-paths", type=int, default=10_000, metavar="N", help=about_bounds)
    comparing.add_argument("--plot", metavar="NAME", help="a picture beside the table: travel.png, .svg or .pdf")
    return parser


def _size(text: str) -> int:
    units = {"K": 10, "M": 20, "G": 30}
    number, shift = (text[:-1], units[text[-1].upper()]) if text[-1:].upper() in units else (text, 0)
    return int(float(number) * (1 << shift))


def main(args: Optional[list[str]] = None) -> int:
    """Runs the command; its exit code."""
    parser = arguments()
    given = parser.parse_args(args)
    if given.work == "compare" and "/" in (given.plot or ""):
        parser.error("--plot is a name without folders: the picture stands beside the table, at --out")
    if given.scheduler is None:
        _workers.prepare()
    try:
        from . import _plot, _run
        from ._catalogue import CatalogueError, read
        from ._guard import Limits
        from ._store import Store
    except ImportError as error:
        return _failed(USAGE, f"{error}; pip install 'pathwright[farm]'")
    settings = dict(pair.split("=", 1) for pair in given.set if "=" in pair)
    if len(settings) < len(given.set):
        parser.error("--set takes KEY=VALUE")
    about: dict[str, object] = {"work": given.work}
    common: dict[str, object] = {"threads": 1, "presets": given.presets}
    common |= {"profiles": given.profile, "settings": settings}
    if given.work == "compare":
        about["strategies"] = given.strategies.split(",")
        about["bound_paths"] = given.bound_paths
        common["certify"] = not given.no_bound
        if unknown := set(given.strategies.split(",")) - set(STRATEGIES):
            parser.error(f"--strategies: {', '.join(sorted(unknown))}: unknown; there are {', '.join(STRATEGIES)}")
    else:
        common["certify"] = given.certify
    try:
        rows = read(given.catalogue)
    except CatalogueError as error:
        return _failed(INPUT, str(error))
    limits = Limits(given.timeout, given.memory)
    job = _run.Job(rows, given.out, about, common, limits, frozenset(filter(None, given.retry.split(","))))
    try:
        table, ended = _run.run(job, given.scheduler, given.workers or _workers.cores())
        if given.work == "compare" and given.plot:
            Store(given.out).put(given.plot, _plot.plot(table.table(), given.plot.rsplit(".", 1)[-1]))
    except KeyboardInterrupt:
        return _failed(INTERRUPTED, "interrupted; the same command goes on where it was")
    except OSError as error:
        return _failed(OUTPUT, f"{given.out}: {error}")
    kinds = ", ".join(f"{kind} {count}" for kind, count in sorted(ended.items()) if kind)
    failed = ended.total() - ended[""] if hasattr(ended, "total") else sum(ended.values()) - ended[""]
    print(f"{given.out}/{given.work}.parquet: {ended['']} rows well, {failed} with errors" + (f" ({kinds})" if kinds else ""))
    return DONE


def _failed(code: int, message: str) -> int:
    print(f"error: {message}", file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
