"""Strategies side by side, as a picture."""

from __future__ import annotations

import io
from collections import defaultdict
from typing import Any

import pyarrow as pa


def plot(table: pa.Table, format: str) -> bytes:
    """The links of each model as a share of those of ``nearest``, strategy by strategy, what no order is below, where that is
    known, and how long they were sought."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot, ticker

    shares, times = measured(table.to_pylist())
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(11, 4.5), layout="constrained")
    for axes, values in ((left, shares), (right, times)):
        names = list(values)
        axes.boxplot([values[name] for name in names], whis=(0, 100), medianprops={"color": "C1"})
        for place, name in enumerate(names, start=1):
            axes.plot([place] * len(values[name]), values[name], ".", color="C0", alpha=0.5)
        axes.set_xticks(range(1, len(names) + 1), names, rotation=20)
        axes.grid(axis="y", alpha=0.3)
    models = max((len(values) for values in shares.values()), default=0)
    left.set_title(f"links between paths, {models} models")
    left.set_ylabel("% of nearest")
    left.set_yscale("log")
    left.yaxis.set_major_locator(ticker.LogLocator(subs=(0.5, 0.6, 0.7, 0.8, 0.9, 1, 1.5, 2, 3, 4)))
    left.yaxis.set_major_formatter(ticker.FormatStrFormatter("%d"))
    left.yaxis.set_minor_locator(ticker.NullLocator())
    right.set_title("processor time of ordering")
    right.set_ylabel("ms for 100 paths")
    right.set_yscale("log")
    file = io.BytesIO()
    figure.savefig(file, format=format, metadata={"Date": None} if format == "svg" else None)
    pyplot.close(figure)
    return file.getvalue()


def measured(rows: list[dict[str, Any]]) -> tuple[dict[str, list[float]], dict[str, list[float]]]:
    """By strategy: links in percent of ``nearest``, with the bound behind them; milliseconds for 100 paths. A point for each
    model."""
    by_row: dict[str, dict[str, dict[str, Any]]] = defaultdict(dict)
    for row in rows:
        if row["strategy"] is not None:
            by_row[row["id"]][row["strategy"]] = row
    shares: dict[str, list[float]] = defaultdict(list)
    times: dict[str, list[float]] = defaultdict(list)
    bounds: list[float] = []
    for strategies in by_row.values():
        nearest = strategies.get("nearest", {}).get("link_mm")
        for name, row in strategies.items():
            if nearest:
                shares[name].append(100.0 * row["link_mm"] / nearest)
                times[name].append(max(1e5 * row["took_s"] / max(row["paths"], 1), 1e-3))
        if nearest and (bound_mm := strategies["nearest"]["bound_mm"]) is not None:
            bounds.append(100.0 * bound_mm / nearest)
    return (shares | {"bound": bounds} if bounds else shares), times
